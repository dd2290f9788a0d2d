//! Limits on password guessing.
//!
//! A right password is accepted at once, even while many wrong ones arrive, also from the same network: only
//! the response to a wrong password is delayed. Still, guesses for a name are limited. Each password counts
//! as wrong until it is verified, and only so many of these are verified:
//!
//! - from one network: 20, then one in 5 seconds, or 17,300 a day;
//! - from all networks together: 100, then one a second, or 86,500 a day;
//! - from browsers in which a certain account was logged in before: as many as from one network.
//!
//! A right password can't be distinguished from a guess before it is verified. Therefore a browser without an
//! earlier login is refused while somebody in its network, or in many networks at once, keeps sending several
//! wrong passwords for the same name at a time.

use std::net::IpAddr;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use axum::http::HeaderMap;
use paros_booth_rules::Refusal;
use subtle::ConstantTimeEq as _;

use super::hash_queue::HashQueue;
use super::login::{BROWSER_COOKIE, read_token};
use super::passwords::verify_password;
use crate::server::app::BoothApp;
use crate::server::rate::RateLimiter;
use crate::server::routes::Peer;

/// The longest delay of the response to a wrong password. A client that sends one password at a time never
/// reaches the limit.
const LONGEST_DELAY: f32 = 5.0;

/// The client of a login. Each client has its own rate limit, and its own place in the queue.
#[derive(Clone, PartialEq, Eq, Hash)]
pub(crate) enum Asker {
    /// A network.
    Network(IpAddr),
    /// The browsers in which a certain account was logged in before.
    Browser([u8; 16]),
    /// A logged-in account.
    Account(String),
}

impl Asker {
    /// Returns the client of a login request.
    pub(super) fn of_request(app: &BoothApp, headers: &HeaderMap, peer: Peer) -> Self {
        let token = read_token(headers, BROWSER_COOKIE);
        let browser = token.and_then(|token| app.booth.check_browser_token(&token));
        browser.map_or_else(|| Asker::Network(peer.network()), Asker::Browser)
    }
}

/// The state that limits logins.
pub(crate) struct LoginGate {
    /// The code that is needed to create the first account; `None` once there is an account.
    first_code: Mutex<Option<String>>,
    wrong: RateLimiter<(Asker, String)>,
    wrong_of_networks: RateLimiter<String>,
    pub(super) hashes: HashQueue<Asker>,
}

impl LoginGate {
    /// Makes the state, with the code for the first account.
    pub(crate) fn new(first_code: Option<String>) -> Self {
        LoginGate {
            first_code: Mutex::new(first_code),
            wrong: RateLimiter::new(20, 1.0 / 5.0),
            wrong_of_networks: RateLimiter::new(100, 1.0),
            hashes: HashQueue::new(),
        }
    }

    /// Checks the code for the first account. Delays the response to a wrong code.
    pub(super) async fn check_first_code(
        &self,
        asker: &Asker,
        code: &str,
    ) -> Result<bool, Refusal> {
        let delay = self.count_wrong(asker, "")?;
        let is_right = {
            let first = self.first_code.lock().unwrap_or_else(PoisonError::into_inner);
            first.as_ref().is_some_and(|first| bool::from(first.as_bytes().ct_eq(code.as_bytes())))
        };
        self.settle((asker, ""), delay, is_right).await;
        Ok(is_right)
    }

    pub(super) fn forget_first_code(&self) {
        *self.first_code.lock().unwrap_or_else(PoisonError::into_inner) = None;
    }

    /// Counts a password as wrong before it is verified, so that concurrent ones are limited too. Returns the
    /// delay of the response if it is wrong.
    fn count_wrong(&self, asker: &Asker, name: &str) -> Result<Duration, Refusal> {
        let (now, key) = (Instant::now(), key_of(asker, name));
        let is_network = matches!(asker, Asker::Network(_));
        let has_left = self.wrong.take(key.clone(), now)
            && (!is_network || self.wrong_of_networks.take(key.1.clone(), now));
        if !has_left {
            return Err(Refusal::Busy { what: "wrong logins", retry_after: 10 });
        }
        // The first wrong password isn't delayed.
        let delay = (self.wrong.used(&key, now) - 1.0).clamp(0.0, LONGEST_DELAY);
        Ok(Duration::from_secs_f32(delay))
    }

    /// Reverts the count of a right password, or waits for the delay of a wrong one.
    async fn settle(&self, (asker, name): (&Asker, &str), delay: Duration, is_right: bool) {
        if !is_right {
            return tokio::time::sleep(delay).await;
        }
        let key = key_of(asker, name);
        if matches!(asker, Asker::Network(_)) {
            self.wrong_of_networks.give_back(&key.1);
        }
        self.wrong.give_back(&key);
    }
}

fn key_of(asker: &Asker, name: &str) -> (Asker, String) {
    // Account names are not longer than this.
    (asker.clone(), name.chars().take(64).collect())
}

/// Returns `true` if a password is the account's. Delays the response to a wrong one.
///
/// # Errors
/// [`Refusal::Busy`] or [`Refusal::Overloaded`] if too many passwords of the same client were wrong or wait;
/// errors of the store.
pub(super) async fn check_password(
    app: &Arc<BoothApp>,
    asker: &Asker,
    name: &str,
    password: String,
) -> Result<bool, Refusal> {
    let turn = app.logins.hashes.enter(asker.clone()).await?;
    let delay = app.logins.count_wrong(asker, name)?;
    let of_name = name.to_owned();
    let hash = app.run(move |app| app.booth.password_hash(&of_name)).await?;
    let is_right = verify_password(app, turn, password, hash).await?;
    app.logins.settle((asker, name), delay, is_right).await;
    Ok(is_right)
}
