//! Runs the tests of the rules, which their own crate runs over a database in memory, over
//! `crate::new_store`.
#[path = "../../rules/tests/badges.rs"]
mod badges;
#[path = "../../rules/tests/clock.rs"]
mod clock;
#[path = "../../rules/tests/common/mod.rs"]
pub(crate) mod common;
#[path = "../../rules/tests/enrol.rs"]
mod enrol;
#[path = "../../rules/tests/find.rs"]
mod find;
#[path = "../../rules/tests/heartbeat.rs"]
mod heartbeat;
#[path = "../../rules/tests/lifecycle.rs"]
mod lifecycle;
#[path = "../../rules/tests/list.rs"]
mod list;
#[path = "../../rules/tests/mail.rs"]
mod mail;
#[path = "../../rules/tests/printers.rs"]
mod printers;
#[path = "../../rules/tests/prints.rs"]
mod prints;
#[path = "../../rules/tests/privacy.rs"]
mod privacy;
#[path = "../../rules/tests/promises.rs"]
mod promises;
#[path = "../../rules/tests/restore.rs"]
mod restore;
#[path = "../../rules/tests/staff.rs"]
mod staff;
#[path = "../../rules/tests/store.rs"]
mod store;
#[path = "../../rules/tests/upload.rs"]
mod upload;
#[path = "../../rules/tests/work.rs"]
mod work;
