//! Texts of refusals, in the page's language.

use paros_booth_rules::{Expected, Reason, Refusal, WordsFault};
use paros_core::badge::Language;
use tracing::warn;

/// Writes a refusal as a sentence. Errors of the store and the disk are logged instead of shown.
pub(crate) fn tell_refusal(language: Language, refusal: &Refusal) -> String {
    if refusal.is_failure() {
        warn!(%refusal, "a page failed");
    }
    as_sentence(&match language {
        Language::English if refusal.is_failure() => {
            "the booth can't now; its log says why".to_owned()
        }
        Language::English => refusal.to_string(),
        Language::Greek => tell_in_greek(refusal),
    })
}

/// Makes a sentence of a text: with a capital and a full stop.
fn as_sentence(text: &str) -> String {
    let mut letters = text.chars();
    let first = letters.next().into_iter().flat_map(char::to_uppercase);
    first.chain(letters).chain(['.']).collect()
}

/// Writes what is wrong with the words of a badge.
pub(crate) fn tell_words_fault(language: Language, fault: &WordsFault) -> String {
    as_sentence(&match (language, fault) {
        (Language::English, fault) => fault.to_string(),
        (Language::Greek, WordsFault::UnknownWord(word)) => {
            format!("«{word}»: δεν είναι χρώμα ούτε εικόνα σήματος")
        }
        (Language::Greek, WordsFault::Colours(count)) => {
            format!("{count} χρώματα· περιμέναμε ένα")
        }
        (Language::Greek, WordsFault::Pictograms(count)) => {
            format!("{count} εικόνες· περιμέναμε μία έως τέσσερις")
        }
    })
}

fn tell_in_greek(refusal: &Refusal) -> String {
    match refusal {
        Refusal::BadRequest(_) => "δεν είναι αυτό που περίμενε η σελίδα".into(),
        Refusal::Unfit(expected) => format!("περιμέναμε {}", expected_in_greek(*expected)),
        Refusal::UnknownToken => "δεν υπάρχει τέτοια σύνδεση, ή δεν υπάρχει πια".into(),
        Refusal::Forbidden(reason) | Refusal::NotFound(reason) | Refusal::Conflict(reason) => {
            reason_in_greek(*reason).into()
        }
        Refusal::TooLarge { most, .. } => format!("είναι πάρα πολλά: το πολύ {most}"),
        Refusal::Undecodable(_) => "από αυτό δεν γίνεται γλυπτό".into(),
        Refusal::Busy { retry_after, .. } => {
            format!("πάρα πολλές φορές· ξανά σε {retry_after} δευτερόλεπτα")
        }
        Refusal::Overloaded { retry_after } => {
            format!("το περίπτερο είναι απασχολημένο· ξανά σε {retry_after} δευτερόλεπτα")
        }
        Refusal::Store(_) | Refusal::Files(_) => {
            "το περίπτερο δεν μπορεί τώρα· το ημερολόγιό του λέει γιατί".into()
        }
    }
}

fn expected_in_greek(expected: Expected) -> String {
    match expected {
        Expected::MailAddress => "μια διεύθυνση e-mail, όπως ana@example.org".into(),
        Expected::AccountName => "ένα όνομα με γράμματα, ψηφία, τελείες και παύλες".into(),
        Expected::Password(least) => format!("κωδικό με {least} χαρακτήρες ή περισσότερους"),
        Expected::Role => "έναν ρόλο: βοηθός ή διαχειριστής".into(),
        Expected::FleetBounds { uses, days } => {
            format!("από 1 ως {uses} συσκευές και από 1 ως {days} ημέρες")
        }
        Expected::BoothAddress => "https:// και τη διεύθυνση όπου φτάνουν οι συσκευές".into(),
        Expected::Height => "ένα ύψος σε χιλιοστά".into(),
        Expected::HeightWithin(least, most) => format!("ύψος από {least} ως {most} mm"),
        Expected::HeightAlone => {
            "ένα ύψος: χωρίς πρόγραμμα τεμαχισμού δεν βρίσκεται μέγεθος για έναν χρόνο".into()
        }
        Expected::Minutes => "έναν χρόνο σε ολόκληρα λεπτά".into(),
        Expected::MinutesWithin(least, most) => format!("χρόνο από {least} ως {most} λεπτά"),
        Expected::Filament(most) => format!("χρώμα νήματος με το πολύ {most} γράμματα"),
        Expected::Note(most) => format!("σημείωση με το πολύ {most} γράμματα"),
        Expected::Form => "τη φόρμα όπως την έχει η σελίδα".into(),
        Expected::ParcelName => {
            "ένα αρχείο γλυπτού όπως το έχει μια συσκευή: 32 δεκαεξαδικά ψηφία και κατάληξη".into()
        }
        Expected::Confirmation => "να το επιβεβαιώσετε".into(),
    }
}

const fn reason_in_greek(reason: Reason) -> &'static str {
    match reason {
        Reason::ForeignHeartbeat => "το μήνυμα είναι άλλης συσκευής",
        Reason::ForeignPage => "η φόρμα είναι σε σελίδα άλλου ιστότοπου",
        Reason::ForeignForm => "η φόρμα είναι άλλης σύνδεσης",
        Reason::AdminsOnly => "αυτό το κάνουν μόνο διαχειριστές",
        Reason::WrongLogin => "λάθος όνομα ή κωδικός",
        Reason::WrongPassword => "ο τωρινός κωδικός είναι άλλος",
        Reason::OwnPassword => "ο δικός σας κωδικός αλλάζει στη σελίδα του λογαριασμού σας",
        Reason::WrongFirstCode => "ο κωδικός είναι άλλος, ή χρησιμοποιήθηκε ήδη",
        Reason::NoPage => "δεν υπάρχει τέτοια σελίδα",
        Reason::NoHeadset => "δεν υπάρχει συσκευή με αυτόν τον αριθμό",
        Reason::NoSculpture => "δεν υπάρχει τέτοιο γλυπτό",
        Reason::NoEnrolToken => "δεν υπάρχει τέτοιο αρχείο εγγραφής",
        Reason::NoAccount => "δεν υπάρχει τέτοιος λογαριασμός",
        Reason::NoPrint => "δεν υπάρχει τέτοια παραγγελία εκτύπωσης",
        Reason::NoBadge => "δεν υπάρχει τέτοιο σήμα",
        Reason::NoPrinter => "δεν υπάρχει τέτοιος εκτυπωτής",
        Reason::NoMailServer => "δεν έχει οριστεί διακομιστής αλληλογραφίας",
        Reason::LinkRevoked => "ο σύνδεσμος του επισκέπτη ακυρώθηκε",
        Reason::ShutOut => "αυτή η συσκευή αποκλείστηκε",
        Reason::NeverCame => "η συσκευή δεν έχει έρθει ποτέ",
        Reason::NotWorn => "κανείς δεν φοράει τη συσκευή",
        Reason::OtherParcel => "έχει ήδη ληφθεί άλλο αρχείο αυτού του γλυπτού",
        Reason::FileMissing => "λείπει το αρχείο ενός γλυπτού από το αντίγραφο",
        Reason::MailsFull => "το γλυπτό έχει όσα μηνύματα επιτρέπονται",
        Reason::PrintsFull => "το γλυπτό έχει όσες εκτυπώσεις επιτρέπονται",
        Reason::HeadsetsFull => "έχουν εγγραφεί όσες συσκευές επιτρέπονται",
        Reason::NumbersFull => "δεν έμεινε αριθμός για συσκευή",
        Reason::PrintMovedOn => "η εκτύπωση έχει αλλάξει κατάσταση στο μεταξύ",
        Reason::NotSliced => "μια εκτύπωση στέλνεται αφού τεμαχιστεί",
        Reason::PrinterTaken => "ο εκτυπωτής έχει άλλη εκτύπωση",
        Reason::FirstAccountThere => "υπάρχει ήδη λογαριασμός",
        Reason::NameTaken => "το όνομα υπάρχει ήδη, ή μοιάζει με άλλου λογαριασμού",
        Reason::LastAdmin => "κάποιος πρέπει να μείνει διαχειριστής",
    }
}

/// The beginnings of stored causes of failed mails and prints, and their Greek translations. If the rest of a
/// cause is a number, it is appended.
const CAUSES: [(&str, &str); 17] = [
    ("the mail server was silent", "ο διακομιστής αλληλογραφίας δεν απαντά"),
    ("the mail server said", "ο διακομιστής αλληλογραφίας απάντησε"),
    ("the mail server", "ο διακομιστής αλληλογραφίας δεν είναι προσβάσιμος"),
    ("its model is too large", "το μοντέλο είναι πολύ μεγάλο για μήνυμα"),
    ("its picture isn't drawn yet", "η εικόνα του δεν είναι έτοιμη"),
    ("the sculpture was withdrawn", "το γλυπτό αποσύρθηκε"),
    ("it may have been sent before", "ίσως στάλθηκε πριν από την επαναφορά του περιπτέρου"),
    ("no mail can be made", "δεν γίνεται μήνυμα από αυτό"),
    ("the printer didn't answer", "ο εκτυπωτής δεν απάντησε"),
    ("the printer wants another key", "ο εκτυπωτής θέλει άλλο κλειδί"),
    ("the printer said", "ο εκτυπωτής απάντησε"),
    ("the printer doesn't have it", "ο εκτυπωτής δεν την έχει"),
    ("the printer", "ο εκτυπωτής σταμάτησε"),
    ("it was stopped at the printer", "σταμάτησε από τον εκτυπωτή"),
    ("it is larger than the printer", "είναι μεγαλύτερο από τον εκτυπωτή"),
    ("the slicer ended with code", "το πρόγραμμα τεμαχισμού τελείωσε με κωδικό"),
    ("the slicer", "το πρόγραμμα τεμαχισμού απέτυχε"),
];

/// Writes the stored cause of a mail's or a print's failure in a language.
pub(crate) fn tell_cause(language: Language, cause: &str) -> String {
    if language == Language::English {
        return cause.to_owned();
    }
    let found = CAUSES.iter().find_map(|(start, text)| Some((cause.strip_prefix(start)?, text)));
    match found {
        Some((rest, text)) if rest.trim().parse::<i64>().is_ok() => {
            format!("{text} {}", rest.trim())
        }
        Some((_, text)) => (*text).to_owned(),
        None => "δεν γίνεται από αυτό".to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use std::io;

    use paros_booth_rules::StoreError;

    use super::*;

    /// Returns refusals of every kind, with every reason.
    fn all_refusals() -> Vec<Refusal> {
        let mut all = vec![
            Refusal::BadRequest("some English words".into()),
            Refusal::UnknownToken,
            Refusal::TooLarge { what: "sculptures at once", most: 5 },
            Refusal::Undecodable("some English words".into()),
            Refusal::Busy { what: "commands wait", retry_after: 10 },
            Refusal::Overloaded { retry_after: 10 },
            Refusal::Store(StoreError::Failed("some English words".into())),
            Refusal::Files(io::Error::other("some English words")),
        ];
        for reason in Reason::ALL {
            all.extend([Refusal::Forbidden(*reason), Refusal::NotFound(*reason)]);
            all.push(Refusal::Conflict(*reason));
        }
        let expected = [
            Expected::MailAddress,
            Expected::AccountName,
            Expected::Password(10),
            Expected::Role,
            Expected::FleetBounds { uses: 1000, days: 365 },
            Expected::BoothAddress,
            Expected::Height,
            Expected::HeightAlone,
            Expected::HeightWithin(10, 1000),
            Expected::Minutes,
            Expected::MinutesWithin(5, 100),
            Expected::Filament(40),
            Expected::Note(300),
            Expected::Form,
            Expected::ParcelName,
            Expected::Confirmation,
        ];
        all.extend(expected.map(Refusal::Unfit));
        all
    }

    /// Finds words in Latin letters, except those that Greek texts may have.
    fn english_words(text: &str) -> Vec<&str> {
        let words = text.split(|letter: char| !letter.is_ascii_alphabetic());
        const SHARED: [&str; 7] = ["", "e", "mail", "https", "mm", "ana", "example"];
        words.filter(|word| !SHARED.contains(word) && *word != "org").collect()
    }

    #[test]
    fn no_error_of_a_greek_page_is_english() {
        for refusal in all_refusals() {
            let told = tell_refusal(Language::Greek, &refusal);
            assert_eq!(english_words(&told), [""; 0], "{refusal}: {told}");
            assert!(told.chars().any(|letter| ('α'..='ω').contains(&letter)), "{refusal}: {told}");
            let english = tell_refusal(Language::English, &refusal);
            assert!(!english_words(&english).is_empty(), "{refusal}: {english}");
            assert!(!english.contains("some English words") || !refusal.is_failure());
        }
        for fault in [
            WordsFault::UnknownWord("δράκος".into()),
            WordsFault::Colours(2),
            WordsFault::Pictograms(5),
        ] {
            let told = tell_words_fault(Language::Greek, &fault);
            assert_eq!(english_words(&told), [""; 0], "{told}");
        }
        let known = CAUSES.map(|(start, _)| start.to_owned());
        let others = ["the mail server said 550", "the slicer: no such file", "anything"];
        for cause in known.into_iter().chain(others.map(str::to_owned)) {
            let told = tell_cause(Language::Greek, &cause);
            assert!(english_words(&told).is_empty() && !told.is_empty(), "{cause}: {told}");
        }
        assert!(tell_cause(Language::Greek, "the mail server said 550").ends_with(" 550"));
    }
}
