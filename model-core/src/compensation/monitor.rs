//! Monitor of the compensated loop: detects a loop that hunts, independently of the observer's validity flags, leaves
//! the joint to plain control, and lets the compensation retry later.
//!
//! ```text
//! (K22)  n' = -1/s, or -20/s while E < (0.35 h)^2;   n + 0, 1/8 or 1 per flank change
//!        explained by the plan (side p > d_min), by the load (side d > d_min or E_0 > (0.35 h)^2), or by neither
//! (K23)  E' = (e^2 - E)/0.15 s,   E_0' = -E_0/0.15 s
//! (K24)  hunting:  n > 4,  or  E > (1.5 h + 0.3 |d|/K)^2 + E_0,
//!        or after a trip  e^2 > (1.5 h + 0.3 |p|/K)^2 + E_0  and  |e| > e_max
//! ```
//!
//! | symbol | identifier |
//! |---|---|
//! | n, amount added at the next change | `unexplained`, `change_weight` |
//! | p, d = p + slow load, d_min | `planned`, `demand`, `least_demand` |
//! | E, E_0 | `mean_square`, `granted_square`: squared error that the compensation did not cause |
//! | e_max: largest recent error of plain control, decays in 2 s | `worst_error` |
//!
//! Impedance mode has no position error: only n decides, with the fast decay. A hunting loop is left to plain control
//! (`inverse`; in impedance mode `plain`) for a time that grows by the factor `longer` with each trip. The time returns
//! to its first value once the compensation has acted for as long.

use super::loop_state::LoopState;
use super::slow_task::SlowTask;
use super::thresholds::MonitorThresholds;
use crate::compensation::tables::CompensationTables;
use crate::gears::Flank;
use crate::numbers::Real;
use crate::numbers::arithmetic::clamp;
use crate::numbers::state_words::state_words;

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
state_words! {
    struct LoopMonitor<T> {
        flank, change_weight, unexplained, load, mean_square, granted_square, last_error, judged_time, worst_error,
        remaining_trip, next_retry_time, acting_time,
    }
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
    const THRESHOLDS: MonitorThresholds<T> = MonitorThresholds::TUNED;

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
        input: &MonitorInput<T>,
        acting: Option<Flank>,
    ) {
        let period = SlowTask::periods::<T>() * tables.clock.period;
        let Some(demand) = self.demand(tables, input) else { return };
        if acting.is_none() && input.has_error {
            let decayed = self.worst_error - period * Self::THRESHOLDS.worst_error_decay * self.worst_error;
            let error = state.error.abs();
            self.worst_error = if error > decayed { error } else { decayed };
        }
        if self.remaining_trip > T::ZERO {
            self.remaining_trip = decrease(self.remaining_trip, period);
            return;
        }
        if acting.is_none() || !input.has_error {
            // The error at takeover was left by another law.
            (self.mean_square, self.last_error, self.judged_time) = (T::ZERO, None, T::ZERO);
        } else if input.external_impact {
            self.last_error = None;
        } else {
            self.update_mean_square(tables, state);
        }
        self.decay_count(tables, state, input, period);
        let Some(flank) = acting else {
            self.flank = None;
            return;
        };
        if self.acting_time < self.next_retry_time {
            self.acting_time += period;
        } else {
            self.next_retry_time = tables.watch.first_away;
        }
        self.count_change(tables, state, flank, input.planned, demand);
        if self.hunts(tables, state, input, demand) {
            self.trip(tables);
        }
    }

    /// Demand of the set-point and the slow load; `None` if not finite.
    fn demand(&mut self, tables: &CompensationTables<T>, input: &MonitorInput<T>) -> Option<T> {
        let share = SlowTask::periods::<T>() * tables.watch.smoothing;
        let [first, second] = &mut self.load;
        *first += share * (input.load - *first);
        *second += share * (*first - *second);
        let demand = input.planned + *second;
        if !demand.is_finite() {
            self.load = [T::ZERO; 2];
            return None;
        }
        Some(demand)
    }

    /// RMS error that is small [rad].
    fn calm_error(tables: &CompensationTables<T>, state: &LoopState<T>) -> T {
        tables.watch.calm_per_half * state.half_gap
    }

    /// Lets the count of unexplained flank changes decay (K22), fast while the error is small. A hunting loop also
    /// pushes the link hard, so a pushed link is never calm.
    fn decay_count(
        &mut self,
        tables: &CompensationTables<T>,
        state: &LoopState<T>,
        input: &MonitorInput<T>,
        period: T,
    ) {
        let calm = Self::calm_error(tables, state);
        let [leak, calm_leak] = tables.watch.leaks;
        let is_calm = !input.has_error || !input.external_impact && self.mean_square < calm * calm;
        self.unexplained = decrease(self.unexplained, period * if is_calm { calm_leak } else { leak });
    }

    /// Counts a change of the flank (K22), and notes what explains the flank in use. Catching a link that was moved
    /// from outside changes flanks rightly, and so does a load. But hunting also looks like a load.
    fn count_change(
        &mut self,
        tables: &CompensationTables<T>,
        state: &LoopState<T>,
        flank: Flank,
        planned: T,
        demand: T,
    ) {
        if self.flank != Some(flank) {
            if self.flank.is_some() {
                self.unexplained += self.change_weight;
            }
            (self.flank, self.change_weight) = (Some(flank), T::ONE);
        }
        let calm = Self::calm_error(tables, state);
        let presses = |torque: T| flank.sign::<T>() * torque > tables.watch.least_demand;
        if presses(planned) {
            self.change_weight = T::ZERO;
        } else if presses(demand) || self.granted_square > calm * calm {
            self.change_weight = clamp(self.change_weight, T::ZERO, Self::THRESHOLDS.load_change_weight);
        }
    }

    /// True if the loop hunts (K24). After a trip the compensation must also be better than plain control.
    fn hunts(&self, tables: &CompensationTables<T>, state: &LoopState<T>, input: &MonitorInput<T>, demand: T) -> bool {
        let table = &tables.watch;
        let bound = |torque: T| {
            let bound = table.error_per_half * state.half_gap + table.error_per_demand * torque.abs();
            bound * bound + self.granted_square
        };
        let square = state.error * state.error;
        let is_worse_than_plain = self.next_retry_time > table.first_away
            && input.has_error
            && square > bound(input.planned)
            && square > self.worst_error * self.worst_error;
        self.unexplained > table.most || self.mean_square > bound(demand) || is_worse_than_plain
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
        if jump > Self::THRESHOLDS.set_point_jump * state.half_gap {
            self.granted_square += jump * jump;
        }
        if self.judged_time < Self::THRESHOLDS.takeover_time {
            self.judged_time += SlowTask::periods::<T>() * tables.law.back_calculation;
            let found = state.error.abs() + T::TWO * (state.error_rate.abs() / tables.law.rate);
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compensation::test_bench::{HALF_GAP, q1, state, tables};

    fn input(planned: f64) -> MonitorInput<f64> {
        MonitorInput { planned, load: 0.0, has_error: true, external_impact: false }
    }

    /// Returns the count after a flank change under a demand, load and granted square.
    fn count(planned: f64, demand: f64, granted_square: f64) -> f64 {
        let (tables, mut monitor) = (tables(), LoopMonitor::new(&tables()));
        monitor.granted_square = granted_square;
        monitor.count_change(&tables, &state(), Flank::Drive, planned, demand);
        monitor.count_change(&tables, &state(), Flank::Back, 0.0, 0.0);
        monitor.unexplained
    }

    #[test]
    fn planned_change_counts_nothing() {
        assert_eq!([count(0.051, 0.0, 0.0), count(0.049, 0.0, 0.0), count(-0.051, 0.0, 0.0)], [0.0, 1.0, 1.0]);
    }

    #[test]
    fn change_by_the_load_counts_an_eighth() {
        assert_eq!([count(0.0, 0.051, 0.0), count(0.0, 0.049, 0.0)], [0.125, 1.0]);
    }

    #[test]
    fn change_under_a_granted_error_counts_an_eighth() {
        let calm = f64::powi(0.35 * HALF_GAP, 2);
        assert_eq!([count(0.0, 0.0, 1.01 * calm), count(0.0, 0.0, 0.99 * calm)], [0.125, 1.0]);
    }

    #[test]
    fn flank_in_use_at_first_counts_nothing() {
        let mut monitor = LoopMonitor::new(&tables());
        monitor.count_change(&tables(), &state(), Flank::Drive, 0.0, 0.0);
        assert_eq!(monitor.unexplained, 0.0);
    }

    #[test]
    fn more_than_four_changes_hunt() {
        let hunts = |unexplained| {
            let monitor = LoopMonitor { unexplained, ..LoopMonitor::new(&tables()) };
            monitor.hunts(&tables(), &state(), &input(0.0), 0.0)
        };
        assert!(!hunts(4.0) && hunts(4.1));
    }

    #[test]
    fn error_beyond_plain_control_hunts() {
        let hunts = |error: f64, demand: f64| {
            let monitor = LoopMonitor { mean_square: error * error, ..LoopMonitor::new(&tables()) };
            monitor.hunts(&tables(), &state(), &input(0.0), demand)
        };
        assert!(!hunts(2.99e-3, 0.0) && hunts(3.01e-3, 0.0));
        assert!(!hunts(3.01e-3, -1.0), "a demand of 1 N m permits another 0.25 mrad");
    }

    #[test]
    fn pushed_link_is_never_calm() {
        let left = |external_impact| {
            let mut monitor = LoopMonitor { unexplained: 1.0, ..LoopMonitor::new(&tables()) };
            monitor.decay_count(&tables(), &state(), &MonitorInput { external_impact, ..input(0.0) }, 3e-3);
            monitor.unexplained
        };
        assert!((left(true) - 0.997).abs() < 1e-12 && (left(false) - 0.94).abs() < 1e-12);
    }

    #[test]
    fn count_does_not_become_negative() {
        assert_eq!((decrease(1.0, 2.0), decrease(2.0, 0.5)), (0.0, 1.5));
    }

    #[test]
    fn each_trip_lasts_four_times_longer_up_to_the_longest() {
        let (tables, mut monitor) = (tables(), LoopMonitor::new(&tables()));
        let times = [(); 4].map(|()| {
            monitor.trip(&tables);
            monitor.remaining_trip
        });
        assert_eq!(times, [10.0, 40.0, 120.0, 120.0]);
    }

    #[test]
    fn jump_of_the_set_point_is_granted() {
        let granted = |jump: f64| {
            let mut monitor = LoopMonitor { judged_time: 6.0, last_error: Some(0.0), ..LoopMonitor::new(&tables()) };
            monitor.update_mean_square(&tables(), &LoopState { error: jump * HALF_GAP, ..state() });
            monitor.granted_square
        };
        assert_eq!(granted(0.24), 0.0);
        assert!((granted(-0.26) - f64::powi(0.26 * HALF_GAP, 2)).abs() < 1e-15);
    }

    #[test]
    fn load_that_is_no_number_is_not_judged() {
        let mut monitor = LoopMonitor { unexplained: 9.0, ..LoopMonitor::new(&tables()) };
        let spoilt = MonitorInput { load: f64::NAN, ..input(0.0) };
        monitor.step(&tables(), &state(), &spoilt, Some(Flank::Drive));
        assert!(!monitor.is_tripped() && monitor.load == [0.0; 2]);
    }

    #[test]
    fn error_at_takeover_is_granted() {
        let granted = |judged_time| {
            let mut monitor = LoopMonitor { judged_time, ..LoopMonitor::new(&tables()) };
            monitor.update_mean_square(&tables(), &LoopState { error: 1e-2, ..state() });
            monitor.granted_square
        };
        assert_eq!([granted(5.99), granted(6.01)], [1e-4, 0.0]);
    }

    #[test]
    fn worst_error_of_plain_control_halves_in_1400_ms() {
        let mut monitor = LoopMonitor { worst_error: 1.0, ..LoopMonitor::new(&tables()) };
        (0..462).for_each(|_| monitor.step(&tables(), &state(), &input(0.0), None));
        assert!((monitor.worst_error - 0.5).abs() < 1e-2, "{}", monitor.worst_error);
    }

    #[test]
    fn tripped_monitor_retries_after_its_time() {
        let (tables, mut monitor) = (tables(), LoopMonitor::new(&tables()));
        monitor.trip(&tables);
        (0..3332).for_each(|_| monitor.step(&tables, &state(), &input(0.0), None));
        assert!(monitor.is_tripped());
        (0..3).for_each(|_| monitor.step(&tables, &state(), &input(0.0), None));
        assert!(!monitor.is_tripped());
    }

    #[test]
    fn slow_load_follows_in_40_ms() {
        let (tables, mut monitor) = (q1::<f64>(), LoopMonitor::new(&q1()));
        // 133 judgements of 3 periods; two stages follow 1 - 2/e in a time constant.
        (0..133).for_each(|_| _ = monitor.demand(&tables, &MonitorInput { load: 1.0, ..input(0.0) }));
        assert!((monitor.load[1] - 0.264).abs() < 0.01, "{}", monitor.load[1]);
    }

    #[test]
    fn error_of_a_third_of_the_half_gap_is_calm() {
        let left = |part: f64| {
            let mean_square = f64::powi(part * HALF_GAP, 2);
            let mut monitor = LoopMonitor { unexplained: 1.0, mean_square, ..LoopMonitor::new(&q1()) };
            monitor.decay_count(&q1(), &state(), &input(0.0), 3e-3);
            monitor.unexplained
        };
        assert!((left(0.34) - 0.94).abs() < 1e-12 && (left(0.36) - 0.997).abs() < 1e-12);
    }

    #[test]
    fn squared_error_is_averaged_over_150_ms() {
        let (tables, mut monitor) = (q1::<f64>(), LoopMonitor { judged_time: 6.0, ..LoopMonitor::new(&q1()) });
        let erring = LoopState { error: 1.0, ..state() };
        // 500 judgements of 3 periods.
        (0..500).for_each(|_| monitor.update_mean_square(&tables, &erring));
        assert!((monitor.mean_square - 0.632).abs() < 1e-3, "{}", monitor.mean_square);
    }

    #[test]
    fn demand_permits_three_tenths_of_its_deflection() {
        let tables = q1::<f64>();
        let hunts = |part: f64| {
            let monitor = LoopMonitor { mean_square: f64::powi(part * HALF_GAP, 2), ..LoopMonitor::new(&tables) };
            // The demand deflects the spring of the loop by the half-gap.
            monitor.hunts(&tables, &state(), &input(0.0), tables.law.position * HALF_GAP)
        };
        assert!(!hunts(1.79) && hunts(1.81));
    }

    #[test]
    fn plain_control_lasts_at_most_120_s() {
        let (tables, mut monitor) = (q1::<f64>(), LoopMonitor::new(&q1()));
        let times = [(); 4].map(|()| {
            monitor.trip(&tables);
            monitor.remaining_trip
        });
        assert_eq!(times, [10.0, 40.0, 120.0, 120.0]);
    }
}
