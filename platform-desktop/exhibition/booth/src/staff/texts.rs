//! The texts of the staff's pages, in two languages.

use axum::http::{HeaderMap, header};
use paros_booth_rules::records::{CommandState, ExportState, MailState, Sculpture};
use paros_core::badge::Language;
use paros_protocol::CommandKind;

use super::page::find_cookie;

/// The texts of the staff's pages.
pub(crate) struct Texts {
    pub(crate) language: Language,
    pub(crate) code: &'static str,
    pub(crate) title: &'static str,
    pub(crate) find: &'static str,
    pub(crate) headsets: &'static str,
    pub(crate) log_in: &'static str,
    pub(crate) log_out: &'static str,
    pub(crate) name: &'static str,
    pub(crate) password: &'static str,
    pub(crate) code_of_start: &'static str,
    pub(crate) first_account: &'static str,
    pub(crate) words: &'static str,
    pub(crate) tap_badge: &'static str,
    pub(crate) how_to_tap: &'static str,
    pub(crate) nothing: &'static str,
    pub(crate) nearest: &'static str,
    pub(crate) right: &'static str,
    pub(crate) wrong: &'static str,
    pub(crate) other_order: &'static str,
    pub(crate) its_colour: &'static str,
    pub(crate) not_understood: &'static str,
    pub(crate) withdrawn_until: &'static str,
    pub(crate) not_done: &'static str,
    pub(crate) back: &'static str,
    pub(crate) picture: &'static str,
    pub(crate) no_badge: &'static str,
    pub(crate) headset: &'static str,
    pub(crate) received: &'static str,
    pub(crate) withdraw: &'static str,
    pub(crate) bring_back: &'static str,
    pub(crate) delete: &'static str,
    pub(crate) delete_for_good: &'static str,
    pub(crate) not_here_yet: &'static str,
    pub(crate) lost: &'static str,
    pub(crate) last_seen: &'static str,
    pub(crate) battery: &'static str,
    pub(crate) worn: &'static str,
    pub(crate) waiting: &'static str,
    pub(crate) wiped: &'static str,
    pub(crate) minutes: &'static str,
    pub(crate) address: &'static str,
    pub(crate) address_of_parent: &'static str,
    pub(crate) address_is_deleted: &'static str,
    pub(crate) send_mail: &'static str,
    pub(crate) next_try: &'static str,
    pub(crate) other_language: &'static str,
    pub(crate) other_code: &'static str,
    commands: [&'static str; 5],
    command_states: [&'static str; 5],
    exports: [&'static str; 3],
    pub(crate) badge_shared: &'static str,
    pub(crate) badge_lapsed: &'static str,
    pub(crate) badges_scarce: &'static str,
    mail_states: [&'static str; 3],
}

impl Texts {
    pub(crate) const fn command(&self, kind: CommandKind) -> &'static str {
        self.commands[kind as usize]
    }

    pub(crate) const fn command_state(&self, state: CommandState) -> &'static str {
        self.command_states[state as usize]
    }

    pub(crate) const fn export(&self, state: ExportState) -> &'static str {
        self.exports[state as usize]
    }

    pub(crate) const fn mail_state(&self, state: MailState) -> &'static str {
        self.mail_states[state as usize]
    }

    /// Returns the texts in the language that the sculpture's visitor chose.
    pub(crate) fn of_visit(sculpture: &Sculpture) -> &'static Texts {
        match sculpture.visit_language() {
            Language::Greek => &GREEK,
            Language::English => &ENGLISH,
        }
    }

    /// Returns the texts in the language that was set in the browser, or that the browser prefers.
    pub(crate) fn of_request(headers: &HeaderMap) -> &'static Texts {
        let asked_first = || headers.get(header::ACCEPT_LANGUAGE)?.to_str().ok();
        let wanted = find_cookie(headers, "language").or_else(asked_first);
        if wanted.is_some_and(|wanted| wanted.starts_with("el")) { &GREEK } else { &ENGLISH }
    }
}

const ENGLISH: Texts = Texts {
    language: Language::English,
    code: "en",
    title: "Paros booth",
    find: "Find",
    headsets: "Headsets",
    log_in: "Log in",
    log_out: "Log out",
    name: "Name",
    password: "Password",
    code_of_start: "Code that the booth printed at its start",
    first_account: "First account",
    words: "Say or type what is known of the badge: its pictures, its colour",
    tap_badge: "Or tap it",
    how_to_tap: "The colour, then the four pictures row by row: the upper two from left to right, then the lower two. Or only what is known.",
    nothing: "Nothing.",
    nearest: "No sculpture has exactly this badge. Perhaps one of these:",
    right: "right",
    wrong: "not on this badge",
    other_order: "in another order",
    its_colour: "its colour",
    not_understood: "Not understood:",
    withdrawn_until: "Withdrawn. It can be brought back until",
    not_done: "That can't be done",
    back: "Back to where you were",
    picture: "Picture of the sculpture",
    no_badge: "without a badge",
    headset: "Headset",
    received: "Received",
    withdraw: "Withdraw",
    bring_back: "Bring back",
    delete: "Delete",
    delete_for_good: "Delete it for good",
    not_here_yet: "announced, not here yet",
    lost: "lost: the headset was wiped",
    last_seen: "Last seen",
    battery: "Battery",
    worn: "Worn for",
    waiting: "Waiting to be sent",
    wiped: "wiped",
    minutes: "min",
    address: "Visitor's e-mail address",
    address_of_parent: "E-mail address of a parent: the visitor is under age",
    address_is_deleted: "The address is deleted as soon as the mail is sent.",
    send_mail: "Send by e-mail",
    next_try: "again at",
    other_language: "Ελληνικά",
    other_code: "el",
    commands: ["Which one is it?", "A minute more", "End", "Recentre", "Reset"],
    command_states: ["waiting", "sent", "done", "expired", "refused"],
    exports: ["mesh being made", "mesh ready", "no mesh"],
    badge_shared: "others may have this badge",
    badge_lapsed: "badge lapsed: another sculpture may have it. Look at picture and hour",
    badges_scarce: "Badges are running out, and visitors will be shown black ones, which may repeat. Keep sculptures for \
                    fewer days, or wipe headsets less often. Blocks of 64 that are left",
    mail_states: ["mail waiting", "mail sent", "mail failed"],
};

const GREEK: Texts = Texts {
    language: Language::Greek,
    code: "el",
    title: "Περίπτερο Paros",
    find: "Εύρεση",
    headsets: "Συσκευές",
    log_in: "Σύνδεση",
    log_out: "Αποσύνδεση",
    name: "Όνομα",
    password: "Κωδικός",
    code_of_start: "Κωδικός που εμφάνισε το πρόγραμμα στην εκκίνηση",
    first_account: "Πρώτος λογαριασμός",
    words: "Πείτε ή γράψτε ό,τι ξέρετε από το σήμα: εικόνες, χρώμα",
    tap_badge: "Ή αγγίξτε το",
    how_to_tap: "Το χρώμα, μετά τις τέσσερις εικόνες γραμμή γραμμή: τις δύο πάνω από αριστερά προς τα δεξιά, μετά τις δύο κάτω. Ή μόνο ό,τι ξέρετε.",
    nothing: "Δεν υπάρχει τίποτα.",
    nearest: "Κανένα γλυπτό δεν έχει ακριβώς αυτό το σήμα. Ίσως ένα από αυτά:",
    right: "σωστά",
    wrong: "δεν υπάρχουν σε αυτό το σήμα",
    other_order: "με άλλη σειρά",
    its_colour: "το χρώμα του",
    not_understood: "Άγνωστες λέξεις:",
    withdrawn_until: "Αποσύρθηκε. Μπορεί να επανέλθει ως τις",
    not_done: "Αυτό δεν γίνεται",
    back: "Πίσω εκεί που ήσασταν",
    picture: "Εικόνα του γλυπτού",
    no_badge: "χωρίς σήμα",
    headset: "Συσκευή",
    received: "Παραλήφθηκε",
    withdraw: "Απόσυρση",
    bring_back: "Επαναφορά",
    delete: "Διαγραφή",
    delete_for_good: "Οριστική διαγραφή",
    not_here_yet: "αναγγέλθηκε, δεν έχει έρθει",
    lost: "χάθηκε: τα δεδομένα της συσκευής διαγράφηκαν",
    last_seen: "Τελευταία επαφή",
    battery: "Μπαταρία",
    worn: "Φοριέται",
    waiting: "Περιμένουν αποστολή",
    wiped: "έγινε διαγραφή δεδομένων",
    minutes: "λεπτά",
    address: "E-mail του επισκέπτη",
    address_of_parent: "E-mail γονέα: ο επισκέπτης είναι ανήλικος",
    address_is_deleted: "Η διεύθυνση διαγράφεται μόλις σταλεί το μήνυμα.",
    send_mail: "Αποστολή με e-mail",
    next_try: "ξανά στις",
    other_language: "English",
    other_code: "en",
    commands: ["Ποια είναι;", "Ένα λεπτό ακόμη", "Τέλος", "Κεντράρισμα", "Επόμενος επισκέπτης"],
    command_states: ["περιμένει", "στάλθηκε", "έγινε", "έληξε", "δεν γίνεται"],
    exports: ["το πλέγμα ετοιμάζεται", "πλέγμα έτοιμο", "χωρίς πλέγμα"],
    badge_shared: "ίσως και άλλοι έχουν αυτό το σήμα",
    badge_lapsed: "το σήμα δεν ισχύει πια: ίσως το έχει άλλο γλυπτό. Δείτε εικόνα και ώρα",
    badges_scarce: "Τα σήματα τελειώνουν, και οι επισκέπτες θα βλέπουν μαύρα, που ίσως επαναλαμβάνονται. Κρατήστε τα γλυπτά \
                    λιγότερες ημέρες, ή σβήνετε σπανιότερα τις συσκευές. Ομάδες των 64 που μένουν",
    mail_states: ["το μήνυμα περιμένει", "το μήνυμα στάλθηκε", "το μήνυμα απέτυχε"],
};
