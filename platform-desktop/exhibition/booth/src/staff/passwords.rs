//! Passwords: their hashes, and the generation of random ones.

use std::io;
use std::sync::Arc;

use argon2::password_hash::phc::PasswordHash;
use argon2::{Argon2, PasswordHasher as _, PasswordVerifier as _};
use paros_booth_rules::{Expected, Refusal};

use super::hash_queue::HashTurn;
use super::login_gate::Asker;
use crate::random::random_bytes;
use crate::server::app::BoothApp;

/// The fewest characters of a password.
pub(super) const MIN_PASSWORD_CHARS: usize = 10;

/// The alphabet of generated passwords: 32 characters that are not easily confused.
const LETTERS: &[u8; 32] = b"abcdefghijkmnpqrstuvwxyz23456789";

/// Hashes a new password of an account.
///
/// # Errors
/// [`Expected::Password`] if it is too short; [`Refusal::Overloaded`].
pub(super) async fn hash_password(
    app: &Arc<BoothApp>,
    asker: Asker,
    password: String,
) -> Result<String, Refusal> {
    if password.chars().count() < MIN_PASSWORD_CHARS {
        return Err(Refusal::Unfit(Expected::Password(MIN_PASSWORD_CHARS)));
    }
    let turn = app.logins.hashes.enter(asker).await?;
    app.run(move |_| {
        // If the request is cancelled, the work still runs to its end and keeps its turn.
        let _turn = turn;
        Ok(make_hash(&password)?)
    })
    .await
}

/// Hashes a password with a random salt.
///
/// # Errors
/// The system has no random bits, or no memory for the hash.
pub(crate) fn make_hash(password: &str) -> io::Result<String> {
    let salt = random_bytes::<16>()?;
    let hash = Argon2::default().hash_password_with_salt(password.as_bytes(), &salt);
    hash.map(|hash| hash.to_string()).map_err(io::Error::other)
}

/// Generates a password of 80 random bits, in four groups.
///
/// # Errors
/// The system has no random bits.
pub(crate) fn draw_password() -> io::Result<String> {
    let letter = |byte: &u8| char::from(LETTERS[usize::from(byte % 32)]);
    let groups: Vec<String> =
        random_bytes::<16>()?.chunks(4).map(|group| group.iter().map(letter).collect()).collect();
    Ok(groups.join("-"))
}

/// Returns `true` if a hash is that of a password. Takes as long without a hash, so that the time doesn't
/// reveal which accounts exist.
pub(super) async fn verify_password(
    app: &Arc<BoothApp>,
    turn: HashTurn,
    password: String,
    hash: Option<String>,
) -> Result<bool, Refusal> {
    app.run(move |_| {
        let _turn = turn;
        let argon2 = Argon2::default();
        let Some(hash) = hash else {
            let _ = argon2.hash_password_with_salt(password.as_bytes(), &[0; 16]);
            return Ok(false);
        };
        let Ok(hash) = PasswordHash::new(&hash) else { return Ok(false) };
        Ok(argon2.verify_password(password.as_bytes(), &hash).is_ok())
    })
    .await
}
