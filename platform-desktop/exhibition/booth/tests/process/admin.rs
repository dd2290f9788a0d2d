//! Accounts, tokens of fleets and the audit, as admins see them, and attendants don't.

use paros_protocol::*;

use crate::rig::{BoothFolder, Headset};
use crate::staff::{Browser, cookie_of, post_form};

const ACCOUNT: &str = "&name=bob&password=battery+horse+correct&role=attendant";

#[test]
fn admins_make_accounts_and_attendants_are_kept_out_of_what_is_not_theirs() {
    let folder = BoothFolder::new("admin-accounts");
    let booth = folder.start();
    let client = &booth.client;
    let ana = Browser::first(client, &booth.first_code().expect("a code"));
    let add = |fields: &str| ana.fill("/staff/admin", "/staff/admin/accounts", fields).status;
    assert_eq!(add("&name=b+b&password=battery+horse+correct&role=attendant"), 400);
    assert_eq!(add("&name=bob&password=short&role=attendant"), 400);
    assert_eq!(add("&name=bob&password=battery+horse+correct&role=king"), 400);
    assert_eq!(add(ACCOUNT), 303);
    assert_eq!(add(ACCOUNT), 409, "the name is taken");
    let log_in = |password: &str| {
        post_form(client, "/staff/login", "", &format!("name=bob&password={password}"))
    };
    let bob = Browser { client, cookie: cookie_of(&log_in("battery+horse+correct")) };
    assert!(!bob.get("/staff").text().contains("/staff/admin"));
    for path in ["/staff/admin", "/staff/audit", "/staff/badges/5", "/staff/badges/5/export.zip"] {
        assert_eq!(bob.get(path).status, 403, "{path}");
        assert_eq!(client.get(path).status, 303, "{path} without a login");
        assert_ne!(ana.get(path).status, 403, "{path}");
    }
    // With a form of his own login, and with one of hers.
    for (path, fields) in [
        ("/staff/admin/accounts", "&name=eve&password=battery+horse+correct&role=admin"),
        ("/staff/admin/accounts/ana/disable", ""),
        ("/staff/admin/tokens", "&note=x&uses=1&days=1&address=https://booth:8443"),
        ("/staff/badges/5/delete", ""),
    ] {
        let page = bob.get("/staff/account");
        let token = page.text().split("name=\"form\" value=\"").nth(1).expect("a form");
        let form = format!("form={}{fields}", &token[..32]);
        assert_eq!(post_form(client, path, &bob.cookie, &form).status, 403, "{path}");
        assert_eq!(post_form(client, path, &ana.cookie, &form).status, 403, "{path}: his form");
    }

    let set = |old: &str, new: &str| {
        let fields = format!("&old={old}&new={new}");
        bob.fill("/staff/account", "/staff/account/password", &fields)
    };
    assert_eq!(set("wrong+horse+battery", "staple+horse+correct").status, 403);
    assert_eq!(set("battery+horse+correct", "short").status, 400);
    let changed = set("battery+horse+correct", "staple+horse+correct");
    assert_eq!(changed.status, 303, "{changed:?}");
    assert!(bob.get("/staff").head.contains("location: /staff/login"), "the old login is over");
    let bob = Browser { client, cookie: cookie_of(&changed) };
    assert_eq!(bob.get("/staff").status, 200);
    assert_eq!(log_in("battery+horse+correct").status, 403);

    let shut_out = ana.click("/staff/admin", "/staff/admin/accounts/bob/disable");
    assert_eq!(shut_out.status, 303);
    assert!(bob.get("/staff").head.contains("location: /staff/login"));
    assert_eq!(ana.click("/staff/admin", "/staff/admin/accounts/bob/enable").status, 303);
    assert!(!ana.get("/staff/admin").text().contains("accounts/ana/disable"), "not herself");

    let audit = ana.get("/staff/audit");
    for action in ["first account", "add account bob", "change password", "disable account bob"] {
        assert!(audit.text().contains(action), "{action}");
    }
    assert!(ana.get("/staff/admin").text().contains("--keep-days"));
}

#[test]
fn a_fleets_file_is_downloaded_lets_headsets_in_and_is_taken_back() {
    let folder = BoothFolder::new("admin-tokens");
    let booth = folder.start();
    let client = &booth.client;
    let ana = Browser::first(client, &booth.first_code().expect("a code"));
    let make = |fields: &str| ana.fill("/staff/admin", "/staff/admin/tokens", fields);
    for bad in [
        "&note=x&uses=0&days=1&address=https://booth:8443",
        "&note=x&uses=1&days=400&address=https://booth:8443",
        "&note=x&uses=1&days=1&address=http://booth",
        "&note=x&uses=1&days=1&address=https://booth%22%0Aca=%22x",
    ] {
        assert_eq!(make(bad).status, 400, "{bad}");
    }
    let tells = |page: &str| ana.get(page).text().contains("expires on");
    make("&note=a+year&uses=2&days=365&address=https://booth:8443");
    assert!(!tells("/staff") && !tells("/staff/admin"), "it ends in a year");
    let file = make("&note=%3Cb%3Ewall+1%3C/b%3E&uses=2&days=1&address=https://booth:8443");
    assert!(tells("/staff") && tells("/staff/admin"), "it ends within 30 days");
    assert!(file.head.contains("attachment; filename=\"paros-fleet.toml\""), "{}", file.head);
    let word = |name: &str| {
        let line = file.text().lines().find_map(|line| line.strip_prefix(name));
        line.expect("it is told").trim_matches('"').to_owned()
    };
    assert_eq!(word("address = "), "https://booth:8443");
    assert!(file.text().contains("-----BEGIN CERTIFICATE-----"));
    let token = EnrolmentToken::parse_hex(&word("enrolment_token = ")).expect("a token");
    Headset::enrol(client, token, 1);
    let page = ana.get("/staff/admin");
    assert!(
        page.text().contains("&lt;b&gt;wall 1")
            && !page.text().contains(&word("enrolment_token = "))
    );
    let hash = paros_protocol::ContentHash::of(&token.0);
    let revoked = ana.click("/staff/admin", &format!("/staff/admin/tokens/{hash}/revoke"));
    assert_eq!(revoked.status, 303);
    let asked = FleetEnrolment {
        enrolment_token: token,
        token_hash: paros_protocol::ContentHash::of(&[9; 32]),
        hint: DeviceHint([9; 16]),
        name: DeviceName::new("Quest").expect("a name"),
    };
    assert_eq!(client.post("/v1/enrol/fleet", &asked.to_json()).status, 401);
    assert!(ana.get("/staff/admin").text().contains("taken back"));
    assert!(!tells("/staff"), "it lets nobody in");
    assert!(!folder.log().contains(&word("enrolment_token = ")));
}
