//! Tests that need the Android library.

mod activity;
mod android;
