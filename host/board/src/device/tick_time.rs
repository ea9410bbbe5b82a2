//! Decides for `joint budget`, `check`, `image`, `flash` and `hil` whether a board has time for the tick of a role at a
//! rate. Instructions of the joint's step come from its certificate; instructions of the rest of a role's tick were
//! counted on the emulated board; cycles per instruction are estimated for the chip. None of it was measured on
//! silicon.

use link::messages::Role;
use model_core::gears::design::{DesignError, Effort, Processor, StepSize, Substeps};
use parameters::JointParameters;

use super::board::Board;
use super::role::{DRIVE, role_name};
use report::failure::{Failure, Outcome};

/// Worst-case instructions of a tick of the role `observer`. The counting program checks this bound and the next.
pub const OBSERVER_INSTRUCTIONS: u32 = 6200;
/// Worst-case instructions of a tick of the role `loop` without its step of the joint, for which the step's own worst
/// case is added. Largest count in a run: 5,768.
const LOOP_INSTRUCTIONS: u32 = 6100;
/// Part of the period that an observer may take; the rest belongs to the motor controller on the same chip.
const OBSERVER_SHARE: f64 = 0.75;
/// Common control rates, in order of preference [Hz].
const COMMON_RATES: [u32; 5] = [10_000, 8000, 5000, 4000, 2000];
/// Highest rate considered [Hz].
const HIGHEST_RATE: u32 = 500_000;
/// Help about building an image in spite of the limit, for a role with a host and for the role `drive`.
const FORCE_HELP: &str =
    "`--force` builds the image anyway; expect overruns and late torques, and `forced` in the board's identity";
const FORCE_DRIVE_HELP: &str = "`--force` builds the image anyway; expect late frames and a joint that runs too slowly";

/// Reason for which a rate is rejected.
#[derive(Debug, Clone, PartialEq)]
pub enum Obstacle {
    /// No step is stable below this rate [Hz].
    Unstable(u32),
    /// The core clock, which the rate does not divide [Hz].
    NoMultiple(u32),
    /// The worst tick exceeds its share of the period.
    NoTime(TickTime),
}

/// Duration of the worst tick.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TickTime {
    /// Instructions of the tick.
    pub instructions: f64,
    /// Duration of the tick over the period.
    pub part: f64,
    /// Largest allowed duration of the tick over the period.
    pub share: f64,
}

/// A joint on a board in a role, for questions about any rate.
pub struct RateCheck<'a> {
    joint: &'a JointParameters,
    board: &'a Board,
    role: Role,
    is_drive: bool,
    processor: Processor,
    step_size: StepSize,
}

impl<'a> RateCheck<'a> {
    /// Joint whose step is fitted to the board.
    pub fn new(joint: &'a JointParameters, board: &'a Board, role: Role) -> Self {
        Self { joint, board, role, is_drive: false, processor: board.processor(), step_size: StepSize::new(joint) }
    }

    /// Joint behind a drive on CAN, whose tick is bounded by that of the role `loop`: the same joint beside more work.
    pub fn drive(joint: &'a JointParameters, board: &'a Board) -> Self {
        Self { is_drive: true, ..Self::new(joint, board, Role::Loop) }
    }

    /// Joint that the board simulates.
    pub fn plant(joint: &'a JointParameters, board: &'a Board) -> Self {
        Self::new(joint, board, Role::Plant)
    }

    /// Number of sub-steps in which contacts may change, at a rate.
    pub fn substeps(&self, rate: u32) -> Result<Substeps, DesignError> {
        self.step_size.substeps(rate, Effort::Within(self.processor))
    }

    /// Worst tick at a rate, if a step is stable at it.
    pub fn tick_time(&self, rate: u32) -> Option<TickTime> {
        let step = self.step_size.cost().all_crossing(self.substeps(rate).ok()?);
        let (instructions, share) = match self.role {
            Role::Plant => (step, self.processor.share),
            Role::Observer => (OBSERVER_INSTRUCTIONS.into(), OBSERVER_SHARE),
            // The role `loop` does not share the chip.
            Role::Loop => (f64::from(LOOP_INSTRUCTIONS) + step, 1.0),
        };
        Some(TickTime { instructions, part: self.processor.part(instructions, rate), share })
    }

    /// Reason for which a rate is rejected, or `None`.
    pub fn obstacle(&self, rate: u32) -> Option<Obstacle> {
        let lowest = self.lowest_rate();
        if rate < lowest {
            return Some(Obstacle::Unstable(lowest));
        }
        if !self.processor.clock.is_multiple_of(rate) {
            return Some(Obstacle::NoMultiple(self.processor.clock));
        }
        self.tick_time(rate).filter(|time| time.part > time.share).map(Obstacle::NoTime)
    }

    /// Rejects a rate that has an obstacle; the help names the nearest rate without one.
    pub fn check(&self, rate: u32) -> Outcome<()> {
        self.obstacle(rate).map_or(Ok(()), |obstacle| Err(self.refusal(rate, &obstacle)))
    }

    /// Rejects a rate as [`Self::check`] does, but accepts a tick that is too long if `force` is set. Returns whether
    /// `force` was needed.
    pub fn check_unless_forced(&self, rate: u32, force: bool) -> Outcome<bool> {
        match self.obstacle(rate) {
            None => Ok(false),
            Some(Obstacle::NoTime(_)) if force => Ok(true),
            Some(obstacle) => {
                let refusal = self.refusal(rate, &obstacle);
                let help = refusal.help().unwrap_or_default().to_owned();
                let force = match obstacle {
                    Obstacle::NoTime(_) if self.is_drive => format!("\n{FORCE_DRIVE_HELP}"),
                    Obstacle::NoTime(_) => format!("\n{FORCE_HELP}"),
                    _ => String::new(),
                };
                Err(refusal.with_help(help + &force))
            }
        }
    }

    fn refusal(&self, rate: u32, obstacle: &Obstacle) -> Failure {
        let why = match obstacle {
            Obstacle::Unstable(lowest) => format!("below {lowest} Hz no step is stable"),
            Obstacle::NoMultiple(clock) => format!("its clock of {clock} Hz is no multiple of it"),
            Obstacle::NoTime(TickTime { instructions, part, share }) => format!(
                "its worst tick takes {instructions:.0} instructions, {:.0} % of the period; {:.0} % are the limit",
                100.0 * part,
                100.0 * share
            ),
        };
        let role = if self.is_drive { DRIVE } else { role_name(self.role) };
        let in_test_file = if self.is_drive { "" } else { " (in a test file control_rate_Hz in [known])" };
        let (joint, board) = (&self.joint.name, self.board.name());
        Failure::new(format!("{joint} cannot be stepped at {rate} Hz on {board} in the role `{role}`: {why}"))
            .with_help(match self.nearest_accepted(rate) {
                Some(nearest) => {
                    format!("the nearest rate that can be met is {nearest} Hz: `--rate {nearest}`{in_test_file}")
                }
                None => {
                    "no rate fits this board: use a faster board, or a joint with fewer planets or harmonics".to_owned()
                }
            })
    }

    /// Lowest rate at which a step is stable [Hz].
    pub fn lowest_rate(&self) -> u32 {
        self.step_size.lowest_rate(Effort::Within(self.processor))
    }

    /// Stable rates that divide the core clock, in descending order [Hz].
    fn rates(&self) -> impl Iterator<Item = u32> {
        let clock = self.processor.clock;
        let divisors = (clock / HIGHEST_RATE).max(1)..=clock / self.lowest_rate();
        divisors.filter(move |divisor| clock.is_multiple_of(*divisor)).map(move |divisor| clock / divisor)
    }

    /// Nearest accepted rate; the higher of two at equal distance.
    pub fn nearest_accepted(&self, rate: u32) -> Option<u32> {
        self.rates()
            .filter(|candidate| self.obstacle(*candidate).is_none())
            .min_by_key(|candidate| (candidate.abs_diff(rate), u32::MAX - candidate))
    }

    /// Ranges of accepted rates: every rate of a range that divides the clock is accepted. There can be several ranges
    /// because the method of the sub-steps changes with the rate.
    pub fn rates_that_fit(&self) -> Vec<[u32; 2]> {
        let mut ranges: Vec<[u32; 2]> = Vec::new();
        let mut before = false;
        for rate in self.rates() {
            let fits = self.obstacle(rate).is_none();
            match ranges.last_mut().filter(|_| before) {
                Some(range) if fits => range[0] = rate,
                _ if fits => ranges.push([rate; 2]),
                _ => {}
            }
            before = fits;
        }
        ranges.reverse();
        ranges
    }

    /// Nearest stable rate that divides the clock [Hz].
    pub fn nearest_divisor_rate(&self, rate: f64) -> u32 {
        self.rates()
            .min_by(|one, other| (f64::from(*one) - rate).abs().total_cmp(&(f64::from(*other) - rate).abs()))
            .unwrap_or(0)
    }
}

/// Highest common control rate at which a role fits its period; the highest of all if none fits [Hz].
pub fn default_control_rate(parameters: &JointParameters, board: &Board, role: Role) -> u32 {
    let on_board = RateCheck::new(parameters, board, role);
    COMMON_RATES.into_iter().find(|rate| on_board.obstacle(*rate).is_none()).unwrap_or(COMMON_RATES[0])
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use joint_file::named;

    use super::*;

    /// A rate that is too high for the role `loop` is rejected with the nearest accepted rate.
    #[test]
    fn excessive_loop_rate_offers_nearest() {
        let q1 = named::load(Path::new("q1")).unwrap().file.parameters;
        let nucleo = Board::load("nucleo-g474re").unwrap();
        let on_board = RateCheck::new(&q1, &nucleo, Role::Loop);
        let usual = default_control_rate(&q1, &nucleo, Role::Loop);
        assert!(on_board.check(usual).is_ok());
        let failure = on_board.check(20_000).unwrap_err();
        assert!(failure.message().contains("on nucleo-g474re in the role `loop`"), "{failure}");
        let nearest = on_board.nearest_accepted(20_000).unwrap();
        assert!(usual <= nearest && nearest < 20_000, "{nearest}");
        assert!(failure.help().unwrap().contains(&format!("--rate {nearest}`")), "{failure}");
        assert!(on_board.check(nearest).is_ok());
    }

    /// The role `drive` is called by its name, and has neither test files nor an identity.
    #[test]
    fn drive_refusal_names_drive() {
        let q1 = named::load(Path::new("q1")).unwrap().file.parameters;
        let nucleo = Board::load("nucleo-g474re").unwrap();
        let failure = RateCheck::drive(&q1, &nucleo).check_unless_forced(20_000, false).unwrap_err();
        assert!(failure.message().contains("on nucleo-g474re in the role `drive`"), "{failure}");
        let help = failure.help().unwrap();
        assert!(help.contains("--force") && !help.contains("identity") && !help.contains("test file"), "{help}");
    }

    /// `--force` accepts a tick that is too long, but no unstable rate and no rate that does not divide the clock.
    #[test]
    fn force_overrides_duration_only() {
        let q1 = named::load(Path::new("q1")).unwrap().file.parameters;
        for role in [Role::Plant, Role::Observer, Role::Loop] {
            let board = Board::emulated();
            let on_board = RateCheck::new(&q1, &board, role);
            let help = on_board.check_unless_forced(168_000, false).unwrap_err().help().unwrap_or_default().to_owned();
            assert!(help.contains("--force"), "{help}");
            assert_eq!(on_board.check_unless_forced(168_000, true).ok(), Some(true), "{role:?}");
            assert_eq!(on_board.check_unless_forced(5000, true).ok(), Some(false), "{role:?}");
            for rate in [100, 20_001] {
                let help = on_board.check_unless_forced(rate, true).unwrap_err().help().unwrap_or_default().to_owned();
                assert!(!help.contains("--force"), "{help}");
            }
        }
    }

    /// The images of Q1 fit the presets at the rates that tests and documentation use.
    #[test]
    fn preset_images_fit_their_boards() {
        let joint = |name: &str| named::load(Path::new(name)).unwrap().file.parameters;
        let emulated = Board::emulated();
        for board in Board::presets().unwrap() {
            RateCheck::plant(&joint("q1"), &board).check(20_000).unwrap();
        }
        // Tests that come along run on Q1 at their control rate in both roles; other joints may be rejected in the role
        // `loop`.
        for role in [Role::Observer, Role::Loop] {
            RateCheck::new(&joint("q1"), &emulated, role).check(10_000).unwrap();
        }
    }

    /// The ranges of accepted rates agree with the verdict on each single rate.
    #[test]
    fn accepted_ranges_match_single_rates() {
        for name in joint_file::PRESETS {
            let joint = named::load(Path::new(name)).unwrap().file.parameters;
            for board in Board::presets().unwrap() {
                for role in [Role::Plant, Role::Observer, Role::Loop] {
                    let on_board = RateCheck::new(&joint, &board, role);
                    let ranges = on_board.rates_that_fit();
                    assert!(ranges.as_flattened().is_sorted());
                    let told = |rate: &u32| ranges.iter().any(|[low, high]| (low..=high).contains(&rate));
                    for rate in on_board.rates() {
                        assert_eq!(told(&rate), on_board.check(rate).is_ok(), "{name}, {}: {rate}", board.name());
                    }
                }
            }
        }
    }
}
