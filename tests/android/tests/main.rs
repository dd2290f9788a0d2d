//! Tests that need the library for Android.

mod activity;
mod android;
