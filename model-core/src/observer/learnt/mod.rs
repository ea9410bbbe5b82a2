//! Estimation of joint, encoder and motor parameters during motion: half-gap, offset, compliance, skew, transmission
//! error and error maps by one recursive least squares (`learner`); bias and friction of the motor (`bias`); cogging
//! (`cogging`); inertia of the link (`inertia`); variances of all parameters (`uncertainty`). Implements (O7), (O9) and
//! (O14).
//!
//! Estimation proceeds in learning intervals of a few control periods (`interval`). For each interval `travel` decides
//! between rest and crossing, and `flank` determines the flank of a rest. Intervals of rest are averaged (`block`);
//! `consistency` accepts or rejects their mean; `trusted` keeps the parameters of long agreement. Work that can wait is
//! done one task per period.

pub mod bias;
mod block;
mod co_motion;
mod cogging;
mod consistency;
mod flank;
pub mod fusion;
mod inertia;
mod interval;
mod last_rest;
pub mod learner;
pub(crate) mod places;
pub mod position_errors;
pub mod regressors;
mod travel;
mod trusted;
pub mod uncertainty;

use bias::Bias;
use block::{Block, Settled};
use cogging::Cogging;
use consistency::{Consistency, GATE, Off, Verdict};
use flank::Signs;
use fusion::{Fused, small};
use inertia::Inertia;
use interval::{Interval, Mean, Rest, Task, rests};
use last_rest::LastRest;
use learner::{Innovation, Learner};
use places::Places;
use position_errors::PositionErrors;
use regressors::{COMPLIANCE, ERROR, HALF_GAP, MAPPED, OFFSET, Regressors, SKEW, Touch};
use travel::{Travel, TravelDetector};
use trusted::Trusted;
use uncertainty::Uncertainty;

use crate::gears::{Flank, sign};
use crate::numbers::Real;
use crate::numbers::phase::sine_cosine;
use crate::observer::contact::by_position::ByPosition;
use crate::observer::filters::Filters;
use crate::observer::filters::load_side::LoadSide;
use crate::observer::sensors::Sensors;
use crate::observer::tables::{LearnerTable, ObserverTables};

/// Longest time over which the force of a rest is averaged [intervals].
const LONG_REST: u8 = 16;

/// Intervals well inside the gap after which the motor side's force estimate has decayed to zero.
const OPEN_AFTER: u8 = 3;

/// Intervals after the readmission of an encoder during which bias, friction, inertia and cogging are not estimated:
/// 0.5 s. The loop takes up to 0.15 s to bring the link back at full torque (measured, presets Q1, L1, C1 and D2, motor
/// encoder frozen or random for half a second), and the filters carry readings from before the fault declaration.
const PROBATION: u16 = 500;

/// Parameter estimator with its evidence. `P` is the number of parameters.
#[derive(Debug, Clone)]
pub struct Learnt<T: Real, const P: usize> {
    pub learner: Learner<T, P>,
    pub bias: Bias<T>,
    pub inertia: Inertia<T>,
    cogging: Cogging<T>,
    pub errors: PositionErrors<T, P>,
    pub uncertainty: Uncertainty<T>,
    interval: Interval<T>,
    travel: TravelDetector<T>,
    block: Block<T, P>,
    last_rest: LastRest<T, P>,
    consistency: Consistency,
    places: Places<T>,
    /// Intervals until forces update the estimates again.
    probation: u16,
    /// Parameters of the last trusted half-gap.
    trusted: Option<Trusted<T, P>>,
    /// Innovation that updates the parameters in the next period.
    weighed: Option<Innovation<T, P>>,
}

/// Result of a learning interval, before it updates an estimate.
#[derive(Debug, Clone, Copy)]
pub struct Reading<T: Real> {
    mean: Mean<T>,
    /// Sine and cosine of the mesh phase in the middle of the interval.
    pub mesh: [T; 2],
    /// Mean deflection less offset, skew and error maps [m].
    deflection: T,
    /// Transmission error in the middle of the interval [m].
    flank_shift: T,
    travel: Travel<T>,
    /// Flank of settled contact.
    pub flank: Option<Flank>,
    /// Standard deviation of the transmission error while the half-gap is unknown; 0 afterwards [m].
    unlearnt: T,
}

impl<T: Real> Reading<T> {
    /// Mean mesh force [N].
    pub fn force(&self) -> T {
        self.mean.force
    }
}

/// Outcome of a period's estimation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Outcome {
    /// Nothing that concerns other parts of the observer.
    Nothing,
    /// The values that hold until the next interval have changed.
    Concluded,
    /// The teeth seem to have grown, or the shafts to have turned against each other: the output encoder fails.
    EncoderFails,
}

impl<T: Real, const P: usize> Learnt<T, P> {
    /// Gain per interval of the filter for the steady mesh force [-]; its noise variance is that of a mean of seven
    /// intervals.
    const STEADY: T = T::QUARTER;

    /// Deviation of the transmission error, over the half-gap, above which rests on an unknown flank update the
    /// transmission error first [-]: the error could hide a crossing; see [`TravelDetector::tells_rest`].
    const HIDDEN: T = T::QUARTER;

    /// Remaining part of the error maps' blur once maps and half-gap are known [-].
    const BLUR_LEFT: T = T::EIGHTH;

    /// Distance from a flank within which the gap may no longer be open, over the half-gap [-]: teeth of a fast
    /// crossing land before the deflection shows it.
    const NEAR_FLANK: T = T::EIGHTH;

    /// Largest variation of the half-gap around the turn, over the half-gap [-]: worn gears vary by 30 %.
    const VARIES: T = T::THREE_EIGHTHS;

    /// Standard deviation added to a half-gap that differs at this place of the turn, over the half-gap [-]: the
    /// half-gap becomes invalid until a rest has shown it, and the gap coordinate stays valid.
    const LOOSENED: T = T::EIGHTH;

    /// Estimator whose largest parts have no tables yet: a copy of those parts would not fit on a small stack.
    #[inline(always)]
    pub fn unbegun(tables: &ObserverTables<T>) -> Self {
        Self {
            bias: Bias::new(&tables.contact),
            inertia: Inertia::new(&tables.inertia),
            cogging: Cogging::new(&tables.cogging),
            errors: PositionErrors::new(),
            uncertainty: Uncertainty::unbegun(),
            learner: Learner::unbegun(),
            interval: Interval::new(),
            travel: TravelDetector::new(),
            block: Block::new(),
            last_rest: LastRest::new(),
            consistency: Consistency::default(),
            places: Places::new(),
            probation: 0,
            trusted: None,
            weighed: None,
        }
    }

    /// Initialises the parts without tables.
    pub fn begin(&mut self, tables: &ObserverTables<T>) {
        self.learner.restart(&tables.learner);
        self.uncertainty.restart(tables, &self.learner);
    }

    /// Estimated half-gap [m] and compliance [m/N].
    pub fn shape(&self) -> [T; 2] {
        [self.learner.value(HALF_GAP), self.learner.value(COMPLIANCE)]
    }

    /// Variance of the half-gap at this place of the turn by its variation around the turn (O20) [m^2].
    pub fn variation(&self, tables: &ObserverTables<T>) -> T {
        self.places.variance(&tables.counts, self.learner.value(HALF_GAP))
    }

    /// Transmission error at a mesh phase given by sine and cosine [m].
    pub fn transmission_error(&self, mesh: &[T; 2]) -> T {
        mesh[0] * self.learner.value(ERROR) + mesh[1] * self.learner.value(ERROR + 1)
    }

    /// Combines motor and load side: deflection less offset, skew and maps (O7), and mesh force (O9).
    #[inline]
    pub fn fuse(
        &self,
        tables: &ObserverTables<T>,
        sensors: &Sensors,
        filters: &Filters<T>,
        both_encoders: bool,
    ) -> Fused<T> {
        let levers = &tables.levers;
        let (drive, load) = (&filters.drive, &filters.load);
        let (_, difference) = sensors.counts.used();
        let flank_shift = self.transmission_error(&self.errors.mesh);
        let measured = tables.counts.length * small(difference) + levers.sun * drive.ahead - levers.output * load.ahead;
        let lost = drive.taken * levers.per_sun;
        let direction = Bias::direction(&tables.contact, drive.speed);
        let net = lost - self.bias.at(direction);
        // Load-dependent losses are friction: they reduce the driving and increase the holding force.
        let loss = if net * direction > T::ZERO { tables.contact.loss_driving } else { tables.contact.loss_driven };
        let force = net + net * direction.abs() * loss;
        let rate = levers.sun * drive.speed - levers.output * load.speed;
        let travel = if rate.abs() > tables.contact.rate_deviation { rate * tables.contact.lag } else { T::ZERO };
        let link_speed = if both_encoders { load.speed } else { T::ZERO };
        let deflection = measured - self.deflection_beside_teeth(link_speed);
        Fused { flank_shift, measured, deflection, rate, travel, lost, direction, force }
    }

    /// Deflection by offset, skew and error maps now [m].
    fn deflection_beside_teeth(&self, link_speed: T) -> T {
        let plain = self.learner.value(OFFSET) + self.learner.value(SKEW) * link_speed;
        if P == MAPPED { plain + self.errors.errors[0] + self.errors.errors[1] } else { plain }
    }

    /// Position of a deflection in the gap, with the deflection's travel [m].
    pub fn position(&self, deflection: T, travel: T) -> ByPosition<T> {
        let [half_gap, _] = self.shape();
        let known = &self.uncertainty;
        ByPosition {
            deflection,
            travel,
            half_gap,
            blur: known.blur,
            near: known.near,
            stiffness: known.stiffness,
            weight: known.position_weight,
        }
    }

    /// Resets all variances and the last rest: the output encoder has returned at another offset.
    pub fn reopen(&mut self, tables: &ObserverTables<T>) {
        self.learner.reopen();
        self.weighed = None;
        self.last_rest = LastRest::new();
        self.find_uncertainty(tables, true);
    }

    /// Restores the trusted parameters after an exclusion of the output encoder, if the half-gap has been doubted
    /// since. Returns true if it restored them.
    pub fn return_to_trusted(&mut self, tables: &ObserverTables<T>) -> bool {
        let Some(trusted) = self.trusted.filter(|_| !self.consistency.is_trusted()) else { return false };
        trusted.restore(&mut self.learner);
        self.weighed = None;
        self.find_uncertainty(tables, false);
        self.uncertainty.of_learnt(tables, &self.learner, self.trusted.is_some());
        true
    }

    /// Resets cogging, offset and motor map: the motor encoder has returned at another offset.
    pub fn doubt_motor(&mut self, tables: &ObserverTables<T>) {
        self.trusted = None;
        self.weighed = None;
        self.cogging = Cogging::new(&tables.cogging);
        self.learner.doubt_motor();
        self.find_uncertainty(tables, true);
    }

    /// Pauses the estimation from forces after an exclusion, until the loop has settled after the return.
    pub fn lose_encoder(&mut self) {
        self.probation = PROBATION;
    }

    /// Discards the open interval and the last rest: readings have broken off.
    pub fn interrupt(&mut self) {
        self.interval = Interval::new();
        self.travel = TravelDetector::new();
        self.block = Block::new();
        self.last_rest = LastRest::new();
        self.weighed = None;
    }

    /// Computes exactly all position-dependent parts of the deflection: regressors of an open gap, and sine and cosine
    /// of the mesh phase.
    pub fn find_errors(
        &mut self,
        tables: &ObserverTables<T>,
        sensors: &Sensors,
        filters: &Filters<T>,
        both_encoders: bool,
    ) -> (Regressors<T, P>, [T; 2]) {
        let table = &tables.counts;
        let (output, _) = sensors.counts.used();
        let link_speed = if both_encoders { filters.load.speed } else { T::ZERO };
        let output_phase = output.phase(&table.output);
        let motor_phase = sensors.counts.motor.phase(&table.motor);
        let free = regressors::free(link_speed, motor_phase, both_encoders.then_some(output_phase));
        let (sine, cosine) = sine_cosine(output_phase.wrapping_mul(table.meshes));
        let mesh = [sine, cosine];
        self.errors.put(&self.learner, &free, mesh);
        (free, mesh)
    }

    /// Adds a period to the interval.
    #[inline]
    pub fn add(&mut self, fused: &Fused<T>) {
        self.interval.add(fused);
    }

    /// Returns true in the middle period of the interval.
    pub fn in_the_middle(&self, table: &LearnerTable<T>) -> bool {
        self.interval.periods == table.middle
    }

    /// Returns true in the last period of the interval.
    pub fn at_the_end(&self, table: &LearnerTable<T>) -> bool {
        self.interval.periods >= table.periods
    }

    /// Returns true while tasks of the last interval are left.
    pub fn has_work(&self) -> bool {
        self.interval.task != Task::Done
    }

    /// Stores the position-dependent parts of the interval's middle, where its mean is valid.
    pub fn keep_errors(
        &mut self,
        tables: &ObserverTables<T>,
        sensors: &Sensors,
        filters: &Filters<T>,
        both_encoders: bool,
    ) {
        self.places.go_to(sensors.counts.output.phase(&tables.counts.output));
        (self.errors.free, self.errors.mesh_then) = self.find_errors(tables, sensors, filters, both_encoders);
    }

    /// Evaluates the interval that ends now, at a motor speed [rad/s].
    pub fn read(&mut self, tables: &ObserverTables<T>, motor_speed: T, both_encoders: bool) -> Reading<T> {
        let mean = self.interval.close(tables.learner.per_periods);
        let mesh = self.errors.mesh_then;
        let deflection = mean.measured - self.learner.deflection(&self.errors.free);
        let [_, compliance] = self.shape();
        let turned = motor_speed.abs() * tables.learner.span;
        // Until the half-gap is known, the estimated transmission error is subtracted, so that it hides no crossing;
        // afterwards it is left in.
        let (unlearnt, blur, known_shift) = if self.uncertainty.half_gap_is_known {
            (T::ZERO, tables.contact.still_per_speed * Self::BLUR_LEFT, T::ZERO)
        } else {
            let (unlearnt, learnt) = self.learner.error_deviation(&tables.learner);
            let per_turned = T::TWO * tables.counts.mesh_periods * tables.levers.per_ratio;
            let blur = tables.contact.still_per_speed - per_turned * learnt;
            (unlearnt, blur, self.transmission_error(&mesh))
        };
        let less_wind_up = deflection - compliance * mean.force - known_shift;
        let read = (mean.lost, mean.direction);
        let travel = self.travel.step(&tables.contact, less_wind_up, read, blur * turned, self.uncertainty.softness);
        self.interval.steady += (mean.force - self.interval.steady) * Self::STEADY;
        let rested = if let Travel::AtRest(intervals) = travel { i32::from(intervals.min(LONG_REST)) } else { 1 };
        self.interval.rested += (mean.force - self.interval.rested).over(T::from_i32(rested));
        let flank_shift = self.transmission_error(&mesh);
        let signs = self.signs(deflection - flank_shift, mean.force);
        let flank = if rests(travel) { flank::settled(&signs, &self.interval, both_encoders) } else { None };
        Reading { mean, mesh, deflection, flank_shift, travel, flank, unlearnt }
    }

    /// Evidence of an interval on the flank: a deflection of the teeth [m] and a force [N].
    fn signs(&self, deflection: T, force: T) -> Signs<'_, T> {
        let [_, compliance] = self.shape();
        Signs { uncertainty: &self.uncertainty, position: self.position(deflection, T::ZERO), force, compliance }
    }

    /// Updates the estimates with an evaluated interval, and begins the next one.
    pub fn close(&mut self, tables: &ObserverTables<T>, reading: &Reading<T>, both_encoders: bool) -> Outcome {
        let Reading { mean, travel, .. } = reading;
        let deflection = reading.deflection - reading.flank_shift;
        if both_encoders {
            self.probation = self.probation.saturating_sub(1);
        }
        self.learn_bias(tables, reading, deflection, both_encoders);
        self.bias.age(&tables.contact);
        if reading.flank.is_some() || matches!(travel, Travel::Crossing(..)) {
            self.interval.flank = reading.flank;
        }
        self.uncertainty.settled = reading.flank.is_some();
        let verdict = self.consistency.step(self.force_between_flanks(tables, deflection, *travel));
        self.obey(tables, verdict);
        let encoder_fails = verdict == Verdict::EncoderFails;

        let rise = mean.force - core::mem::replace(&mut self.interval.force, mean.force);
        let rest = self.rest(tables, reading, rise, both_encoders && !encoder_fails);
        if rest == Rest::No {
            self.last_rest.interrupt();
        }
        let force = mean.force + tables.learner.force_lag * rise;
        let settled = Settled { free: &self.errors.free, mesh: &reading.mesh, measured: mean.measured, force };
        let shortest = flank::shortest_touch(&self.uncertainty, &tables.learner);
        let full = self.block.add(&settled, rest, shortest, &tables.learner);
        self.interval.task = Task::Inertia(full);
        self.interval.direction = mean.direction;
        self.interval.nearer = if reading.deflection < reading.flank_shift { Flank::Back } else { Flank::Drive };
        if encoder_fails { Outcome::EncoderFails } else { Outcome::Nothing }
    }

    /// Decides if an interval is a rest that updates the parameters, and on which flank; the force rises by `rise` [N].
    fn rest(&mut self, tables: &ObserverTables<T>, reading: &Reading<T>, rise: T, both_encoders: bool) -> Rest {
        let [half_gap, _] = self.shape();
        let known = self.uncertainty.half_gap_is_known;
        // Teeth at rest while the motor turns are on a flank, even if no force shows which. While the transmission
        // error could hide a crossing, this is not certain of any rest: the transmission error is estimated first.
        let wide = self.last_rest.co_motion().half_gap_at_least(half_gap);
        let rests_somewhere =
            rests(reading.travel) && !known && (reading.unlearnt > wide * Self::HIDDEN || self.travel.tells_rest(wide));
        // A stationary motor repeats one rounded reading under a force hidden by friction: this rest is used once on
        // either flank.
        let turns = reading.mean.direction.abs() > T::HALF;
        let signs = self.signs(reading.deflection - reading.flank_shift, reading.mean.force);
        let loaded = flank::loaded(&signs, &self.interval, &tables.learner, rise);
        // The first millisecond of a landing is not used.
        let twice = loaded.filter(|_| loaded == self.interval.loaded);
        let told = reading.flank.or(twice);
        self.interval.loaded = loaded;
        let new = turns || told.is_some() && told != self.interval.learnt_on;
        if both_encoders && new && (told.is_some() || rests_somewhere) { Rest::On(told) } else { Rest::No }
    }

    /// Detects force at rest between the flanks beyond bias and stiction, and grades the distance from the flanks.
    fn force_between_flanks(&self, tables: &ObserverTables<T>, deflection: T, travel: Travel<T>) -> Option<Off> {
        let known = &self.uncertainty;
        let [half_gap, _] = self.shape();
        let thrice = T::THREE * known.steady_force_deviation + T::TWO * self.bias.friction.abs();
        let inside = half_gap - known.blur - tables.rounding();
        let between = known.half_gap_is_known && deflection.abs() < inside;
        let off = if half_gap - deflection.abs() < Self::VARIES * half_gap { Off::AsInAnotherPlace } else { Off::Far };
        (between && rests(travel) && self.interval.steady.abs() > thrice).then_some(off)
    }

    /// Updates the torque bias (O16) while the gap is certainly open.
    fn learn_bias(&mut self, tables: &ObserverTables<T>, reading: &Reading<T>, deflection: T, both_encoders: bool) {
        let [half_gap, _] = self.shape();
        let known = self.uncertainty.half_gap_is_known;
        let (blur, near) = (self.uncertainty.blur, Self::NEAR_FLANK * half_gap);
        let inside = half_gap - T::TWO * if blur > near { blur } else { near };
        let open = known && deflection.abs() < inside;
        self.interval.open_for = if open { self.interval.open_for.saturating_add(1) } else { 0 };
        let read = match reading.travel {
            _ if !both_encoders || self.probation > 0 => None,
            _ if self.interval.open_for >= OPEN_AFTER => Some((reading.mean.lost, reading.mean.direction)),
            Travel::Crossing(lost, direction) if !known => Some((lost, direction)),
            _ => None,
        };
        if let Some((lost, direction)) = read {
            self.bias.learn(&tables.contact, lost, direction);
        }
    }

    /// Updates the motor's cogging once per interval, from the motor's place in its turn [turns], its speed [rad/s] and
    /// the load torque [N m]. Returns sine and cosine of the driving torque, referred to the link [N m].
    pub fn learn_cogging(&mut self, tables: &ObserverTables<T>, seen: [T; 3]) -> [T; 2] {
        let settled = self.interval.flank.filter(|_| self.uncertainty.settled && self.probation == 0);
        self.cogging.learn(&tables.cogging, seen, settled);
        self.cogging.torque()
    }

    /// Does the next task of the last interval.
    pub fn work(&mut self, tables: &ObserverTables<T>, load: &mut LoadSide<T>, both_encoders: bool) -> Outcome {
        let mut outcome = Outcome::Nothing;
        self.interval.task = match self.interval.task {
            Task::Inertia(rest) => {
                let seen = both_encoders && self.probation == 0 && self.uncertainty.half_gap_serves;
                self.inertia.learn(&tables.inertia, load, seen);
                if rest { Task::Flank } else { Task::Uncertainty }
            }
            Task::Flank => {
                self.tell_flank(tables);
                if self.block.flank().is_some() { Task::Weigh } else { Task::Learn }
            }
            Task::Weigh => {
                self.interval.learnt_on = self.block.flank();
                if self.weigh_rest(tables) == Verdict::EncoderFails {
                    outcome = Outcome::EncoderFails;
                }
                Task::Learn
            }
            Task::Learn => {
                self.learn_rest(tables);
                Task::Uncertainty
            }
            Task::Uncertainty => {
                self.learner.forget(tables.learner.forgetting);
                self.find_uncertainty(tables, both_encoders);
                Task::Conclude
            }
            Task::Conclude | Task::Done => {
                self.uncertainty.of_learnt(tables, &self.learner, self.trusted.is_some());
                outcome = Outcome::Concluded;
                Task::Done
            }
        };
        outcome
    }

    /// Determines the flank of a rest, by force or by the change of the deflection.
    fn tell_flank(&mut self, tables: &ObserverTables<T>) {
        let (regressors, deflection) = self.block.full();
        let mut flank = self.block.flank();
        if let Some(told) = flank {
            self.last_rest.co_motion().told(told);
        } else {
            flank = self.flank_without_force(tables, &regressors, deflection);
        }
        self.last_rest.put(&regressors, deflection, flank);
        self.block.tell(flank);
    }

    /// Determines the flank of a rest by the deflection. If the flank stays unknown but the teeth certainly are on a
    /// flank, the rest updates the parameters that do not depend on the flank.
    fn flank_without_force(
        &mut self,
        tables: &ObserverTables<T>,
        regressors: &Regressors<T, P>,
        deflection: T,
    ) -> Option<Flank> {
        let [half_gap, _] = self.shape();
        let innovation = self.last_rest.innovation(&tables.learner, &self.learner, regressors, deflection)?;
        let flank = self.last_rest.flank(&tables.learner, &innovation, regressors, half_gap, tables.levers.output);
        if self.travel.tells_rest(self.last_rest.co_motion().half_gap_at_least(half_gap)) {
            // Teeth also reverse inside the gap, for a moment at rest: then the force of the whole rest shows no stop.
            // Teeth also leave a flank slowly, at rest for a while: then the steady force has decayed.
            let force = if self.last_rest.was_on(flank) { self.interval.steady } else { self.interval.rested };
            let felt = sign::<T>(flank) * force > self.uncertainty.steady_force_deviation;
            let flank = if felt { flank } else { self.last_rest.co_motion().flank() };
            if flank.is_some() {
                return flank;
            }
        }
        if innovation.is_within(GATE) && self.last_rest.co_motion().lasts(half_gap) {
            self.weighed = Some(innovation);
        }
        None
    }

    /// Accepts a rest on a flank as a measurement, or rejects it as an outlier.
    fn weigh_rest(&mut self, tables: &ObserverTables<T>) -> Verdict {
        let table = &tables.learner;
        let [half_gap, _] = self.shape();
        let (regressors, deflection) = self.block.full();
        let worth = self.block.worth(table, self.uncertainty.half_gap_is_known);
        let weight = (table.weight * worth).over(self.uncertainty.rest_deviation);
        let innovation = self.learner.innovation(table, &regressors, deflection, weight);
        let square = innovation.value * innovation.value;
        let belongs = innovation.is_within(GATE);
        if let Some(flank) = self.block.flank() {
            let off = [square, innovation.variance].map(|normalised| normalised.over(weight * weight));
            self.places.take(&tables.counts, flank, off, half_gap, belongs);
        }
        if !belongs {
            let beyond = innovation.value.abs().over(weight);
            let off = if beyond <= half_gap * tables.contact.known_part {
                Off::Little
            } else if beyond < Self::VARIES * half_gap {
                Off::AsInAnotherPlace
            } else {
                Off::Far
            };
            let verdict = self.consistency.outlier(off, self.trusted.is_some());
            self.obey(tables, verdict);
            return verdict;
        }
        self.consistency.fits(self.block.flank());
        self.weighed = Some(innovation);
        Verdict::Keep
    }

    /// Updates the parameters with the accepted rest, if any.
    fn learn_rest(&mut self, tables: &ObserverTables<T>) {
        let Some(innovation) = self.weighed.take() else { return };
        self.errors.relearn(&mut self.learner, |learner| learner.learn(&tables.learner, &innovation));
        let Some(flank) = self.block.flank() else { return };
        self.uncertainty.take_innovation(innovation.value, innovation.variance, flank);
        if self.consistency.is_trusted() {
            self.trusted = Some(Trusted::of(&self.learner));
            if self.uncertainty.detect_half_gap_change() {
                self.learner.loosen_half_gap(&tables.learner, Self::LOOSENED);
            }
        }
    }

    /// Applies a verdict: resets the variances of the parameters in doubt.
    fn obey(&mut self, tables: &ObserverTables<T>, verdict: Verdict) {
        match verdict {
            Verdict::Keep | Verdict::EncoderFails => {}
            Verdict::LoosenHalfGap => self.learner.loosen_half_gap(&tables.learner, Self::LOOSENED),
            Verdict::RelearnHalfGap => self.learner.doubt_half_gap(),
            Verdict::RelearnAll => self.learner.reopen(),
        }
    }

    /// Updates the variances after an interval.
    fn find_uncertainty(&mut self, tables: &ObserverTables<T>, both_encoders: bool) {
        let mut seen = self.errors.free;
        if let (Some(offset), false) = (seen.get_mut(OFFSET), both_encoders) {
            // Without an output encoder the offset has no error.
            *offset = T::ZERO;
        }
        let touch = Touch { flank: Some(self.interval.nearer), force: T::ZERO, mesh: self.errors.mesh_then };
        let [_, compliance] = self.shape();
        self.uncertainty.of_force(tables, &self.bias, compliance, self.interval.direction);
        self.uncertainty.next(tables, &self.learner, &seen, &touch);
    }
}
