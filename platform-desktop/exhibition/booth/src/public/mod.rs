//! The visitors' pages: a separate listener that serves only pages behind links that can't be guessed.

mod address;
mod pages;
mod texts;

use std::net::SocketAddr;
use std::path::PathBuf;

use clap::Args;

pub(crate) use address::{PublicAddress, draw_qr};
pub(crate) use pages::router;

/// Where visitors find their sculptures. Without an address there are no QR codes, and mails carry files alone.
#[derive(Clone, Debug, Default, Args)]
pub struct PublicOptions {
    /// The address to listen at for visitors.
    #[arg(long, value_name = "ADDRESS:PORT", requires = "public_url")]
    pub public_listen: Option<SocketAddr>,
    /// What stands before each visitor's link, as phones reach it.
    #[arg(long, value_name = "https://HOST", requires = "public_listen")]
    pub public_url: Option<String>,
    /// A certificate with its chain, in PEM. Without it the booth speaks plain HTTP there, for a proxy before it.
    #[arg(long, value_name = "FILE", requires_all = ["public_key", "public_listen"])]
    pub public_cert: Option<PathBuf>,
    /// Its private key, in PEM.
    #[arg(long, value_name = "FILE", requires = "public_cert")]
    pub public_key: Option<PathBuf>,
}
