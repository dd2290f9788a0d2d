//! The settings that a booth was started with, for its admins to view. Passwords are left out.

use std::fmt::Display;
use std::path::PathBuf;

use clap::ValueEnum as _;
use paros_booth_rules::BoothTime;

use crate::commands::options::{FolderOption, MuseumOptions, ServeOptions};
use crate::commands::shared::SharedOptions;
use crate::printing::SlicerOptions;
use crate::public::PublicOptions;
use crate::server::mailer::MailOptions;
use crate::server::staff_certificate::{StaffCertificate, StaffCertificateOptions};

/// Facts of the booth that its pages show.
pub(crate) struct SiteFacts {
    /// The certificate of the booth's certificate authority, in PEM.
    pub ca_pem: String,
    /// The time at which that certificate expires.
    pub ca_end: Option<BoothTime>,
    /// The booth's settings: pairs of flag and value.
    pub settings: Vec<(&'static str, String)>,
    /// Facts of the museum that visitors see.
    pub museum: MuseumOptions,
    /// The certificate for staff's browsers.
    pub of_staff: StaffCertificate,
}

/// Lists the version, and each command-line flag with its value. Destructures all options, so that a new one
/// can't be forgotten.
pub(crate) fn list_settings(options: &ServeOptions) -> Vec<(&'static str, String)> {
    let ServeOptions {
        folder,
        listen,
        name,
        json,
        keep,
        quota_gb,
        demo,
        certificate,
        mail,
        slicer,
        public,
        museum: MuseumOptions { opening_hours },
    } = options;
    let FolderOption { folder: _, shared } = folder;
    let mut list = vec![
        ("version", env!("CARGO_PKG_VERSION").to_owned()),
        ("--folder", folder.path().display().to_string()),
    ];
    list.extend(list_shared(shared));
    list.extend([
        ("--listen", listen.to_string()),
        ("--name", or_none((!name.is_empty()).then(|| name.join(", ")))),
        ("--json", on_or_off(*json)),
        ("--keep-days", keep.keep_days.to_string()),
        ("--quota-gb", quota_gb.to_string()),
        ("--demo", on_or_off(*demo)),
    ]);
    let StaffCertificateOptions { staff_cert, staff_key } = certificate;
    list.extend([("--staff-cert", path(staff_cert)), ("--staff-key", path(staff_key))]);
    list.extend(list_mail(mail));
    list.extend(list_slicer(slicer));
    list.extend(list_public(public));
    list.push(("--opening-hours", or_none(opening_hours.as_ref())));
    list
}

fn list_shared(options: &SharedOptions) -> [(&'static str, String); 4] {
    let SharedOptions { database, database_password_file, database_ca, files } = options;
    [
        // The address may contain a password.
        ("--database", or_none(database.as_ref().map(|_| "postgres://…"))),
        ("--database-password-file", path(database_password_file)),
        ("--database-ca", path(database_ca)),
        ("--files", or_none(files.as_ref())),
    ]
}

fn list_mail(options: &MailOptions) -> [(&'static str, String); 6] {
    let MailOptions { smtp, smtp_tls, smtp_user, smtp_password_file, smtp_ca, mail_from } = options;
    let how = smtp_tls.to_possible_value();
    [
        ("--smtp", or_none(smtp.as_ref())),
        ("--smtp-tls", or_none(how.as_ref().map(|how| how.get_name()))),
        ("--smtp-user", or_none(smtp_user.as_ref())),
        ("--smtp-password-file", path(smtp_password_file)),
        ("--smtp-ca", path(smtp_ca)),
        ("--mail-from", or_none(mail_from.as_ref())),
    ]
}

fn list_slicer(options: &SlicerOptions) -> [(&'static str, String); 3] {
    let SlicerOptions { slicer, slicer_profile, printers } = options;
    [
        ("--slicer", path(slicer)),
        ("--slicer-profile", path(slicer_profile)),
        ("--printers", path(printers)),
    ]
}

fn list_public(options: &PublicOptions) -> [(&'static str, String); 4] {
    let PublicOptions { public_listen, public_url, public_cert, public_key } = options;
    [
        ("--public-listen", or_none(*public_listen)),
        ("--public-url", or_none(public_url.as_ref())),
        ("--public-cert", path(public_cert)),
        ("--public-key", path(public_key)),
    ]
}

fn path(path: &Option<PathBuf>) -> String {
    or_none(path.as_ref().map(|path| path.display()))
}

fn or_none(value: Option<impl Display>) -> String {
    value.map_or_else(|| "–".to_owned(), |value| value.to_string())
}

fn on_or_off(is_on: bool) -> String {
    if is_on { "✓".to_owned() } else { "–".to_owned() }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use clap::{CommandFactory as _, Parser as _};

    use super::list_settings;
    use crate::commands::options::Options;

    #[test]
    fn every_flag_is_listed_and_no_secret() {
        let command = Options::command();
        let flags: BTreeSet<String> = command
            .get_arguments()
            .filter_map(|argument| argument.get_long())
            .filter(|flag| !["help", "version"].contains(flag))
            .map(|flag| format!("--{flag}"))
            .collect();
        assert!(flags.contains("--printers") && flags.contains("--public-key"), "{flags:?}");
        let list = |arguments: &[&str]| {
            let options = Options::try_parse_from([&["paros-booth"], arguments].concat());
            list_settings(&options.expect("options").serve)
        };
        let listed: BTreeSet<String> =
            list(&[]).iter().skip(1).map(|(flag, _)| (*flag).to_owned()).collect();
        assert_eq!(listed, flags);
        let shown = list(&[
            "--database",
            "postgres://ana:hunter2@host/booth",
            "--files",
            "s3://bucket/site",
            "--smtp",
            "mail.example:587",
            "--mail-from",
            "a@example.org",
        ]);
        let value = |name| &shown.iter().find(|(flag, _)| *flag == name).expect("it is listed").1;
        assert_eq!(
            (value("--smtp").as_str(), value("--smtp-tls").as_str()),
            ("mail.example:587", "starttls")
        );
        assert_eq!(value("--files"), "s3://bucket/site");
        assert!(!format!("{shown:?}").contains("hunter2"), "{shown:?}");
    }
}
