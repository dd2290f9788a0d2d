//! The texts of the pages about accounts, administration and privacy, in two languages.

use paros_booth_rules::records::StaffRole;
use paros_booth_rules::{BoothPlan, ImportOutcome};
use paros_core::badge::Language;

use super::texts::Texts;

/// The texts of these pages.
pub(crate) struct AdminTexts {
    language: Language,
    pub(crate) admin: &'static str,
    pub(crate) account: &'static str,
    pub(crate) accounts: &'static str,
    pub(crate) role: &'static str,
    pub(crate) state: &'static str,
    pub(crate) disabled: &'static str,
    pub(crate) disable: &'static str,
    pub(crate) enable: &'static str,
    pub(crate) new_account: &'static str,
    pub(crate) first_password: &'static str,
    pub(crate) old_password: &'static str,
    pub(crate) new_password: &'static str,
    pub(crate) change_password: &'static str,
    pub(crate) logins_end: &'static str,
    pub(crate) all_logins_end: &'static str,
    pub(crate) fleet_tokens: &'static str,
    pub(crate) new_token: &'static str,
    pub(crate) note: &'static str,
    pub(crate) uses: &'static str,
    pub(crate) uses_left: &'static str,
    pub(crate) days: &'static str,
    pub(crate) expires: &'static str,
    pub(crate) revoke: &'static str,
    pub(crate) revoked: &'static str,
    pub(crate) over: &'static str,
    pub(crate) booth_address: &'static str,
    pub(crate) keep_file_secret: &'static str,
    pub(crate) settings: &'static str,
    pub(crate) audit: &'static str,
    pub(crate) older: &'static str,
    pub(crate) when: &'static str,
    pub(crate) who: &'static str,
    pub(crate) what: &'static str,
    pub(crate) sculpture: &'static str,
    pub(crate) the_booth: &'static str,
    pub(crate) known: &'static str,
    pub(crate) export_all: &'static str,
    pub(crate) delete_all: &'static str,
    pub(crate) others_too: &'static str,
    pub(crate) deleted_on: &'static str,
    pub(crate) still_to_come: &'static str,
    pub(crate) kept_until: &'static str,
    pub(crate) has_trace: &'static str,
    pub(crate) print: &'static str,
    /// Removes the last tapped picture from the search.
    pub(crate) take_back: &'static str,
    pub(crate) keep_address: &'static str,
    pub(crate) privacy_title: &'static str,
    pub(crate) clock_is_right: &'static str,
    pub(crate) import: &'static str,
    pub(crate) import_about: &'static str,
    pub(crate) import_needs_script: &'static str,
    pub(crate) import_files: &'static str,
    import_outcomes: [&'static str; 3],
    roles: [&'static str; 2],
}

impl AdminTexts {
    /// Returns the texts in the language of a page.
    pub(crate) const fn of(texts: &Texts) -> &'static AdminTexts {
        match texts.language {
            Language::English => &ENGLISH,
            Language::Greek => &GREEK,
        }
    }

    pub(crate) const fn role_name(&self, role: StaffRole) -> &'static str {
        self.roles[role as usize]
    }

    pub(crate) const fn import_outcome(&self, outcome: ImportOutcome) -> &'static str {
        self.import_outcomes[outcome as usize]
    }

    /// Writes that the fleet file expires on a day, and how to make the next one.
    pub(crate) fn file_ends(&self, note: &str, day: &str) -> String {
        match self.language {
            Language::English => format!(
                "The fleet's file “{note}” expires on {day}: make the next one under Admin, or by paros-booth fleet-file."
            ),
            Language::Greek => format!(
                "Το αρχείο «{note}» λήγει στις {day}: φτιάξτε το επόμενο στη Διαχείριση ή με paros-booth fleet-file."
            ),
        }
    }

    /// Writes that the certificate of `--staff-cert` expires on a day, and how to load the next one.
    pub(crate) fn staff_certificate_ends(&self, day: &str) -> String {
        match self.language {
            Language::English => format!(
                "The certificate of --staff-cert ends on {day}: put the new files in its place, then systemctl reload paros-booth."
            ),
            Language::Greek => format!(
                "Το πιστοποιητικό του --staff-cert λήγει στις {day}: βάλτε τα νέα αρχεία στη θέση του, και μετά systemctl reload paros-booth."
            ),
        }
    }

    /// Writes the question whether a clock that jumped is right.
    pub(crate) fn clock_jumped(&self, now: &str, seen_at: &str) -> String {
        match self.language {
            Language::English => format!(
                "The clock of this machine jumped: it shows {now}, and the booth last saw it at {seen_at}. Until you answer, no sculpture expires. If the clock is wrong, set it right; this question then goes away."
            ),
            Language::Greek => format!(
                "Το ρολόι του υπολογιστή άλλαξε απότομα: δείχνει {now}, ενώ το περίπτερο το είδε τελευταία στις {seen_at}. Ώσπου να απαντήσετε, κανένα γλυπτό δεν λήγει. Αν το ρολόι είναι λάθος, διορθώστε το· η ερώτηση τότε φεύγει."
            ),
        }
    }

    /// Writes that the certificate of the site's own authority expires on a day.
    pub(crate) fn authority_ends(&self, day: &str) -> String {
        match self.language {
            Language::English => format!(
                "The site's certificate authority ends on {day}: from then on headsets need a new site's file."
            ),
            Language::Greek => format!(
                "Η αρχή πιστοποίησης του χώρου λήγει στις {day}: από τότε οι συσκευές χρειάζονται αρχείο νέου χώρου."
            ),
        }
    }

    /// Writes the paragraphs about what is kept and for how long.
    pub(crate) fn privacy(&self, plan: &BoothPlan) -> Vec<String> {
        let BoothPlan { retention_days, trace_days, withdrawn_days, horizon_days } = plan;
        match self.language {
            Language::English => vec![
                format!("What you sculpted is kept for {retention_days} days after the day on which it came, under the badge that you were shown; in its last {withdrawn_days} days it is hidden. Your name isn't asked for. With it goes how long you sculpted, in which language, and whether you are under age, if you said so."),
                format!("Where the exhibition records your hands' motion, that is kept for {trace_days} days. By itself a headset sends none."),
                "An e-mail address is kept until the mail was sent, or has failed, unless you agree that it stays as long as the sculpture. It is in no log and no backup.".into(),
                format!("You may withdraw your sculpture: it is hidden at once, can be brought back for {withdrawn_days} days, and is deleted then. Or have it deleted at once, with all that is known under your badge. Tell the staff your badge; they also give you a copy of all of it."),
                format!("Of a deleted sculpture only its number stays, for {horizon_days} days, so that a headset that still has it deletes it too. Then your badge may be given to somebody else."),
            ],
            Language::Greek => vec![
                format!("Ό,τι σκαλίσατε κρατιέται {retention_days} ημέρες μετά την ημέρα που έφτασε, με το σήμα που είδατε· τις τελευταίες {withdrawn_days} ημέρες είναι κρυμμένο. Δεν ζητάμε το όνομά σας. Μαζί του κρατιέται πόση ώρα σκαλίζατε, σε ποια γλώσσα, και αν είστε ανήλικος, εφόσον το είπατε."),
                format!("Όπου η έκθεση καταγράφει την κίνηση των χεριών σας, αυτή κρατιέται {trace_days} ημέρες. Από μόνη της μια συσκευή δεν τη στέλνει."),
                "Μια διεύθυνση e-mail κρατιέται ώσπου να σταλεί το μήνυμα ή να αποτύχει, εκτός αν συμφωνείτε να μείνει όσο και το γλυπτό. Δεν υπάρχει σε κανένα ημερολόγιο και σε κανένα αντίγραφο ασφαλείας.".into(),
                format!("Μπορείτε να αποσύρετε το γλυπτό σας: κρύβεται αμέσως, μπορεί να επανέλθει για {withdrawn_days} ημέρες, και μετά διαγράφεται. Ή να διαγραφεί αμέσως, με όλα όσα είναι γνωστά με το σήμα σας. Πείτε το σήμα σας στο προσωπικό· σας δίνει και αντίγραφο όλων."),
                format!("Από ένα διαγραμμένο γλυπτό μένει μόνο ο αριθμός του, για {horizon_days} ημέρες, ώστε να το διαγράψει και όποια συσκευή το έχει ακόμη. Μετά το σήμα σας μπορεί να δοθεί σε άλλον."),
            ],
        }
    }
}

const ENGLISH: AdminTexts = AdminTexts {
    language: Language::English,
    admin: "Admin",
    account: "Your account",
    accounts: "Accounts",
    role: "Role",
    state: "State",
    disabled: "shut out",
    disable: "Shut out",
    enable: "Let in again",
    new_account: "New account",
    first_password: "First password, to be changed by its owner",
    old_password: "Password of now",
    new_password: "New password",
    change_password: "Change password",
    logins_end: "All other logins of this account end.",
    all_logins_end: "All logins of the account end. If it is shut out, it is let in again.",
    fleet_tokens: "Files for fleets of headsets",
    new_token: "Make a file",
    note: "Note",
    uses: "Headsets that it lets in",
    uses_left: "Headsets left",
    days: "Days until it expires",
    expires: "Expires",
    revoke: "Take back",
    revoked: "taken back",
    over: "used up or expired",
    booth_address: "The booth's address, as headsets reach it",
    keep_file_secret: "The file is shown once. Whoever has it can let a headset in.",
    settings: "Settings",
    audit: "Who did what",
    older: "Older",
    when: "When",
    who: "Who",
    what: "What",
    sculpture: "Sculpture",
    the_booth: "the booth",
    known: "All that is known under this badge",
    export_all: "Export all",
    delete_all: "Delete all",
    others_too: "Others may have this badge: what is below may be several visitors'.",
    deleted_on: "Deleted on",
    still_to_come: "A headset still has a sculpture of this badge. Delete it here once it has come.",
    kept_until: "Kept until",
    has_trace: "With the motion of the hands",
    print: "Print",
    take_back: "Take the last one back",
    keep_address: "The visitor agrees that the address is kept as long as the sculpture",
    privacy_title: "What is kept of you, and for how long",
    clock_is_right: "The clock is right",
    import: "Sculptures from a headset's disk",
    import_about: "For a headset that is broken or can't reach the booth: copy its outbox, and choose the files here. They are taken as if the headset had sent them.",
    import_needs_script: "This page needs JavaScript. The command import-spool does without.",
    import_files: "Files of its outbox (.parcel, .sent, .refused)",
    import_outcomes: ["Taken.", "The booth has it already.", "It was deleted at the booth."],
    roles: ["attendant", "admin"],
};

const GREEK: AdminTexts = AdminTexts {
    language: Language::Greek,
    admin: "Διαχείριση",
    account: "Ο λογαριασμός σας",
    accounts: "Λογαριασμοί",
    role: "Ρόλος",
    state: "Κατάσταση",
    disabled: "αποκλεισμένος",
    disable: "Αποκλεισμός",
    enable: "Επαναφορά",
    new_account: "Νέος λογαριασμός",
    first_password: "Πρώτος κωδικός, να τον αλλάξει ο κάτοχος",
    old_password: "Τωρινός κωδικός",
    new_password: "Νέος κωδικός",
    change_password: "Αλλαγή κωδικού",
    logins_end: "Όλες οι άλλες συνδέσεις του λογαριασμού τελειώνουν.",
    all_logins_end: "Όλες οι συνδέσεις του λογαριασμού τελειώνουν. Αν είναι αποκλεισμένος, επανέρχεται.",
    fleet_tokens: "Αρχεία για ομάδες συσκευών",
    new_token: "Δημιουργία αρχείου",
    note: "Σημείωση",
    uses: "Πόσες συσκευές δέχεται",
    uses_left: "Απομένουν συσκευές",
    days: "Ημέρες ως τη λήξη",
    expires: "Λήγει",
    revoke: "Ανάκληση",
    revoked: "ανακλήθηκε",
    over: "εξαντλήθηκε ή έληξε",
    booth_address: "Η διεύθυνση του περιπτέρου για τις συσκευές",
    keep_file_secret: "Το αρχείο δείχνεται μία φορά. Όποιος το έχει μπορεί να εγγράψει συσκευή.",
    settings: "Ρυθμίσεις",
    audit: "Ποιος έκανε τι",
    older: "Παλαιότερα",
    when: "Πότε",
    who: "Ποιος",
    what: "Τι",
    sculpture: "Γλυπτό",
    the_booth: "το περίπτερο",
    known: "Όλα όσα είναι γνωστά με αυτό το σήμα",
    export_all: "Εξαγωγή όλων",
    delete_all: "Διαγραφή όλων",
    others_too: "Ίσως και άλλοι έχουν αυτό το σήμα: τα παρακάτω μπορεί να είναι πολλών επισκεπτών.",
    deleted_on: "Διαγράφηκε",
    still_to_come: "Μια συσκευή έχει ακόμη γλυπτό με αυτό το σήμα. Διαγράψτε το εδώ μόλις έρθει.",
    kept_until: "Κρατιέται ως",
    has_trace: "Με την κίνηση των χεριών",
    print: "Εκτύπωση",
    take_back: "Αναίρεση της τελευταίας επιλογής",
    keep_address: "Ο επισκέπτης συμφωνεί να κρατηθεί η διεύθυνση όσο και το γλυπτό",
    privacy_title: "Τι κρατιέται από εσάς, και για πόσο",
    clock_is_right: "Το ρολόι είναι σωστό",
    import: "Γλυπτά από τον δίσκο συσκευής",
    import_about: "Για συσκευή που χάλασε ή δεν φτάνει το περίπτερο: αντιγράψτε τα εξερχόμενά της και διαλέξτε τα αρχεία εδώ. Λαμβάνονται σαν να τα έστειλε η συσκευή.",
    import_needs_script: "Αυτή η σελίδα χρειάζεται JavaScript. Η εντολή import-spool όχι.",
    import_files: "Αρχεία των εξερχομένων (.parcel, .sent, .refused)",
    import_outcomes: ["Ελήφθη.", "Το περίπτερο το έχει ήδη.", "Διαγράφηκε στο περίπτερο."],
    roles: ["βοηθός", "διαχειριστής"],
};
