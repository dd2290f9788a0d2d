//! Texts of the list of sculptures and its filters, in two languages.

use paros_core::badge::Language;

/// Texts of the list of sculptures and its filters.
pub(crate) struct ListTexts {
    pub(crate) sculptures: &'static str,
    pub(crate) badge: &'static str,
    pub(crate) day: &'static str,
    pub(crate) hour: &'static str,
    pub(crate) language: &'static str,
    pub(crate) start: &'static str,
    pub(crate) state: &'static str,
    pub(crate) kept: &'static str,
    pub(crate) withdrawn: &'static str,
    pub(crate) missing: &'static str,
    pub(crate) any: &'static str,
    pub(crate) any_start: &'static str,
    pub(crate) show: &'static str,
    pub(crate) clear: &'static str,
    pub(crate) newer: &'static str,
    pub(crate) of: &'static str,
    pub(crate) none: &'static str,
}

impl ListTexts {
    pub(crate) const fn of(language: Language) -> &'static ListTexts {
        match language {
            Language::English => &ENGLISH,
            Language::Greek => &GREEK,
        }
    }
}

const ENGLISH: ListTexts = ListTexts {
    sculptures: "Sculptures",
    badge: "Pictures or colour of the badge",
    day: "Day",
    hour: "Hour",
    language: "Language",
    start: "Start",
    state: "State",
    kept: "kept",
    withdrawn: "withdrawn",
    missing: "not here yet",
    any: "any",
    any_start: "any",
    show: "Show",
    clear: "Show all",
    newer: "Newer",
    of: "of",
    none: "No sculpture matches.",
};

const GREEK: ListTexts = ListTexts {
    sculptures: "Γλυπτά",
    badge: "Εικόνες ή χρώμα του σήματος",
    day: "Ημέρα",
    hour: "Ώρα",
    language: "Γλώσσα",
    start: "Αρχικό σχήμα",
    state: "Κατάσταση",
    kept: "διαθέσιμα",
    withdrawn: "αποσυρμένα",
    missing: "δεν έχουν έρθει ακόμη",
    any: "όλες",
    any_start: "όλα",
    show: "Εμφάνιση",
    clear: "Όλα",
    newer: "Νεότερα",
    of: "από",
    none: "Κανένα γλυπτό δεν ταιριάζει.",
};
