//! The desktop's link from an outbox to its booth: HTTPS by `ureq` and rustls, which trusts the site's certificate
//! authority alone, follows no redirect and asks no proxy.
//!
//! A thread for each of the two kinds of request, so that a part on its way holds up no heartbeat. Whether the network
//! is said to reach the Internet is nobody's business: a booth's needn't.
#![forbid(unsafe_code)]

mod ask;
mod enrol;

use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread;
use std::time::Duration;

use paros_core::limits::{HEARTBEAT_TIMEOUT_MS, UPLOAD_TIMEOUT_MS};
use paros_core::outbox::messages::DeviceToken;
use paros_shell::outbox::{BoothLink, BoothRequest, LinkAnswer};
use rustls::crypto::ring;
use ureq::Agent;
use ureq::tls::{Certificate, RootCerts, TlsConfig, TlsProvider};

use ask::Booth;
pub use enrol::{EnrolHttps, fetch_shown_authority};

/// Where a booth is, and by what it is known.
#[derive(Clone, Debug)]
pub struct BoothAddress {
    /// `https://HOST:PORT`, without a slash at its end.
    pub url: String,
    /// The certificate of the site's authority, DER.
    pub ca: Vec<u8>,
    /// By which the booth knows the headset.
    pub token: DeviceToken,
}

/// How long an answer is waited for.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct LinkTimes {
    /// That to a part of a parcel.
    pub put: Duration,
    /// That to a heartbeat.
    pub heartbeat: Duration,
}

/// A link to a booth. Its threads end once it is dropped and what they wait for is over.
#[derive(Debug)]
pub struct HttpsLink {
    puts: Sender<BoothRequest>,
    heartbeats: Sender<BoothRequest>,
    answers: Receiver<LinkAnswer>,
}

impl Default for LinkTimes {
    /// A little less than the outbox waits, so that no request waits for one that was given up.
    fn default() -> Self {
        let less = |ms: u64| Duration::from_millis(ms - ms / 10);
        LinkTimes { put: less(UPLOAD_TIMEOUT_MS), heartbeat: less(HEARTBEAT_TIMEOUT_MS) }
    }
}

impl HttpsLink {
    /// A link that isn't connected yet.
    #[must_use]
    pub fn open(address: &BoothAddress, times: LinkTimes) -> Self {
        let (tell, answers) = channel();
        let spawn = |timeout: Duration, tell: Sender<LinkAnswer>| {
            let (ask, requests) = channel::<BoothRequest>();
            let booth = Booth::new(make_agent(&address.ca, timeout), address);
            thread::spawn(move || {
                for request in requests {
                    // Nobody listens any more where the link was dropped.
                    if tell.send(booth.ask(&request)).is_err() {
                        break;
                    }
                }
            });
            ask
        };
        let puts = spawn(times.put, tell.clone());
        HttpsLink { puts, heartbeats: spawn(times.heartbeat, tell), answers }
    }
}

impl BoothLink for HttpsLink {
    fn send(&mut self, request: BoothRequest) {
        let queue = match &request {
            BoothRequest::Put { .. } => &self.puts,
            BoothRequest::Heartbeat { .. } => &self.heartbeats,
        };
        // The threads end after this.
        let _ = queue.send(request);
    }

    fn poll(&mut self) -> Option<LinkAnswer> {
        self.answers.try_recv().ok()
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
