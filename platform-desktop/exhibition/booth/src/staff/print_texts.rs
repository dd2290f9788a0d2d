//! The texts about prints on the staff's pages, in two languages.

use paros_booth_rules::PrintStep;
use paros_booth_rules::records::PrintState;
use paros_core::badge::Language;

use crate::printing::Activity;

/// The texts about prints on the staff's pages.
pub(crate) struct PrintTexts {
    pub(crate) prints: &'static str,
    pub(crate) order: &'static str,
    pub(crate) height_mm: &'static str,
    pub(crate) or_minutes: &'static str,
    pub(crate) filament: &'static str,
    pub(crate) note: &'static str,
    pub(crate) at_most: &'static str,
    pub(crate) estimate_waits: &'static str,
    pub(crate) estimate_unknown: &'static str,
    pub(crate) slip: &'static str,
    pub(crate) print_slip: &'static str,
    pub(crate) open: &'static str,
    pub(crate) scan: &'static str,
    pub(crate) revoke_link: &'static str,
    pub(crate) renew_link: &'static str,
    pub(crate) link_revoked: &'static str,
    pub(crate) bed_is_empty: &'static str,
    pub(crate) send_to: &'static str,
    pub(crate) printer_silent: &'static str,
    activities: [&'static str; 6],
    states: [&'static str; 6],
    steps: [&'static str; 6],
}

impl PrintTexts {
    pub(crate) const fn of(language: Language) -> &'static PrintTexts {
        match language {
            Language::English => &ENGLISH,
            Language::Greek => &GREEK,
        }
    }

    pub(crate) const fn state(&self, state: PrintState) -> &'static str {
        self.states[state as usize]
    }

    pub(crate) const fn activity(&self, activity: Activity) -> &'static str {
        self.activities[activity as usize]
    }

    pub(crate) const fn step(&self, step: PrintStep) -> &'static str {
        self.steps[step as usize]
    }
}

const ENGLISH: PrintTexts = PrintTexts {
    prints: "Prints",
    order: "Order a print",
    height_mm: "Height in mm",
    or_minutes: "Or as large as fits, in minutes",
    filament: "Filament's colour",
    note: "Note",
    at_most: "at most",
    estimate_waits: "time and material are being worked out",
    estimate_unknown: "time and material unknown",
    slip: "Slip",
    print_slip: "Print this slip",
    open: "Open",
    scan: "Your sculpture, to see and to keep: scan this",
    revoke_link: "Take the visitor's link back",
    renew_link: "Make a new link",
    link_revoked: "The visitor's link was taken back.",
    bed_is_empty: "Is the bed of the printer empty? Then",
    send_to: "send it to",
    printer_silent: "doesn't answer",
    activities: ["free", "prints", "has finished", "was stopped", "is broken", "is busy"],
    states: ["ordered", "printing", "done", "failed", "cancelled", "ready to print"],
    steps: ["Slice", "Printing has begun", "It is done", "It failed", "Cancel", "Order again"],
};

const GREEK: PrintTexts = PrintTexts {
    prints: "Εκτυπώσεις",
    order: "Παραγγελία εκτύπωσης",
    height_mm: "Ύψος σε mm",
    or_minutes: "Ή όσο μεγάλο χωράει, σε λεπτά",
    filament: "Χρώμα νήματος",
    note: "Σημείωση",
    at_most: "το πολύ",
    estimate_waits: "υπολογίζονται χρόνος και υλικό",
    estimate_unknown: "άγνωστος χρόνος και υλικό",
    slip: "Δελτίο",
    print_slip: "Εκτύπωση του δελτίου",
    open: "Ώρες λειτουργίας",
    scan: "Το γλυπτό σας, για να το δείτε και να το κρατήσετε: σαρώστε",
    revoke_link: "Ακύρωση του συνδέσμου",
    renew_link: "Νέος σύνδεσμος",
    link_revoked: "Ο σύνδεσμος του επισκέπτη ακυρώθηκε.",
    bed_is_empty: "Είναι άδεια η πλάκα του εκτυπωτή; Τότε",
    send_to: "αποστολή στον",
    printer_silent: "δεν απαντά",
    activities: ["ελεύθερος", "εκτυπώνει", "τελείωσε", "σταμάτησε", "έχει βλάβη", "απασχολημένος"],
    states: [
        "παραγγέλθηκε",
        "εκτυπώνεται",
        "έτοιμο",
        "απέτυχε",
        "ακυρώθηκε",
        "έτοιμο για εκτύπωση",
    ],
    steps: ["Τεμαχισμός", "Άρχισε η εκτύπωση", "Έτοιμο", "Απέτυχε", "Ακύρωση", "Ξανά"],
};
