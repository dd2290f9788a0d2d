//! The rights of staff.

use std::time::Duration;

use super::common::*;
use paros_booth_rules::limits::{SESSION_IDLE, SESSION_LIFE};
use paros_booth_rules::records::StaffRole;
use paros_booth_rules::{BoothTime, SessionBits};

const fn bits(byte: u8) -> SessionBits {
    SessionBits { cookie: [byte; 32], form_token: [byte + 1; 16] }
}

#[test]
fn the_first_account_is_an_admins_and_there_is_one_first() {
    let Rig { booth, .. } = Rig::new();
    assert!(!booth.has_accounts().unwrap());
    booth.add_first_admin("ana", "hash", START).unwrap();
    assert!(booth.has_accounts().unwrap());
    assert_eq!(status(booth.add_first_admin("eve", "hash", START)), 409);
    assert_eq!(booth.list_accounts().unwrap()[0].role, StaffRole::Admin);
    booth.add_account("bob", "hash", StaffRole::Attendant, "ana", START).unwrap();
    assert_eq!(status(booth.add_account("bob", "x", StaffRole::Admin, "ana", START)), 409);
    for name in ["", "a b", "<b>", "a\nb", &"x".repeat(65)] {
        let added = booth.add_account(name, "x", StaffRole::Attendant, "ana", START);
        assert_eq!(status(added), 400, "{name}");
    }
}

#[test]
fn a_name_that_looks_like_anothers_is_refused() {
    let Rig { booth, .. } = Rig::new();
    booth.add_first_admin("anna", "hash", START).unwrap();
    let add = |name| booth.add_account(name, "x", StaffRole::Attendant, "anna", START);
    // Capitals; a Cyrillic first letter; Greek capitals; a Greek capital among Latin letters; Cyrillic beside Greek.
    for name in ["anna", "ANNA", "Anna", "\u{430}nna", "ΑΝΝΑ", "anΝa", "\u{430}Νna"] {
        assert_eq!(status(add(name)), 409, "{name}");
    }
    for name in ["Άννα", "hanna", "ana", "Γιώργος", "anna.k", "anna2"] {
        add(name).expect(name);
    }
    assert_eq!(status(add("ΓΙΏΡΓΟΣ")), 409);
}

#[test]
fn a_login_lasts_while_it_is_used_and_no_longer_than_a_day() {
    let Rig { booth, .. } = Rig::new();
    booth.add_first_admin("ana", "hash", START).unwrap();
    booth.log_in("ana", &bits(1), START).unwrap();
    let find = |now: BoothTime| booth.find_login(&bits(1).cookie, now);
    let found = find(START).unwrap();
    assert_eq!((found.account.as_str(), found.role), ("ana", StaffRole::Admin));
    found.check_form(&[2; 16]).expect("its own form");
    assert_eq!(status(found.check_form(&[3; 16])), 403);
    assert_eq!(status(booth.find_login(&[9; 32], START)), 401);
    let idle = START.after(SESSION_IDLE);
    assert_eq!(status(find(idle)), 401);
    // Requests that a page makes by itself don't extend a login.
    booth.log_in("ana", &bits(4), START).unwrap();
    booth.peek_login(&bits(4).cookie, START.after(SESSION_IDLE / 2)).expect("it isn't over");
    assert_eq!(status(booth.peek_login(&bits(4).cookie, idle)), 401);
    // With uses in between, a login lasts until the end of its life.
    let mut now = START;
    while now < START.after(SESSION_LIFE) {
        find(now).expect("it is used");
        now = now.after(SESSION_IDLE / 2);
    }
    assert_eq!(status(find(START.after(SESSION_LIFE))), 401);
    assert_eq!(status(find(now.after(Duration::from_secs(1)))), 401);
}

#[test]
fn who_is_shut_out_is_out_at_once_and_an_admin_is_left() {
    let Rig { booth, .. } = Rig::new();
    booth.add_first_admin("ana", "hash", START).unwrap();
    booth.add_account("bob", "hash of bob", StaffRole::Attendant, "ana", START).unwrap();
    booth.log_in("bob", &bits(1), START).unwrap();
    let bob = booth.find_login(&bits(1).cookie, START).unwrap();
    assert_eq!(status(bob.check_admin()), 403);
    assert_eq!(booth.password_hash("bob").unwrap().as_deref(), Some("hash of bob"));
    booth.set_account_disabled("bob", true, "ana", START).unwrap();
    assert_eq!(status(booth.find_login(&bits(1).cookie, START)), 401);
    assert_eq!(booth.password_hash("bob").unwrap(), None);
    assert_eq!(booth.password_hash("eve").unwrap(), None);
    assert_eq!(status(booth.set_account_disabled("ana", true, "ana", START)), 409);
    booth.set_account_disabled("bob", false, "ana", START).unwrap();
    assert_eq!(status(booth.find_login(&bits(1).cookie, START)), 401, "the login is over");
    booth.log_in("bob", &bits(1), START).unwrap();
    booth.log_out(&bits(1).cookie).unwrap();
    assert_eq!(status(booth.find_login(&bits(1).cookie, START)), 401);
}

#[test]
fn a_browsers_token_proves_which_account_was_logged_in() {
    let Rig { booth, .. } = Rig::new();
    let token = booth.make_browser_token("ana");
    let ana = booth.check_browser_token(&token).expect("the booth made it");
    assert_eq!(booth.check_browser_token(&booth.make_browser_token("ana")), Some(ana));
    assert_ne!(booth.check_browser_token(&booth.make_browser_token("bob")), Some(ana));
    for place in 0..32 {
        let mut forged = token;
        forged[place] ^= 1;
        assert_eq!(booth.check_browser_token(&forged), None, "{place}");
    }
}

#[test]
fn a_reset_password_ends_all_logins_and_lets_its_account_in() {
    let Rig { booth, .. } = Rig::new();
    booth.add_first_admin("ana", "hash", START).unwrap();
    booth.add_account("bob", "hash of bob", StaffRole::Attendant, "ana", START).unwrap();
    booth.log_in("bob", &bits(1), START).unwrap();
    booth.log_in("ana", &bits(3), START).unwrap();
    assert!(!booth.reset_password("bob", "second", "ana", START).unwrap());
    assert_eq!(booth.password_hash("bob").unwrap().as_deref(), Some("second"));
    assert_eq!(status(booth.find_login(&bits(1).cookie, START)), 401);
    booth.find_login(&bits(3).cookie, START).expect("another's");
    booth.set_account_disabled("bob", true, "ana", START).unwrap();
    assert!(booth.reset_password("bob", "third", "console", START).unwrap(), "it was shut out");
    assert_eq!(booth.password_hash("bob").unwrap().as_deref(), Some("third"));
    assert_eq!(booth.list_accounts().unwrap()[1].role, StaffRole::Attendant);
    assert_eq!(status(booth.reset_password("eve", "x", "ana", START)), 404);
    let audit = booth.list_audit(9).unwrap();
    let has = |by: &str, action: &str| {
        audit.iter().any(|entry| entry.account.as_deref() == Some(by) && entry.action == action)
    };
    assert!(has("ana", "reset password of bob") && has("console", "reset password of bob"));
    assert!(has("console", "enable account bob"));
}

#[test]
fn a_new_password_ends_all_logins_of_its_account() {
    let Rig { booth, .. } = Rig::new();
    booth.add_first_admin("ana", "hash", START).unwrap();
    booth.add_account("bob", "hash of bob", StaffRole::Attendant, "ana", START).unwrap();
    booth.log_in("bob", &bits(1), START).unwrap();
    booth.log_in("bob", &bits(3), START).unwrap();
    booth.log_in("ana", &bits(5), START).unwrap();
    booth.set_password("bob", "another", START).unwrap();
    assert_eq!(booth.password_hash("bob").unwrap().as_deref(), Some("another"));
    for byte in [1, 3] {
        assert_eq!(status(booth.find_login(&bits(byte).cookie, START)), 401);
    }
    booth.find_login(&bits(5).cookie, START).expect("another's");
    booth.set_account_disabled("bob", true, "ana", START).unwrap();
    assert_eq!(status(booth.set_password("bob", "x", START)), 404);
    assert_eq!(status(booth.set_password("eve", "x", START)), 404);
    let audit = booth.list_audit(9).unwrap();
    assert!(audit.iter().any(|entry| entry.action == "change password"));
    assert!(audit.iter().any(|entry| entry.action == "disable account bob"));
}
