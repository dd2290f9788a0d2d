//! The desktop's link from an outbox to its booth: HTTPS by `ureq` and rustls, which trusts the site's certificate
//! authority alone, follows no redirect and asks no proxy.
//!
//! Whether the network is said to reach the Internet is nobody's business: a booth's needn't.
#![forbid(unsafe_code)]

mod ask;
mod enrol;

use std::sync::Arc;
use std::time::Duration;

pub use paros_shell::outbox::{BoothAddress, LinkTimes};
use paros_shell::outbox::{BoothLink, BoothRequest, LinkAnswer, LinkError, ThreadedLink};
use rustls::crypto::ring;
use ureq::Agent;
use ureq::tls::{Certificate, RootCerts, TlsConfig, TlsProvider};

pub use ask::HttpsCaller;
pub use enrol::{EnrolHttps, fetch_shown_authority};

/// A link to a booth. Its threads end once it is dropped and what they wait for is over.
#[derive(Debug)]
pub struct HttpsLink(ThreadedLink);

impl HttpsLink {
    /// A link that isn't connected yet.
    #[must_use]
    pub fn open(address: &BoothAddress, times: LinkTimes) -> Self {
        let [of_puts, of_heartbeats] = [times.put, times.heartbeat]
            .map(|timeout| HttpsCaller::new(&address.url, &address.ca, timeout));
        HttpsLink(ThreadedLink::start(address.token, of_puts, of_heartbeats))
    }

    /// Why the last request had no answer; `None` where it had one.
    #[must_use]
    pub const fn last_error(&self) -> Option<&LinkError> {
        self.0.last_error()
    }
}

impl BoothLink for HttpsLink {
    fn send(&mut self, request: BoothRequest) {
        self.0.send(request);
    }

    fn poll(&mut self) -> Option<LinkAnswer> {
        self.0.poll()
    }
}

fn make_agent(ca: &[u8], timeout: Duration) -> Agent {
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
        .timeout_global(Some(timeout))
        .build();
    config.into()
}
