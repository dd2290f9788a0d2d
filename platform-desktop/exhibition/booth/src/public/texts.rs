//! The texts of a visitor's page, in two languages.

use paros_core::badge::Language;

/// The texts of a visitor's page.
pub(crate) struct PublicTexts {
    pub(crate) language: Language,
    pub(crate) code: &'static str,
    pub(crate) title: &'static str,
    pub(crate) picture: &'static str,
    pub(crate) kept_until: &'static str,
    pub(crate) open: &'static str,
    pub(crate) delete: &'static str,
    pub(crate) delete_really: &'static str,
    pub(crate) delete_for_good: &'static str,
    pub(crate) back: &'static str,
    pub(crate) deleted: &'static str,
    pub(crate) not_here: &'static str,
    pub(crate) busy: &'static str,
    pub(crate) other_language: &'static str,
    pub(crate) other_code: &'static str,
}

impl PublicTexts {
    pub(crate) const fn of(language: Language) -> &'static PublicTexts {
        match language {
            Language::English => &ENGLISH,
            Language::Greek => &GREEK,
        }
    }
}

const ENGLISH: PublicTexts = PublicTexts {
    language: Language::English,
    code: "en",
    title: "Your sculpture",
    picture: "A picture of your sculpture",
    kept_until: "It is kept until the end of",
    open: "The booth is open",
    delete: "Delete my sculpture",
    delete_really: "Your sculpture will be deleted here, with its picture and all that is known of it. Nobody can bring it back. Files that you downloaded stay yours.",
    delete_for_good: "Delete it for good",
    back: "Back",
    deleted: "Your sculpture is deleted.",
    not_here: "There is no sculpture here, or not any more. Ask at the booth for a new link.",
    busy: "Too many at once. Try again in a moment.",
    other_language: "Ελληνικά",
    other_code: "el",
};

const GREEK: PublicTexts = PublicTexts {
    language: Language::Greek,
    code: "el",
    title: "Το γλυπτό σας",
    picture: "Εικόνα του γλυπτού σας",
    kept_until: "Φυλάσσεται ως το τέλος της",
    open: "Ώρες λειτουργίας του περιπτέρου",
    delete: "Διαγραφή του γλυπτού μου",
    delete_really: "Το γλυπτό σας θα διαγραφεί από εδώ, με την εικόνα του και όλα όσα είναι γνωστά γι' αυτό. Κανείς δεν μπορεί να το επαναφέρει. Τα αρχεία που κατεβάσατε μένουν δικά σας.",
    delete_for_good: "Οριστική διαγραφή",
    back: "Πίσω",
    deleted: "Το γλυπτό σας διαγράφηκε.",
    not_here: "Εδώ δεν υπάρχει γλυπτό, ή δεν υπάρχει πια. Ζητήστε στο περίπτερο νέο σύνδεσμο.",
    busy: "Πολλοί μαζί. Δοκιμάστε ξανά σε λίγο.",
    other_language: "English",
    other_code: "en",
};
