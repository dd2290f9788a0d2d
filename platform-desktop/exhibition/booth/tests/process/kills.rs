//! Kills the booth at random times while headsets upload.

use std::collections::BTreeMap;
use std::sync::Mutex;
use std::time::Duration;

use paros_protocol::ParcelOutcome;

use crate::rig::{BoothFolder, Client, Headset, Parcel};

/// The number of kills, unless `PAROS_BOOTH_KILLS` sets it.
const KILLS: u32 = 12;

const HEADSETS: u8 = 4;

/// Returns a pseudorandom number for a seed (splitmix64).
fn scramble(seed: u64) -> u64 {
    let mut bits = seed.wrapping_add(0x9e37_79b9_7f4a_7c15);
    bits = (bits ^ bits >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    bits = (bits ^ bits >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
    bits ^ bits >> 31
}

/// The parcels that the booth has acknowledged, by number.
type Signed = Mutex<BTreeMap<u32, Parcel>>;

#[test]
fn killed_at_any_moment_it_loses_nothing_and_keeps_nothing_twice() {
    let kills = std::env::var("PAROS_BOOTH_KILLS").ok().and_then(|kills| kills.parse().ok());
    let kills: u32 = kills.unwrap_or(KILLS);
    let folder = BoothFolder::new("kills");
    let mut booth = folder.start();
    let fleet = folder.fleet_token();
    let headsets: Vec<Headset> =
        (1..=HEADSETS).map(|byte| Headset::enrol(&booth.client, fleet, byte)).collect();
    let signed = Signed::default();
    for round in 0..kills {
        std::thread::scope(|scope| {
            for (k, headset) in headsets.iter().enumerate() {
                // Parcels of the previous round, complete or not, and new ones.
                let numbers = (3 * round).saturating_sub(2)..3 * round + 6;
                let of_headset = numbers.map(move |n| n * u32::from(HEADSETS) + k as u32 + 1);
                let (client, signed) = (&booth.client, &signed);
                scope.spawn(move || upload_all(client, headset, of_headset, signed));
            }
            std::thread::sleep(Duration::from_millis(scramble(u64::from(round)) % 1500));
            let id = booth.id();
            let killed = std::process::Command::new("kill").args(["-9", &id.to_string()]).status();
            assert!(killed.expect("kill").success());
        });
        booth.wait();
        booth = folder.start();
    }
    let signed = signed.into_inner().unwrap();
    assert!(signed.len() as u32 >= kills, "it was hardly ever alive");
    for parcel in signed.values() {
        let again = headsets[0].upload(&booth.client, parcel).unwrap();
        assert_eq!(again.expect("it is known"), ParcelOutcome::Kept);
        assert!(parcel.is_kept_in(&folder.path().join("sculptures")), "{}", parcel.facts.id);
    }
    let kept = booth.client.metric("paros_booth_sculptures");
    assert!(kept >= signed.len() as u64);
    println!("{kills} kills, {} heard of, {kept} kept", signed.len());
}

/// Sends parcels one after the other, until the booth is killed.
fn upload_all(
    client: &Client,
    headset: &Headset,
    numbers: impl Iterator<Item = u32>,
    signed: &Signed,
) {
    for number in numbers {
        let make = if number.is_multiple_of(5) { Parcel::large } else { Parcel::volume };
        let parcel = make(number);
        let Ok(done) = headset.upload(client, &parcel) else { return };
        assert_eq!(done.expect("nothing is refused"), ParcelOutcome::Kept);
        signed.lock().unwrap().insert(number, parcel);
    }
}
