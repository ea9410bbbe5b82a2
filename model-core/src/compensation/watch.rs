//! Monitor of the compensated loop, (K22) to (K24): detects a loop that hunts, independently of the observer's validity
//! flags, leaves the joint to plain control, and lets the compensation retry later.
//!
//! Symbols: e = `error` of the link, h = `half` the lost motion, p = `planned` demand of the set-point's own motion
//! (inertia, friction), d = `demand`, p plus the slow load, s side of the flank in use, n = `unexplained`, m = `square`,
//! g = `granted`, w = `worst`, a = `error_per_half`, b = `error_per_demand`, c = `calm_per_half`, t = period/`memory`,
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

use super::situation::Situation;
use super::turn::Turn;
use crate::compensation::tables::CompensationTables;
use crate::gears::Flank;
use crate::numbers::Real;
use crate::numbers::arithmetic::clamp;

/// Monitor of the compensated loop.
#[derive(Debug, Clone)]
pub(super) struct Watch<T: Real> {
    /// Flank in use at the last judgement.
    flank: Option<Flank>,
    /// Amount that leaving the flank will add to the count: 0, 1/8 or 1 [-].
    counts: T,
    /// Decaying count of unexplained flank changes [-].
    unexplained: T,
    /// Slow part of the load, smoothed twice [N m].
    load: [T; 2],
    /// Mean square of the error [rad^2].
    square: T,
    /// Squared error not caused by the compensation, g, decaying [rad^2].
    granted: T,
    /// Error at the previous judgement, if judged [rad].
    before: Option<T>,
    /// Time for which errors have been judged, saturating [time constants of the loop].
    judged: T,
    /// Largest recent error while the compensation does not act, decaying [rad].
    worst: T,
    /// Remaining time of plain control after a trip; zero while the compensation may act [s].
    away: T,
    /// Time of plain control after the next trip [s].
    next_away: T,
    /// Time for which the compensation has acted since the last trip, saturating [s].
    served: T,
}

/// Quantities of a period that the monitor judges.
#[derive(Debug, Clone, Copy)]
pub(super) struct Watched<T: Real> {
    /// Torque of the set-point's own motion: inertia and friction [N m].
    pub planned: T,
    /// Even load of the load model [N m].
    pub load: T,
    /// True if the error of the link is a measure of the loop's quality.
    pub has_error: bool,
    /// True while the link is pushed hard: the error is then the push's, unless hunting itself throws the link.
    pub is_thrown: bool,
}

impl<T: Real> Watch<T> {
    /// Change of the error between two judgements beyond the change by its rate, over half the lost motion, that counts
    /// as a jump of the set-point [-].
    const JUMP: T = T::QUARTER;

    /// Time after takeover in which the error is granted [time constants of the loop]: the observer first has to
    /// estimate the link's speed.
    const FOUND: T = T::SIX;

    /// Amount that a flank change explained by the load adds to the count [-]. With the decay of 1/s a load may change
    /// flanks eight times per second.
    const BY_LOAD: T = T::EIGHTH;

    /// Decay rate of the largest error [1/s].
    const FADES: T = T::HALF;

    pub fn new(tables: &CompensationTables<T>) -> Self {
        Self {
            flank: None,
            counts: T::ZERO,
            unexplained: T::ZERO,
            load: [T::ZERO; 2],
            square: T::ZERO,
            granted: T::ZERO,
            before: None,
            judged: T::ZERO,
            worst: T::ZERO,
            away: T::ZERO,
            next_away: tables.watch.first_away,
            served: T::ZERO,
        }
    }

    /// True while a tripped loop is left to plain control.
    pub fn is_away(&self) -> bool {
        self.away > T::ZERO
    }

    /// Judges one of [`Turn::periods`] periods in which the compensation acts on a flank (`acting`). If it does not
    /// act, records the error of plain control and counts down the time of plain control.
    pub fn step(
        &mut self,
        tables: &CompensationTables<T>,
        situation: &Situation<T>,
        watched: &Watched<T>,
        acting: Option<Flank>,
    ) {
        let (table, period) = (&tables.watch, Turn::periods::<T>() * tables.clock.period);
        let [first, second] = &mut self.load;
        let share = Turn::periods::<T>() * table.smoothing;
        *first += share * (watched.load - *first);
        *second += share * (*first - *second);
        let demand = watched.planned + *second;
        if !demand.is_finite() {
            self.load = [T::ZERO; 2];
            return;
        }
        if acting.is_none() && watched.has_error {
            let faded = self.worst - period * Self::FADES * self.worst;
            let error = situation.error.abs();
            self.worst = if error > faded { error } else { faded };
        }
        if self.away > T::ZERO {
            self.away = less(self.away, period);
            return;
        }
        if acting.is_none() || !watched.has_error {
            // The error at takeover was left by another law.
            (self.square, self.before, self.judged) = (T::ZERO, None, T::ZERO);
        } else if watched.is_thrown {
            self.before = None;
        } else {
            self.judge_error(tables, situation);
        }
        let calm = table.calm_per_half * situation.half;
        let [leak, calm_leak] = table.leaks;
        // A hunting loop also pushes the link hard, so a pushed link is never calm.
        let is_calm = !watched.has_error || !watched.is_thrown && self.square < calm * calm;
        let leak = if is_calm { calm_leak } else { leak };
        self.unexplained = less(self.unexplained, period * leak);
        let Some(flank) = acting else {
            self.flank = None;
            return;
        };
        if self.served < self.next_away {
            self.served += period;
        } else {
            self.next_away = table.first_away;
        }
        if self.flank != Some(flank) {
            if self.flank.is_some() {
                self.unexplained += self.counts;
            }
            (self.flank, self.counts) = (Some(flank), T::ONE);
        }
        // Catching a link that was moved from outside changes flanks rightly, and so does a load. But hunting also
        // looks like a load.
        let asks = |demand: T| flank.sign::<T>() * demand > table.least_demand;
        if asks(watched.planned) {
            self.counts = T::ZERO;
        } else if asks(demand) || self.granted > calm * calm {
            self.counts = clamp(self.counts, T::ZERO, Self::BY_LOAD);
        }
        let bound = |demand: T| {
            let bound = table.error_per_half * situation.half + table.error_per_demand * demand.abs();
            bound * bound + self.granted
        };
        let error = situation.error * situation.error;
        // After a trip the compensation must be better than plain control.
        let is_worse = self.next_away > table.first_away
            && watched.has_error
            && error > bound(watched.planned)
            && error > self.worst * self.worst;
        if self.unexplained > table.most || self.square > bound(demand) || is_worse {
            self.trip(tables);
        }
    }

    /// Updates the mean square of the error, and the grant if the error has another cause.
    fn judge_error(&mut self, tables: &CompensationTables<T>, situation: &Situation<T>) {
        let memory = Turn::periods::<T>() * tables.watch.memory;
        let period = Turn::periods::<T>() * tables.clock.period;
        self.square += memory * (situation.error * situation.error - self.square);
        self.granted -= memory * self.granted;
        let jump = self
            .before
            .replace(situation.error)
            .map_or(T::ZERO, |before| (situation.error - before - period * situation.error_rate).abs());
        if jump > Self::JUMP * situation.half {
            self.granted += jump * jump;
        }
        if self.judged < Self::FOUND {
            self.judged += Turn::periods::<T>() * tables.law.back_calculation;
            let found = situation.error.abs() + T::TWO * (situation.error_rate.abs() / tables.law.rate);
            let found = found * found;
            self.granted = if found > self.granted { found } else { self.granted };
        }
    }

    /// Leaves the joint to plain control and resets the monitor.
    #[cold]
    fn trip(&mut self, tables: &CompensationTables<T>) {
        let table = &tables.watch;
        self.away = self.next_away;
        self.next_away = clamp(self.next_away * table.longer, table.first_away, table.longest_away);
        (self.flank, self.counts) = (None, T::ZERO);
        (self.unexplained, self.square, self.served) = (T::ZERO, T::ZERO, T::ZERO);
        (self.granted, self.before, self.judged) = (T::ZERO, None, T::ZERO);
    }
}

/// Subtracts `by`; not below zero.
fn less<T: Real>(value: T, by: T) -> T {
    let left = value - by;
    if left > T::ZERO { left } else { T::ZERO }
}
