//! The desktop's link from an outbox to its booth: HTTPS by `ureq` and rustls, which trusts the site's certificate
//! authority alone, follows no redirect and asks no proxy.
//!
//! Whether the network is said to reach the Internet is nobody's business: a booth's needn't.
#![forbid(unsafe_code)]

mod ask;

use std::sync::Arc;

use paros_protocol::LinkTimes;
use paros_upload::{BoothAddress, ThreadedLink};
use rustls::crypto::ring;
use ureq::Agent;
use ureq::tls::{Certificate, RootCerts, TlsConfig, TlsProvider};

pub use ask::HttpsCaller;

/// A link to a booth that isn't connected yet.
#[must_use]
pub fn open_link(address: &BoothAddress, times: LinkTimes) -> ThreadedLink {
    let [of_puts, of_heartbeats] = [(); 2].map(|()| HttpsCaller::new(&address.url, &address.ca));
    ThreadedLink::start(address.token, times, of_puts, of_heartbeats)
}

fn make_agent(ca: &[u8]) -> Agent {
    let roots = RootCerts::new_with_certs(&[Certificate::from_der(ca).to_owned()]);
    let tls = TlsConfig::builder()
        .provider(TlsProvider::Rustls)
        .root_certs(roots)
        .unversioned_rustls_crypto_provider(Arc::new(ring::default_provider()))
        .build();
    let config = Agent::config_builder()
        .tls_config(tls)
        .https_only(true)
        .http_status_as_error(false)
        .max_redirects(0)
        .max_redirects_will_error(false)
        .proxy(None)
        .build();
    config.into()
}
