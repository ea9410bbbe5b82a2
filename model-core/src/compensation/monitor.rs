//! Monitor of the compensated loop, (K22) to (K24): detects a loop that hunts, independently of the observer's validity
//! flags, leaves the joint to plain control, and lets the compensation retry later.
//!
//! Symbols: e = `error` of the link, h = `half` the lost motion, p = `planned` demand of the set-point's own motion
//! (inertia, friction), d = `demand`, p plus the slow load, s side of the flank in use, n = `unexplained`, m = `mean_square`,
//! g = `granted_square`, w = `worst_error`, a = `error_per_half`, b = `error_per_demand`, c = `calm_per_half`, t = period/`memory`,
//! d_min = `least_demand`.
//!
//! 1. Unexplained flank changes. A flank that is left adds 0 to the count n if s p > d_min at some time while it was in
//!    use, 1/8 if s d > d_min or g > (c h)^2 at some time, otherwise 1. n decays, fast while the error is small,
//!    m < (c h)^2, and the link is not pushed hard. The loop hunts if n > `most`.
//! 2. Mean error beyond the error of plain control. With m' = (e^2 - m)/t the loop hunts if m > (a h + b |d|)^2 + g.
//!    g is the squared error that the compensation did not cause, by the state at takeover or by jumps of the set-point;
//!    g decays like m.
//! 3. After a trip, an error beyond the largest recent error w of plain control: e^2 > (a h + b |p|)^2 + g and |e| > w.
//!    While plain control acts, w decays with a time constant of 2 s.
//!
//! Impedance mode has no position error: only n decides, with the fast decay.
//!
//! A hunting loop is left to plain control (`inverse`; in impedance mode `plain`) for a time that grows by the factor
//! `longer` with each trip. The time returns to its first value once the compensation has acted for as long.

use super::loop_state::LoopState;
use super::slow_task::SlowTask;
use crate::compensation::tables::CompensationTables;
use crate::gears::Flank;
use crate::numbers::Real;
use crate::numbers::arithmetic::clamp;

/// Monitor of the compensated loop.
#[derive(Debug, Clone)]
pub(super) struct LoopMonitor<T: Real> {
    /// Flank in use at the last judgement.
    flank: Option<Flank>,
    /// Amount that leaving the flank will add to the count: 0, 1/8 or 1 [-].
    change_weight: T,
    /// Decaying count of unexplained flank changes [-].
    unexplained: T,
    /// Slow part of the load, smoothed twice [N m].
    load: [T; 2],
    /// Mean square of the error [rad^2].
    mean_square: T,
    /// Squared error not caused by the compensation, g, decaying [rad^2].
    granted_square: T,
    /// Error at the previous judgement, if judged [rad].
    last_error: Option<T>,
    /// Time for which errors have been judged, saturating [time constants of the loop].
    judged_time: T,
    /// Largest recent error while the compensation does not act, decaying [rad].
    worst_error: T,
    /// Remaining time of plain control after a trip; zero while the compensation may act [s].
    remaining_trip: T,
    /// Time of plain control after the next trip [s].
    next_retry_time: T,
    /// Time for which the compensation has acted since the last trip, saturating [s].
    acting_time: T,
}

/// Quantities of a period that the monitor judges.
#[derive(Debug, Clone, Copy)]
pub(super) struct MonitorInput<T: Real> {
    /// Torque of the set-point's own motion: inertia and friction [N m].
    pub planned: T,
    /// Gravity torque of the load model [N m].
    pub load: T,
    /// True if the error of the link is a measure of the loop's quality.
    pub has_error: bool,
    /// True while the link is pushed hard: the error is then the push's, unless hunting itself throws the link.
    pub external_impact: bool,
}

impl<T: Real> LoopMonitor<T> {
    /// Change of the error between two judgements beyond the change by its rate, over half the lost motion, that counts
    /// as a jump of the set-point [-].
    const SET_POINT_JUMP: T = T::QUARTER;

    /// Time after takeover in which the error is granted [time constants of the loop]: the observer first has to
    /// estimate the link's speed.
    const TAKEOVER_TIME: T = T::SIX;

    /// Amount that a flank change explained by the load adds to the count [-]. With the decay of 1/s a load may change
    /// flanks eight times per second.
    const LOAD_CHANGE_WEIGHT: T = T::EIGHTH;

    /// Decay rate of the largest error [1/s].
    const WORST_ERROR_DECAY: T = T::HALF;

    pub fn new(tables: &CompensationTables<T>) -> Self {
        Self {
            flank: None,
            change_weight: T::ZERO,
            unexplained: T::ZERO,
            load: [T::ZERO; 2],
            mean_square: T::ZERO,
            granted_square: T::ZERO,
            last_error: None,
            judged_time: T::ZERO,
            worst_error: T::ZERO,
            remaining_trip: T::ZERO,
            next_retry_time: tables.watch.first_away,
            acting_time: T::ZERO,
        }
    }

    /// True while a tripped loop is left to plain control.
    pub fn is_tripped(&self) -> bool {
        self.remaining_trip > T::ZERO
    }

    /// Judges one of [`SlowTask::periods`] periods in which the compensation acts on a flank (`acting`). If it does not
    /// act, records the error of plain control and counts down the time of plain control.
    pub fn step(
        &mut self,
        tables: &CompensationTables<T>,
        state: &LoopState<T>,
        watched: &MonitorInput<T>,
        acting: Option<Flank>,
    ) {
        let (table, period) = (&tables.watch, SlowTask::periods::<T>() * tables.clock.period);
        let [first, second] = &mut self.load;
        let share = SlowTask::periods::<T>() * table.smoothing;
        *first += share * (watched.load - *first);
        *second += share * (*first - *second);
        let demand = watched.planned + *second;
        if !demand.is_finite() {
            self.load = [T::ZERO; 2];
            return;
        }
        if acting.is_none() && watched.has_error {
            let faded = self.worst_error - period * Self::WORST_ERROR_DECAY * self.worst_error;
            let error = state.error.abs();
            self.worst_error = if error > faded { error } else { faded };
        }
        if self.remaining_trip > T::ZERO {
            self.remaining_trip = decrease(self.remaining_trip, period);
            return;
        }
        if acting.is_none() || !watched.has_error {
            // The error at takeover was left by another law.
            (self.mean_square, self.last_error, self.judged_time) = (T::ZERO, None, T::ZERO);
        } else if watched.external_impact {
            self.last_error = None;
        } else {
            self.update_mean_square(tables, state);
        }
        let calm = table.calm_per_half * state.half_gap;
        let [leak, calm_leak] = table.leaks;
        // A hunting loop also pushes the link hard, so a pushed link is never calm.
        let is_calm = !watched.has_error || !watched.external_impact && self.mean_square < calm * calm;
        let leak = if is_calm { calm_leak } else { leak };
        self.unexplained = decrease(self.unexplained, period * leak);
        let Some(flank) = acting else {
            self.flank = None;
            return;
        };
        if self.acting_time < self.next_retry_time {
            self.acting_time += period;
        } else {
            self.next_retry_time = table.first_away;
        }
        if self.flank != Some(flank) {
            if self.flank.is_some() {
                self.unexplained += self.change_weight;
            }
            (self.flank, self.change_weight) = (Some(flank), T::ONE);
        }
        // Catching a link that was moved from outside changes flanks rightly, and so does a load. But hunting also
        // looks like a load.
        let asks = |demand: T| flank.sign::<T>() * demand > table.least_demand;
        if asks(watched.planned) {
            self.change_weight = T::ZERO;
        } else if asks(demand) || self.granted_square > calm * calm {
            self.change_weight = clamp(self.change_weight, T::ZERO, Self::LOAD_CHANGE_WEIGHT);
        }
        let bound = |demand: T| {
            let bound = table.error_per_half * state.half_gap + table.error_per_demand * demand.abs();
            bound * bound + self.granted_square
        };
        let error = state.error * state.error;
        // After a trip the compensation must be better than plain control.
        let is_worse = self.next_retry_time > table.first_away
            && watched.has_error
            && error > bound(watched.planned)
            && error > self.worst_error * self.worst_error;
        if self.unexplained > table.most || self.mean_square > bound(demand) || is_worse {
            self.trip(tables);
        }
    }

    /// Updates the mean square of the error, and the grant if the error has another cause.
    fn update_mean_square(&mut self, tables: &CompensationTables<T>, state: &LoopState<T>) {
        let memory = SlowTask::periods::<T>() * tables.watch.memory;
        let period = SlowTask::periods::<T>() * tables.clock.period;
        self.mean_square += memory * (state.error * state.error - self.mean_square);
        self.granted_square -= memory * self.granted_square;
        let jump = self
            .last_error
            .replace(state.error)
            .map_or(T::ZERO, |last_error| (state.error - last_error - period * state.error_rate).abs());
        if jump > Self::SET_POINT_JUMP * state.half_gap {
            self.granted_square += jump * jump;
        }
        if self.judged_time < Self::TAKEOVER_TIME {
            self.judged_time += SlowTask::periods::<T>() * tables.law.back_calculation;
            let found = state.error.abs() + T::TWO * state.error_rate.abs().over(tables.law.rate);
            let found = found * found;
            self.granted_square = if found > self.granted_square { found } else { self.granted_square };
        }
    }

    /// Leaves the joint to plain control and resets the monitor.
    #[cold]
    fn trip(&mut self, tables: &CompensationTables<T>) {
        let table = &tables.watch;
        self.remaining_trip = self.next_retry_time;
        self.next_retry_time = clamp(self.next_retry_time * table.longer, table.first_away, table.longest_away);
        (self.flank, self.change_weight) = (None, T::ZERO);
        (self.unexplained, self.mean_square, self.acting_time) = (T::ZERO, T::ZERO, T::ZERO);
        (self.granted_square, self.last_error, self.judged_time) = (T::ZERO, None, T::ZERO);
    }
}

/// Subtracts `by`; not below zero.
fn decrease<T: Real>(value: T, by: T) -> T {
    let left = value - by;
    if left > T::ZERO { left } else { T::ZERO }
}
