//! The booth's TLS server certificate (the leaf), signed by its own authority. It is renewed while the booth
//! runs, well before it expires and when the machine's addresses change.

use std::fmt;
use std::net::IpAddr;
use std::sync::{Arc, PoisonError, RwLock};
use std::time::{Duration, SystemTime};

use rcgen::{
    CertificateParams, DnType, ExtendedKeyUsagePurpose, IsCa, Issuer, KeyPair, KeyUsagePurpose,
    PKCS_ECDSA_P256_SHA256, date_time_ymd,
};
use tokio_rustls::rustls::ServerConfig;
use tokio_rustls::rustls::crypto::ring::default_provider;
use tokio_rustls::rustls::pki_types::PrivateKeyDer;
use tokio_rustls::rustls::server::{ClientHello, ResolvesServerCert};
use tokio_rustls::rustls::sign::CertifiedKey;
use tokio_rustls::rustls::version::TLS13;

use crate::error::Error;
use crate::server::keys::{BoothKeys, ca_params};
use crate::server::staff_certificate::{StaffCertificate, has_name};

/// The validity of a leaf. Browsers of tablets reject a validity of more than 825 days.
const LEAF_LIFE: Duration = Duration::from_secs(800 * 86_400);

/// The age at which a leaf is renewed.
const LEAF_AGE: Duration = Duration::from_secs(400 * 86_400);

/// The current leaf, and the certificate for staff's browsers.
pub(crate) struct LeafKeeper {
    keys: BoothKeys,
    /// A certificate from another authority, for clients that connect by its names.
    of_staff: StaffCertificate,
    leaf: RwLock<Leaf>,
}

struct Leaf {
    certified: Arc<CertifiedKey>,
    names: Vec<String>,
    made_at: SystemTime,
}

impl LeafKeeper {
    /// Makes a leaf for these names and addresses.
    ///
    /// # Errors
    /// A name is invalid, or an error of the cryptographic libraries.
    pub(crate) fn new(
        keys: BoothKeys,
        of_staff: StaffCertificate,
        names: Vec<String>,
        now: SystemTime,
    ) -> Result<Arc<Self>, Error> {
        let certified = make_leaf(&keys, &names, now)?;
        let leaf = RwLock::new(Leaf { certified, names, made_at: now });
        Ok(Arc::new(LeafKeeper { keys, of_staff, leaf }))
    }

    /// Renews the leaf if its names have changed, or it is old. Returns `true` if it was renewed.
    ///
    /// # Errors
    /// The errors of [`LeafKeeper::new`]. Then the leaf isn't changed.
    pub(crate) fn renew_if_due(&self, names: &[String], now: SystemTime) -> Result<bool, Error> {
        let is_due = {
            let leaf = self.leaf.read().unwrap_or_else(PoisonError::into_inner);
            // If the clock was set back, the age counts as zero.
            let age = now.duration_since(leaf.made_at).unwrap_or_default();
            age >= LEAF_AGE || leaf.names != names
        };
        if is_due {
            self.renew(names, now)?;
        }
        Ok(is_due)
    }

    /// Makes a new leaf, and loads the staff's certificate again. Open connections are kept.
    ///
    /// # Errors
    /// The errors of [`LeafKeeper::new`] and [`StaffCertificate::load`]. Then the leaf isn't changed.
    pub(crate) fn reload(&self, names: &[String], now: SystemTime) -> Result<(), Error> {
        self.of_staff.reload()?;
        self.renew(names, now)
    }

    fn renew(&self, names: &[String], now: SystemTime) -> Result<(), Error> {
        let certified = make_leaf(&self.keys, names, now)?;
        let leaf = Leaf { certified, names: names.to_vec(), made_at: now };
        *self.leaf.write().unwrap_or_else(PoisonError::into_inner) = leaf;
        Ok(())
    }

    /// Returns a TLS configuration that presents the leaf that is current at each handshake.
    ///
    /// # Errors
    /// An error of the cryptographic libraries.
    pub(crate) fn tls_config(self: &Arc<Self>) -> Result<ServerConfig, Error> {
        let mut config = ServerConfig::builder_with_provider(default_provider().into())
            .with_protocol_versions(&[&TLS13])
            .map_err(|error| Error::failure("certificate", error))?
            .with_no_client_auth()
            .with_cert_resolver(self.clone());
        config.alpn_protocols = vec![b"http/1.1".to_vec()];
        Ok(config)
    }

    fn current(&self) -> Arc<CertifiedKey> {
        self.leaf.read().unwrap_or_else(PoisonError::into_inner).certified.clone()
    }
}

impl ResolvesServerCert for LeafKeeper {
    fn resolve(&self, hello: ClientHello<'_>) -> Option<Arc<CertifiedKey>> {
        let of_staff = self.of_staff.current();
        let named =
            hello.server_name().and_then(|name| of_staff.filter(|cert| has_name(cert, name)));
        Some(named.unwrap_or_else(|| self.current()))
    }
}

/// Hides the keys.
impl fmt::Debug for LeafKeeper {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("LeafKeeper")
    }
}

/// Returns the names and addresses by which clients reach this machine.
#[must_use]
pub(crate) fn local_names(listen: IpAddr, others: &[String]) -> Vec<String> {
    let mut names = vec!["localhost".to_owned(), "127.0.0.1".to_owned(), "::1".to_owned()];
    let address = if listen.is_unspecified() { primary_address() } else { Some(listen) };
    names.extend(address.map(|address| address.to_string()));
    names.extend(others.iter().cloned());
    names.dedup();
    names
}

/// Returns the address from which this machine connects to others. Sends nothing.
#[must_use]
pub(crate) fn primary_address() -> Option<IpAddr> {
    let socket = std::net::UdpSocket::bind("0.0.0.0:0").ok()?;
    // An address reserved for documentation: connecting a UDP socket only selects a route.
    socket.connect("192.0.2.1:9").ok()?;
    socket.local_addr().ok().map(|address| address.ip())
}

fn make_leaf(
    keys: &BoothKeys,
    names: &[String],
    now: SystemTime,
) -> Result<Arc<CertifiedKey>, Error> {
    let fail = |why: &dyn fmt::Display| Error::failure("certificate", why);
    let leaf_key = KeyPair::generate_for(&PKCS_ECDSA_P256_SHA256).map_err(|e| fail(&e))?;
    let mut params = CertificateParams::new(names).map_err(|e| fail(&e))?;
    params.distinguished_name = Default::default();
    params.distinguished_name.push(DnType::CommonName, "Paros booth");
    params.not_before = date_time_ymd(2020, 1, 1);
    let age = now.duration_since(SystemTime::UNIX_EPOCH).unwrap_or_default();
    params.not_after = date_time_ymd(1970, 1, 1) + (age + LEAF_LIFE);
    params.is_ca = IsCa::ExplicitNoCa;
    params.key_usages = vec![KeyUsagePurpose::DigitalSignature];
    params.extended_key_usages = vec![ExtendedKeyUsagePurpose::ServerAuth];
    params.use_authority_key_identifier_extension = true;
    let issuer = Issuer::new(ca_params(&keys.site.site), &keys.ca_key);
    let leaf = params.signed_by(&leaf_key, &issuer).map_err(|e| fail(&e))?;
    let key = PrivateKeyDer::try_from(leaf_key.serialize_der()).map_err(|e| fail(&e))?;
    let certified = CertifiedKey::from_der(vec![leaf.der().clone()], key, &default_provider());
    Ok(Arc::new(certified.map_err(|e| fail(&e))?))
}

#[cfg(test)]
mod tests {
    use std::fs;
    use std::time::{Duration, SystemTime};

    use super::{LEAF_AGE, LEAF_LIFE, LeafKeeper};
    use crate::server::keys::BoothKeys;
    use crate::server::staff_certificate::StaffCertificate;

    #[test]
    fn a_leaf_is_made_anew_long_before_it_ends_and_for_other_addresses() {
        let folder = std::env::temp_dir().join(format!("paros-leaf-{}", std::process::id()));
        let keys = BoothKeys::load_or_draw(&folder, true).expect("they are drawn");
        fs::remove_dir_all(&folder).expect("they were made");
        let names = ["192.0.2.7".to_owned()];
        let start = SystemTime::UNIX_EPOCH + Duration::from_secs(1_790_000_000);
        let keeper = LeafKeeper::new(keys, StaffCertificate::default(), names.to_vec(), start)
            .expect("made");
        let der = || keeper.current().cert[0].to_vec();
        let renew = |names: &[String], now| keeper.renew_if_due(names, now).expect("made");
        let first = der();
        for now in [start, start + LEAF_AGE - Duration::from_secs(1), SystemTime::UNIX_EPOCH] {
            assert!(!renew(&names, now));
        }
        assert!(der() == first);
        assert!(renew(&names, start + LEAF_AGE));
        let second = der();
        assert!(second != first);
        let other = ["192.0.2.8".to_owned()];
        assert!(renew(&other, start + LEAF_AGE));
        assert!(der() != second);
        assert!(!renew(&other, start + LEAF_AGE));
        assert!(keeper.renew_if_due(&["κανένα".to_owned()], start).is_err());
        assert!(!renew(&other, start + LEAF_AGE), "it is as it was");
        assert!(LEAF_AGE * 2 <= LEAF_LIFE);
    }
}
