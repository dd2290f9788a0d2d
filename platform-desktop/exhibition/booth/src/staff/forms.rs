//! A form that was refused comes back as its own page, with what was typed and the reason beside it.

use axum::http::{StatusCode, header};
use axum::response::Response;
use maud::{Markup, html};
use paros_booth_rules::{Expected, Reason, Refusal};

use super::page::Fields;
use super::passwords::MIN_PASSWORD_CHARS;
use super::refusal_texts::tell_refusal;
use super::texts::Texts;

/// What ties a field to the reason beside it.
const REASON: &str = "reason";

/// A form as it was sent, and why it was refused.
pub(crate) struct Refused {
    form: &'static str,
    fields: Fields,
    field: &'static str,
    why: String,
    status: StatusCode,
    retry_after: Option<u32>,
}

/// What a form shows: nothing but its defaults, or what was typed in it.
#[derive(Clone, Copy)]
pub(crate) struct FormView<'a>(Option<&'a Refused>);

impl Refused {
    /// A form of a page, by its name there.
    pub(crate) fn new(
        texts: &Texts,
        form: &'static str,
        fields: Fields,
        refusal: &Refusal,
    ) -> Self {
        let status = StatusCode::from_u16(refusal.status());
        Refused {
            form,
            fields,
            field: field_of(refusal),
            why: tell_refusal(texts.language, refusal),
            status: status.unwrap_or(StatusCode::INTERNAL_SERVER_ERROR),
            retry_after: refusal.retry_after(),
        }
    }

    /// The page that the form is on, as the answer to it.
    pub(crate) fn answer(&self, mut page: Response) -> Response {
        *page.status_mut() = self.status;
        if let Some(seconds) = self.retry_after {
            page.headers_mut().insert(header::RETRY_AFTER, seconds.into());
        }
        page
    }
}

impl<'a> FormView<'a> {
    /// A form of a page on which one may have been refused.
    pub(crate) fn of(refused: Option<&'a Refused>, form: &str) -> Self {
        FormView(refused.filter(|refused| refused.form == form))
    }

    /// The same form, if it was sent with this value in a field: of several forms on a page one was refused.
    pub(crate) fn only_if(self, name: &str, value: &str) -> Self {
        FormView(self.0.filter(|refused| refused.fields.get(name) == value))
    }

    /// Whether it was refused.
    pub(crate) const fn is_refused(self) -> bool {
        self.0.is_some()
    }

    /// What was typed into a field, or its default.
    pub(crate) fn value(self, name: &str, default: &str) -> String {
        self.0.map_or_else(|| default.to_owned(), |refused| refused.fields.get(name))
    }

    /// The reason, where it is about this field; about none of them, where the form begins (`""`).
    pub(crate) fn why(self, field: &str) -> Markup {
        html! {
            @if let Some(refused) = self.about(field) {
                p class="note" role="alert" id=(REASON) { (refused.why) }
            }
        }
    }

    /// What tells that a field is wrong to those who don't see where the reason stands.
    pub(crate) fn invalid(self, field: &str) -> Option<&'static str> {
        self.about(field).map(|_| "true")
    }

    /// Where the reason of a field stands.
    pub(crate) fn described(self, field: &str) -> Option<&'static str> {
        self.about(field).map(|_| REASON)
    }

    /// A field for the password that an account is to have, and the reason beside it.
    pub(crate) fn new_password_field(self, label: &str, name: &str) -> Markup {
        html! {
            label {
                (label)
                input name=(name) type="password" autocomplete="new-password" required minlength=(MIN_PASSWORD_CHARS)
                    aria-invalid=[self.invalid("password")] aria-describedby=[self.described("password")];
            }
            (self.why("password"))
        }
    }

    fn about(self, field: &str) -> Option<&'a Refused> {
        self.0.filter(|refused| refused.field == field)
    }
}

/// The field that a refusal is about; none of them otherwise.
const fn field_of(refusal: &Refusal) -> &'static str {
    match refusal {
        Refusal::Unfit(expected) => match expected {
            Expected::MailAddress | Expected::BoothAddress => "address",
            Expected::AccountName => "name",
            Expected::Password(_) => "password",
            Expected::Role => "role",
            Expected::FleetBounds { .. } => "uses",
            Expected::Height | Expected::HeightAlone | Expected::HeightWithin(..) => "height",
            Expected::Minutes | Expected::MinutesWithin(..) => "minutes",
            Expected::Filament(_) => "filament",
            Expected::Note(_) => "note",
            Expected::Form | Expected::ParcelName | Expected::Confirmation => "",
        },
        Refusal::Forbidden(Reason::WrongPassword) => "old",
        Refusal::Forbidden(Reason::WrongFirstCode) => "code",
        Refusal::Conflict(Reason::NameTaken) => "name",
        _ => "",
    }
}
