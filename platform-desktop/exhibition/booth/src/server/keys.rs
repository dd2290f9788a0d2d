//! The keys of a site: its name, the secret of visitors' links, and its certificate authority. They are
//! generated at the first start, and stored in files with mode 0600.

use std::fs::{self, DirBuilder};
use std::os::unix::fs::DirBuilderExt as _;
use std::path::Path;

use paros_booth_rules::SiteKeys;
use paros_protocol::{ContentHash, SiteId};
use paros_shell::durable::write_private_file;
use rcgen::{
    BasicConstraints, CertificateParams, DnType, IsCa, KeyPair, KeyUsagePurpose,
    PKCS_ECDSA_P256_SHA256, date_time_ymd,
};
use tokio_rustls::rustls::pki_types::{CertificateDer, pem::PemObject as _};

use crate::error::Error;
use crate::random::random_bytes;

/// The magic bytes of the file of secrets. The last byte is the version.
const SECRETS_MAGIC: [u8; 8] = *b"PBSITE\0\x02";

/// The length of the file: magic, the site's name, the secret of its links.
const SECRETS_BYTES: usize = 8 + 16 + 32;

/// The keys of a site.
pub(crate) struct BoothKeys {
    /// The keys that the rules use.
    pub site: SiteKeys,
    /// The certificate authority's certificate, in PEM.
    pub ca_pem: String,
    /// The certificate authority's private key.
    pub ca_key: KeyPair,
}

impl BoothKeys {
    /// Returns `true` if a booth's folder holds the keys of a site.
    pub(crate) fn are_in(folder: &Path) -> bool {
        folder.join("keys/site.key").exists()
    }

    /// Loads the keys in a booth's folder. If there are none and `is_new` is `true`, generates them.
    ///
    /// # Errors
    /// The error of the disk or the system; the keys are damaged; the keys are missing and `is_new` is
    /// `false`.
    pub(crate) fn load_or_draw(folder: &Path, is_new: bool) -> Result<Self, Error> {
        let folder = folder.join("keys");
        let secrets = folder.join("site.key");
        if !secrets.exists() {
            if !is_new {
                let why = "its keys are missing; bring them back from a backup, or copy those of another booth of the site";
                return Err(Error::Input(format!("{}: {why}", secrets.display())));
            }
            draw(&folder)?;
        }
        load(&folder)
    }
}

/// Returns the certificate parameters of a site's authority.
pub(crate) fn ca_params(site: &SiteId) -> CertificateParams {
    let mut params = CertificateParams::default();
    params.distinguished_name = Default::default();
    // Each site has another name, so that a tablet can trust several sites.
    params.distinguished_name.push(DnType::CommonName, format!("Paros site {site}"));
    // The validity is long, as a headset's clock may be wrong by years.
    params.not_before = date_time_ymd(2020, 1, 1);
    params.not_after = date_time_ymd(2099, 1, 1);
    params.is_ca = IsCa::Ca(BasicConstraints::Constrained(0));
    params.key_usages = vec![KeyUsagePurpose::KeyCertSign, KeyUsagePurpose::CrlSign];
    params
}

/// Generates all keys. The secrets are written last: if their file is missing, no key was used yet.
fn draw(folder: &Path) -> Result<(), Error> {
    let made = DirBuilder::new().recursive(true).mode(0o700).create(folder);
    made.map_err(|error| Error::at(folder, error))?;
    let random = |error| Error::failure("random bits", error);
    let site = SiteId(random_bytes().map_err(random)?);
    let fail = |error| Error::failure("certificate", error);
    let ca_key = KeyPair::generate_for(&PKCS_ECDSA_P256_SHA256).map_err(fail)?;
    let ca = ca_params(&site).self_signed(&ca_key).map_err(fail)?;
    let mut secrets = SECRETS_MAGIC.to_vec();
    secrets.extend(site.0);
    secrets.extend(random_bytes::<32>().map_err(random)?);
    for (name, bytes) in [
        ("ca.key", ca_key.serialize_pem().as_bytes()),
        ("ca.pem", ca.pem().as_bytes()),
        ("site.key", &secrets),
    ] {
        let path = folder.join(name);
        write_private_file(&path, bytes).map_err(|error| Error::at(&path, error.source))?;
    }
    Ok(())
}

fn load(folder: &Path) -> Result<BoothKeys, Error> {
    let read = |name| {
        let path = folder.join(name);
        fs::read(&path).map_err(|error| Error::at(&path, error)).map(|bytes| (path, bytes))
    };
    let bad = |path: &Path, expected: &str| {
        Err(Error::Input(format!("{}: expected {expected}", path.display())))
    };
    let (path, secrets) = read("site.key")?;
    if secrets.len() != SECRETS_BYTES || secrets[..8] != SECRETS_MAGIC {
        return bad(&path, "56 bytes that begin with PBSITE, and version 2");
    }
    let site = SiteId(secrets[8..24].try_into().unwrap_or_default());
    let link_secret = secrets[24..].try_into().unwrap_or_default();
    let (path, ca_pem) = read("ca.pem")?;
    let Ok(ca) = CertificateDer::from_pem_slice(&ca_pem) else {
        return bad(&path, "a certificate in PEM");
    };
    let ca_hash = ContentHash::of(&ca);
    let ca_pem = String::from_utf8_lossy(&ca_pem).into_owned();
    let (path, key) = read("ca.key")?;
    let Ok(ca_key) = KeyPair::from_pem(&String::from_utf8_lossy(&key)) else {
        return bad(&path, "a private key in PEM");
    };
    let site = SiteKeys::new(site, ca_hash, link_secret);
    Ok(BoothKeys { site, ca_pem, ca_key })
}
