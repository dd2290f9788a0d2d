//! What an enrolment gave, as a shell keeps it: a file of TOML that its owner alone may read.

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

/// The file's name, in the folder of saved sessions unless a setting says otherwise.
pub const ENROLMENT_FILE_NAME: &str = "enrolment.toml";

/// Bytes that such a file, or a fleet's, has at most: a certificate of an authority takes one or two thousand.
const MAX_FILE_BYTES: u64 = 64 << 10;

/// What an enrolment gave, and where the booth is.
#[derive(Clone, PartialEq, Debug)]
pub struct Enrolment {
    /// `https://HOST:PORT`, without a slash at its end.
    pub address: String,
    /// The certificate of the site's authority, DER.
    pub ca: Vec<u8>,
    /// By which the booth knows the device.
    pub token: Secret,
    /// Whose headset it is now.
    pub owner: OutboxOwner,
}

/// A token, which compares and is never shown.
#[derive(Clone, Copy, PartialEq, Eq)]
pub struct Secret([u8; DeviceToken::BYTES]);

/// A device that wants to enrol.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct NewDevice {
    /// By which staff find it again once it was wiped.
    pub hint: DeviceHint,
    /// What it calls itself.
    pub name: DeviceName,
    /// The token that it drew.
    pub token: Secret,
}

/// Why a device isn't enrolled.
#[derive(Debug, thiserror::Error)]
pub enum EnrolError {
    /// A file: which, where in it, and what was expected.
    #[error("{0}")]
    File(String),
    /// There is no answer.
    #[error("{}", tell_fault(*.0))]
    Link(LinkFault),
    /// The booth answered something else.
    #[error("the booth refuses ({status}): {why}")]
    Refused {
        /// The status of HTTP.
        status: u16,
        /// What it says.
        why: String,
    },
    /// An answer that is none.
    #[error("the booth's answer: {0}")]
    BadAnswer(#[from] ProtocolError),
    /// The booth isn't the one that the fleet's file is of, or its authority isn't the one that it shows.
    #[error("the booth is another site's: expected the keys that it told first")]
    AnotherSite,
    /// The system has no random bits.
    #[error("the system has no random bits")]
    NoRandomBits,
    /// It can't be kept.
    #[error(transparent)]
    Write(#[from] WriteError),
}

impl Secret {
    /// The token's bytes.
    #[must_use]
    pub const fn token(&self) -> DeviceToken {
        DeviceToken(self.0)
    }

    /// Its SHA-256, which is all that the booth keeps of it.
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
    /// A device with a token that is drawn now. `hint` is what it remembers itself by; `None` for none, which is drawn
    /// too.
    ///
    /// # Errors
    /// [`EnrolError::NoRandomBits`].
    pub fn draw(hint: Option<DeviceHint>, name: DeviceName) -> Result<Self, EnrolError> {
        let hint = match hint {
            Some(hint) => hint,
            None => DeviceHint(random_bytes()?),
        };
        Ok(NewDevice { hint, name, token: Secret(random_bytes()?) })
    }
}

/// What a device of this name of the system's (Linux's `machine-id`, Android's `ANDROID_ID`) remembers itself by, without
/// telling what it is.
#[must_use]
pub fn hint_of_device(id: &str) -> DeviceHint {
    let ContentHash(hash) = ContentHash::of(format!("paros device hint v1\0{id}").as_bytes());
    let mut hint = [0; DeviceHint::BYTES];
    hint.copy_from_slice(&hash[..DeviceHint::BYTES]);
    DeviceHint(hint)
}

impl Enrolment {
    /// Where the booth is, and by what it knows the device.
    #[must_use]
    pub fn booth_address(&self) -> BoothAddress {
        let (url, ca) = (self.address.clone(), self.ca.clone());
        BoothAddress { url, ca, token: self.token.token() }
    }

    /// The same at the address and with the authority that a fleet's file tells, where the file is of the same site.
    #[must_use]
    pub fn moved_to(&self, fleet: &FleetFile) -> Option<Self> {
        let is_same = self.owner.site == fleet.site;
        let (address, ca) = (fleet.address.clone(), fleet.ca.clone());
        is_same.then(|| Enrolment { address, ca, ..self.clone() })
    }

    /// Writes it to a file that nobody else may read.
    ///
    /// # Errors
    /// When the disk refuses.
    pub fn write(&self, path: &Path) -> Result<(), WriteError> {
        if let Some(folder) = path.parent().filter(|folder| !folder.as_os_str().is_empty()) {
            durable::make_folder(folder)?;
        }
        durable::write_private_file(path, self.to_toml().as_bytes())
    }

    /// Reads one; `None` where there is no file.
    ///
    /// # Errors
    /// What the file can't be read by, or what is wrong with it: which file, where and what was expected.
    pub fn read(path: &Path) -> Result<Option<Self>, EnrolError> {
        let fields = Fields::read(path)?;
        fields.map(|fields| Self::from_fields(&fields)).transpose()
    }

    /// Takes the bytes of such a file that `source` has.
    ///
    /// # Errors
    /// Where in it and what was expected.
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

    /// What such a file has.
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

/// Random bytes of the system.
pub(super) fn random_bytes<const N: usize>() -> Result<[u8; N], EnrolError> {
    let mut bytes = [0; N];
    getrandom::fill(&mut bytes).map_err(|_| EnrolError::NoRandomBits)?;
    Ok(bytes)
}

/// The body of an answer that is 200.
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

/// The fields of a file: texts, and numbers as they stand there.
struct Fields {
    /// The file, as messages name it.
    source: String,
    values: BTreeMap<String, String>,
}

impl Fields {
    /// Reads a file of TOML; `None` where there is none.
    fn read(path: &Path) -> Result<Option<Self>, EnrolError> {
        let source = path.display().to_string();
        match durable::read_regular_file_up_to(path, MAX_FILE_BYTES) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(None),
            Err(error) => Err(EnrolError::File(format!("{source}: {error}"))),
            Ok(bytes) => Fields::parse(&source, &bytes).map(Some),
        }
    }

    /// Takes a file's bytes.
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

/// A booth's address without a slash at its end; `None` for what is none.
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
    /// Whether a file or an argument is at fault, and not what is there now.
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

/// Where an enrolment is kept beside a shell's saved sessions.
#[must_use]
pub fn enrolment_file(sessions: &Path) -> PathBuf {
    sessions.join(ENROLMENT_FILE_NAME)
}

#[cfg(test)]
mod tests;
