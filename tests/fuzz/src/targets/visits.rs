//! The time of a headset's last use: rejected at an offset within the bytes, or unchanged by a round trip.

use std::time::Duration;

use paros_core::internals::checksum;
use paros_shell::last_use::{BootId, LastUse};

use crate::engine::FuzzTarget;

pub(super) const LAST_USE: FuzzTarget = FuzzTarget {
    name: "last_use",
    seeds: || {
        let boot = BootId::parse_uuid("6af84ad0-079a-4d3a-a5d5-bbed09b02c54").expect("a boot");
        let used = |millis| LastUse { boot, since_boot: Duration::from_millis(millis) };
        [0, 1 << 20, u64::MAX].map(|millis| used(millis).encode().to_vec()).into()
    },
    words: &[b"PLUS", b"\x01\0"],
    longest: LastUse::BYTES + 2,
    runs: 8000,
    run: |bytes| {
        let mut mended = bytes.to_vec();
        if let Some((body, end)) = mended.split_last_chunk_mut::<8>() {
            *end = checksum(body).to_le_bytes();
        }
        format!("{}; {}", decode(bytes), decode(&mended))
    },
};

fn decode(bytes: &[u8]) -> &'static str {
    match LastUse::decode(bytes) {
        Ok(used) => {
            assert_eq!(used.encode()[..], *bytes);
            "a time"
        }
        Err(bad) => {
            assert!(bad.offset <= bytes.len());
            bad.expected
        }
    }
}
