//! The booth is killed at random, and headsets go on as if nothing were.

use std::collections::BTreeMap;
use std::sync::Mutex;
use std::time::Duration;

use paros_core::outbox::messages::*;

use crate::rig::{BoothFolder, Headset, Parcel};

/// How often it is killed; `PAROS_BOOTH_KILLS` says otherwise.
const KILLS: u32 = 12;

const HEADSETS: u8 = 4;

/// A number that looks random, of a seed (splitmix64).
fn scramble(seed: u64) -> u64 {
    let mut bits = seed.wrapping_add(0x9e37_79b9_7f4a_7c15);
    bits = (bits ^ bits >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    bits = (bits ^ bits >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
    bits ^ bits >> 31
}

#[test]
fn killed_at_any_moment_it_loses_nothing_and_keeps_nothing_twice() {
    let kills = std::env::var("PAROS_BOOTH_KILLS").ok().and_then(|kills| kills.parse().ok());
    let kills: u32 = kills.unwrap_or(KILLS);
    let folder = BoothFolder::new("kills");
    let mut booth = folder.start();
    let fleet = folder.fleet_token();
    let headsets: Vec<Headset> =
        (1..=HEADSETS).map(|byte| Headset::enrol(&booth.client, fleet, byte)).collect();
    // What was signed for, by parcel.
    let signed: Mutex<BTreeMap<u32, (Parcel, SignedReceipt)>> = Mutex::default();
    let mut next = 0;
    for round in 0..kills {
        let client = &booth.client;
        // Each has parcels that were begun before, and new ones.
        let of_headset = |k: usize| {
            let headset = &headsets[k];
            move |number: u32| {
                let kind =
                    if number.is_multiple_of(5) { ParcelKind::Mesh } else { ParcelKind::Volume };
                Parcel::new(headset.number, number, kind)
            }
        };
        let (first, signed) = (next, &signed);
        std::thread::scope(|scope| {
            for (k, headset) in headsets.iter().enumerate() {
                let make = of_headset(k);
                scope.spawn(move || {
                    let from = first.max(2) - 2;
                    for number in (from..first + 6).map(|n| n * u32::from(HEADSETS) + k as u32 + 1)
                    {
                        let parcel = make(number);
                        let Ok(done) = headset.upload(client, &parcel) else { return };
                        let receipt = done.expect("nothing is refused");
                        let mut signed = signed.lock().unwrap();
                        if let Some((_, before)) = signed.insert(number, (parcel, receipt)) {
                            assert_eq!(before, receipt, "signed otherwise before");
                        }
                    }
                });
            }
            let millis = scramble(u64::from(round)) % 1500;
            std::thread::sleep(Duration::from_millis(millis));
            let id = booth.id();
            let killed = std::process::Command::new("kill").args(["-9", &id.to_string()]).status();
            assert!(killed.expect("kill").success());
        });
        next += 3;
        booth.wait();
        booth = folder.start();
    }
    let signed = signed.into_inner().unwrap();
    assert!(!signed.is_empty(), "it was never alive");
    for (parcel, receipt) in signed.values() {
        let headset = &headsets[parcel.facts.headset as usize - 1];
        let again = headset.upload(&booth.client, parcel).unwrap().expect("a receipt");
        assert_eq!(again, *receipt);
        // The receipt came of what is kept, not of what came now.
        let name = format!("{}-{}.sculpture", parcel.facts.id, parcel.hash);
        let kept = std::fs::read(folder.path().join("sculptures").join(name)).expect("it is kept");
        assert_eq!(kept, parcel.bytes);
    }
    let kept = booth.client.metric("paros_booth_sculptures");
    assert!(kept >= signed.len() as u64);
    // A file beyond the records is one of a parcel that was cut off, and comes again.
    let files = folder.files("sculptures").iter().filter(|name| !name.starts_with('.')).count();
    assert!(files as u64 >= kept);
    println!("{kills} kills, {} receipts, {kept} kept, {files} files", signed.len());
}
