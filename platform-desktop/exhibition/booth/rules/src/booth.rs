//! The booth: its store, its parcel files, its keys and its plan.

use std::sync::Arc;

use hmac::{Hmac, KeyInit as _, Mac as _};
use paros_protocol::{ContentHash, SiteId};
use sha2::Sha256;

use crate::parcel_files::ParcelFiles;
use crate::store::{Store, StoreError, Transaction};

/// The booth's rules. Each request is a call, and calls may run concurrently.
#[derive(Clone)]
pub struct Booth {
    pub(crate) store: Arc<dyn Store>,
    pub(crate) files: Arc<dyn ParcelFiles>,
    pub(crate) keys: SiteKeys,
    pub(crate) plan: BoothPlan,
    /// The number of this process, where several work on the same records.
    pub(crate) worker: u64,
}

/// A transaction, as the rules use it.
pub(crate) type Tx<'a> = dyn Transaction + 'a;

/// The identity of a site.
#[derive(Clone)]
pub struct SiteKeys {
    /// The id of the site.
    pub site: SiteId,
    /// The SHA-256 of the certificate of the site's certificate authority.
    pub ca_hash: ContentHash,
    pub(crate) link_secret: [u8; 32],
}

/// Retention periods, in days.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct BoothPlan {
    /// Retention of sculptures, counted from the day of their arrival.
    pub retention_days: u16,
    /// Retention of traces, which record a person's motion.
    pub trace_days: u16,
    /// Time from the withdrawal of a sculpture to its deletion.
    pub withdrawn_days: u16,
    /// Lifetime of tombstones: how long a headset may keep a sculpture that was deleted here, until it asks.
    pub horizon_days: u16,
}

impl Default for BoothPlan {
    fn default() -> Self {
        BoothPlan { retention_days: 90, trace_days: 14, withdrawn_days: 7, horizon_days: 180 }
    }
}

impl Booth {
    /// Makes a booth of these parts.
    #[must_use]
    pub fn new(
        store: Arc<dyn Store>,
        files: Arc<dyn ParcelFiles>,
        keys: SiteKeys,
        plan: BoothPlan,
    ) -> Self {
        Booth { store, files, keys, plan, worker: 0 }
    }

    /// Returns the keys of the site.
    #[must_use]
    pub const fn keys(&self) -> &SiteKeys {
        &self.keys
    }

    /// Returns the retention periods.
    #[must_use]
    pub const fn plan(&self) -> BoothPlan {
        self.plan
    }

    pub(crate) fn update<T>(
        &self,
        work: impl FnMut(&mut Tx<'_>) -> Result<T, crate::Refusal>,
    ) -> Result<T, crate::Refusal> {
        crate::store::update(self.store.as_ref(), work)
    }

    pub(crate) fn view<T>(
        &self,
        work: impl FnOnce(&mut Tx<'_>) -> Result<T, StoreError>,
    ) -> Result<T, crate::Refusal> {
        Ok(crate::store::view(self.store.as_ref(), work)?)
    }
}

impl SiteKeys {
    /// Makes the keys of random bits: the site's id, and the secret behind visitors' links.
    #[must_use]
    pub const fn new(site: SiteId, ca_hash: ContentHash, link_secret: [u8; 32]) -> Self {
        SiteKeys { site, ca_hash, link_secret }
    }

    /// Returns the first bytes of the HMAC of these parts, which only the site can compute. `context`
    /// separates the uses.
    pub(crate) fn make_secret<const BYTES: usize>(
        &self,
        context: &[u8],
        parts: &[&[u8]],
    ) -> [u8; BYTES] {
        // HMAC itself pads a shorter key with zeros to a block.
        let mut key = [0; 64];
        key[..32].copy_from_slice(&self.link_secret);
        let mut mac = Hmac::<Sha256>::new(&key.into());
        mac.update(context);
        parts.iter().for_each(|part| mac.update(part));
        let mut secret = [0; BYTES];
        secret.copy_from_slice(&mac.finalize().into_bytes()[..BYTES]);
        secret
    }
}
