//! Mail orders of visitors.

use super::common::*;
use paros_booth_rules::limits::{MAX_MAIL_TRIES, MAX_MAILS_OF_ONE, MAX_RETRY_WAIT, MIN_RETRY_WAIT};
use paros_booth_rules::records::{MailOrder, MailState};
use paros_booth_rules::{BoothTime, MailOutcome};
use paros_core::badge::Language;

const ANA: &str = "ana.p+paros@example.org";

/// Makes a booth with a sculpture of a Greek visitor.
fn with_sculpture() -> (Rig, SculptureId) {
    let rig = Rig::new();
    let device = rig.enrol(1);
    let parcel = Parcel::new(1, leased(5));
    rig.upload(&device, &parcel, START).unwrap();
    (rig, parcel.id)
}

impl Rig {
    fn mail(&self, id: &SculptureId) -> MailOrder {
        self.booth.list_mails(id).unwrap().remove(0)
    }
}

#[test]
fn a_mail_is_tried_until_a_server_takes_it_and_then_its_address_is_gone() {
    let (rig, id) = with_sculpture();
    let booth = &rig.booth;
    assert_eq!(booth.next_mail(START).unwrap(), None);
    booth.ask_mail(&id, (&format!(" {ANA} "), false), 7, "bob", START).unwrap();
    let mut now = START;
    let mut wait = MIN_RETRY_WAIT;
    for tries in 1..12 {
        let job = booth.next_mail(now).unwrap().expect("it is due");
        assert_eq!((job.order, job.address.as_str(), job.sculpture.id), (7, ANA, id.0));
        assert_eq!(job.language, Language::Greek);
        booth.note_mail(7, &MailOutcome::Later("no answer".into()), now).unwrap();
        let order = rig.mail(&id);
        assert_eq!(
            (order.state, order.tries, order.why.as_str()),
            (MailState::Queued, tries, "no answer")
        );
        assert_eq!(booth.next_mail(BoothTime(now.after(wait).0 - 1)).unwrap(), None, "{tries}");
        now = now.after(wait);
        wait = (2 * wait).min(MAX_RETRY_WAIT);
    }
    booth.note_mail(7, &MailOutcome::Accepted, now).unwrap();
    let order = rig.mail(&id);
    assert_eq!((order.state, order.address, order.why.as_str()), (MailState::Accepted, None, ""));
    assert_eq!(booth.next_mail(days(2)).unwrap(), None);
    // A late or repeated outcome changes nothing.
    booth.note_mail(7, &MailOutcome::Refused("no such address".into()), now).unwrap();
    booth.note_mail(8, &MailOutcome::Accepted, now).unwrap();
    assert_eq!(rig.mail(&id).state, MailState::Accepted);
    let audit = booth.list_audit(10).unwrap();
    assert!(audit.iter().any(|entry| entry.action == "mail"));
    assert!(!format!("{audit:?}").contains("example"), "no address");
}

#[test]
fn a_mail_that_fails_for_good_has_no_address_either() {
    let (rig, id) = with_sculpture();
    let booth = &rig.booth;
    booth.ask_mail(&id, (ANA, false), 1, "bob", START).unwrap();
    booth.note_mail(1, &MailOutcome::Refused("550".into()), START).unwrap();
    let order = rig.mail(&id);
    assert_eq!((order.state, order.address, order.why.as_str()), (MailState::Failed, None, "550"));
    booth.ask_mail(&id, (ANA, false), 2, "bob", seconds(1)).unwrap();
    for _ in 0..MAX_MAIL_TRIES {
        assert_eq!(rig.mail(&id).state, MailState::Queued);
        booth.note_mail(2, &MailOutcome::Later("no answer".into()), seconds(1)).unwrap();
    }
    assert_eq!((rig.mail(&id).state, rig.mail(&id).address), (MailState::Failed, None));
}

#[test]
fn what_is_withdrawn_or_deleted_is_not_sent_and_its_address_is_forgotten() {
    let (rig, id) = with_sculpture();
    let booth = &rig.booth;
    booth.ask_mail(&id, (ANA, false), 1, "bob", START).unwrap();
    booth.withdraw(&id, "bob", START).unwrap();
    assert_eq!((rig.mail(&id).state, rig.mail(&id).address), (MailState::Failed, None));
    assert_eq!(status(booth.ask_mail(&id, (ANA, false), 2, "bob", START)), 404);
    booth.bring_back(&id, "bob", START).unwrap();
    assert_eq!(booth.next_mail(days(1)).unwrap(), None, "it is asked for anew");
    booth.ask_mail(&id, (ANA, false), 3, "bob", seconds(1)).unwrap();
    assert_eq!(rig.sweep(days(400)).withdrawn, 1);
    assert_eq!(booth.next_mail(days(400)).unwrap(), None);
    booth.bring_back(&id, "bob", days(400)).unwrap();
    assert_eq!((rig.mail(&id).state, rig.mail(&id).address), (MailState::Failed, None));
    booth.ask_mail(&id, (ANA, false), 4, "bob", seconds(2)).unwrap();
    booth.delete(&id, "bob", seconds(3)).unwrap();
    assert_eq!(booth.list_mails(&id).unwrap(), []);
    assert_eq!(booth.next_mail(seconds(4)).unwrap(), None);
}

#[test]
fn a_sculpture_has_so_many_mails() {
    let (rig, id) = with_sculpture();
    for order in 0..MAX_MAILS_OF_ONE {
        rig.booth.ask_mail(&id, (ANA, false), order, "bob", START).unwrap();
    }
    assert_eq!(status(rig.booth.ask_mail(&id, (ANA, false), 99, "bob", START)), 409);
    assert_eq!(
        status(rig.booth.ask_mail(&SculptureId([9; 16]), (ANA, false), 98, "bob", START)),
        404
    );
}

#[test]
fn an_address_is_one_address_and_nothing_else() {
    let (rig, id) = with_sculpture();
    let ask = |address: &str| rig.booth.ask_mail(&id, (address, false), 1, "bob", START);
    let long = format!("{}@example.org", "a".repeat(65));
    for address in [
        "",
        "ana",
        "ana@",
        "@example.org",
        "ana@example",
        "ana@@example.org",
        "a b@example.org",
        "ana@example.org\r\nBcc: eve@example.org",
        "ana@example.org\nRCPT TO:<eve@example.org>",
        "ana@example.org,eve@example.org",
        "<ana@example.org>",
        "Ana <ana@example.org>",
        "\"ana\"@example.org",
        "ana@exam ple.org",
        "ana@-example.org",
        "ana@example..org",
        ".ana@example.org",
        "ana@[127.0.0.1]",
        "ana\0@example.org",
        "άνα@example.org",
        "<script>alert(1)</script>@example.org",
        &long,
    ] {
        assert_eq!(status(ask(address)), 400, "{address}");
    }
    assert_eq!(rig.booth.list_mails(&id).unwrap(), []);
    // This is a valid local part, and harmless.
    ask("o'brien'--@example.org").unwrap();
    assert_eq!(rig.mail(&id).address.as_deref(), Some("o'brien'--@example.org"));
}

#[test]
fn an_address_stays_where_the_visitor_agreed_until_the_sculpture_goes() {
    let (rig, id) = with_sculpture();
    rig.booth.ask_mail(&id, (ANA, true), 1, "bob", START).unwrap();
    assert!(rig.booth.next_mail(START).unwrap().expect("it is due").keeps_address);
    rig.booth.note_mail(1, &MailOutcome::Accepted, START).unwrap();
    assert_eq!(rig.mail(&id).address.as_deref(), Some(ANA));
    // A refused mail's address isn't kept.
    rig.booth.ask_mail(&id, (ANA, true), 2, "bob", seconds(1)).unwrap();
    rig.booth.note_mail(2, &MailOutcome::Refused("550".into()), START).unwrap();
    assert_eq!(rig.mail(&id).address, None);
    rig.booth.withdraw(&id, "bob", seconds(2)).unwrap();
    let mails = rig.booth.list_mails(&id).unwrap();
    assert!(mails.len() == 2 && mails.iter().all(|mail| mail.address.is_none()), "{mails:?}");
}
