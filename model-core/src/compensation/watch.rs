//! Monitor of the compensated loop: steps back to control on the motor alone where the loop hunts, whatever the observer
//! believes, and lets the compensation try again later.
//!
//! Three effects tell that a loop hunts. Symbols: e error of the link, h half the lost motion, d planned demand (inertia, friction
//! and slow load), p that of the set-point's own motion, P spring of the loop, dwell = time between two flank changes.
//!
//! 1. Flank changes that the demand does not explain. Leaving a flank s adds nothing to a count if s p > d_min at some time on it, 1/8 if
//!    s d > d_min or g > (c h)^2 at some time, else 1. The count falls by a leak, which is large while the error is small, m < (c h)^2,
//!    and the link is not thrown. The loop hunts when the count exceeds `most`.
//! 2. A mean error larger than that of control without compensation. The mean square m of e follows m' = (e^2 - m) / t; the loop
//!    hunts when m > (a h + b |d| / P)^2 + g. The error that the compensation finds when it takes over, as a place and a speed, and
//!    jumps of the set-point are not its own: their square g fades as m does.
//! 3. After a trip: an error beyond the largest one, w, that the law which took over has left of late, e^2 > (a h + b |p| / P)^2 + g
//!    and |e| > w. It fades in two seconds, as long as that law controls.
//!
//! An impedance has no error of its own: there only the count decides, with the large leak.
//!
//! A loop that hunts is left to control on the motor alone (`inverse`; an impedance to `plain`) for a time that grows by `longer` with each trip, and is
//! forgiven when the compensation has served for as long.

use super::situation::Situation;
use super::turn::Turn;
use crate::compensation::tables::CompensationTables;
use crate::gears::Flank;
use crate::numbers::Real;
use crate::numbers::arithmetic::clamp;

/// Monitor of the compensated loop.
#[derive(Debug, Clone)]
pub(super) struct Watch<T: Real> {
    /// Flank that was in use last.
    flank: Option<Flank>,
    /// What leaving that flank will count for, by what has asked for it since [-].
    counts: T,
    /// Unexplained flank changes, leaking [-].
    unexplained: T,
    /// Slow part of the load, smoothed twice [N m].
    load: [T; 2],
    /// Mean square of the error [rad^2].
    square: T,
    /// Square of the error that is not the compensation's own, as far as it has not faded [rad^2].
    granted: T,
    /// Error of the period before, if it was judged [rad].
    before: Option<T>,
    /// For how long errors have been judged, in time constants of the loop, as far as that matters [-].
    judged: T,
    /// Largest error of late while the motor alone is controlled [rad].
    worst: T,
    /// Time left to control on the motor alone; zero while the compensation may act [s].
    away: T,
    /// Length of the next time away [s].
    next_away: T,
    /// Time for which the compensation has acted since it was away last, as far as that matters [s].
    served: T,
}

/// Quantities of one period that the monitor judges.
#[derive(Debug, Clone, Copy)]
pub(super) struct Watched<T: Real> {
    /// Torque that the set-point's own motion asks for: inertia and friction [N m].
    pub planned: T,
    /// Load as the observer has it [N m].
    pub load: T,
    /// Whether the link's error says how well the loop serves.
    pub has_error: bool,
    /// Whether the link is thrown: its error is the push's then, unless the loop hunts, which throws it as well.
    pub is_thrown: bool,
}

impl<T: Real> Watch<T> {
    /// Change of the error in a period beyond what its rate says, over half the lost motion, from which on the set-point has
    /// jumped [-].
    const JUMP: T = T::QUARTER;

    /// Time constants of the loop within which it finds what it has taken over [-]: the observer has to learn the link's speed first.
    const FOUND: T = T::SIX;

    /// What a flank change counts for that a load explains [-]. With the leak of 1/s a load may change flanks eight times a second.
    const BY_LOAD: T = T::EIGHTH;

    /// Rate at which the largest error fades [1/s].
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

    /// Whether the compensation has stepped back.
    pub fn is_away(&self) -> bool {
        self.away > T::ZERO
    }

    /// Judges one of [`Turn::periods`] periods in which the compensation acts on a flank with some share of the torque; without one it
    /// takes in what control without compensation leaves, and lets the time away pass.
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
            // What another law leaves behind is found.
            (self.square, self.before, self.judged) = (T::ZERO, None, T::ZERO);
        } else if watched.is_thrown {
            self.before = None;
        } else {
            self.judge_error(tables, situation);
        }
        let calm = table.calm_per_half * situation.half;
        let [leak, calm_leak] = table.leaks;
        // A loop that hunts throws the link as a push does: then nothing is calm.
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
        // What catches a link that something else has moved changes flanks as it must, and so does a load. But hunting is felt as a
        // load as well.
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
        // After a trip the compensation has to be better than the law that took over.
        let is_worse = self.next_away > table.first_away
            && watched.has_error
            && error > bound(watched.planned)
            && error > self.worst * self.worst;
        if self.unexplained > table.most || self.square > bound(demand) || is_worse {
            self.trip(tables);
        }
    }

    /// Takes the error into its mean square, and into what is granted if something else has made it.
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
            let found = situation.error.abs() + T::TWO * situation.error_rate.abs().over(tables.law.rate);
            let found = found * found;
            self.granted = if found > self.granted { found } else { self.granted };
        }
    }

    /// Steps back.
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

/// What is left of a value, not below zero.
fn less<T: Real>(value: T, by: T) -> T {
    let left = value - by;
    if left > T::ZERO { left } else { T::ZERO }
}
