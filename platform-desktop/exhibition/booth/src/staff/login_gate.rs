//! How fast passwords can be guessed.
//!
//! A right password is let through at once, however many wrong ones come meanwhile, from the same network too: only the
//! answer to a wrong one is slow. Guesses for a name are bounded all the same. Each password counts as wrong until it is
//! found right, and of those that count as wrong so many are looked at:
//!
//! - from one network: 20, then one in 5 seconds, or 17,300 a day;
//! - from all networks together: 100, then one a second, or 86,500 a day;
//! - from browsers in which a certain account was logged in before: as many as from one network.
//!
//! A right password can't be told from a guess before it is looked at. Therefore a browser where nobody was logged in before
//! is refused for as long as somebody in its network, or in many networks at once, keeps trying several wrong passwords for
//! the same name at a time.

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

/// The longest wait for the answer to a wrong password. An asker with one password at a time never runs out of those that
/// are looked at.
const LONGEST_DELAY: f32 = 5.0;

/// The asker of a login. Each one has wrong passwords and a place in the queue of its own.
#[derive(Clone, PartialEq, Eq, Hash)]
pub(crate) enum Asker {
    /// A network.
    Network(IpAddr),
    /// The browsers in which some account was logged in before.
    Browser([u8; 16]),
    /// An account that is logged in.
    Account(String),
}

impl Asker {
    /// Returns the asker of a request to log in.
    pub(super) fn of_request(app: &BoothApp, headers: &HeaderMap, peer: Peer) -> Self {
        let token = read_token(headers, BROWSER_COOKIE);
        let browser = token.and_then(|token| app.booth.check_browser_token(&token));
        browser.map_or_else(|| Asker::Network(peer.network()), Asker::Browser)
    }
}

/// Memory of logins.
pub(crate) struct LoginGate {
    /// The code that the first account has to bring; `None` once there is an account.
    first_code: Mutex<Option<String>>,
    wrong: RateLimiter<(Asker, String)>,
    wrong_of_networks: RateLimiter<String>,
    pub(super) hashes: HashQueue<Asker>,
}

impl LoginGate {
    /// With the code that the first account has to bring.
    pub(crate) fn new(first_code: Option<String>) -> Self {
        LoginGate {
            first_code: Mutex::new(first_code),
            wrong: RateLimiter::new(20, 1.0 / 5.0),
            wrong_of_networks: RateLimiter::new(100, 1.0),
            hashes: HashQueue::new(),
        }
    }

    /// Checks the code for the first account. The answer to a wrong one is slow.
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

    /// Counts a password as wrong before it is looked at, so that those that come at the same time count too. Returns the
    /// delay of its answer, if it is wrong.
    fn count_wrong(&self, asker: &Asker, name: &str) -> Result<Duration, Refusal> {
        let (now, key) = (Instant::now(), key_of(asker, name));
        let is_network = matches!(asker, Asker::Network(_));
        let has_left = self.wrong.take(key.clone(), now)
            && (!is_network || self.wrong_of_networks.take(key.1.clone(), now));
        if !has_left {
            return Err(Refusal::Busy { what: "wrong logins", retry_after: 10 });
        }
        // The first one isn't delayed.
        let delay = (self.wrong.used(&key, now) - 1.0).clamp(0.0, LONGEST_DELAY);
        Ok(Duration::from_secs_f32(delay))
    }

    /// Takes the count of a right password back, or waits as long as the answer to a wrong one takes.
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
    // No account has a longer name.
    (asker.clone(), name.chars().take(64).collect())
}

/// Returns `true` if a password is the account's. The answer to a wrong one is slow.
///
/// # Errors
/// [`Refusal::Busy`] or [`Refusal::Overloaded`] where too many of the same asker were wrong or wait; those of the store.
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
