//! Confirmations of actions, shown once on the next page. A cookie that lives for a minute carries a key of
//! the confirmation: nothing is in the address, and the text can't be forged.

use axum::http::HeaderMap;
use axum::response::{IntoResponse, Redirect, Response};
use maud::{Markup, html};
use paros_booth_rules::PrintStep;
use paros_core::badge::Language;

use super::page::{find_cookie, with_cookie};

/// An action that is confirmed.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Done {
    MailAsked,
    PrintOrdered,
    PrintStarted,
    PrintFinished,
    PrintFailed,
    PrintCancelled,
    PrintRetried,
    PrintSent,
    Withdrawn,
    BroughtBack,
    Deleted,
    BadgeDeleted,
    LinkRevoked,
    LinkRenewed,
    CommandAsked,
    AccountAdded,
    AccountDisabled,
    AccountEnabled,
    PasswordChanged,
    PasswordReset,
    TokenMade,
    TokenRevoked,
    ClockConfirmed,
}

/// The cookie's key and the text in English and Greek of each confirmation, in the order of [`Done`].
const TEXTS: [(Done, &str, [&str; 2]); 23] = [
    (
        Done::MailAsked,
        "mail",
        [
            "The mail waits to be sent. Below you see when it has gone.",
            "Το μήνυμα περιμένει να σταλεί. Παρακάτω φαίνεται πότε έφυγε.",
        ],
    ),
    (
        Done::PrintOrdered,
        "print",
        [
            "The print is ordered. It stands below, and among all prints.",
            "Η εκτύπωση παραγγέλθηκε. Είναι παρακάτω, και σε όλες τις εκτυπώσεις.",
        ],
    ),
    (Done::PrintStarted, "start", ["Noted: it is being printed.", "Σημειώθηκε: εκτυπώνεται."]),
    (
        Done::PrintFinished,
        "finish",
        ["Noted: the print is done.", "Σημειώθηκε: η εκτύπωση είναι έτοιμη."],
    ),
    (Done::PrintFailed, "fail", ["Noted: the print failed.", "Σημειώθηκε: η εκτύπωση απέτυχε."]),
    (Done::PrintCancelled, "cancel", ["The print is cancelled.", "Η εκτύπωση ακυρώθηκε."]),
    (Done::PrintRetried, "retry", ["The print is ordered again.", "Η εκτύπωση παραγγέλθηκε ξανά."]),
    (
        Done::PrintSent,
        "send",
        ["The print goes to the printer.", "Η εκτύπωση πηγαίνει στον εκτυπωτή."],
    ),
    (
        Done::Withdrawn,
        "withdraw",
        [
            "The sculpture is withdrawn: no list shows it, and its visitor's link is closed.",
            "Το γλυπτό αποσύρθηκε: δεν φαίνεται σε λίστες, και ο σύνδεσμος του επισκέπτη έκλεισε.",
        ],
    ),
    (Done::BroughtBack, "bring-back", ["The sculpture is back.", "Το γλυπτό επανήλθε."]),
    (Done::Deleted, "delete", ["The sculpture is deleted.", "Το γλυπτό διαγράφηκε."]),
    (
        Done::BadgeDeleted,
        "delete-badge",
        ["All sculptures of this badge are deleted.", "Όλα τα γλυπτά με αυτό το σήμα διαγράφηκαν."],
    ),
    (
        Done::LinkRevoked,
        "revoke-link",
        ["The visitor's link leads nowhere now.", "Ο σύνδεσμος του επισκέπτη δεν ισχύει πια."],
    ),
    (
        Done::LinkRenewed,
        "renew-link",
        [
            "There is a new link, on the next slip; the one before leads nowhere.",
            "Υπάρχει νέος σύνδεσμος, στο επόμενο δελτίο· ο προηγούμενος δεν ισχύει πια.",
        ],
    ),
    (
        Done::CommandAsked,
        "command",
        [
            "The headset is asked. Below you see what becomes of it.",
            "Η συσκευή ειδοποιείται. Παρακάτω φαίνεται τι έγινε.",
        ],
    ),
    (Done::AccountAdded, "account", ["The account is made.", "Ο λογαριασμός δημιουργήθηκε."]),
    (Done::AccountDisabled, "disable", ["The account is shut out.", "Ο λογαριασμός αποκλείστηκε."]),
    (Done::AccountEnabled, "enable", ["The account is let in again.", "Ο λογαριασμός επανήλθε."]),
    (Done::PasswordChanged, "password", ["The password is changed.", "Ο κωδικός άλλαξε."]),
    (
        Done::PasswordReset,
        "reset",
        [
            "The account has its new password, and its logins have ended.",
            "Ο λογαριασμός έχει νέο κωδικό, και οι συνδέσεις του τελείωσαν.",
        ],
    ),
    (Done::TokenMade, "token", ["The file was made.", "Το αρχείο δημιουργήθηκε."]),
    (
        Done::TokenRevoked,
        "revoke-token",
        [
            "The file is taken back: it lets no headset in any more.",
            "Το αρχείο ανακλήθηκε: δεν εγγράφει πια συσκευές.",
        ],
    ),
    (
        Done::ClockConfirmed,
        "clock",
        [
            "The clock is confirmed. Sculptures age again.",
            "Το ρολόι επιβεβαιώθηκε. Τα γλυπτά λήγουν πάλι κανονικά.",
        ],
    ),
];

/// The attributes of the cookie.
const ATTRIBUTES: &str = "Path=/staff; Secure; HttpOnly; SameSite=Strict";

impl Done {
    /// Redirects to a page that shows the confirmation.
    pub(crate) fn lead_to(self, to: &str) -> Response {
        self.tell_on_next_page(Redirect::to(to).into_response())
    }

    /// Sets the cookie, so that the next page shows the confirmation.
    pub(crate) fn tell_on_next_page(self, answer: Response) -> Response {
        let (_, key, _) = TEXTS[self as usize];
        with_cookie(answer, &format!("done={key}; {ATTRIBUTES}; Max-Age=60"))
    }

    /// Reads the confirmation from a request's cookie.
    pub(crate) fn of_request(headers: &HeaderMap) -> Option<Done> {
        let key = find_cookie(headers, "done")?;
        TEXTS.into_iter().find(|(_, other, _)| *other == key).map(|(done, ..)| done)
    }

    /// Returns the confirmation of a step that staff take; `None` for a step of the slicer.
    pub(crate) const fn of_step(step: PrintStep) -> Option<Done> {
        Some(match step {
            PrintStep::Slice => return None,
            PrintStep::Start => Done::PrintStarted,
            PrintStep::Finish => Done::PrintFinished,
            PrintStep::Fail => Done::PrintFailed,
            PrintStep::Cancel => Done::PrintCancelled,
            PrintStep::Retry => Done::PrintRetried,
        })
    }

    /// Draws the confirmation. Screen readers announce it.
    pub(crate) fn draw(self, language: Language) -> Markup {
        let (.., texts) = TEXTS[self as usize];
        html! { p class="done" role="status" id="done" { (texts[language as usize]) } }
    }
}

/// Removes the cookie, so that the confirmation isn't shown again.
pub(crate) fn forget_done(answer: Response) -> Response {
    with_cookie(answer, &format!("done=; {ATTRIBUTES}; Max-Age=0"))
}

#[cfg(test)]
mod tests {
    use axum::http::HeaderMap;

    use super::{Done, TEXTS};

    #[test]
    fn each_has_its_texts_and_its_key() {
        for (k, (done, key, texts)) in TEXTS.into_iter().enumerate() {
            assert_eq!(done as usize, k, "{key}");
            assert!(texts.iter().all(|text| text.ends_with('.')), "{key}");
            let mut headers = HeaderMap::new();
            headers.insert("cookie", format!("a=b; done={key}; c=d").parse().unwrap());
            assert_eq!(Done::of_request(&headers), Some(done));
            headers.insert("cookie", format!("done={key}x").parse().unwrap());
            assert_eq!(Done::of_request(&headers), None);
        }
        assert_eq!(Done::ClockConfirmed as usize + 1, TEXTS.len());
    }
}
