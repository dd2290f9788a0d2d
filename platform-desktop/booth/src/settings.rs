//! What a booth was started with, for its admins to look at. No password is in it.

use crate::options::ServeOptions;

/// What the pages tell of the booth itself.
pub(crate) struct SiteFacts {
    /// The certificate of its authority, in PEM.
    pub ca_pem: String,
    /// Its settings: flag and value.
    pub settings: Vec<(&'static str, String)>,
}

/// The settings, in the order of the command line's help.
pub(crate) fn list_settings(options: &ServeOptions) -> Vec<(&'static str, String)> {
    let ServeOptions { folder, listen, name, keep_days, quota_gb, mail, .. } = options;
    let or_none = |value: Option<String>| value.unwrap_or_else(|| "–".to_owned());
    vec![
        ("version", env!("CARGO_PKG_VERSION").to_owned()),
        ("--folder", folder.path().display().to_string()),
        ("--listen", listen.to_string()),
        ("--name", or_none((!name.is_empty()).then(|| name.join(", ")))),
        ("--keep-days", keep_days.to_string()),
        ("--quota-gb", quota_gb.to_string()),
        ("--smtp", or_none(mail.smtp.clone())),
        ("--smtp-tls", format!("{:?}", mail.smtp_tls).to_lowercase()),
        ("--smtp-user", or_none(mail.smtp_user.clone())),
        ("--mail-from", or_none(mail.mail_from.as_ref().map(ToString::to_string))),
    ]
}
