//! A visit to an exhibition, from the headset put on to the badge in hand: a state machine that decides what comes
//! next, and when.
//!
//! Takes, each tick, whether the headset is worn and used, a command of panel, staff or shell, and what the tick did;
//! gives when sessions start and sculptures are final. It counts ticks and knows no clock, no language and no picture:
//! shells draw [`VisitPhase`]s and translate numbers. A [`World`](crate::World) steps it; without
//! [`VisitCommand::Open`] there are no visits, and sessions start and end by the shell's inputs alone.

mod input;
mod machine;
mod phase;
mod plan;
mod presence;
mod save;

pub use input::{PanelAction, Presence, StaffCommand, VisitCommand, VisitInput};
pub use machine::{EXTENSION_TICKS, Visit, WARNING_SECONDS};
pub(crate) use machine::{VisitDecision, VisitFacts};
pub use phase::{GuideStep, VisitPhase};
pub use plan::{PlanSetting, VisitPlan};
