//! The tests of the desktop's link.

mod link_suite;

use paros_upload_https::open_link;

#[test]
fn requests_and_answers_are_as_the_booth_has_them() {
    link_suite::check_requests_and_answers(open_link);
}

#[test]
fn who_has_another_authority_or_address_is_not_the_booth() {
    link_suite::check_trust(open_link);
}

#[test]
fn nobody_and_silence_are_faults_and_a_part_holds_up_no_heartbeat() {
    link_suite::check_silence(open_link);
    link_suite::check_cut_handshakes(open_link);
    link_suite::check_no_plain_http(open_link);
}

#[test]
fn redirects_are_not_followed_and_long_bodies_not_read() {
    link_suite::check_redirects_and_long_bodies(open_link);
}
