//! The mail thread: sends mails, one after the other, to the mail server of the options.

use std::error::Error as _;
use std::fs;
use std::io;
use std::net::IpAddr;
use std::path::PathBuf;
use std::time::Duration;

use clap::{Args, ValueEnum};
use lettre::message::header::ContentType;
use lettre::message::{Attachment, Mailbox, MultiPart, SinglePart};
use lettre::transport::smtp::authentication::Credentials;
use lettre::transport::smtp::client::{Certificate, CertificateStore, Tls, TlsParameters};
use lettre::transport::smtp::extension::ClientId;
use lettre::{Address, Message, SmtpTransport, Transport as _};
use paros_booth_rules::records::ExportState;
use paros_booth_rules::{Booth, MailJob, MailOutcome, Refusal};
use paros_core::badge::{BadgeNumber, Language, write_words};
use paros_protocol::SculptureId;
use tokio_rustls::rustls;
use tracing::{info, warn};

use crate::clock::booth_time;
use crate::error::Error;
use crate::models::exporter::make_stl;
use crate::models::threemf::write_3mf;
use crate::public::PublicAddress;

/// The most bytes of a model in a mail: most servers accept no more, as encoding makes it longer.
const MAX_MODEL_BYTES: usize = 10_000_000;

/// The timeout of the mail server.
const SMTP_TIMEOUT: Duration = Duration::from_secs(20);

/// The poll interval for mails that are due.
const LOOK_AGAIN: Duration = Duration::from_secs(15);

/// Options for mails. Without a mail server, mails can't be requested.
#[derive(Clone, Debug, Args)]
pub struct MailOptions {
    /// Mail server that accepts the booth's mails.
    #[arg(long, value_name = "HOST:PORT", requires = "mail_from")]
    pub smtp: Option<String>,
    /// Encryption of the connection to the mail server. `none` is allowed only for a server on this machine.
    #[arg(long, value_name = "HOW", default_value = "starttls")]
    pub smtp_tls: SmtpTls,
    /// User name for the mail server.
    #[arg(long, value_name = "NAME", requires_all = ["smtp", "smtp_password_file"])]
    pub smtp_user: Option<String>,
    /// File with the mail server's password in its first line.
    #[arg(long, value_name = "FILE", requires = "smtp_user")]
    pub smtp_password_file: Option<PathBuf>,
    /// PEM file with the certificate authority that verifies the mail server, instead of the system's.
    #[arg(long, value_name = "FILE", requires = "smtp")]
    pub smtp_ca: Option<PathBuf>,
    /// Sender address of the mails.
    #[arg(long, value_name = "ADDRESS", requires = "smtp")]
    pub mail_from: Option<Address>,
}

/// The encryption of the connection to a mail server.
#[derive(Clone, Copy, PartialEq, Eq, Debug, ValueEnum)]
pub enum SmtpTls {
    /// TLS after the STARTTLS command (usually port 587).
    Starttls,
    /// TLS from the first byte (usually port 465).
    Tls,
    /// No encryption.
    None,
}

/// The content of a mail beside the picture.
enum MailContent {
    /// The model in 3MF.
    Model(Vec<u8>),
    /// A link to the model, which is too large for a mail.
    Link(String),
}

/// The mail server and the sender's address.
pub(crate) struct Mailer {
    transport: SmtpTransport,
    from: Mailbox,
    public: Option<PublicAddress>,
}

impl Mailer {
    /// Makes the mailer of the options. Returns `None` without a mail server. Models that are too large for a
    /// mail are linked to on the visitors' pages at `public`.
    ///
    /// # Errors
    /// A description of what is wrong with the options, or with a file that they name.
    pub(crate) fn new(
        options: &MailOptions,
        public: Option<PublicAddress>,
    ) -> Result<Option<Self>, Error> {
        let (Some(server), Some(from)) = (&options.smtp, &options.mail_from) else {
            return Ok(None);
        };
        let bad = |expected: &str| Error::Input(format!("--smtp {server}: expected {expected}"));
        let (host, port) = server.rsplit_once(':').ok_or_else(|| bad("HOST:PORT"))?;
        let port: u16 = port.parse().map_err(|_| bad("a port"))?;
        let host = host.trim_matches(['[', ']']);
        let tls = match options.smtp_tls {
            SmtpTls::None if !is_this_machine(host) => {
                return Err(bad("an address of this machine, or TLS"));
            }
            SmtpTls::None => Tls::None,
            SmtpTls::Starttls => Tls::Required(tls_parameters(host, options)?),
            SmtpTls::Tls => Tls::Wrapper(tls_parameters(host, options)?),
        };
        let mut transport = SmtpTransport::builder_dangerous(host)
            .port(port)
            .tls(tls)
            .timeout(Some(SMTP_TIMEOUT))
            .hello_name(ClientId::Domain("paros-booth.invalid".into()));
        if let (Some(user), Some(path)) = (&options.smtp_user, &options.smtp_password_file) {
            let file = fs::read_to_string(path);
            let file =
                file.map_err(|error| Error::Input(format!("{}: {error}", path.display())))?;
            let password = file.lines().next().unwrap_or_default().to_owned();
            transport = transport.credentials(Credentials::new(user.clone(), password));
        }
        let from = Mailbox::new(Some("Paros".into()), from.clone());
        Ok(Some(Mailer { transport: transport.build(), from, public }))
    }

    /// Sends the next mail, if one is due. Returns the time until the next look for work.
    pub(crate) fn send_next(&self, booth: &Booth) -> Duration {
        let sent = booth.next_mail(booth_time()).and_then(|job| {
            let Some(job) = job else { return Ok(LOOK_AGAIN) };
            let outcome = self.send(booth, &job)?;
            info!(order = job.order, ?outcome, "mail");
            booth.note_mail(job.order, &outcome, booth_time())?;
            Ok(Duration::ZERO)
        });
        sent.unwrap_or_else(|error| {
            // Retry later: the error of the disk or the database may be temporary.
            warn!(%error, "a mail could not be sent");
            LOOK_AGAIN
        })
    }

    fn send(&self, booth: &Booth, job: &MailJob) -> Result<MailOutcome, Refusal> {
        if job.sculpture.export == ExportState::Queued {
            return Ok(MailOutcome::Later("its picture isn't drawn yet".into()));
        }
        let picture = booth.read_picture(&job.sculpture)?;
        let model = make_stl(&booth.read_kept(&job.sculpture)?).and_then(|stl| write_3mf(&stl));
        let content = model.and_then(|model| choose_content(model, || self.link_of(booth, job)));
        let content = match content {
            Ok(content) => content,
            Err(why) => return Ok(MailOutcome::Refused(why)),
        };
        let Some(message) = self.write_message(job, picture, content) else {
            // The error isn't passed on: it may contain the address.
            return Ok(MailOutcome::Refused("no mail can be made of it".into()));
        };
        Ok(match self.transport.send(&message) {
            Ok(_) => MailOutcome::Accepted,
            Err(error) => outcome_of(&error),
        })
    }

    /// Returns the visitor's link, if visitors have pages and the link isn't revoked.
    fn link_of(&self, booth: &Booth, job: &MailJob) -> Option<String> {
        let id = SculptureId(job.sculpture.id);
        let token = booth.link_token(&id).ok()?;
        self.public.as_ref().map(|public| public.link(&id, &token))
    }

    fn write_message(
        &self,
        job: &MailJob,
        picture: Option<Vec<u8>>,
        content: MailContent,
    ) -> Option<Message> {
        let to: Address = job.address.parse().ok()?;
        let (subject, text) = write_text(job, &content);
        let mut parts = MultiPart::mixed().singlepart(SinglePart::plain(text));
        if let Some(png) = picture {
            let kind = ContentType::parse("image/png").ok()?;
            parts = parts.singlepart(Attachment::new("sculpture.png".into()).body(png, kind));
        }
        if let MailContent::Model(model) = content {
            let kind = ContentType::parse("model/3mf").ok()?;
            parts = parts.singlepart(Attachment::new("sculpture.3mf".into()).body(model, kind));
        }
        let message = Message::builder()
            .from(self.from.clone())
            .to(Mailbox::new(None, to))
            .subject(subject)
            // The id is stable: a mail that is sent twice, for example after a power cut, counts as one.
            .message_id(Some(format!("<{:016x}@{}>", job.order, self.from.email.domain())))
            .date_now()
            .multipart(parts);
        message.ok()
    }
}

/// Returns the model if it fits into a mail, otherwise the link if there is one.
fn choose_content(
    model: Vec<u8>,
    link: impl FnOnce() -> Option<String>,
) -> Result<MailContent, String> {
    if model.len() <= MAX_MODEL_BYTES {
        return Ok(MailContent::Model(model));
    }
    link().map(MailContent::Link).ok_or_else(|| "its model is too large for a mail".into())
}

/// Returns `true` if `host` is a loopback address.
fn is_this_machine(host: &str) -> bool {
    host == "localhost" || host.parse().is_ok_and(|address: IpAddr| address.is_loopback())
}

fn tls_parameters(host: &str, options: &MailOptions) -> Result<TlsParameters, Error> {
    let mut tls = TlsParameters::builder(host.to_owned());
    if let Some(path) = &options.smtp_ca {
        let bad = |why: &dyn std::fmt::Display| Error::Input(format!("{}: {why}", path.display()));
        let pem = fs::read(path).map_err(|error| bad(&error))?;
        tls = tls
            .certificate_store(CertificateStore::None)
            .add_root_certificate(Certificate::from_pem(&pem).map_err(|error| bad(&error))?);
    }
    tls.build_rustls().map_err(|error| Error::failure("mail server", error))
}

/// Interprets an SMTP error. Uses only the code of a server's response, as the text may contain the address.
fn outcome_of(error: &lettre::transport::smtp::Error) -> MailOutcome {
    let Some(code) = error.status() else {
        return MailOutcome::Later(format!("the mail server {}", fault_without_code(error)));
    };
    let code = code.to_string();
    // A failed login is the booth's fault, and its configuration may be corrected: retry later.
    let is_login = ["530", "534", "535", "538"].contains(&code.as_str());
    if is_login {
        return MailOutcome::Later(format!("the mail server refuses the booth's login, by {code}"));
    }
    let why = format!("the mail server said {code}");
    if error.is_permanent() { MailOutcome::Refused(why) } else { MailOutcome::Later(why) }
}

/// Describes an error without an SMTP code. All of these may be temporary.
fn fault_without_code(error: &lettre::transport::smtp::Error) -> &'static str {
    let mut source = error.source();
    while let Some(cause) = source {
        let of_tls = cause.downcast_ref::<io::Error>().and_then(io::Error::get_ref);
        match of_tls.and_then(|of_tls| of_tls.downcast_ref()) {
            Some(rustls::Error::InvalidCertificate(_)) => {
                return "shows a certificate that isn't to be trusted";
            }
            Some(_) => return "can't be spoken with by TLS",
            None => source = cause.source(),
        }
    }
    // The library distinguishes these cases only by their text, which contains no address.
    let words = error.to_string();
    match () {
        () if error.is_timeout() => "was silent",
        () if words.contains("STARTTLS is not supported") => "offers no TLS",
        () if words.contains("authentication mechanism") => "offers no login by a password",
        () => "can't be reached",
    }
}

/// Writes the subject and the text, in the visitor's language.
fn write_text(job: &MailJob, content: &MailContent) -> (&'static str, String) {
    let mut words = String::new();
    if let Some(badge) = job.sculpture.badge.and_then(BadgeNumber::new) {
        // Writing to a String doesn't fail.
        let _ = write_words(&mut words, &badge.badge(), job.language);
    }
    match job.language {
        Language::English => {
            let where_it_is = match content {
                MailContent::Model(_) => {
                    "The .3mf file is what 3D printers' programs open.".to_owned()
                }
                MailContent::Link(link) => {
                    format!("Its files are too large for a mail. Here you find them:\n{link}")
                }
            };
            let kept = if job.keeps_address {
                "As you agreed, your address is kept as long as the sculpture."
            } else {
                "Your address was kept for this mail alone, and is deleted now."
            };
            let text = format!(
                "Hello,\n\nthis is the sculpture that you carved with Paros. Its badge: {words}\n\n\
                 {where_it_is}\n\n\
                 {kept}\n"
            );
            ("Your sculpture", text)
        }
        Language::Greek => {
            let where_it_is = match content {
                MailContent::Model(_) => {
                    "Το αρχείο .3mf ανοίγει στα προγράμματα των τρισδιάστατων εκτυπωτών.".to_owned()
                }
                MailContent::Link(link) => {
                    format!("Τα αρχεία του είναι πολύ μεγάλα για μήνυμα. Θα τα βρείτε εδώ:\n{link}")
                }
            };
            let kept = if job.keeps_address {
                "Όπως συμφωνήσατε, η διεύθυνσή σας κρατιέται όσο και το γλυπτό."
            } else {
                "Η διεύθυνσή σας κρατήθηκε μόνο για αυτό το μήνυμα, και τώρα διαγράφεται."
            };
            let text = format!(
                "Γεια σας,\n\nαυτό είναι το γλυπτό που σκαλίσατε με το Paros. Το σήμα του: {words}\n\n\
                 {where_it_is}\n\n\
                 {kept}\n"
            );
            ("Το γλυπτό σας", text)
        }
    }
}

#[cfg(test)]
mod tests {
    use paros_booth_rules::MailJob;
    use paros_booth_rules::records::{ExportState, Sculpture};
    use paros_core::badge::Language;
    use paros_core::session::SessionMode;

    use super::{MAX_MODEL_BYTES, MailContent, choose_content, write_text};

    const LINK: &str = "https://paros.example/s/1/2";

    fn job(language: Language) -> MailJob {
        let sculpture = Sculpture {
            id: [1; 16],
            headset: 1,
            hash: [2; 32],
            badge: Some(77),
            claimed_badge: Some(77),
            pictures: 0,
            language: *b"en",
            mode: SessionMode::FreeForm,
            facts: Vec::new(),
            received_at: Default::default(),
            keep_day: 1,
            withdrawn_at: None,
            has_trace: false,
            export: ExportState::Made,
            link_generation: 0,
            is_link_revoked: false,
        };
        let address = "ana@example.org".into();
        MailJob { order: 1, address, language, sculpture, keeps_address: false }
    }

    #[test]
    fn what_is_too_large_for_a_mail_is_a_link_and_without_one_it_says_so() {
        let link = || Some(LINK.to_owned());
        let fits = choose_content(vec![0; MAX_MODEL_BYTES], link);
        assert!(matches!(fits, Ok(MailContent::Model(_))));
        let content = choose_content(vec![0; MAX_MODEL_BYTES + 1], link).expect("a link");
        for language in [Language::English, Language::Greek] {
            let (_, text) = write_text(&job(language), &content);
            assert!(text.lines().any(|line| line == LINK) && !text.contains("3mf"), "{text}");
            let (_, text) = write_text(&job(language), &MailContent::Model(Vec::new()));
            assert!(text.contains("3mf") && !text.contains("http"), "{text}");
        }
        let none = choose_content(vec![0; MAX_MODEL_BYTES + 1], || None);
        assert_eq!(none.err().as_deref(), Some("its model is too large for a mail"));
    }
}
