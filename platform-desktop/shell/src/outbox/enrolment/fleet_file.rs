//! A fleet's file: what `paros-booth fleet-file` prints, by which many devices enrol.

use std::path::Path;

use paros_core::outbox::messages::{EnrolmentToken, ReceiptKey, SiteId};
use rustls_pki_types::CertificateDer;
use rustls_pki_types::pem::PemObject as _;

use super::{EnrolError, Fields};

/// A fleet's file. Whoever has it can enrol a device.
#[derive(Clone, Debug)]
pub struct FleetFile {
    /// `https://HOST:PORT`, without a slash at its end.
    pub address: String,
    /// The booth's site.
    pub site: SiteId,
    /// By which its receipts are checked.
    pub receipt_key: ReceiptKey,
    /// What lets a device in.
    pub enrolment_token: EnrolmentToken,
    /// The certificate of the site's authority, DER.
    pub ca: Vec<u8>,
}

impl FleetFile {
    /// Reads one.
    ///
    /// # Errors
    /// Which file, where and what was expected.
    pub fn read(path: &Path) -> Result<Self, EnrolError> {
        Self::of_fields(&Fields::read(path)?.ok_or_else(|| {
            let why = "expected a fleet's file, as `paros-booth fleet-file` prints it";
            EnrolError::File(format!("{}: there is no such file; {why}", path.display()))
        })?)
    }

    /// Takes the bytes of one; `path` is what errors name.
    ///
    /// # Errors
    /// Those of [`FleetFile::read`].
    pub fn parse(bytes: &[u8], path: &Path) -> Result<Self, EnrolError> {
        Self::of_fields(&Fields::parse(bytes.to_vec(), path)?)
    }

    fn of_fields(fields: &Fields<'_>) -> Result<Self, EnrolError> {
        let ca = CertificateDer::from_pem_slice(fields.text("ca")?.as_bytes());
        let ca = ca.map_err(|_| fields.expect("ca", "a certificate in PEM"))?;
        Ok(FleetFile {
            address: fields.address()?,
            site: fields.site()?,
            receipt_key: fields.receipt_key()?,
            enrolment_token: fields.hex(
                "enrolment_token",
                "64 hexadecimal digits",
                EnrolmentToken::parse_hex,
            )?,
            ca: ca.to_vec(),
        })
    }
}
