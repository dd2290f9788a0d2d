//! The desktop's link from an outbox to its booth: HTTPS with `ureq` and rustls. It trusts only the site's
//! certificate authority, follows no redirects and uses no proxy.
//!
//! It doesn't check for Internet access, as a booth's network may have none.
#![forbid(unsafe_code)]

mod ask;

use std::sync::Arc;

use paros_protocol::LinkTimes;
use paros_upload::{BoothAddress, ThreadedLink};
use rustls::crypto::ring;
use ureq::Agent;
use ureq::tls::{Certificate, RootCerts, TlsConfig, TlsProvider};

pub use ask::HttpsCaller;

/// Opens a link to a booth. It connects with the first request.
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
