//! When the compensation changes its stage or its flank: one table, which the control runs and the documentation prints.

use super::set_point::Stage;

/// What a period can show.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
pub enum Event {
    /// The teeth will have to pass on torque of the other sign, by more than hysteresis and noise.
    DemandTurned = 1,
    /// An impedance's own spring asks for the other flank, by less than that.
    SpringUndecided = 2,
    /// Nothing shows contact, and the flank is open by more than half of the half-gap.
    FlankLost = 4,
    /// Nothing shows contact, and the flank is open by more than the estimates' errors.
    FlankOpening = 8,
    /// The flank touches and, on a path, the motor has been braked.
    FlankMet = 16,
    /// The path is at its end.
    PathEnded = 32,
    /// None of these.
    Underway = 64,
}

impl Event {
    /// The same as a sentence, for the documentation.
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

/// What follows from it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Action {
    /// A path to the other flank.
    CrossOver,
    /// A path to the same flank.
    CrossBack,
    /// On towards the flank at a small speed.
    Land,
    /// The flank carries; the law's torque rises from nothing.
    Carry,
    /// The law's torque finds the flank by itself; the one that is felt is taken.
    LetSpringFind,
    /// A shorter path, if what is left takes that much less now.
    Shorten,
}

/// A line of the table: an event and what follows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Transition {
    /// What has to be so.
    pub when: Event,
    /// What follows.
    pub action: Action,
}

const fn on(when: Event, action: Action) -> Transition {
    Transition { when, action }
}

/// A flank carries.
const TOUCHING: &[Transition] = &[
    on(Event::DemandTurned, Action::CrossOver),
    on(Event::SpringUndecided, Action::LetSpringFind),
    on(Event::FlankLost, Action::CrossBack),
    on(Event::FlankOpening, Action::Land),
];

/// On a path through the gap.
const CROSSING: &[Transition] = &[
    on(Event::DemandTurned, Action::CrossOver),
    on(Event::FlankMet, Action::Carry),
    on(Event::PathEnded, Action::Land),
    on(Event::Underway, Action::Shorten),
];

/// Closing on a flank at a small speed.
const LANDING: &[Transition] = &[
    on(Event::DemandTurned, Action::CrossOver),
    on(Event::SpringUndecided, Action::LetSpringFind),
    on(Event::FlankMet, Action::Carry),
];

/// What may follow in a stage: of its lines the first whose event is there. Where none is, the stage goes on.
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
    /// The same as a sentence, for the documentation.
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

    /// The stage that follows.
    pub const fn stage(self) -> Stage {
        match self {
            Self::CrossOver | Self::CrossBack | Self::Shorten => Stage::Crossing,
            Self::Land => Stage::Landing,
            Self::Carry | Self::LetSpringFind => Stage::Touching,
        }
    }
}

/// The events that a stage answers, each a bit.
const fn answered(stage: Stage) -> u8 {
    match stage {
        Stage::Touching => const { bits(TOUCHING) },
        Stage::Crossing => const { bits(CROSSING) },
        Stage::Landing => const { bits(LANDING) },
        Stage::Plain | Stage::Off | Stage::Reversed => 0,
    }
}

/// The events of some lines, each a bit.
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
    /// None but that time goes by.
    pub const UNDERWAY: Self = Self(Event::Underway as u8);

    /// These, and an event if it is there.
    pub fn with(self, event: Event, there: bool) -> Self {
        Self(self.0 | if there { event as u8 } else { 0 })
    }

    /// What follows in a stage.
    #[inline]
    pub fn action(self, stage: Stage) -> Option<Action> {
        // In most periods there is nothing that the stage would answer.
        if self.0 & answered(stage) == 0 {
            return None;
        }
        transitions(stage).iter().find(|line| self.0 & line.when as u8 != 0).map(|line| line.action)
    }
}
