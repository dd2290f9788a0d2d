//! An optional certificate from another authority, for staff's browsers. It is presented to clients that
//! connect by one of its names. Headsets trust the booth's own authority, and connect by another name or by
//! an address.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::{Arc, PoisonError, RwLock};

use clap::Args;
use paros_booth_rules::BoothTime;
use tokio_rustls::rustls::client::verify_server_name;
use tokio_rustls::rustls::crypto::ring::default_provider;
use tokio_rustls::rustls::pki_types::{
    CertificateDer, PrivateKeyDer, ServerName, pem::PemObject as _,
};
use tokio_rustls::rustls::server::ParsedCertificate;
use tokio_rustls::rustls::sign::CertifiedKey;
use x509_cert::Certificate;
use x509_cert::der::Decode as _;

use crate::error::Error;

/// A certificate for the staff's page. Without it, browsers get the booth's own certificate.
#[derive(Clone, Debug, Default, Args)]
pub struct StaffCertificateOptions {
    /// PEM file with a certificate and its chain, for clients that connect by one of its names.
    ///
    /// Headsets must connect by another name or by an address.
    #[arg(long, value_name = "FILE", requires = "staff_key")]
    pub staff_cert: Option<PathBuf>,
    /// PEM file with the private key of the certificate.
    #[arg(long, value_name = "FILE", requires = "staff_cert")]
    pub staff_key: Option<PathBuf>,
}

/// The staff's certificate, if the options name one. It can be reloaded while the booth serves.
#[derive(Clone, Default)]
pub(crate) struct StaffCertificate {
    options: StaffCertificateOptions,
    certified: Arc<RwLock<Option<Arc<CertifiedKey>>>>,
}

impl StaffCertificate {
    /// Loads the certificate, if the options name one.
    ///
    /// # Errors
    /// [`Error::Input`] if a file is invalid.
    pub(crate) fn load(options: &StaffCertificateOptions) -> Result<Self, Error> {
        let certificate = StaffCertificate { options: options.clone(), ..Self::default() };
        certificate.reload()?;
        Ok(certificate)
    }

    /// Loads the files again.
    ///
    /// # Errors
    /// The errors of [`StaffCertificate::load`]. Then the certificate isn't changed.
    pub(crate) fn reload(&self) -> Result<(), Error> {
        let StaffCertificateOptions { staff_cert: Some(cert), staff_key: Some(key) } =
            &self.options
        else {
            return Ok(());
        };
        let certified = Arc::new(load_certificate(cert, key)?);
        *self.certified.write().unwrap_or_else(PoisonError::into_inner) = Some(certified);
        Ok(())
    }

    /// Returns the certificate, if the options name one.
    pub(crate) fn current(&self) -> Option<Arc<CertifiedKey>> {
        self.certified.read().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// Returns the time at which the certificate expires, if the options name one.
    pub(crate) fn end(&self) -> Option<BoothTime> {
        end_of(self.current()?.end_entity_cert().ok()?)
    }
}

/// Loads a certificate with its chain, and its private key.
///
/// # Errors
/// [`Error::Input`] if a file is invalid.
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

/// Returns the time at which a certificate in PEM expires; `None` if it can't be read.
pub(crate) fn end_of_pem(pem: &str) -> Option<BoothTime> {
    end_of(&CertificateDer::from_pem_slice(pem.as_bytes()).ok()?)
}

/// Returns the time at which a certificate in DER expires; `None` if it can't be read.
fn end_of(der: &[u8]) -> Option<BoothTime> {
    let end = Certificate::from_der(der).ok()?.tbs_certificate.validity.not_after;
    Some(BoothTime(0).after(end.to_unix_duration()))
}

/// Returns `true` if a certificate is valid for a name.
pub(crate) fn has_name(certified: &CertifiedKey, name: &str) -> bool {
    let parsed = certified.end_entity_cert().and_then(ParsedCertificate::try_from);
    let (Ok(parsed), Ok(name)) = (parsed, ServerName::try_from(name)) else { return false };
    verify_server_name(&parsed, &name).is_ok()
}

#[cfg(test)]
mod tests {
    use paros_booth_rules::BoothTime;
    use rcgen::{CertificateParams, KeyPair, date_time_ymd};

    use super::end_of;

    #[test]
    fn the_end_of_a_certificate_is_read() {
        let mut params = CertificateParams::new(vec!["booth.example".to_owned()]).expect("a name");
        let key = KeyPair::generate().expect("a key");
        params.not_after = date_time_ymd(2031, 5, 9);
        let certificate = params.self_signed(&key).expect("a certificate");
        assert_eq!(end_of(certificate.der()), Some(BoothTime(1_936_051_200_000)));
        params.not_after = date_time_ymd(2099, 1, 1);
        let certificate = params.self_signed(&key).expect("a certificate");
        assert_eq!(end_of(certificate.der()), Some(BoothTime(4_070_908_800_000)));
        assert_eq!(end_of(b"no certificate"), None);
    }
}
