//! Enrolments: the result of an enrolment, as a TOML file that only its owner may read.

mod by_fleet;
mod fleet_file;

use std::collections::BTreeMap;
use std::fmt;
use std::io;
use std::path::{Path, PathBuf};

use paros_protocol::{ContentHash, DeviceHint, DeviceName, DeviceToken, ProtocolError, SiteId};
use paros_shell::durable::{self, WriteError};
use toml::de::{DeTable, DeValue};

use super::events::OutboxOwner;
use super::http::{BoothAddress, BoothCaller, HttpRequest};
use super::link::{HttpAnswer, LinkFault};

pub use by_fleet::enrol_by_fleet;
pub use fleet_file::{FLEET_FILE_NAME, FleetFile};

/// The default name of the enrolment file, in the folder of saved sessions.
pub const ENROLMENT_FILE_NAME: &str = "enrolment.toml";

/// Largest enrolment or fleet file in bytes: an authority's certificate takes one or two thousand.
const MAX_FILE_BYTES: u64 = 64 << 10;

/// The result of an enrolment, and the booth's address.
#[derive(Clone, PartialEq, Debug)]
pub struct Enrolment {
    /// The URL of the booth, `https://HOST:PORT`, without a trailing slash.
    pub address: String,
    /// The certificate of the site's certificate authority, DER.
    pub ca: Vec<u8>,
    /// The token that identifies the device to the booth.
    pub token: Secret,
    /// The site and the headset number of the device.
    pub owner: OutboxOwner,
}

/// A device token that can be compared, and that `Debug` doesn't show.
#[derive(Clone, Copy, PartialEq, Eq)]
pub struct Secret([u8; DeviceToken::BYTES]);

/// A device that asks to enrol.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct NewDevice {
    /// The hint by which staff recognise the device after a wipe.
    pub hint: DeviceHint,
    /// The device's own name.
    pub name: DeviceName,
    /// The token that the device drew.
    pub token: Secret,
}

/// The reason why an enrolment failed.
#[derive(Debug, thiserror::Error)]
pub enum EnrolError {
    /// A file is invalid: with its name, the place in it, and what was expected.
    #[error("{0}")]
    File(String),
    /// There is no answer of the booth.
    #[error("{}", tell_fault(*.0))]
    Link(LinkFault),
    /// The booth refused the enrolment.
    #[error("the booth refuses ({status}): {why}")]
    Refused {
        /// The HTTP status.
        status: u16,
        /// The booth's explanation.
        why: String,
    },
    /// The answer can't be read.
    #[error("the booth's answer: {0}")]
    BadAnswer(#[from] ProtocolError),
    /// The booth's site isn't that of the fleet file.
    #[error("the booth is another site's: expected the keys that it told first")]
    AnotherSite,
    /// The system has no random bits.
    #[error("the system has no random bits")]
    NoRandomBits,
    /// The enrolment can't be written to the disk.
    #[error(transparent)]
    Write(#[from] WriteError),
}

impl Secret {
    /// Returns the token.
    #[must_use]
    pub const fn token(&self) -> DeviceToken {
        DeviceToken(self.0)
    }

    /// Returns the SHA-256 of the token. The booth stores only this hash.
    #[must_use]
    pub fn hash(&self) -> ContentHash {
        ContentHash::of(&self.0)
    }
}

impl fmt::Debug for Secret {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Secret(not shown)")
    }
}

impl NewDevice {
    /// Makes a device with a random token. `hint` identifies the device; `None` draws a random hint.
    ///
    /// # Errors
    /// [`EnrolError::NoRandomBits`] if the system has no random bits.
    pub fn draw(hint: Option<DeviceHint>, name: DeviceName) -> Result<Self, EnrolError> {
        let hint = match hint {
            Some(hint) => hint,
            None => DeviceHint(random_bytes()?),
        };
        Ok(NewDevice { hint, name, token: Secret(random_bytes()?) })
    }
}

/// Returns the device hint for a system identifier (Linux's `machine-id`, Android's `ANDROID_ID`). It is a
/// hash, which doesn't reveal the identifier.
#[must_use]
pub fn hint_of_device(id: &str) -> DeviceHint {
    let ContentHash(hash) = ContentHash::of(format!("paros device hint v1\0{id}").as_bytes());
    let mut hint = [0; DeviceHint::BYTES];
    hint.copy_from_slice(&hash[..DeviceHint::BYTES]);
    DeviceHint(hint)
}

impl Enrolment {
    /// Returns the address of the booth with the device's token.
    #[must_use]
    pub fn booth_address(&self) -> BoothAddress {
        let (url, ca) = (self.address.clone(), self.ca.clone());
        BoothAddress { url, ca, token: self.token.token() }
    }

    /// Returns the enrolment with the address and authority of a fleet file; `None` for another site's file.
    #[must_use]
    pub fn moved_to(&self, fleet: &FleetFile) -> Option<Self> {
        let is_same = self.owner.site == fleet.site;
        let (address, ca) = (fleet.address.clone(), fleet.ca.clone());
        is_same.then(|| Enrolment { address, ca, ..self.clone() })
    }

    /// Writes the enrolment to a file that only its owner may read.
    ///
    /// # Errors
    /// Returns an error if the disk refuses.
    pub fn write(&self, path: &Path) -> Result<(), WriteError> {
        if let Some(folder) = path.parent().filter(|folder| !folder.as_os_str().is_empty()) {
            durable::make_folder(folder)?;
        }
        durable::write_private_file(path, self.to_toml().as_bytes())
    }

    /// Reads an enrolment file; `None` if there is no such file.
    ///
    /// # Errors
    /// Returns an error for an unreadable or invalid file: its name, the place, and what was expected.
    pub fn read(path: &Path) -> Result<Option<Self>, EnrolError> {
        let fields = Fields::read(path)?;
        fields.map(|fields| Self::from_fields(&fields)).transpose()
    }

    /// Parses the bytes of an enrolment file. `source` names the file in errors.
    ///
    /// # Errors
    /// Returns an error with the place, and what was expected.
    pub fn parse(source: &str, bytes: &[u8]) -> Result<Self, EnrolError> {
        Self::from_fields(&Fields::parse(source, bytes)?)
    }

    fn from_fields(fields: &Fields) -> Result<Self, EnrolError> {
        let headset = fields.text("headset")?.parse().ok().filter(|&number: &u32| number > 0);
        let headset = headset.ok_or_else(|| fields.expect("headset", "a number from 1"))?;
        let ca = parse_hex(fields.text("ca")?).filter(|ca| !ca.is_empty());
        let token = fields.hex("token", "64 hexadecimal digits", |text| {
            DeviceToken::parse_hex(text).map(|token| Secret(token.0))
        });
        Ok(Enrolment {
            address: fields.address()?,
            ca: ca.ok_or_else(|| fields.expect("ca", "a certificate in hexadecimal digits"))?,
            token: token?,
            owner: OutboxOwner { site: fields.site()?, headset },
        })
    }

    /// Returns the content of an enrolment file.
    #[must_use]
    pub fn to_toml(&self) -> String {
        let Enrolment { address, ca, token, owner } = self;
        let ca: String = ca.iter().map(|byte| format!("{byte:02x}")).collect();
        format!(
            "# By this the booth knows this device: whoever has it is taken for it.\n\
             address = \"{address}\"\nsite = \"{}\"\nheadset = {}\n\
             token = \"{}\"\nca = \"{ca}\"\n",
            owner.site,
            owner.headset,
            token.token().reveal()
        )
    }
}

/// Returns random bytes of the system.
pub(super) fn random_bytes<const N: usize>() -> Result<[u8; N], EnrolError> {
    let mut bytes = [0; N];
    getrandom::fill(&mut bytes).map_err(|_| EnrolError::NoRandomBits)?;
    Ok(bytes)
}

/// Sends a `POST` request, and returns the body of an answer with status 200.
fn ask(link: &mut impl BoothCaller, path: &str, body: &[u8]) -> Result<Vec<u8>, EnrolError> {
    let answer = link.call(&HttpRequest::post(path, body));
    match answer.map_err(|error| EnrolError::Link(error.fault))? {
        HttpAnswer { status: 200, body, .. } => Ok(body),
        HttpAnswer { status, body, .. } => {
            let why = String::from_utf8_lossy(&body).trim().chars().take(200).collect();
            Err(EnrolError::Refused { status, why })
        }
    }
}

/// The fields of a TOML file: texts, and integers as their digits.
struct Fields {
    /// The name of the file in messages.
    source: String,
    values: BTreeMap<String, String>,
}

impl Fields {
    /// Reads a TOML file; `None` if there is no such file.
    fn read(path: &Path) -> Result<Option<Self>, EnrolError> {
        let source = path.display().to_string();
        match durable::read_regular_file_up_to(path, MAX_FILE_BYTES) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(None),
            Err(error) => Err(EnrolError::File(format!("{source}: {error}"))),
            Ok(bytes) => Fields::parse(&source, &bytes).map(Some),
        }
    }

    /// Parses the bytes of a file.
    fn parse(source: &str, bytes: &[u8]) -> Result<Self, EnrolError> {
        let at = |why: &dyn fmt::Display| EnrolError::File(format!("{source}: {why}"));
        let text = str::from_utf8(bytes).map_err(|_| at(&"expected text in UTF-8"))?;
        let table = DeTable::parse(text).map_err(|error| {
            let before = error.span().and_then(|span| text.get(..span.start));
            let line = before.map_or(1, |before| before.matches('\n').count() + 1);
            at(&format_args!("line {line}: expected TOML: {}", error.message()))
        })?;
        let value = |value: &DeValue<'_>| match value {
            DeValue::String(text) => Some(text.clone().into_owned()),
            DeValue::Integer(digits) => Some(digits.as_str().to_owned()),
            _ => None,
        };
        let values = table.get_ref().iter().filter_map(|(key, found)| {
            Some((key.get_ref().clone().into_owned(), value(found.get_ref())?))
        });
        Ok(Fields { source: source.to_owned(), values: values.collect() })
    }

    fn expect(&self, key: &str, expected: &str) -> EnrolError {
        EnrolError::File(format!("{}: {key}: expected {expected}", self.source))
    }

    fn text(&self, key: &str) -> Result<&str, EnrolError> {
        let text = self.values.get(key).map(String::as_str);
        text.ok_or_else(|| self.expect(key, "a value"))
    }

    fn hex<T>(
        &self,
        key: &str,
        expected: &str,
        parse: impl FnOnce(&str) -> Option<T>,
    ) -> Result<T, EnrolError> {
        parse(self.text(key)?).ok_or_else(|| self.expect(key, expected))
    }

    fn address(&self) -> Result<String, EnrolError> {
        let address = check_address(self.text("address")?);
        address.ok_or_else(|| self.expect("address", "https:// and an address"))
    }

    fn site(&self) -> Result<SiteId, EnrolError> {
        self.hex("site", "32 hexadecimal digits", SiteId::parse_hex)
    }
}

/// Returns a booth's address without a trailing slash; `None` if it isn't a valid address.
#[must_use]
pub fn check_address(text: &str) -> Option<String> {
    let host = text.strip_prefix("https://")?.trim_end_matches('/');
    let is_plain = |letter: char| letter.is_ascii_graphic() && !"\"\\/?#@".contains(letter);
    (!host.is_empty() && host.chars().all(is_plain)).then(|| format!("https://{host}"))
}

fn parse_hex(text: &str) -> Option<Vec<u8>> {
    let digits: Option<Vec<u8>> =
        text.chars().map(|digit| digit.to_digit(16).map(|value| value as u8)).collect();
    let digits = digits.filter(|digits| digits.len().is_multiple_of(2))?;
    Some(digits.chunks(2).map(|pair| pair[0] << 4 | pair[1]).collect())
}

impl EnrolError {
    /// `true` if a file or an argument is wrong, rather than the booth or the network.
    #[must_use]
    pub const fn is_input(&self) -> bool {
        matches!(self, EnrolError::File(_))
    }
}

const fn tell_fault(fault: LinkFault) -> &'static str {
    match fault {
        LinkFault::Unreachable => "the booth isn't reached",
        LinkFault::TimedOut => "the booth doesn't answer",
        LinkFault::Untrusted => "who answers isn't the booth: expected a certificate of its site",
    }
}

/// Returns the default path of the enrolment file, in the folder of saved sessions.
#[must_use]
pub fn enrolment_file(sessions: &Path) -> PathBuf {
    sessions.join(ENROLMENT_FILE_NAME)
}

#[cfg(test)]
mod tests;
