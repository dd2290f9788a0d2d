//! Tests of the headset's shell: its program in sessions of Monado and on traces, its calls into Java, and
//! its search for a runtime.

mod android;
mod booth;
mod device;
mod java;
mod motion;
mod negotiation;
mod replay;
#[cfg(unix)]
mod runtimes;
#[cfg(unix)]
mod session;
