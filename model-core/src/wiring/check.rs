//! Wiring check with a driven motor: a few gentle legs in alternating directions, safe with any wiring fault.
//!
//! The sign of the torque's effect is unknown, so that each leg measures it: the torque rises until motor or output has
//! turned by half of a small travel; then the opposite torque brakes the motion. Friction, ratio and signs need not be
//! known; the design bounds the travel (`wiring::design`).
//!
//! | state | torque | ends when | then |
//! |---|---|---|---|
//! | rest | 0 | the rest time is over: nothing moves | push |
//! | | | the rest time is over and a shaft moves, before the first leg | refused |
//! | | | the rest time is over and a shaft moves, later | brake, with a quarter of the torque, four times at most |
//! | push | rises to the allowed torque | motor or output has turned by half of the travel | brake |
//! | | | the time at the allowed torque is over | rest; the next leg |
//! | brake | against the motion | the motion is over | rest; the next leg |
//! | any | | motor or output is beyond the travel limit | refused |

use super::thresholds::{CHECK, JUDGE};
use core::fmt;

use super::judge::WiringJudge;
use super::tables::WiringTable;
use super::track::difference;
use super::verdict::Wiring;
use crate::numbers::Real;
use crate::observer::Samples;

/// Limit of a travel [counts], so that products of travels fit.
const MAX_COUNTS: u64 = u32::MAX as u64;

/// Reason for a check that ended before its last leg.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum WiringRefusal {
    /// The joint moved before the first torque: let it come to rest.
    NotAtRest,
    /// The joint moved farther than the check may: an external force drives it.
    TooFar,
    /// The check took too long.
    TooLong,
}

impl fmt::Display for WiringRefusal {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(match self {
            Self::NotAtRest => "the joint moved before any torque was given: let it come to rest",
            Self::TooFar => "the joint moved further than the wiring check may: look for what else drives it",
            Self::TooLong => "the wiring check took too long: look at the times of the samples",
        })
    }
}

/// Progress of a check.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum WiringProgress<T: Real> {
    /// Command the torque and pass the samples of the next period.
    Running,
    /// The last leg is over.
    Done(Wiring<T>),
    /// The check ended early; [`WiringCheck::wiring`] has the verdicts so far.
    Refused(WiringRefusal),
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum State {
    Rest,
    Push,
    Brake,
    Done,
    Refused(WiringRefusal),
}

/// Wiring check of one joint.
///
/// ```
/// use model_core::gears::{Tables, design::design};
/// use model_core::observer::design::observer_settings;
/// use model_core::wiring::{WiringCheck, WiringProgress};
/// use model_core::virtual_joint::{VirtualJoint, design::design_surroundings};
/// use model_core::wiring::design::design_wiring;
///
/// let q1 = joint_file::read(joint_file::preset("q1").unwrap()).unwrap();
/// let gears: Tables<f32, 3> = design(&q1.parameters, q1.surroundings.control_rate)?;
/// let around = design_surroundings(&q1.parameters, &q1.surroundings, &gears)?;
/// let table = design_wiring(&q1.parameters, &observer_settings(&q1.surroundings))?;
/// let (mut joint, mut check) = (VirtualJoint::new(&gears, &around), WiringCheck::<f32>::new(&table));
/// let wiring = loop {
///     // No more than 0.5 N m.
///     let (torque, progress) = check.step(&joint.samples(), 0.5);
///     match progress {
///         WiringProgress::Running => joint.advance(torque, 0.0),
///         WiringProgress::Done(wiring) => break wiring,
///         WiringProgress::Refused(refusal) => panic!("{refusal}"),
///     }
/// };
/// assert!(wiring.is_right(), "{wiring}");
/// # Ok::<(), model_core::gears::design::DesignError>(())
/// ```
#[derive(Debug, Clone)]
pub struct WiringCheck<'tables, T: Real> {
    table: &'tables WiringTable<T>,
    judge: WiringJudge<'tables, T>,
    state: State,
    leg: u8,
    brakings: u8,
    /// Periods since the beginning, in this state, at the allowed torque, and in this window.
    total: u32,
    periods: u32,
    held_periods: u32,
    window: u32,
    /// Magnitude of the torque, and its direction: 1 or -1.
    torque_magnitude: T,
    direction: i32,
    /// Positions at the beginning of the leg or rest, and of the window.
    start: [i64; 2],
    window_start: [i64; 2],
    /// `watches_output`: braking watches the output, otherwise the motor. `motion_sign`: direction of the braked
    /// motion. `window_travel`: counts of the watched shaft in the last window of the push.
    watches_output: bool,
    motion_sign: i64,
    window_travel: i64,
    torque: T,
}

impl<'tables, T: Real> WiringCheck<'tables, T> {
    /// Creates a check. The joint must be at rest and free to move by a few degrees.
    pub fn new(table: &'tables WiringTable<T>) -> Self {
        Self {
            table,
            judge: WiringJudge::new(table),
            state: State::Rest,
            leg: 0,
            brakings: 0,
            total: 0,
            periods: 0,
            held_periods: 0,
            window: 0,
            torque_magnitude: T::ZERO,
            direction: 1,
            start: [0; 2],
            window_start: [0; 2],
            watches_output: false,
            motion_sign: 0,
            window_travel: 0,
            torque: T::ZERO,
        }
    }

    /// Verdicts so far.
    pub fn wiring(&self) -> Wiring<T> {
        self.judge.wiring()
    }

    /// Runs one control period. Returns the torque to command next, at most `allowed` [N m], and the progress. The
    /// torque is zero once the check has ended.
    pub fn step(&mut self, samples: &Samples<T>, allowed: T) -> (T, WiringProgress<T>) {
        let is_new = self.judge.step(samples);
        self.total = self.total.saturating_add(1);
        if self.is_running() && self.total > self.table.longest {
            self.state = State::Refused(WiringRefusal::TooLong);
        }
        let smaller = |one: T, other: T| if one < other { one } else { other };
        // The comparison also turns NaN into zero.
        let allowed = if allowed > T::ZERO { smaller(allowed, self.table.torque_limit) } else { T::ZERO };
        if is_new && self.is_running() {
            self.advance(allowed);
        }
        self.torque_magnitude = smaller(self.torque_magnitude, allowed);
        let progress = match self.state {
            State::Done => WiringProgress::Done(self.judge.wiring()),
            State::Refused(refusal) => WiringProgress::Refused(refusal),
            State::Rest => {
                self.torque = T::ZERO;
                return (T::ZERO, WiringProgress::Running);
            }
            State::Push | State::Brake => {
                self.torque = T::from_i32(self.direction) * self.torque_magnitude;
                return (self.torque, WiringProgress::Running);
            }
        };
        self.torque = T::ZERO;
        (T::ZERO, progress)
    }

    fn is_running(&self) -> bool {
        matches!(self.state, State::Rest | State::Push | State::Brake)
    }

    fn advance(&mut self, allowed: T) {
        let positions = [self.judge.motor.position, self.judge.output.position];
        if self.is_far(positions, self.table.limit) {
            self.state = State::Refused(WiringRefusal::TooFar);
            return;
        }
        self.periods = self.periods.saturating_add(1);
        match self.state {
            State::Rest => self.rest(positions),
            State::Push => self.push(positions, allowed),
            State::Brake => self.brake(positions),
            State::Done | State::Refused(_) => {}
        }
    }

    /// Returns true if the travel of the joint has reached a limit. Wrong counts per turn overstate or understate a
    /// travel, so that the geometric mean of both travels decides; it is right even for exchanged encoders. A motor
    /// without an output encoder or with a stationary output has its own limit.
    fn is_far(&self, travel: [i64; 2], limit: [u32; 2]) -> bool {
        let [motor, output] = travel.map(|counts| counts.unsigned_abs().min(MAX_COUNTS));
        let [motor_limit, output_limit] = limit.map(u64::from);
        let stands = [motor, output].map(|counts| counts <= JUDGE.min_motion.unsigned_abs());
        let alone = (stands[1] && motor >= motor_limit) || (stands[0] && output >= output_limit);
        let both = motor.saturating_mul(output) >= motor_limit.saturating_mul(output_limit);
        alone || both || motor >= motor_limit.saturating_mul(CHECK.unmatched_travel_factor)
    }

    fn enter(&mut self, state: State, positions: [i64; 2]) {
        self.state = state;
        (self.periods, self.held_periods, self.window) = (0, 0, 0);
        (self.start, self.window_start) = (positions, positions);
    }

    fn rest(&mut self, positions: [i64; 2]) {
        if self.periods < self.table.rest {
            return;
        }
        let travel = difference(positions, self.start);
        let is_creeping = |shaft: usize| {
            let max_creep =
                CHECK.rest_flicker.saturating_add(i64::from(of_shaft(self.table.leg, shaft) >> CHECK.creep_shift));
            of_shaft(travel, shaft).saturating_abs() > max_creep
        };
        let watched = usize::from(self.watches_output);
        if self.leg == 0 && self.motion_sign == 0 {
            if is_creeping(0) || is_creeping(1) {
                self.state = State::Refused(WiringRefusal::NotAtRest);
                return;
            }
        } else if is_creeping(watched) && self.brakings > 0 {
            // A shaft still moves: brake it, with the torque direction that the leg has shown.
            self.brakings -= 1;
            let motion = of_shaft(travel, watched).signum();
            if motion != self.motion_sign {
                self.direction = -self.direction;
            }
            self.motion_sign = motion;
            self.torque_magnitude *= T::QUARTER;
            let windows = i64::from(self.table.rest.checked_div(self.table.window).unwrap_or(1).max(1));
            self.window_travel = of_shaft(travel, watched).saturating_abs().checked_div(windows).unwrap_or(0);
            self.enter(State::Brake, positions);
            return;
        } else if self.leg >= CHECK.legs {
            self.state = State::Done;
            return;
        }
        self.direction = if self.leg & 1 == 0 { 1 } else { -1 };
        self.leg += 1;
        self.torque_magnitude = T::ZERO;
        self.brakings = CHECK.brakings;
        self.enter(State::Push, positions);
    }

    fn push(&mut self, positions: [i64; 2], allowed: T) {
        self.torque_magnitude += self.table.rise;
        if self.torque_magnitude >= allowed {
            self.torque_magnitude = allowed;
            self.held_periods = self.held_periods.saturating_add(1);
        }
        let travel = difference(positions, self.start);
        let is_far = self.is_far(travel, self.table.leg);
        let output_moved = of_shaft(travel, 1).saturating_abs() >= JUDGE.min_motion;
        let watched = usize::from(output_moved);
        let window_over = self.window_over();
        if window_over {
            self.window_travel = of_shaft(difference(positions, self.window_start), watched).saturating_abs();
            self.window_start = positions;
        }
        if is_far {
            self.watches_output = output_moved;
            self.motion_sign = of_shaft(travel, watched).signum();
            self.direction = -self.direction;
            self.enter(State::Brake, positions);
        } else if self.held_periods > self.table.hold {
            self.watches_output = output_moved;
            self.motion_sign = if self.motion_sign == 0 { 1 } else { self.motion_sign };
            self.brakings = 0;
            self.enter(State::Rest, positions);
        }
    }

    fn brake(&mut self, positions: [i64; 2]) {
        if !self.window_over() {
            return;
        }
        let travel_along = of_shaft(difference(positions, self.window_start), usize::from(self.watches_output))
            .saturating_mul(self.motion_sign);
        self.window_start = positions;
        let braked = travel_along <= (self.window_travel >> CHECK.stopped_shift).max(1);
        if braked || self.periods > self.table.hold {
            self.enter(State::Rest, positions);
        }
    }

    /// Counts a period of the window. Returns true in its last period.
    fn window_over(&mut self) -> bool {
        self.window += 1;
        let over = self.window >= self.table.window;
        if over {
            self.window = 0;
        }
        over
    }
}

fn of_shaft<V: Copy + Default>(of_shafts: [V; 2], shaft: usize) -> V {
    of_shafts.get(shaft).copied().unwrap_or_default()
}
