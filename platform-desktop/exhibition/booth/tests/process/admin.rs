//! Tests of accounts, enrolment tokens and the audit log: admins see them, attendants don't.

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
    // With a form token of his own login, and the same token with her login.
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
fn a_forgotten_password_is_reset_by_another_admin() {
    let folder = BoothFolder::new("admin-reset");
    let booth = folder.start();
    let client = &booth.client;
    let ana = Browser::first(client, &booth.first_code().expect("a code"));
    ana.fill("/staff/admin", "/staff/admin/accounts", ACCOUNT);
    let log_in = |password: &str| {
        post_form(client, "/staff/login", "", &format!("name=bob&password={password}"))
    };
    let bob = Browser { client, cookie: cookie_of(&log_in("battery+horse+correct")) };
    let to = "/staff/admin/accounts/bob/password";
    let reset =
        |password: &str| ana.fill("/staff/admin", to, &format!("&name=bob&password={password}"));
    let short = reset("short");
    assert_eq!(short.status, 400);
    let form = short.text().split("<details open>").nth(1).expect("the form is open");
    assert!(form.contains(to) && form.contains("role=\"alert\""), "{form}");
    assert_eq!(short.text().matches("<details open>").count(), 1, "no other form is");
    assert_eq!(bob.get("/staff").status, 200);
    assert_eq!(ana.click("/staff/admin", "/staff/admin/accounts/bob/disable").status, 303);
    let done = reset("staple+horse+correct");
    assert!(done.status == 303 && cookie_of(&done) == "done=reset", "{done:?}");
    assert!(bob.get("/staff").head.contains("location: /staff/login"), "the old login is over");
    assert_eq!(log_in("battery+horse+correct").status, 403);
    let bob = Browser { client, cookie: cookie_of(&log_in("staple+horse+correct")) };
    assert_eq!(bob.get("/staff").status, 200, "it is let in again");
    assert!(ana.get("/staff/audit").text().contains("reset password of bob</td><td>ana</td>"));
    // Her own password can't be reset here; neither his form token nor an unknown name works.
    assert!(!ana.get("/staff/admin").text().contains("accounts/ana/password"));
    let token = |browser: &Browser, page| {
        let page = browser.get(page);
        page.text().split("name=\"form\" value=\"").nth(1).expect("a form")[..32].to_owned()
    };
    let send = |browser: &Browser, name: &str, token: &str| {
        let form = format!("form={token}&name={name}&password=wrong+horse+battery");
        let to = format!("/staff/admin/accounts/{name}/password");
        post_form(client, &to, &browser.cookie, &form).status
    };
    let (of_ana, of_bob) = (token(&ana, "/staff/admin"), token(&bob, "/staff/account"));
    assert_eq!(send(&ana, "ana", &of_ana), 403);
    assert_eq!(send(&ana, "eve", &of_ana), 404);
    assert_eq!(send(&bob, "ana", &of_bob), 403);
}

#[test]
fn a_forgotten_password_is_reset_by_a_command_while_the_booth_serves() {
    let folder = BoothFolder::new("admin-reset-command");
    let none = folder.run(&["reset-password", "ana"]).expect_err("there is no booth");
    assert!(none.contains("there is no booth"), "{none}");
    let booth = folder.start();
    let none = folder.run(&["reset-password", "ana"]).expect_err("there are no accounts");
    assert!(none.contains("a code for the first one"), "{none}");
    let client = &booth.client;
    let ana = Browser::first(client, &booth.first_code().expect("a code"));
    ana.fill("/staff/admin", "/staff/admin/accounts", ACCOUNT);
    let unknown = folder.run(&["reset-password", "eve"]).expect_err("an unknown name");
    assert_eq!(unknown, "paros-booth: \"eve\": no such account; the accounts are ana, bob\n");
    let reset = |name: &str| {
        let told = folder.run(&["reset-password", name]).expect("it is there");
        let password = told.lines().next().and_then(|line| line.split(": ").nth(1));
        (password.expect("a password").to_owned(), told.contains("It was shut out"))
    };
    let (first, was_shut_out) = reset("ana");
    assert!(first.len() == 19 && !was_shut_out, "{first}");
    assert!(ana.get("/staff").head.contains("location: /staff/login"), "her logins are over");
    let log_in = |name: &str, password: &str| {
        post_form(client, "/staff/login", "", &format!("name={name}&password={password}"))
    };
    assert_eq!(log_in("ana", "correct+horse+battery").status, 403);
    let ana = Browser { client, cookie: cookie_of(&log_in("ana", &first)) };
    assert!(ana.get("/staff/audit").text().contains("reset password of ana</td><td>console</td>"));
    assert_eq!(ana.click("/staff/admin", "/staff/admin/accounts/bob/disable").status, 303);
    let (second, was_shut_out) = reset("bob");
    assert!(was_shut_out && second != first);
    assert_eq!(log_in("bob", &second).status, 303);
    assert!(!folder.log().contains(&second) && !folder.log().contains(&first));
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
