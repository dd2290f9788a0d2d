//! A booth and a shell as processes: every sculpture reaches the booth, whichever process is killed in
//! between.

mod kills;
mod rig;

use std::collections::BTreeSet;

use paros_booth_process::find_booth;
use paros_protocol::{DeviceName, Parcel};
use paros_upload::enrolment::{FleetFile, NewDevice, enrol_by_fleet};
use paros_upload_https::HttpsCaller;

use rig::{Place, wait_for_log};

#[test]
fn visits_sculptures_come_to_a_booth() {
    let Some(booth) = find_booth() else { return };
    let place = Place::new("visits", booth);
    let running = place.start_booth();
    place.enrol_by_fleet_file(&running);
    let told = place.run_shell_to_the_end(2, 7);
    let kept: BTreeSet<_> = told.kept.iter().collect();
    assert_eq!((kept.len(), told.signed.is_empty()), (2, false), "{told:?}");
    let parcels = place.parcels_at_booth();
    assert_eq!(
        parcels.iter().map(|(facts, _)| facts.id.to_string()).collect::<BTreeSet<_>>(),
        kept.into_iter().cloned().collect()
    );
    let kept: BTreeSet<_> = parcels.iter().map(|(_, volume)| volume.clone()).collect();
    let pack = |volume: Vec<u8>| {
        let parcel = Parcel::pack(&parcels[0].0, &volume, None).expect("a volume");
        parcel.volume().to_vec()
    };
    let own = place.volumes().into_iter().map(pack).collect();
    assert_eq!(kept, own, "the visitors' own volumes");
    wait_for_log(&running, "state=Made", 2);
    // The second badge is leased, because the booth has been reached by then.
    let badges: Vec<_> = parcels.iter().map(|(facts, _)| facts.badge.expect("shown")).collect();
    assert_ne!(badges[0], badges[1]);
}

#[test]
fn another_authority_is_told_and_nothing_is_sent_there() {
    let Some(booth) = find_booth() else { return };
    let (place, other) = (Place::new("pinned", booth.clone()), Place::new("other", booth));
    let (running, stranger) = (place.start_booth(), other.start_booth());
    let own = running.make_fleet_file();
    let mut fleet = FleetFile::parse("fleet", own.as_bytes()).expect("a fleet's file");
    let device = NewDevice::draw(None, DeviceName::new("desk").expect("a name")).expect("bits");
    for (address, told) in
        [(stranger.address(), "isn't the booth"), ("https://127.0.0.1:1", "isn't reached")]
    {
        fleet.address = address.into();
        let mut link = HttpsCaller::new(&fleet.address, &fleet.ca);
        let error = enrol_by_fleet(&mut link, &fleet, &device).expect_err("nothing is sent");
        assert!(error.to_string().contains(told), "{error}");
    }
}
