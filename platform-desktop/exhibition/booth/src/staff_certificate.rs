//! A certificate that somebody else signed, for staff's browsers: shown to who asks by a name that it has. Headsets know
//! the booth by its own authority, and ask by another name or by its address.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use clap::Args;
use tokio_rustls::rustls::client::verify_server_name;
use tokio_rustls::rustls::crypto::ring::default_provider;
use tokio_rustls::rustls::pki_types::{
    CertificateDer, PrivateKeyDer, ServerName, pem::PemObject as _,
};
use tokio_rustls::rustls::server::ParsedCertificate;
use tokio_rustls::rustls::sign::CertifiedKey;

use crate::error::Error;

/// A proper certificate for the staff's page. Without it browsers meet the booth's own.
#[derive(Clone, Debug, Default, Args)]
pub struct StaffCertificateOptions {
    /// A certificate with its chain, in PEM, that is shown to who asks by a name that it has. Headsets have to ask by
    /// another.
    #[arg(long, value_name = "FILE", requires = "staff_key")]
    pub staff_cert: Option<PathBuf>,
    /// Its private key, in PEM.
    #[arg(long, value_name = "FILE", requires = "staff_cert")]
    pub staff_key: Option<PathBuf>,
}

impl StaffCertificateOptions {
    /// The certificate, if one was named.
    ///
    /// # Errors
    /// [`Error::Input`] for a file that isn't what it should be.
    pub(crate) fn load(&self) -> Result<Option<Arc<CertifiedKey>>, Error> {
        let (Some(cert), Some(key)) = (&self.staff_cert, &self.staff_key) else { return Ok(None) };
        load_certificate(cert, key).map(|certified| Some(Arc::new(certified)))
    }
}

/// Loads a certificate with its chain, and its key.
///
/// # Errors
/// [`Error::Input`] for a file that isn't what it should be.
pub(crate) fn load_certificate(cert: &Path, key: &Path) -> Result<CertifiedKey, Error> {
    let bad = |path: &Path, expected: &str| {
        Error::Input(format!("{}: expected {expected}", path.display()))
    };
    let read = |path: &Path| {
        fs::read(path).map_err(|error| Error::Input(format!("{}: {error}", path.display())))
    };
    let chain: Result<Vec<_>, _> = CertificateDer::pem_slice_iter(&read(cert)?).collect();
    let chain = chain.ok().filter(|chain| !chain.is_empty());
    let chain = chain.ok_or_else(|| bad(cert, "certificates in PEM"))?;
    let key_of = PrivateKeyDer::from_pem_slice(&read(key)?);
    let key_of = key_of.map_err(|_| bad(key, "a private key in PEM"))?;
    CertifiedKey::from_der(chain, key_of, &default_provider())
        .map_err(|error| bad(key, &format!("the certificate's key ({error})")))
}

/// Whether a certificate is for a name.
pub(crate) fn has_name(certified: &CertifiedKey, name: &str) -> bool {
    let parsed = certified.end_entity_cert().and_then(ParsedCertificate::try_from);
    let (Ok(parsed), Ok(name)) = (parsed, ServerName::try_from(name)) else { return false };
    verify_server_name(&parsed, &name).is_ok()
}
