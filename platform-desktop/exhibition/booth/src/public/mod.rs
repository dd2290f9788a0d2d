//! The visitors' pages: a separate listener that serves only pages behind links that can't be guessed.

mod address;
mod pages;
mod texts;

use std::net::SocketAddr;
use std::path::PathBuf;

use clap::Args;

pub(crate) use address::{PublicAddress, draw_qr};
pub(crate) use pages::router;

/// Options of the visitors' pages. Without an address there are no QR codes, and mails contain only files.
#[derive(Clone, Debug, Default, Args)]
pub struct PublicOptions {
    /// Address on which the booth listens for visitors.
    #[arg(long, value_name = "ADDRESS:PORT", requires = "public_url")]
    pub public_listen: Option<SocketAddr>,
    /// Base URL of the visitors' links, as phones reach it.
    #[arg(long, value_name = "https://HOST", requires = "public_listen")]
    pub public_url: Option<String>,
    /// PEM file with a certificate and its chain. Without it, the pages use plain HTTP, for a reverse proxy.
    #[arg(long, value_name = "FILE", requires_all = ["public_key", "public_listen"])]
    pub public_cert: Option<PathBuf>,
    /// PEM file with the private key of the certificate.
    #[arg(long, value_name = "FILE", requires = "public_cert")]
    pub public_key: Option<PathBuf>,
}
