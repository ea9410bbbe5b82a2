//! Inertia of the link, from its response to mesh forces that change faster than a weight's torque: a landing, an
//! oscillation of the teeth, a push. Slow responses are not used: weight and inertia are not separable there.
//!
//! ```text
//! (O6)  high_pass(m_now t_f - t_l) = m high_pass(t_f) + noise
//! ```
//!
//! Symbols: m_now = `mobility`, t_f = `stationary_response.torque`, t_l = `load.torque`; left side = `answer`,
//! high_pass(t_f) = `force`.
//!
//! The load filter is linear. Its torque is mobility (designed inertia over inertia) times its response t_f to the mesh
//! torque on a stationary link, less its response to the motion alone. Force and response of the link thus pass one
//! filter, and a changed mobility can be applied to the load side in retrospect.

use super::thresholds::OUTLIER;
use crate::numbers::Real;
use crate::numbers::arithmetic::clamp;
use crate::numbers::state_words::state_words;
use crate::observer::filters::load_side::LoadSide;
use crate::observer::tables::InertiaTable;

/// Estimate of the link's mobility.
#[derive(Debug, Clone, Copy)]
pub struct LinkInertia<T: Real> {
    /// Sum of the mesh torque over the periods of the interval [N m].
    sum: T,
    /// Response of the load filter to the mesh torque on a stationary link.
    stationary_response: LoadSide<T>,
    /// Slow parts of this torque and of the link's response, two stages each [N m].
    slow: [[T; 2]; 2],
    /// Designed inertia over the link's inertia (m) [-].
    mobility: T,
    /// Variance of the mobility [-].
    variance: T,
    /// Mean square of equally fast torques on the link from other sources than the meshes [N^2 m^2].
    external_variance: T,
    /// Intervals of motion in one direction, with constant dry friction; negative for backward motion.
    one_way_intervals: i32,
}
state_words! {
    struct LinkInertia<T> {
        sum, stationary_response, slow, mobility, variance, external_variance, one_way_intervals,
    }
}

impl<T: Real> LinkInertia<T> {
    pub fn new(table: &InertiaTable<T>) -> Self {
        Self {
            sum: T::ZERO,
            stationary_response: LoadSide::default(),
            slow: [[T::ZERO; 2]; 2],
            mobility: T::ONE,
            variance: table.prior,
            external_variance: T::TWO * table.most_restless,
            one_way_intervals: 0,
        }
    }

    /// Saved numbers.
    pub fn saved_numbers(&self) -> impl Iterator<Item = T> {
        [self.mobility, self.variance].into_iter()
    }

    /// Restores the saved numbers.
    pub fn restore_numbers(&mut self, next_number: &mut impl FnMut() -> T) {
        self.mobility = next_number();
        self.variance = next_number();
    }

    /// Returns true if the mobility is within its limits and its variance does not exceed the initial one.
    pub fn is_in_range(&self, table: &InertiaTable<T>) -> bool {
        self.mobility == limit_mobility(table, self.mobility)
            && self.variance >= T::ZERO
            && self.variance <= table.prior + table.drift
    }

    /// Scales the mesh torque of a period by the mobility for the load side.
    pub fn mesh_torque_for_load(&mut self, from_meshes: T) -> T {
        self.sum += from_meshes;
        self.mobility * from_meshes
    }

    /// Inertia over the designed inertia, and its variance [-].
    pub fn ratio(&self) -> [T; 2] {
        let ratio = T::ONE / self.mobility;
        let squared = ratio * ratio;
        [ratio, self.variance * squared * squared]
    }

    /// Updates the mobility once per interval with the link's response.
    pub fn update(&mut self, table: &InertiaTable<T>, load: &mut LoadSide<T>, is_usable: bool) {
        let torque = core::mem::replace(&mut self.sum, T::ZERO) * table.per_periods;
        self.advance_stationary_response(table, torque);
        let [of_force, of_answer] = &mut self.slow;
        let force = high_pass(of_force, table.slow, self.stationary_response.torque);
        let answer = high_pass(of_answer, table.slow, self.mobility * self.stationary_response.torque - load.torque);
        self.count_one_way_motion(table, load.speed, is_usable);
        if self.variance < table.prior {
            self.variance += table.drift;
        }
        if self.one_way_intervals.unsigned_abs() >= table.settled_after {
            self.correct(table, load, force, answer);
        }
    }

    /// Advances the response of the load filter to a mesh torque [N m] on a stationary link by an interval.
    fn advance_stationary_response(&mut self, table: &InertiaTable<T>, mesh_torque: T) {
        let LoadSide { angle_residual, speed, torque } = self.stationary_response;
        let [angle_row, speed_row, torque_row] = table.still.map(|[of_angle, of_speed, of_torque, of_mesh]| {
            of_angle * angle_residual + of_speed * speed + of_torque * torque + of_mesh * mesh_torque
        });
        self.stationary_response = LoadSide { angle_residual: angle_row, speed: speed_row, torque: torque_row };
    }

    /// Counts the intervals of motion in one direction.
    fn count_one_way_motion(&mut self, table: &InertiaTable<T>, speed: T, is_usable: bool) {
        self.one_way_intervals = if !is_usable {
            0
        } else if speed > table.moving && self.one_way_intervals >= 0 {
            self.one_way_intervals.saturating_add(1)
        } else if -speed > table.moving && self.one_way_intervals <= 0 {
            self.one_way_intervals.saturating_sub(1)
        } else {
            0
        };
    }

    /// Corrects the mobility, and the load side in retrospect, with the link's answer to a force, both as fast torques
    /// [N m].
    fn correct(&mut self, table: &InertiaTable<T>, load: &mut LoadSide<T>, force: T, answer: T) {
        let innovation = answer - self.mobility * force;
        // If external forces push the link repeatedly, mesh forces respond to the link instead of the link to mesh
        // forces.
        let mobility_variance = self.variance * force * force;
        let excess = innovation * innovation - mobility_variance;
        self.external_variance +=
            ((if excess > T::ZERO { excess } else { T::ZERO }) - self.external_variance) * table.memory;
        if force.abs() < table.least || self.external_variance > table.most_restless {
            return;
        }
        let expected = table.noise + mobility_variance;
        if innovation * innovation > T::from_i32(OUTLIER.inertia_sigma * OUTLIER.inertia_sigma) * expected {
            return;
        }
        let gain = self.variance * (force / expected);
        let before = self.mobility;
        self.mobility = limit_mobility(table, before + gain * innovation);
        let change = self.mobility - before;
        self.variance -= gain * force * self.variance;
        load.angle_residual += change * self.stationary_response.angle_residual;
        load.speed += change * self.stationary_response.speed;
        load.torque += change * self.stationary_response.torque;
    }
}

/// Limits a mobility to its range.
fn limit_mobility<T: Real>(table: &InertiaTable<T>, mobility: T) -> T {
    T::ONE + clamp(mobility - T::ONE, -table.limit, table.limit)
}

/// Removes the slow parts of a value, and updates them.
fn high_pass<T: Real>(slow: &mut [T; 2], part: T, value: T) -> T {
    slow.iter_mut().fold(value, |value, slow| {
        *slow += (value - *slow) * part;
        value - *slow
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::observer::test_tables::Q1_DOUBLE;

    fn table() -> InertiaTable<f32> {
        InertiaTable {
            per_periods: 0.1,
            still: [[0.0; 4], [0.0; 4], [0.0, 0.0, 0.0, 1.0]],
            slow: 0.1,
            moving: 0.1,
            settled_after: 3,
            least: 1.0,
            noise: 1.0,
            most_restless: 1.0,
            memory: 0.5,
            prior: 0.09,
            limit: 0.9,
            known: 0.02,
            drift: 0.001,
        }
    }

    /// Link of the given mobility that answers mesh torques of alternating sign while it turns forwards.
    fn shaken(mobility: f32, intervals: u16, is_usable: bool) -> LinkInertia<f32> {
        let mut inertia = LinkInertia::new(&table());
        inertia.external_variance = 0.0;
        let mut load = LoadSide { angle_residual: 0.0, speed: 1.0, torque: 0.0 };
        for interval in 0..intervals {
            let torque = if interval % 2 == 0 { 100.0 } else { -100.0 };
            inertia.mesh_torque_for_load(10.0 * torque);
            load.torque = (inertia.mobility - mobility) * torque;
            inertia.update(&table(), &mut load, is_usable);
        }
        inertia
    }

    #[test]
    fn mesh_torque_is_scaled_by_mobility() {
        let mut inertia = LinkInertia::<f32>::new(&table());
        inertia.mobility = 0.5;
        assert_eq!(inertia.mesh_torque_for_load(4.0), 2.0);
        let [ratio, variance] = inertia.ratio();
        assert!(ratio == 2.0 && (variance - 0.09 * 16.0).abs() < 1e-6);
    }

    #[test]
    fn unusable_interval_keeps_mobility() {
        assert_eq!(shaken(0.8, 50, false).mobility, 1.0);
    }

    #[test]
    fn mobility_follows_response() {
        let inertia = shaken(0.98, 60, true);
        assert!((inertia.mobility - 0.98).abs() < 0.01, "{}", inertia.mobility);
    }

    #[test]
    fn reversal_waits_for_slow_parts() {
        assert_eq!(shaken(0.98, u16::try_from(table().settled_after).unwrap_or(0) - 1, true).mobility, 1.0);
    }

    #[test]
    fn mobility_is_limited() {
        assert_eq!(limit_mobility(&table(), 5.0), 1.9);
        assert!((limit_mobility(&table(), -5.0) - 0.1_f32).abs() < 1e-6);
    }

    #[test]
    fn high_pass_removes_constant() {
        let mut slow = [0.0; 2];
        let first: f32 = high_pass(&mut slow, 0.1, 1.0);
        assert!(first > 0.8);
        let last: f32 = (0..500).fold(first, |_, _| high_pass(&mut slow, 0.1, 1.0));
        assert!(last.abs() < 1e-3, "{last}");
    }

    #[test]
    fn response_beyond_four_sigma_is_rejected() {
        // A force of 10 N m with a mobility known to sqrt(0.08), and a noise of 1 N m: deviation of 3 N m.
        let mobility = |innovation: f32| {
            let mut inertia = LinkInertia { variance: 0.08, external_variance: 0.0, ..LinkInertia::new(&table()) };
            let table = InertiaTable { memory: 0.0, ..table() };
            inertia.correct(&table, &mut LoadSide::default(), 10.0, 10.0 + innovation);
            inertia.mobility
        };
        assert!(mobility(11.9) > 1.0 && mobility(-11.9) < 1.0);
        assert_eq!((mobility(12.1), mobility(-12.1)), (1.0, 1.0));
    }

    /// Table of Q1: learning intervals of 1 ms, 15 N m at the link.
    fn designed() -> &'static InertiaTable<f64> {
        &Q1_DOUBLE.inertia
    }

    /// Mobility after one answer to a force [N m], under external torques of a mean square [N^2 m^2].
    fn corrected(force: f64, answer: f64, external_variance: f64) -> f64 {
        let mut inertia = LinkInertia { external_variance, ..LinkInertia::new(designed()) };
        inertia.correct(designed(), &mut LoadSide::default(), force, answer);
        inertia.mobility
    }

    #[test]
    fn mobility_stays_within_90_percent() {
        let limit = |mobility| limit_mobility(designed(), mobility);
        assert!((limit(9.0) - 1.9).abs() < 1e-12 && (limit(-9.0) - 0.1).abs() < 1e-12);
    }

    #[test]
    fn motion_lasts_three_filter_times() {
        // The high-pass filter of 20 ms settles in 60 ms. Each update averages the external torques.
        let is_updated = |intervals: i32| {
            let mut inertia = LinkInertia {
                one_way_intervals: intervals - 1,
                external_variance: 1.0,
                ..LinkInertia::new(designed())
            };
            inertia.update(designed(), &mut LoadSide { speed: 10.0, ..LoadSide::default() }, true);
            inertia.external_variance != 1.0
        };
        assert!(!is_updated(59) && is_updated(60));
    }

    #[test]
    fn force_below_a_twentieth_shows_nothing() {
        assert_eq!(corrected(0.74, 0.8, 0.0), 1.0);
        assert!(corrected(0.76, 0.8, 0.0) > 1.0);
    }

    #[test]
    fn pushes_are_averaged_over_half_a_second() {
        let mut inertia = LinkInertia { external_variance: 1.0, ..LinkInertia::new(designed()) };
        (0..500).for_each(|_| inertia.correct(designed(), &mut LoadSide::default(), 1.0, 1.0));
        assert!((inertia.external_variance - 0.368).abs() < 1e-3, "{}", inertia.external_variance);
    }

    #[test]
    fn pushes_of_half_the_noise_pause_inertia() {
        // Noise of 0.32 N m in the filter and of 1 % of the motor's limit: a mean square of 0.127 N^2 m^2.
        assert!(corrected(5.0, 6.0, 0.061) > 1.0);
        assert_eq!(corrected(5.0, 6.0, 0.066), 1.0);
    }

    #[test]
    fn ten_intervals_count_as_one_answer() {
        // Prior of 0.09, ten times the noise of 0.127 N^2 m^2.
        let gain = 0.09 * 5.0 / (1.27 + 0.09 * 25.0);
        assert!((corrected(5.0, 6.0, 0.0) - 1.0 - gain).abs() < 1e-3, "{}", corrected(5.0, 6.0, 0.0));
    }
}
