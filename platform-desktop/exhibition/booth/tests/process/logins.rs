//! Tests that wrong logins are delayed and limited, and don't affect other clients.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::{JoinHandle, sleep, spawn};
use std::time::{Duration, Instant};

use crate::rig::{Answer, BoothFolder, BoothProcess, Client};
use crate::smtp_sink::wait_until;
use crate::staff::{Browser, cookie_of, post_form};

const RIGHT: &str = "correct+horse+battery";

fn log_in(client: &Client, cookie: &str, name: &str, password: &str) -> Answer {
    post_form(client, "/staff/login", cookie, &format!("name={name}&password={password}"))
}

/// Sends `count` wrong passwords at once. Returns the threads that wait for the statuses.
fn guess(client: &Client, name: &'static str, count: usize) -> Vec<JoinHandle<u16>> {
    let guess = |k| {
        let client = client.clone();
        spawn(move || log_in(&client, "", name, &format!("guess+number+{k}")).status)
    };
    (0..count).map(guess).collect()
}

fn wait_for(guesses: Vec<JoinHandle<u16>>) -> Vec<u16> {
    guesses.into_iter().map(|guess| guess.join().expect("an answer")).collect()
}

/// Returns the cookie of a browser in which somebody has logged in.
fn browser_cookie(answer: &Answer) -> String {
    let mut cookies = answer.head.lines().filter_map(|line| line.strip_prefix("set-cookie: "));
    let cookie = cookies.find(|cookie| cookie.starts_with("__host-paros-browser="));
    let pair = cookie.expect("it is set").split(';').next().expect("a pair");
    pair.replace("__host-paros-browser", "__Host-paros-browser")
}

/// Starts a booth with the accounts ana and bob, who have the same password.
fn start(folder: &BoothFolder) -> (BoothProcess, String) {
    let booth = folder.start();
    let code = booth.first_code().expect("a code");
    let cookie = Browser::first(&booth.client, &code).cookie;
    let ana = Browser { client: &booth.client, cookie: cookie.clone() };
    let bob = format!("&name=bob&password={RIGHT}&role=attendant");
    assert_eq!(ana.fill("/staff/admin", "/staff/admin/accounts", &bob).status, 303);
    (booth, cookie)
}

#[test]
fn a_right_login_passes_while_wrong_ones_of_its_address_wait() {
    let folder = BoothFolder::new("logins-wait");
    let (booth, _) = start(&folder);
    let client = &booth.client;
    let start = Instant::now();
    assert_eq!(log_in(client, "", "ana", "guess+number+0").status, 403);
    assert!(start.elapsed() < Duration::from_secs(4), "the first one isn't slow");
    let guesses = guess(client, "ana", 9);
    sleep(Duration::from_millis(500));
    for name in ["ana", "bob"] {
        assert_eq!(log_in(client, "", name, RIGHT).status, 303, "{name}");
    }
    let waiting = guesses.iter().filter(|guess| !guess.is_finished()).count();
    assert!(waiting >= 2, "{waiting} wrong ones still wait");
    assert_eq!(wait_for(guesses), [403; 9]);
    // Further wrong passwords, sent one at a time, are delayed by seconds.
    let start = Instant::now();
    assert_eq!(log_in(client, "", "ana", "guess+number+1").status, 403);
    assert!(start.elapsed() > Duration::from_secs(4), "{:?}", start.elapsed());
}

#[test]
fn guesses_are_bounded_and_keep_nobody_out_who_was_logged_in_before() {
    let folder = BoothFolder::new("logins-bound");
    let (booth, session) = start(&folder);
    let thief = booth.client.at_address([127, 0, 0, 2].into());
    let known = browser_cookie(&log_in(&thief, "", "bob", RIGHT));
    let start = Instant::now();
    // A client that keeps guessing.
    let is_over = Arc::new(AtomicBool::new(false));
    let (thiefs, ends) = (thief.clone(), is_over.clone());
    let guessing = spawn(move || {
        let mut guesses = Vec::new();
        while !ends.load(Ordering::Relaxed) {
            guesses.extend(guess(&thiefs, "ana", 1));
            sleep(Duration::from_millis(150));
        }
        wait_for(guesses)
    });
    // While there are too many guesses, right passwords are refused too, as they can't be distinguished
    // before they are verified.
    let refused = wait_until(|| {
        let answer = log_in(&thief, "", "ana", RIGHT);
        (answer.status == 429).then_some(answer)
    });
    assert!(refused.head.contains("retry-after: 10"), "{}", refused.head);
    assert_eq!(log_in(&thief, &known, "ana", RIGHT).status, 303, "a browser that is known");
    assert_eq!(log_in(&thief, "", "bob", RIGHT).status, 303, "another name");
    assert_eq!(log_in(&booth.client, "", "ana", RIGHT).status, 303, "another address");
    let forged = format!("__Host-paros-browser={}", "0".repeat(64));
    wait_until(|| (log_in(&thief, &forged, "ana", RIGHT).status == 429).then_some(()));
    is_over.store(true, Ordering::Relaxed);
    let statuses = guessing.join().expect("it ends");
    let most = 21 + start.elapsed().as_secs() / 5;
    let seen = statuses.iter().filter(|status| **status == 403).count() as u64;
    assert!((18..=most).contains(&seen) && seen < statuses.len() as u64, "{most}: {statuses:?}");
    // Existing sessions continue.
    assert_eq!(Browser { client: &thief, cookie: session }.get("/staff").status, 200);
    assert!(cookie_of(&log_in(&thief, &known, "ana", RIGHT)).starts_with("__Host-paros="));
}
