//! The running booth: its routes, their shared state, and the worker threads.

pub(crate) mod app;
pub(crate) mod body;
pub(crate) mod changes;
pub(crate) mod connections;
pub(crate) mod gate;
pub(crate) mod keys;
pub(crate) mod leaf;
pub(crate) mod listener;
pub(crate) mod mailer;
pub(crate) mod metrics;
pub(crate) mod page_guard;
pub(crate) mod places;
pub(crate) mod rate;
pub(crate) mod routes;
pub(crate) mod run;
pub(crate) mod staff_certificate;
pub(crate) mod work_keeper;
pub(crate) mod worker;
