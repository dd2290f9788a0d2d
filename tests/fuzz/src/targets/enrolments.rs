//! Enrolment files, a device's own and a fleet's: rejected with the file's name and the expected value, or
//! unchanged by a round trip.

use paros_upload::enrolment::{EnrolError, Enrolment, FleetFile};

use crate::engine::FuzzTarget;

pub(super) const ENROLMENT: FuzzTarget = FuzzTarget {
    name: "enrolment",
    seeds: || {
        let site =
            "address = \"https://10.0.0.7:8443\"\nsite = \"07070707070707070707070707070707\"\n";
        let secret = "0909090909090909090909090909090909090909090909090909090909090909";
        let own = format!("{site}headset = 3\ntoken = \"{secret}\"\nca = \"308200\"\n");
        let ca = "-----BEGIN CERTIFICATE-----\nMAA=\n-----END CERTIFICATE-----\n";
        let fleet = format!("{site}enrolment_token = \"{secret}\"\nca = \"\"\"\n{ca}\"\"\"\n");
        vec![own.into_bytes(), fleet.into_bytes()]
    },
    words: &[b"https://", b"\"\"\"", b"-----BEGIN CERTIFICATE-----", b"headset = ", b"ca = "],
    longest: 1024,
    runs: 4000,
    run: |bytes| {
        let source = "enrolment.toml";
        let own = Enrolment::parse(source, bytes).map(|enrolment| {
            assert!(enrolment.owner.headset > 0 && !enrolment.ca.is_empty());
            let again = Enrolment::parse(source, enrolment.to_toml().as_bytes()).expect("its own");
            assert_eq!(again, enrolment);
        });
        let fleet = FleetFile::parse(source, bytes).map(drop);
        format!("{}; {}", describe(own), describe(fleet))
    },
};

fn describe(read: Result<(), EnrolError>) -> String {
    match read {
        Ok(()) => "an enrolment".into(),
        Err(error) => {
            let told = error.to_string();
            assert!(error.is_input() && told.starts_with("enrolment.toml: "), "{told}");
            // The field's name, without the TOML parser's message.
            told.split(':').nth(1).unwrap_or_default().into()
        }
    }
}
