//! The fleet file: the output of `paros-booth fleet-file`, with which many devices enrol.

use std::path::Path;

use base64ct::{Base64, Encoding as _};
use paros_protocol::{EnrolmentToken, SiteId};
use paros_shell::headset::package::FLEET_ASSET;
use rustls_pki_types::CertificateDer;
use rustls_pki_types::pem::PemObject as _;

use super::{EnrolError, Fields};

/// The name of a fleet file, in a headset's folder of sessions and in its package.
pub const FLEET_FILE_NAME: &str = FLEET_ASSET;

/// The content of a fleet file. Anyone who has the file can enrol a device.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct FleetFile {
    /// The URL of the booth, `https://HOST:PORT`, without a trailing slash.
    pub address: String,
    /// The booth's site.
    pub site: SiteId,
    /// The token that enrols a device.
    pub enrolment_token: EnrolmentToken,
    /// The certificate of the site's certificate authority, DER.
    pub ca: Vec<u8>,
}

impl FleetFile {
    /// Reads a fleet file.
    ///
    /// # Errors
    /// Returns an error with the name of the file, the place, and what was expected.
    pub fn read(path: &Path) -> Result<Self, EnrolError> {
        let fields = Fields::read(path)?.ok_or_else(|| {
            let why = "expected a fleet's file, as `paros-booth fleet-file` prints it";
            EnrolError::File(format!("{}: there is no such file; {why}", path.display()))
        })?;
        FleetFile::from_fields(&fields)
    }

    /// Parses the bytes of a fleet file. `source` names the file in errors.
    ///
    /// # Errors
    /// Returns an error with the place, and what was expected.
    pub fn parse(source: &str, bytes: &[u8]) -> Result<Self, EnrolError> {
        FleetFile::from_fields(&Fields::parse(source, bytes)?)
    }

    /// Parses a fleet file from a text that may have lost its line breaks, such as in a console's form: the
    /// file, or the file in base64 with white space anywhere.
    ///
    /// # Errors
    /// Returns an error with the place, and what was expected.
    pub fn parse_text(source: &str, text: &str) -> Result<Self, EnrolError> {
        let letters: String = text.split_whitespace().collect();
        match Base64::decode_vec(&letters) {
            Ok(bytes) => FleetFile::parse(source, &bytes),
            Err(_) => FleetFile::parse(source, text.as_bytes()),
        }
    }

    fn from_fields(fields: &Fields) -> Result<Self, EnrolError> {
        let ca = CertificateDer::from_pem_slice(fields.text("ca")?.as_bytes());
        let ca = ca.map_err(|_| fields.expect("ca", "a certificate in PEM"))?;
        Ok(FleetFile {
            address: fields.address()?,
            site: fields.site()?,
            enrolment_token: fields.hex(
                "enrolment_token",
                "64 hexadecimal digits",
                EnrolmentToken::parse_hex,
            )?,
            ca: ca.to_vec(),
        })
    }
}
