//! Transition table of stages and flanks: the control runs the table, and `docs/theory/compensation.md` prints it.

use super::set_point::Stage;

/// Event of a control period.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
pub enum Event {
    /// Demand of the opposite sign that exceeds hysteresis and noise.
    DemandTurned = 1,
    /// Demand of the opposite sign in impedance mode, within the hysteresis.
    SpringUndecided = 2,
    /// No contact; the opening exceeds half of the half-gap.
    FlankLost = 4,
    /// No contact; the opening exceeds the estimation error.
    FlankOpening = 8,
    /// Flank touches; on a path the motor has also been braked.
    FlankMet = 16,
    /// End of the path's time.
    PathEnded = 32,
    /// No other event.
    Underway = 64,
}

impl Event {
    /// Sentence for the documentation.
    pub const fn meaning(self) -> &'static str {
        match self {
            Self::DemandTurned => "The demand changes sign by more than the hysteresis.",
            Self::SpringUndecided => "Impedance mode: the demand changes sign by less than the hysteresis.",
            Self::FlankLost => "No contact; the opening exceeds half of the half-gap.",
            Self::FlankOpening => "No contact; the opening exceeds the estimation error.",
            Self::FlankMet => "The flank is felt, seen or stops the motor; on a path the motor is also braked.",
            Self::PathEnded => "The time of the path is over.",
            Self::Underway => "No other event.",
        }
    }
}

/// Action that follows from an event.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Action {
    /// Starts a path to the other flank.
    CrossOver,
    /// Starts a path to the same flank.
    CrossBack,
    /// Approaches the flank at the landing speed.
    Land,
    /// Lets the flank carry; the torque of the law rises from zero.
    Carry,
    /// Lets the torque of the law find the flank; a flank that is detected past the middle of the gap becomes the flank
    /// in use.
    LetSpringFind,
    /// Starts a new path if it ends clearly sooner.
    Shorten,
}

/// Row of the table: an event and its action.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Transition {
    /// Event that fires the row.
    pub when: Event,
    /// Action of the row.
    pub action: Action,
}

const fn on(when: Event, action: Action) -> Transition {
    Transition { when, action }
}

/// Rows while a flank carries.
const TOUCHING: &[Transition] = &[
    on(Event::DemandTurned, Action::CrossOver),
    on(Event::SpringUndecided, Action::LetSpringFind),
    on(Event::FlankLost, Action::CrossBack),
    on(Event::FlankOpening, Action::Land),
];

/// Rows while the motor follows a path through the gap.
const CROSSING: &[Transition] = &[
    on(Event::DemandTurned, Action::CrossOver),
    on(Event::FlankMet, Action::Carry),
    on(Event::PathEnded, Action::Land),
    on(Event::Underway, Action::Shorten),
];

/// Rows while the motor closes on a flank at the landing speed.
const LANDING: &[Transition] = &[
    on(Event::DemandTurned, Action::CrossOver),
    on(Event::SpringUndecided, Action::LetSpringFind),
    on(Event::FlankMet, Action::Carry),
];

/// Returns the rows of a stage. The first row whose event is present fires; without a matching row the stage does not
/// change.
///
/// ```
/// use model_core::compensation::Stage;
/// use model_core::compensation::transitions::{Action, Event, transitions};
///
/// // Whatever else there is: a torque that turns round is answered first.
/// for stage in [Stage::Touching, Stage::Crossing, Stage::Landing] {
///     assert_eq!(transitions(stage)[0].when, Event::DemandTurned);
///     assert_eq!(transitions(stage)[0].action, Action::CrossOver);
/// }
/// // A path through the gap ends on its flank or, where the flank is later than thought, at a small speed.
/// let line = |event| transitions(Stage::Crossing).iter().find(|line| line.when == event).unwrap();
/// let after = |event| line(event).action.stage();
/// assert_eq!([Event::FlankMet, Event::PathEnded].map(after), [Stage::Touching, Stage::Landing]);
/// assert!(transitions(Stage::Plain).is_empty(), "without the gap there is no flank to go to");
/// ```
pub const fn transitions(stage: Stage) -> &'static [Transition] {
    match stage {
        Stage::Touching => TOUCHING,
        Stage::Crossing => CROSSING,
        Stage::Landing => LANDING,
        Stage::Plain | Stage::Off | Stage::Reversed => &[],
    }
}

impl Action {
    /// Sentence for the documentation.
    pub const fn meaning(self) -> &'static str {
        match self {
            Self::CrossOver => "Lay a path to the other flank.",
            Self::CrossBack => "Lay a path to the same flank.",
            Self::Land => "Close at the landing speed.",
            Self::Carry => "The flank carries; the torque rises from zero.",
            Self::LetSpringFind => "The torque finds the flank; a flank felt beyond the middle of the gap is taken.",
            Self::Shorten => "Lay a new path if it ends clearly sooner.",
        }
    }

    /// Next stage.
    pub const fn stage(self) -> Stage {
        match self {
            Self::CrossOver | Self::CrossBack | Self::Shorten => Stage::Crossing,
            Self::Land => Stage::Landing,
            Self::Carry | Self::LetSpringFind => Stage::Touching,
        }
    }
}

/// Bit mask of the events that have a row in a stage.
const fn answered(stage: Stage) -> u8 {
    match stage {
        Stage::Touching => const { bits(TOUCHING) },
        Stage::Crossing => const { bits(CROSSING) },
        Stage::Landing => const { bits(LANDING) },
        Stage::Plain | Stage::Off | Stage::Reversed => 0,
    }
}

/// Bit mask of the events of some rows.
const fn bits(mut lines: &[Transition]) -> u8 {
    let mut bits = 0;
    while let [line, rest @ ..] = lines {
        bits |= line.when as u8;
        lines = rest;
    }
    bits
}

/// Events of a period.
#[derive(Debug, Clone, Copy)]
pub(super) struct Events(u8);

impl Events {
    /// No event but `Underway`.
    pub const UNDERWAY: Self = Self(Event::Underway as u8);

    /// Adds an event if it is present.
    pub fn with(self, event: Event, there: bool) -> Self {
        Self(self.0 | if there { event as u8 } else { 0 })
    }

    /// Returns the action of the first matching row of a stage.
    #[inline]
    pub fn action(self, stage: Stage) -> Option<Action> {
        // In most periods no row of the stage matches.
        if self.0 & answered(stage) == 0 {
            return None;
        }
        transitions(stage).iter().find(|line| self.0 & line.when as u8 != 0).map(|line| line.action)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn first_matching_row_fires() {
        let events = Events::UNDERWAY.with(Event::FlankOpening, true).with(Event::FlankLost, true);
        assert_eq!(events.action(Stage::Touching), Some(Action::CrossBack));
        assert_eq!(events.with(Event::DemandTurned, true).action(Stage::Touching), Some(Action::CrossOver));
    }

    #[test]
    fn event_without_a_row_keeps_the_stage() {
        assert_eq!(Events::UNDERWAY.action(Stage::Touching), None);
        assert_eq!(Events::UNDERWAY.with(Event::PathEnded, true).action(Stage::Landing), None);
    }

    #[test]
    fn event_that_is_absent_does_not_fire() {
        assert_eq!(Events::UNDERWAY.with(Event::FlankMet, false).action(Stage::Landing), None);
    }

    #[test]
    fn stage_without_a_flank_has_no_action() {
        let all = Events(u8::MAX);
        assert_eq!([Stage::Plain, Stage::Off, Stage::Reversed].map(|stage| all.action(stage)), [None; 3]);
    }
}
