//! A visit to an exhibition, from putting on the headset to receiving the badge: a state machine of phases.
//!
//! Inputs of each tick: is the headset worn and used, a command of panel, staff or shell, and the facts of
//! the tick. Outputs: when sessions start and sculptures are final. The machine counts ticks and is
//! independent of clocks, languages and pictures: shells draw [`VisitPhase`]s and translate numbers. A
//! [`World`](crate::World) steps it. Without [`VisitCommand::Open`] there are no visits, and only the shell's
//! inputs start and end sessions.

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
