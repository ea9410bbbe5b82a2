//! Judge of the wiring: derives verdicts from raw counts, times and torques of any motion.
//!
//! **Important terms**
//!
//! - `F`, the angle factor: motor angle over the ratio, divided by the output angle, with the tables' counts. `F` is 1
//!   for correct wiring. `F` is the slope of motor over output angle, with the direction of motion as second regressor;
//!   the step of this regressor is half of the lost motion, by which the motor leads (`line.rs`).
//! - `A_m`, `A_o`: change of speed of motor and output per unit of torque, the slopes of second differences of their
//!   angles over torque, with the direction (dry friction) as second regressor. Over two neighbouring blocks of the
//!   length `L`
//!
//!   `x(k+1) - 2 x(k) + x(k-1) = integral of w(t) a(t) dt` (2)
//!
//! where `w` rises over the first block from 0 to `L` and falls over the second; torque is weighted alike.
//! - `G = J_m A_m + (J_l/r) A_o`, the torque factor: momentum per unit of torque, with or without contact of the teeth.
//!   `G` is 1 for correct wiring.
//!
//! The signs of `A_m` and `F` distinguish three reversals if only one of the three is reversed:
//!
//! | `A_m` | `F` | reversed |
//! |---|---|---|
//! | + | + | nothing, or all three |
//! | + | - | output encoder |
//! | - | + | torque |
//! | - | - | motor encoder |
//!
//! An `F` of 2^k means an encoder with other bits than the tables. The encoder whose correction brings `G` nearer to 1
//! is blamed.

use super::line::{Fit, Line};
use super::tables::WiringTable;
use super::thresholds::JUDGE;
use super::track::{Track, difference};
use super::verdict::{Wiring, WiringItem, WiringVerdict};
use crate::numbers::Real;
use crate::observer::Samples;

/// State that a block passes to the next block.
#[derive(Debug, Clone, Copy, Default)]
struct BlockState<T: Real> {
    /// Positions at the end of the block.
    ends: [i64; 2],
    /// Travel in the block [counts].
    travel: [i64; 2],
    /// Torque, weighted from 0 at the beginning to 1 at the end of the block, times its periods [N m].
    rise: T,
    direction: i32,
    /// `sign`: sign of the torque if constant over the block, otherwise 0. `same_sign_blocks`: consecutive blocks with
    /// this sign.
    sign: i32,
    same_sign_blocks: u8,
}

/// Magnitude of the angle factor `F` with its tolerance, and whether both are known well enough to judge.
struct AngleFactor<T: Real> {
    size: T,
    is_sure: bool,
    tolerance: T,
}

impl<T: Real> AngleFactor<T> {
    /// Returns true if the factor has an expected magnitude.
    fn matches(&self, expected: T) -> bool {
        self.is_sure && (self.size - expected).abs() <= self.tolerance * expected
    }
}

/// Judge of the wiring of one joint.
///
/// Log of a joint whose output encoder counts in the wrong direction:
///
/// ```
/// use model_core::gears::{Tables, design::design};
/// use model_core::observer::design::observer_settings;
/// use model_core::wiring::{WiringVerdict, WiringItem, WiringJudge};
/// use model_core::virtual_joint::{VirtualJoint, design::design_surroundings};
/// use model_core::wiring::design::design_wiring;
///
/// let q1 = joint_file::read(joint_file::preset("q1").unwrap()).unwrap();
/// let gears: Tables<f32, 3> = design(&q1.parameters, q1.surroundings.control_rate)?;
/// let around = design_surroundings(&q1.parameters, &q1.surroundings, &gears)?;
/// let table = design_wiring(&q1.parameters, &observer_settings(&q1.surroundings))?;
/// let (mut joint, mut judge) = (VirtualJoint::new(&gears, &around), WiringJudge::<f32>::new(&table));
/// for period in 0..20_000 {
///     let mut samples = joint.samples();
///     let output = samples.output.as_mut().unwrap();
///     output.counts = (1 << 17) - 1 - output.counts;
///     judge.step(&samples);
///     joint.advance(0.5 * (12.6 * 1e-4 * period as f32).cos(), 0.0);
/// }
/// let wiring = judge.wiring();
/// assert_eq!(wiring.verdict(WiringItem::OutputDirection), WiringVerdict::Wrong(-1.0), "{wiring}");
/// assert_eq!(wiring.verdict(WiringItem::MotorDirection), WiringVerdict::Right, "{wiring}");
/// # Ok::<(), model_core::gears::design::DesignError>(())
/// ```
#[derive(Debug, Clone)]
pub struct WiringJudge<'tables, T: Real> {
    table: &'tables WiringTable<T>,
    began: bool,
    time: u32,
    motor_time: u32,
    /// Calls; calls that repeat the last samples; calls a period apart; calls with an old motor reading.
    calls: u32,
    repeated_calls: u32,
    timely_calls: u32,
    stale_calls: u32,
    /// Calls after a short interval, and the ticks of these intervals.
    short_calls: u32,
    short_ticks: u64,
    pub(super) motor: Track,
    pub(super) output: Track,
    largest_torque: T,
    /// Periods in this block, sum of the torque, and sum of the torque weighted from 0 at the beginning to 1 at the
    /// end.
    periods: u32,
    torque: T,
    rise: T,
    sign: i32,
    block: BlockState<T>,
    /// Closed blocks.
    blocks: u8,
    angles: Line<T>,
    /// Second differences of both angles over torque.
    responses: Line<T>,
    /// Second differences over torque in blocks after `JUDGE.same_sign_blocks` blocks with a torque of one sign.
    one_sign_responses: Line<T>,
    /// Positions of the last standstill, until a shaft has moved.
    standstill: Option<[i64; 2]>,
    /// Number of starts with the motor, and with the output, moving first.
    leads: [u16; 2],
    /// Starts of the motor with and against the torque.
    starts: [u16; 2],
}

impl<'tables, T: Real> WiringJudge<'tables, T> {
    /// Creates a judge without samples.
    pub fn new(table: &'tables WiringTable<T>) -> Self {
        Self {
            table,
            began: false,
            time: 0,
            motor_time: 0,
            calls: 0,
            repeated_calls: 0,
            timely_calls: 0,
            stale_calls: 0,
            short_calls: 0,
            short_ticks: 0,
            motor: Track::default(),
            output: Track::default(),
            largest_torque: T::ZERO,
            periods: 0,
            torque: T::ZERO,
            rise: T::ZERO,
            sign: 0,
            block: BlockState::default(),
            blocks: 0,
            angles: Line::default(),
            responses: Line::default(),
            one_sign_responses: Line::default(),
            standstill: None,
            leads: [0; 2],
            starts: [0; 2],
        }
    }

    /// Adds the samples of one control period. Returns true if they are new.
    pub fn step(&mut self, samples: &Samples<T>) -> bool {
        if !self.check_times(samples) {
            return false;
        }
        self.motor.add_counts(&self.table.counts.motor, samples.motor.counts);
        if let Some(output) = samples.output.filter(|_| self.table.counts.has_output) {
            self.output.add_counts(&self.table.counts.output, output.counts);
        }
        // The comparison is also false for NaN.
        let is_plausible = samples.torque.abs() <= T::TWO * self.table.torque_limit;
        let torque = if is_plausible { samples.torque } else { T::ZERO };
        if torque.abs() > self.largest_torque {
            self.largest_torque = torque.abs();
        }
        let sign = if torque > T::ZERO {
            1
        } else if torque < T::ZERO {
            -1
        } else {
            0
        };
        self.sign = if self.periods == 0 || sign == self.sign { sign } else { 0 };
        self.torque += torque;
        self.rise += torque * (T::from_i32(self.periods as i32) + T::HALF) * self.table.per_block;
        self.record_lead();
        self.periods += 1;
        if self.periods >= self.table.block {
            self.close_block();
        }
        true
    }

    /// Notes the times of a call. Returns true if its samples are new.
    fn check_times(&mut self, samples: &Samples<T>) -> bool {
        let clock = &self.table.clock;
        let elapsed = samples.time.wrapping_sub(core::mem::replace(&mut self.time, samples.time));
        let motor_elapsed =
            samples.motor.time.wrapping_sub(core::mem::replace(&mut self.motor_time, samples.motor.time));
        if !core::mem::replace(&mut self.began, true) {
            return true;
        }
        self.calls = self.calls.saturating_add(1);
        if elapsed == 0 {
            self.repeated_calls = self.repeated_calls.saturating_add(1);
            return false;
        }
        let quarter = clock.period >> 2;
        if elapsed.abs_diff(clock.period) <= quarter {
            self.timely_calls = self.timely_calls.saturating_add(1);
        }
        if elapsed <= clock.oldest {
            self.short_calls = self.short_calls.saturating_add(1);
            self.short_ticks = self.short_ticks.saturating_add(elapsed.into());
        }
        let age = (samples.time.wrapping_sub(samples.motor.time) as i32).unsigned_abs();
        if motor_elapsed == 0 || age > clock.oldest {
            self.stale_calls = self.stale_calls.saturating_add(1);
        }
        true
    }

    /// Notes which shaft moves first from a standstill: its travel would have moved the other shaft if the other had
    /// followed.
    fn record_lead(&mut self) {
        let Some([motor_from, output_from]) = self.standstill else { return };
        let motor = self.motor.position.saturating_sub(motor_from).saturating_abs();
        let output = self.output.position.saturating_sub(output_from).saturating_abs();
        let [motor_leads, output_leads] = self.table.leads.map(i64::from);
        if motor >= motor_leads || output >= output_leads {
            self.standstill = None;
            let [by_motor, by_output] = &mut self.leads;
            if output <= JUDGE.flicker && motor >= motor_leads {
                *by_motor = by_motor.saturating_add(1);
            } else if motor <= JUDGE.flicker && output >= output_leads {
                *by_output = by_output.saturating_add(1);
            }
        }
    }

    fn close_block(&mut self) {
        let table = self.table;
        let before = self.block;
        let ends = [self.motor.position, self.output.position];
        let travel = difference(ends, before.ends);
        let [motor, output] = travel.map(motion_sign);
        let direction = if motor == 0 { output } else { motor };
        if travel.iter().all(|by| by.saturating_abs() < JUDGE.min_block_travel) && table.counts.has_output {
            self.standstill = Some(ends);
        }
        let rise = core::mem::replace(&mut self.rise, T::ZERO);
        let sum = core::mem::replace(&mut self.torque, T::ZERO);
        self.periods = 0;
        let same_sign_blocks =
            if self.sign != 0 && self.sign == before.sign { before.same_sign_blocks.saturating_add(1) } else { 1 };
        self.block = BlockState { ends, travel, rise, direction, sign: self.sign, same_sign_blocks };
        self.blocks = self.blocks.saturating_add(1);
        if self.blocks < 2 {
            return;
        }
        let torque = (before.rise + (sum - rise)) * table.per_block;
        if motor != 0 && before.direction == 0 {
            self.record_start(torque, motor);
        }
        // A motor that moves alone winds up or crosses the gap: the effect of torque on the joint is not visible.
        let alone = table.counts.has_output && (motor == 0 || output == 0);
        if !alone && direction != 0 && direction == before.direction {
            self.add_response(torque, difference(travel, before.travel));
        }
    }

    /// Records a start of the motor, with or against the torque.
    fn record_start(&mut self, torque: T, motor_sign: i32) {
        let against = usize::from((torque > T::ZERO) != (motor_sign > 0));
        if let Some(starts) = self.starts.get_mut(against).filter(|_| torque.abs() > T::ZERO) {
            *starts = starts.saturating_add(1);
        }
    }

    /// Adds the second difference of both positions [counts] under a torque to the lines of responses, and the present
    /// angles to the line of angles.
    fn add_response(&mut self, torque: T, second_difference: [i64; 2]) {
        let counts = &self.table.counts;
        let side = T::from_i32(self.block.direction);
        let angles = [counts.motor.angle, counts.output.angle];
        let [motor, output] = second_difference.map(T::from_i64);
        let response = [angles[0] * motor, angles[1] * output];
        self.responses.add(torque, side, response);
        if self.block.same_sign_blocks >= JUDGE.same_sign_blocks {
            self.one_sign_responses.add(torque, side, response);
        }
        if counts.has_output {
            let [motor, output] = self.block.ends;
            let y = angles[0] * self.table.per_ratio * T::from_i64(motor);
            self.angles.add(angles[1] * T::from_i64(output), side, [y, T::ZERO]);
        }
    }

    /// Verdicts on all samples so far.
    pub fn wiring(&self) -> Wiring<T> {
        let table = self.table;
        let mut wiring = Wiring { has_output: table.counts.has_output, ..Wiring::default() };
        self.judge_times(&mut wiring);
        let has_output = table.counts.has_output;
        let spans = [self.motor.span(), self.output.span()];
        let [motor_moved, output_moved] = spans.map(|span| span >= JUDGE.min_motion);
        let motor_travel = table.counts.motor.angle * table.per_ratio * T::from_i64(spans[0]);
        let output_travel = table.counts.output.angle * T::from_i64(spans[1]);
        self.judge_ranges(&mut wiring);
        if motor_moved || output_moved {
            wiring.set(WiringItem::Motion, WiringVerdict::Right);
        } else if self.largest_torque > T::ZERO {
            wiring.set(WiringItem::Motion, WiringVerdict::Wrong(table.friction));
        }
        if has_output && spans[1] <= JUDGE.flicker && motor_travel > table.play {
            wiring.set(WiringItem::OutputCounts, WiringVerdict::Wrong(T::ZERO));
        }
        if has_output && spans[0] <= JUDGE.flicker && output_travel > table.play {
            // Exchanged encoders with a motor that only crosses its gap look like this, too.
            let exchanged = table.counts.motor.angle * table.per_ratio * T::from_i64(spans[1]) < table.play;
            let standstill_verdict =
                if exchanged { WiringVerdict::Suspect(T::ZERO) } else { WiringVerdict::Wrong(T::ZERO) };
            wiring.set(WiringItem::MotorCounts, standstill_verdict);
            wiring.set(WiringItem::Places, if exchanged { standstill_verdict } else { WiringVerdict::NotSeen });
        }
        let fit = self.angles.fit([T::ONE, T::ZERO]).filter(|_| motor_moved && output_moved && has_output);
        let output_sign = fit.map_or(0, |fit| fit.sign());
        judge_directions(&mut wiring, self.drive_sign(output_sign), output_sign, has_output);
        // As in the check, wrong counts per turn overstate or understate a travel.
        let travel = (motor_travel * output_travel).square_root();
        let tolerance = table.ratio_tolerance + table.slack / at_least_smallest(travel);
        let angles_agree = motor_moved && output_moved && has_output && {
            let fit = fit.unwrap_or_default();
            let tolerance = tolerance + T::FOUR * (fit.deviation / at_least_smallest(fit.slope.abs()));
            self.judge_factor(&mut wiring, &fit, tolerance, [motor_travel, output_travel])
        };
        if angles_agree || !has_output {
            self.judge_torque(&mut wiring, output_sign);
        }
        wiring
    }

    fn judge_times(&self, wiring: &mut Wiring<T>) {
        let new = self.calls.saturating_sub(self.repeated_calls);
        if self.calls < JUDGE.min_calls {
            return;
        }
        let count = |number: u32| T::from_i64(number.into());
        let repeated = self.repeated_calls > self.calls >> 2;
        let calls = WiringVerdict::Wrong(count(self.calls) / count(new.max(1)));
        wiring.set(WiringItem::Calls, if repeated { calls } else { WiringVerdict::Right });
        if new < JUDGE.min_calls >> 1 {
            return;
        }
        let mostly = |part: u32| part >= new.saturating_sub(new >> 2);
        wiring.set(
            WiringItem::MotorTime,
            if mostly(self.stale_calls) { WiringVerdict::Wrong(T::ZERO) } else { WiringVerdict::Right },
        );
        if mostly(self.timely_calls) {
            wiring.set(WiringItem::Period, WiringVerdict::Right);
            wiring.set(WiringItem::Clock, WiringVerdict::Right);
            return;
        }
        let found = self.measured_period();
        wiring.set(WiringItem::Period, WiringVerdict::Suspect(found));
        wiring.set(WiringItem::Clock, WiringVerdict::Suspect(found));
    }

    /// Mean time between calls over the control period [-].
    fn measured_period(&self) -> T {
        let ticks = T::from_i64(self.short_ticks.min(i64::MAX as u64) as i64);
        let periods = T::from_i64(self.short_calls.into()) * T::from_i64(self.table.clock.period.into());
        ticks / at_least_smallest(periods)
    }

    /// Judges raw counts beyond the range of the tables: the encoder's true counts per turn are a larger power of two.
    fn judge_ranges(&self, wiring: &mut Wiring<T>) {
        let counts = &self.table.counts;
        for (item, track, table) in [
            (WiringItem::MotorCounts, &self.motor, &counts.motor),
            (WiringItem::OutputCounts, &self.output, &counts.output),
        ] {
            if track.largest_out_of_range > 0 {
                let turn =
                    u64::from(track.largest_out_of_range).saturating_add(1).checked_next_power_of_two().unwrap_or(0);
                let found = turn.max(u64::from(table.turn)) as i64;
                wiring.set(item, WiringVerdict::Wrong(T::from_i64(found)));
            }
        }
    }

    /// Direction of the motor under a positive torque; 0 if unknown. `output_sign` is the direction of the output
    /// relative to the motor.
    fn drive_sign(&self, output_sign: i32) -> i32 {
        let [motor, output] = [[T::ONE, T::ZERO], [T::ZERO, T::ONE]].map(|weights| self.responses.fit(weights));
        // The output's response is more regular: the motor also crosses the gap.
        let by_output = output.map_or(0, |fit| output_sign * fit.sign());
        if by_output != 0 {
            return by_output;
        }
        let by_motor = motor.map_or(0, |fit| fit.sign());
        if by_motor != 0 {
            return by_motor;
        }
        match self.starts {
            [with, 0] if with >= 2 => 1,
            [0, against] if against >= 2 => -1,
            _ => 0,
        }
    }

    /// Judges ratio, counts and places by the angle factor. Returns true if the angles agree with the tables.
    fn judge_factor(&self, wiring: &mut Wiring<T>, fit: &Fit<T>, tolerance: T, travels: [T; 2]) -> bool {
        let bad = [WiringItem::MotorCounts, WiringItem::OutputCounts].map(|item| wiring.verdict(item).is_bad());
        let factor =
            AngleFactor { size: fit.slope.abs(), is_sure: fit.sign() != 0 && tolerance < T::QUARTER, tolerance };
        // The true travel may be half of the apparent one, and counts beyond their range can only mean wrong bits.
        let power_tolerance =
            if bad == [false; 2] && tolerance < T::EIGHTH { tolerance + tolerance } else { T::QUARTER };
        let power = if factor.is_sure { matching_power_of_two(factor.size, power_tolerance) } else { None };
        let blamed_motor = power.and_then(|power| self.blamed_encoder(power, fit.sign(), bad));
        let exchange = self.exchange();
        let [motor_travel, output_travel] = travels;
        let travel_ratio = motor_travel / at_least_smallest(output_travel);
        let resembles_exchange = factor_from_one(travel_ratio / at_least_smallest(exchange * exchange)) < T::THREE;
        let explained = power.filter(|_| blamed_motor.is_some());
        if resembles_exchange && self.are_exchanged(fit, &factor, exchange, power, explained) {
            wiring.set(WiringItem::Places, WiringVerdict::Wrong(T::ZERO));
            // Counts of the other encoder are no evidence on an encoder's own range.
            wiring.set(WiringItem::MotorCounts, WiringVerdict::NotSeen);
            wiring.set(WiringItem::OutputCounts, WiringVerdict::NotSeen);
            return false;
        }
        if !factor.is_sure {
            self.suspect_counts(wiring, travel_ratio, resembles_exchange, motor_travel, output_travel);
            return false;
        }
        wiring.set(WiringItem::Places, WiringVerdict::Right);
        if factor.matches(T::ONE) {
            for item in [WiringItem::Ratio, WiringItem::MotorCounts, WiringItem::OutputCounts] {
                if !wiring.verdict(item).is_bad() {
                    wiring.set(item, WiringVerdict::Right);
                }
            }
            return bad == [false; 2];
        }
        match power {
            Some(power) => self.judge_counts(wiring, power, blamed_motor),
            None => wiring.set(WiringItem::Ratio, WiringVerdict::Wrong(self.table.ratio * factor.size)),
        }
        false
    }

    /// Reading of the motor over its angle with exchanged encoders [-]: the motor's place reads output turns times
    /// output counts, and vice versa. The angle factor is then the square.
    fn exchange(&self) -> T {
        let counts = &self.table.counts;
        let [motor_turn, output_turn] = [&counts.motor, &counts.output].map(|encoder| T::from_i64(encoder.turn.into()));
        (output_turn / at_least_smallest(motor_turn)) * self.table.per_ratio
    }

    /// Returns true if motor and output encoder are exchanged: the motor's place lags, the output's place leads, or no
    /// other fault explains the angle factor. `explained` is the power of two that one encoder's bits explain.
    fn are_exchanged(
        &self,
        fit: &Fit<T>,
        factor: &AngleFactor<T>,
        exchange: T,
        power: Option<T>,
        explained: Option<T>,
    ) -> bool {
        let (size, lost_motion) = (factor.size, self.table.lost_motion);
        let exchanged = exchange * exchange;
        let smaller = if size < T::ONE { size } else { T::ONE };
        let motor_leads = fit.step > T::EIGHTH * smaller * lost_motion && fit.step > T::FOUR * fit.step_deviation;
        if motor_leads {
            return false;
        }
        let motor_lags = fit.step < -T::EIGHTH * exchange * lost_motion && -fit.step > T::FOUR * fit.step_deviation;
        let [by_motor, by_output] = self.leads;
        let output_leads = by_output >= 2 && by_output > by_motor;
        let no_other = factor.matches(exchanged) && !factor.matches(T::ONE) && power.is_none() && by_output >= by_motor;
        // Leads decide if bits do not explain the angles, explain them less well, or point to neither encoder.
        let bits_explain = explained
            .is_some_and(|power| factor_from_one(size / power) <= factor_from_one(size / at_least_smallest(exchanged)));
        motor_lags || (output_leads && !bits_explain) || no_other
    }

    /// Judges the counts per turn for an angle factor of a power of two.
    fn judge_counts(&self, wiring: &mut Wiring<T>, power: T, blamed_motor: Option<bool>) {
        let counts = &self.table.counts;
        let [motor_turn, output_turn] = [&counts.motor, &counts.output].map(|encoder| T::from_i64(encoder.turn.into()));
        let (of_motor, of_output) = (motor_turn * power, output_turn / power);
        let [motor, output] = match blamed_motor {
            Some(true) => [WiringVerdict::Wrong(of_motor), WiringVerdict::Right],
            Some(false) => [WiringVerdict::Right, WiringVerdict::Wrong(of_output)],
            None => [WiringVerdict::Suspect(of_motor), WiringVerdict::Suspect(of_output)],
        };
        wiring.set(WiringItem::MotorCounts, motor);
        wiring.set(WiringItem::OutputCounts, output);
    }

    /// Judges travels that do not match at all and have no fitted line: counts are wrong, or encoders are exchanged.
    fn suspect_counts(
        &self,
        wiring: &mut Wiring<T>,
        travel_ratio: T,
        resembles_exchange: bool,
        motor_travel: T,
        output_travel: T,
    ) {
        let counts = &self.table.counts;
        let larger_travel = if motor_travel > output_travel { motor_travel } else { output_travel };
        if larger_travel < self.table.play || factor_from_one(travel_ratio) < T::THREE {
            return;
        }
        let turns = [&counts.motor, &counts.output].map(|encoder| T::from_i64(encoder.turn.into()));
        let [motor, output] =
            [turns[0] * travel_ratio, turns[1] / at_least_smallest(travel_ratio)].map(WiringVerdict::Suspect);
        wiring.set(WiringItem::MotorCounts, motor);
        wiring.set(WiringItem::OutputCounts, output);
        if resembles_exchange {
            wiring.set(WiringItem::Places, WiringVerdict::Suspect(T::ZERO));
        }
    }

    /// Finds the encoder to blame for an angle factor of a power of two: true for the motor's, false for the output's.
    fn blamed_encoder(&self, power: T, output_sign: i32, [motor_beyond, output_beyond]: [bool; 2]) -> Option<bool> {
        if motor_beyond != output_beyond {
            return Some(motor_beyond);
        }
        if (self.motor.wrapped_at > 0) != (self.output.wrapped_at > 0) {
            return Some(self.motor.wrapped_at > 0);
        }
        let motor = factor_from_one(self.momentum(
            &self.responses,
            [T::ONE / at_least_smallest(power), T::ONE],
            output_sign,
        )?);
        let output = factor_from_one(self.momentum(&self.responses, [T::ONE, power], output_sign)?);
        let smaller = if motor < output { motor } else { output };
        (smaller < self.table.torque_factor).then_some(motor < output)
    }

    /// Momentum per unit of torque, if the angles of motor and output are wrong by the factors given and the output
    /// moves in the direction `output_sign` relative to the motor; `None` if known no better than within a quarter.
    fn momentum(&self, line: &Line<T>, [motor, output]: [T; 2], output_sign: i32) -> Option<T> {
        let table = self.table;
        let [of_motor, of_output] = table.impulse;
        let weights = if table.counts.has_output {
            [of_motor * motor, of_output * output * T::from_i32(if output_sign < 0 { -1 } else { 1 })]
        } else {
            [of_motor + of_output * table.per_ratio, T::ZERO]
        };
        let fit = line.fit(weights)?;
        (fit.deviation < T::QUARTER * fit.slope.abs()).then_some(fit.slope.abs())
    }

    /// Judges the torque or, with wrong times, decides between rate and clock.
    fn judge_torque(&self, wiring: &mut Wiring<T>, output_sign: i32) {
        let known =
            [&self.responses, &self.one_sign_responses].map(|line| self.momentum(line, [T::ONE; 2], output_sign));
        if known == [None; 2] {
            return;
        }
        // Friction, weight and the gap disturb the two lines differently: only an error of both lines counts.
        let nearest = |expected: T| {
            let off = |factor: T| factor_from_one(factor / at_least_smallest(expected));
            let nearer = |one: T, other: T| if off(one) <= off(other) { one } else { other };
            match known {
                [Some(all), Some(one_sign_responses)] => nearer(all, one_sign_responses),
                [all, one_sign_responses] => all.or(one_sign_responses).unwrap_or(expected),
            }
        };
        let WiringVerdict::Suspect(period) = wiring.verdict(WiringItem::Period) else {
            if wiring.verdict(WiringItem::Period) == WiringVerdict::Right {
                let found = nearest(T::ONE);
                let is_right = factor_from_one(found) < self.table.torque_factor;
                wiring.set(
                    WiringItem::TorqueScale,
                    if is_right { WiringVerdict::Right } else { WiringVerdict::Wrong(found) },
                );
            }
            return;
        };
        // Calls in truth `period` apart see accelerations times its square; a wrong clock alone changes nothing.
        let square = period * period;
        let by_clock = factor_from_one(nearest(T::ONE));
        let by_rate = factor_from_one(nearest(square) / at_least_smallest(square));
        let smaller = if by_clock < by_rate { by_clock } else { by_rate };
        if smaller < self.table.torque_factor {
            let (rate, clock) = (WiringItem::Period, WiringItem::Clock);
            let (right, wrong) = if by_clock < by_rate { (rate, clock) } else { (clock, rate) };
            wiring.set(right, WiringVerdict::Right);
            wiring.set(wrong, WiringVerdict::Wrong(period));
        }
    }
}

/// Judges the three directions by the signs of the motor's response to torque and of the output's motion relative to
/// the motor.
fn judge_directions<T: Real>(wiring: &mut Wiring<T>, motor_sign: i32, output_sign: i32, has_output: bool) {
    let (motor, output, torque) =
        (WiringItem::MotorDirection, WiringItem::OutputDirection, WiringItem::TorqueDirection);
    let wrong = WiringVerdict::Wrong(-T::ONE);
    let suspect = WiringVerdict::Suspect(-T::ONE);
    let [of_motor, of_output, of_torque] = match (motor_sign, output_sign) {
        (1, 1) => [WiringVerdict::Right; 3],
        (1, -1) => [WiringVerdict::Right, wrong, WiringVerdict::Right],
        (-1, 1) => [WiringVerdict::Right, WiringVerdict::Right, wrong],
        (-1, -1) => [wrong, WiringVerdict::Right, WiringVerdict::Right],
        (-1, _) => [suspect, WiringVerdict::NotSeen, suspect],
        (1, _) => [WiringVerdict::Right, WiringVerdict::NotSeen, WiringVerdict::Right],
        (_, -1) => [suspect, suspect, WiringVerdict::NotSeen],
        _ => [WiringVerdict::NotSeen; 3],
    };
    wiring.set(motor, of_motor);
    wiring.set(output, if has_output { of_output } else { WiringVerdict::NotSeen });
    wiring.set(torque, of_torque);
}

/// Sign of a block's travel [counts]; 0 for a travel that noise explains.
fn motion_sign(travel: i64) -> i32 {
    if travel >= JUDGE.min_block_travel {
        1
    } else if travel <= -JUDGE.min_block_travel {
        -1
    } else {
        0
    }
}

/// Limits a number to positive values for division.
fn at_least_smallest<T: Real>(value: T) -> T {
    if value > T::LEAST { value } else { T::LEAST }
}

/// Deviation of a positive number from 1 as a factor of at least 1.
fn factor_from_one<T: Real>(value: T) -> T {
    if value > T::ONE { value } else { T::ONE / at_least_smallest(value) }
}

/// Power of two other than 1 that matches the angle factor within the tolerance.
fn matching_power_of_two<T: Real>(size: T, tolerance: T) -> Option<T> {
    let (mut up, mut down) = (T::ONE, T::ONE);
    for _ in 0..JUDGE.max_bits {
        (up, down) = (up + up, down * T::HALF);
        if let Some(power) = [up, down].into_iter().find(|power| (size - *power).abs() <= tolerance * *power) {
            return Some(power);
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn factor_from_one_is_symmetric() {
        assert_eq!((factor_from_one(4.0_f32), factor_from_one(0.25_f32)), (4.0, 4.0));
        assert!(factor_from_one(0.0_f32).is_finite());
    }

    #[test]
    fn power_of_two_is_matched_within_tolerance() {
        assert_eq!(matching_power_of_two(4.3_f32, 0.1), Some(4.0));
        assert_eq!(matching_power_of_two(0.5_f32, 0.1), Some(0.5));
        assert_eq!(matching_power_of_two(1.0_f32, 0.1), None);
        assert_eq!(matching_power_of_two(64.0_f32, 0.1), None, "more than 5 bits");
    }

    #[test]
    fn signs_separate_three_reversals() {
        use WiringItem::{MotorDirection, OutputDirection, TorqueDirection};
        for (motor_sign, output_sign, wrong) in
            [(1, -1, OutputDirection), (-1, 1, TorqueDirection), (-1, -1, MotorDirection)]
        {
            let mut wiring = Wiring::<f32>::default();
            judge_directions(&mut wiring, motor_sign, output_sign, true);
            for item in [MotorDirection, OutputDirection, TorqueDirection] {
                assert_eq!(wiring.verdict(item).is_bad(), item == wrong, "{item:?}");
            }
        }
    }

    #[test]
    fn unknown_output_leaves_two_suspects() {
        let mut wiring = Wiring::<f32>::default();
        judge_directions(&mut wiring, -1, 0, true);
        assert_eq!(wiring.verdict(WiringItem::MotorDirection), WiringVerdict::Suspect(-1.0));
        assert_eq!(wiring.verdict(WiringItem::TorqueDirection), WiringVerdict::Suspect(-1.0));
        assert_eq!(wiring.verdict(WiringItem::OutputDirection), WiringVerdict::NotSeen);
    }
}
