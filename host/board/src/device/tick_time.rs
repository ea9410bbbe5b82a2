//! Whether a board has time for the tick of a role at a rate: the one verdict of `joint budget`, `check`, `image`, `flash` and
//! `hil`. Instructions are those of the certificate for the joint's step, and as counted on the emulated board for what a role
//! does beside it; cycles an instruction are reckoned for the chip. None of it was measured on silicon.

use link::messages::Role;
use model_core::gears::design::{DesignError, Effort, Processor, StepSize, Substeps};
use parameters::JointParameters;

use super::board::Board;
use super::role::word;
use report::failure::{Failure, Outcome};

/// Instructions that a tick of the role `observer` takes at most. What counts them holds them against this and the next.
pub const OBSERVER: u32 = 6200;
/// Those of a tick of the role `loop` beyond a step of the joint in which every mesh crosses. The most that a run has shown is
/// 5,768.
const LOOP: u32 = 6100;
/// Part of the period that an observer may take: the rest is the motor controller's whose guest it is.
const GUEST: f64 = 0.75;
/// Rates that are usual for a control period [Hz].
const USUAL: [u32; 5] = [10_000, 8000, 5000, 4000, 2000];
/// No rate above is looked at [Hz].
const HIGHEST: u32 = 500_000;
/// How to have an image all the same.
const FORCE: &str = "`--force` builds it all the same, for overruns and late torques that its hello announces";

/// What stands against a rate.
#[derive(Debug, Clone, PartialEq)]
pub enum Obstacle {
    /// Below so many Hz no step is stable.
    Unstable(u32),
    /// The core clock is so many Hz, and no multiple of it.
    NoMultiple(u32),
    /// The worst tick takes too long.
    NoTime(TickTime),
}

/// What the worst tick takes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TickTime {
    /// Instructions.
    pub instructions: f64,
    /// Part of the period.
    pub part: f64,
    /// Part of the period that it may take.
    pub share: f64,
}

/// A joint on a board in a role, at any rate.
pub struct OnBoard<'a> {
    joint: &'a JointParameters,
    board: &'a Board,
    role: Role,
    processor: Processor,
    step_size: StepSize,
}

impl<'a> OnBoard<'a> {
    /// Of a joint whose step is fitted to the board.
    pub fn new(joint: &'a JointParameters, board: &'a Board, role: Role) -> Self {
        Self { joint, board, role, processor: board.processor(), step_size: StepSize::new(joint) }
    }

    /// Of a joint that the board simulates.
    pub fn plant(joint: &'a JointParameters, board: &'a Board) -> Self {
        Self::new(joint, board, Role::Plant)
    }

    /// Sub-steps of a tick in which contacts change.
    pub fn substeps(&self, rate: u32) -> Result<Substeps, DesignError> {
        self.step_size.substeps(rate, Effort::Within(self.processor))
    }

    /// The worst tick at a rate that is stable.
    pub fn tick_time(&self, rate: u32) -> Option<TickTime> {
        let step = self.step_size.cost().all_crossing(self.substeps(rate).ok()?);
        let (instructions, share) = match self.role {
            Role::Plant => (step, self.processor.share),
            Role::Observer => (OBSERVER.into(), GUEST),
            // A whole loop has the chip alone.
            Role::Loop => (f64::from(LOOP) + step, 1.0),
        };
        Some(TickTime { instructions, part: self.processor.part(instructions, rate), share })
    }

    /// What stands against a rate; nothing if the board can be built for it.
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

    /// Refuses a rate that something stands against; names the nearest that nothing does.
    pub fn refuse(&self, rate: u32) -> Outcome<()> {
        self.obstacle(rate).map_or(Ok(()), |obstacle| Err(self.refusal(rate, &obstacle)))
    }

    /// The same for an image, of which what takes too long can be had by force; says whether that was needed.
    pub fn refuse_unless_forced(&self, rate: u32, force: bool) -> Outcome<bool> {
        match self.obstacle(rate) {
            None => Ok(false),
            Some(Obstacle::NoTime(_)) if force => Ok(true),
            Some(obstacle) => {
                let refusal = self.refusal(rate, &obstacle);
                let help = refusal.help().unwrap_or_default().to_owned();
                let force = if matches!(obstacle, Obstacle::NoTime(_)) { format!("\n{FORCE}") } else { String::new() };
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
        let (joint, board, role) = (&self.joint.name, self.board.name(), word(self.role));
        Failure::new(format!("{joint} cannot be stepped at {rate} Hz on {board} in the role `{role}`: {why}")).with_help(
            match self.nearest(rate) {
                Some(nearest) => format!(
                    "the nearest rate that can be met is {nearest} Hz: `--rate {nearest}` (in a test file control_rate_Hz in \
                     [known])"
                ),
                None => "no rate can be met on this board: take a faster one, or fewer planets or harmonics".to_owned(),
            },
        )
    }

    /// Below it no step is stable [Hz].
    pub fn lowest_rate(&self) -> u32 {
        self.step_size.lowest_rate(Effort::Within(self.processor))
    }

    /// Rates that can be made of the clock and are stable, the highest first [Hz].
    fn rates(&self) -> impl Iterator<Item = u32> {
        let clock = self.processor.clock;
        let divisors = (clock / HIGHEST).max(1)..=clock / self.lowest_rate();
        divisors.filter(move |divisor| clock.is_multiple_of(*divisor)).map(move |divisor| clock / divisor)
    }

    /// The nearest rate that nothing stands against; of two as near, the higher.
    pub fn nearest(&self, rate: u32) -> Option<u32> {
        self.rates()
            .filter(|candidate| self.obstacle(*candidate).is_none())
            .min_by_key(|candidate| (candidate.abs_diff(rate), u32::MAX - candidate))
    }

    /// Rates that nothing stands against, as stretches from a lowest to a highest in which every rate that the clock can be divided
    /// to is one. There can be several, since the method of the sub-steps changes with the rate.
    pub fn rates_that_fit(&self) -> Vec<[u32; 2]> {
        let mut stretches: Vec<[u32; 2]> = Vec::new();
        let mut before = false;
        for rate in self.rates() {
            let fits = self.obstacle(rate).is_none();
            match stretches.last_mut().filter(|_| before) {
                Some(stretch) if fits => stretch[0] = rate,
                _ if fits => stretches.push([rate; 2]),
                _ => {}
            }
            before = fits;
        }
        stretches.reverse();
        stretches
    }

    /// The nearest rate to which the clock can be divided [Hz].
    pub fn divided(&self, rate: f64) -> u32 {
        self.rates()
            .min_by(|one, other| (f64::from(*one) - rate).abs().total_cmp(&(f64::from(*other) - rate).abs()))
            .unwrap_or(0)
    }
}

/// The highest usual rate at which a role that controls fits into its period; the usual one where none does [Hz].
pub fn usual_rate(parameters: &JointParameters, board: &Board, role: Role) -> u32 {
    let on_board = OnBoard::new(parameters, board, role);
    USUAL.into_iter().find(|rate| on_board.obstacle(*rate).is_none()).unwrap_or(USUAL[0])
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use joint_file::named;

    use super::*;

    #[test]
    fn a_loop_fits_where_its_ticks_do_and_is_offered_the_nearest_rate_where_not() {
        let q1 = named::load(Path::new("q1")).unwrap().file.parameters;
        let nucleo = Board::load("nucleo-g474re").unwrap();
        let on_board = OnBoard::new(&q1, &nucleo, Role::Loop);
        let usual = usual_rate(&q1, &nucleo, Role::Loop);
        assert!(on_board.refuse(usual).is_ok());
        let failure = on_board.refuse(20_000).unwrap_err();
        assert!(failure.message().contains("on nucleo-g474re in the role `loop`"), "{failure}");
        let nearest = on_board.nearest(20_000).unwrap();
        assert!(usual <= nearest && nearest < 20_000, "{nearest}");
        assert!(failure.help().unwrap().contains(&format!("--rate {nearest}`")), "{failure}");
        assert!(on_board.refuse(nearest).is_ok());
    }

    #[test]
    fn force_overrides_what_takes_too_long_and_nothing_else() {
        let q1 = named::load(Path::new("q1")).unwrap().file.parameters;
        for role in [Role::Plant, Role::Observer, Role::Loop] {
            let board = Board::emulated();
            let on_board = OnBoard::new(&q1, &board, role);
            let help = on_board.refuse_unless_forced(168_000, false).unwrap_err().help().unwrap_or_default().to_owned();
            assert!(help.contains("--force"), "{help}");
            assert_eq!(on_board.refuse_unless_forced(168_000, true).ok(), Some(true), "{role:?}");
            assert_eq!(on_board.refuse_unless_forced(5000, true).ok(), Some(false), "{role:?}");
            for rate in [100, 20_001] {
                let help = on_board.refuse_unless_forced(rate, true).unwrap_err().help().unwrap_or_default().to_owned();
                assert!(!help.contains("--force"), "{help}");
            }
        }
    }

    #[test]
    fn images_that_come_along_fit_their_boards() {
        let joint = |name: &str| named::load(Path::new(name)).unwrap().file.parameters;
        let emulated = Board::emulated();
        for board in Board::presets().unwrap() {
            OnBoard::plant(&joint("q1"), &board).refuse(20_000).unwrap();
        }
        // Tests that come along run on Q1 at their control rate, in both roles; others may be refused in the role `loop`.
        for role in [Role::Observer, Role::Loop] {
            OnBoard::new(&joint("q1"), &emulated, role).refuse(10_000).unwrap();
        }
    }

    #[test]
    fn stretches_of_rates_that_fit_hold_all_of_them_and_no_other() {
        for name in joint_file::PRESETS {
            let joint = named::load(Path::new(name)).unwrap().file.parameters;
            for board in Board::presets().unwrap() {
                for role in [Role::Plant, Role::Observer, Role::Loop] {
                    let on_board = OnBoard::new(&joint, &board, role);
                    let stretches = on_board.rates_that_fit();
                    assert!(stretches.as_flattened().is_sorted());
                    let told = |rate: &u32| stretches.iter().any(|[low, high]| (low..=high).contains(&rate));
                    for rate in on_board.rates() {
                        assert_eq!(told(&rate), on_board.refuse(rate).is_ok(), "{name}, {}: {rate}", board.name());
                    }
                }
            }
        }
    }
}
