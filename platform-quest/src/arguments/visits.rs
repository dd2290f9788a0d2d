//! The flags with which tests enable visits.

use clap::Args;
use paros_core::visit::{PlanSetting, VisitPlan};
use paros_shell::settings::StaffPin;
use paros_visit::VisitOptions;

/// Flags that enable and configure visits.
#[derive(Args, Debug)]
pub(super) struct VisitArgs {
    /// Hold visits.
    #[arg(long, hide = true)]
    visits: bool,
    /// The staff's PIN, four digits.
    #[arg(long, hide = true, requires = "visits", value_name = "PIN", value_parser = parse_pin)]
    visits_pin: Option<StaffPin>,
    /// Changes to the core's visit plan: names of settings with seconds, such as `Length=60,HandsOff=1`.
    #[arg(long, hide = true, requires = "visits", value_name = "PLAN", value_parser = parse_setting, value_delimiter = ',')]
    visits_plan: Vec<(PlanSetting, u16)>,
}

impl VisitArgs {
    pub(super) fn to_options(&self) -> Option<VisitOptions> {
        let mut plan = VisitPlan::new();
        self.visits_plan.iter().for_each(|(setting, value)| plan.set_value(*setting, *value));
        let staff_pin = self.visits_pin;
        self.visits.then(|| VisitOptions { plan, staff_pin, ..VisitOptions::default() })
    }
}

fn parse_pin(text: &str) -> Result<StaffPin, String> {
    StaffPin::from_text(text).ok_or("expected four digits".into())
}

fn parse_setting(text: &str) -> Result<(PlanSetting, u16), String> {
    let (name, value) = text.split_once('=').ok_or("expected NAME=SECONDS")?;
    let setting = PlanSetting::ALL.into_iter().find(|setting| format!("{setting:?}") == name);
    let setting =
        setting.ok_or_else(|| format!("{name}: expected one of {:?}", PlanSetting::ALL))?;
    let value = value.parse().map_err(|_| "expected seconds, 0 to 65535")?;
    Ok((setting, value))
}

#[cfg(test)]
mod tests {
    use clap::Parser;
    use paros_core::session::SessionMode;
    use paros_core::visit::{PlanSetting, VisitPlan};

    use super::{StaffPin, VisitArgs};

    #[derive(Parser)]
    struct Flags {
        #[command(flatten)]
        visits: VisitArgs,
    }

    fn parse(words: &str) -> Result<VisitArgs, String> {
        let words = ["paros-quest"].into_iter().chain(words.split_whitespace());
        Flags::try_parse_from(words).map(|flags| flags.visits).map_err(|error| error.to_string())
    }

    #[test]
    fn visits_are_held_where_a_flag_says_so() {
        assert_eq!(parse("").expect("flags").to_options(), None);
        let words = "--visits --visits-pin 0426 --visits-plan Length=30,HandsOff=1";
        let options = parse(words).expect("flags").to_options().expect("visits");
        let mut plan = VisitPlan::new();
        plan.set_value(PlanSetting::Length, 30);
        plan.set_value(PlanSetting::HandsOff, 1);
        assert_eq!((options.staff_pin, options.plan), (StaffPin::from_text("0426"), plan));
        let owl = SessionMode::Constrained { figure: 8 };
        let starts = [SessionMode::FreeForm, owl, SessionMode::Creative];
        assert_eq!((&options.starts[..], options.languages.len()), (&starts[..], 2));
    }

    #[test]
    fn what_is_wrong_says_what_was_expected() {
        for (words, expected) in [
            ("--visits --visits-pin 042", "expected four digits"),
            ("--visits --visits-pin 04x6", "expected four digits"),
            ("--visits-pin 0426", "--visits"),
            ("--visits --visits-plan Length", "expected NAME=SECONDS"),
            ("--visits --visits-plan Naps=3", "expected one of [Welcome"),
            ("--visits --visits-plan Length=long", "expected seconds"),
        ] {
            let why = parse(words).expect_err(words);
            assert!(why.contains(expected), "{why}");
        }
    }
}
