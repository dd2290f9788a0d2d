//! Refused forms: the form's page is shown again, with the input and the reason beside the field.

use axum::http::{StatusCode, header};
use axum::response::Response;
use maud::{Markup, html};
use paros_booth_rules::{Expected, Reason, Refusal};

use super::page::Fields;
use super::passwords::MIN_PASSWORD_CHARS;
use super::refusal_texts::tell_refusal;
use super::texts::Texts;

/// The id of the reason's element, which the field refers to.
const REASON: &str = "reason";

/// The content of a refused form, and the reason.
pub(crate) struct Refused {
    form: &'static str,
    fields: Fields,
    field: &'static str,
    why: String,
    status: StatusCode,
    retry_after: Option<u32>,
}

/// The content that a form shows: its defaults, or the input that was refused.
#[derive(Clone, Copy)]
pub(crate) struct FormView<'a>(Option<&'a Refused>);

impl Refused {
    /// Makes a refused form. `form` is its name on the page.
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

    /// Adds the refusal's status to the form's page.
    pub(crate) fn answer(&self, mut page: Response) -> Response {
        *page.status_mut() = self.status;
        if let Some(seconds) = self.retry_after {
            page.headers_mut().insert(header::RETRY_AFTER, seconds.into());
        }
        page
    }
}

impl<'a> FormView<'a> {
    /// Returns the view of the form with this name; `refused` is the refused form of the page, if any.
    pub(crate) fn of(refused: Option<&'a Refused>, form: &str) -> Self {
        FormView(refused.filter(|refused| refused.form == form))
    }

    /// Keeps the input only if a field has this value, to find the refused one of several equal forms on a
    /// page.
    pub(crate) fn only_if(self, name: &str, value: &str) -> Self {
        FormView(self.0.filter(|refused| refused.fields.get(name) == value))
    }

    /// Returns `true` if the form was refused.
    pub(crate) const fn is_refused(self) -> bool {
        self.0.is_some()
    }

    /// Returns the input of a field, or its default.
    pub(crate) fn value(self, name: &str, default: &str) -> String {
        self.0.map_or_else(|| default.to_owned(), |refused| refused.fields.get(name))
    }

    /// Draws the reason if it concerns this field. The field `""` stands for the whole form.
    pub(crate) fn why(self, field: &str) -> Markup {
        html! {
            @if let Some(refused) = self.about(field) {
                p class="note" role="alert" id=(REASON) { (refused.why) }
            }
        }
    }

    /// Returns the value of `aria-invalid` for a field, which screen readers use.
    pub(crate) fn invalid(self, field: &str) -> Option<&'static str> {
        self.about(field).map(|_| "true")
    }

    /// Returns the value of `aria-describedby` for a field: the id of the reason.
    pub(crate) fn described(self, field: &str) -> Option<&'static str> {
        self.about(field).map(|_| REASON)
    }

    /// Draws a field for a new password, and the reason beside it.
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

/// Returns the name of the field that a refusal concerns; otherwise `""`.
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
