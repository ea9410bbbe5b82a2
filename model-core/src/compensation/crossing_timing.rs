//! Duration of a crossing.
//!
//! ```text
//! (K8)  T_c = max(2 h/v_x + ramp, 2 ramp),   v_x = M_x/Z
//!       ramp = max(q v_x, 4 T_r), or max(sqrt(2 h q), 4 T_r) if v_x is not reached
//! ```
//!
//! Symbols: T_c = `duration`, M_x = `force`, 1/Z = `strike_speed_per_torque`, q = `ramp_per_speed`, 4 T_r =
//! `shortest_ramp`.

use crate::compensation::tables::CompensationTables;
use crate::numbers::Real;
use crate::numbers::arithmetic::clamp;
use crate::numbers::state_words::state_words;

/// Times of a crossing.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct CrossingTiming<T: Real> {
    /// Duration of the path [s].
    pub duration: T,
    /// Duration of each of the two ramps, to and from the steady speed [s]; at most half of `duration`.
    pub ramp: T,
}
state_words! { struct CrossingTiming<T> { duration, ramp } }

impl<T: Real> CrossingTiming<T> {
    /// Crossing of a gap of twice `half`. The force on planets struck on the way is at most a share of the rated force
    /// or, if larger, `demand`, up to a share of the peak torque. Ramps are as steep as the motor's torque and the
    /// delays of the loop permit.
    pub fn new(tables: &CompensationTables<T>, half: T, demand: T) -> Self {
        let force = clamp(demand.abs(), tables.crossing.strike_torque, tables.crossing.hardest_strike);
        let speed = force * tables.crossing.strike_speed_per_torque;
        let longest = tables.crossing.longest;
        if speed <= T::ZERO {
            return Self { duration: longest, ramp: tables.crossing.shortest_ramp };
        }
        let Self { duration, ramp } =
            Self::at(speed, half + half, tables.crossing.ramp_per_speed, tables.crossing.shortest_ramp);
        Self { duration: clamp(duration, T::ZERO, longest), ramp: clamp(ramp, T::ZERO, T::HALF * longest) }
    }

    /// Crossing of a distance at a speed, without a bound of the duration. `ramp_per_speed` is the duration of a ramp
    /// per unit of speed.
    pub fn at(speed: T, way: T, ramp_per_speed: T, shortest_ramp: T) -> Self {
        let along = way / speed;
        let steepest = ramp_per_speed * speed;
        // If the gap ends before the speed is reached, the path consists of two ramps.
        let ramp = if steepest > along { (ramp_per_speed * way).square_root() } else { steepest };
        let ramp = if ramp < shortest_ramp { shortest_ramp } else { ramp };
        let (flat, twice) = (ramp + along, ramp + ramp);
        Self { duration: if flat < twice { twice } else { flat }, ramp }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compensation::test_bench::{q1, tables};

    #[test]
    fn wide_gap_has_a_steady_speed() {
        let timing = CrossingTiming::at(0.2, 20e-3, 0.15, 8e-3);
        assert!((timing.ramp - 30e-3).abs() < 1e-12 && (timing.duration - 130e-3).abs() < 1e-12);
    }

    #[test]
    fn narrow_gap_is_two_ramps() {
        let timing = CrossingTiming::at(0.6, 4e-3, 0.15, 8e-3);
        assert!((timing.ramp - f64::sqrt(0.15 * 4e-3)).abs() < 1e-6);
        assert_eq!(timing.duration, 2.0 * timing.ramp);
    }

    #[test]
    fn ramp_is_never_shorter_than_the_delays_allow() {
        let timing = CrossingTiming::at(0.2, 1e-6, 0.15, 8e-3);
        assert_eq!((timing.ramp, timing.duration), (8e-3, 16e-3));
    }

    #[test]
    fn small_demand_strikes_with_the_least_force() {
        let at = |demand| CrossingTiming::new(&tables(), 4e-3, demand).duration;
        assert_eq!([at(0.0), at(-1.9)], [at(2.0); 2]);
    }

    #[test]
    fn large_demand_crosses_faster_up_to_the_hardest_strike() {
        let at = |demand| CrossingTiming::new(&tables(), 20e-3, demand).duration;
        let tables = tables();
        assert!(at(3.0) <= at(2.0));
        assert_eq!(at(6.0), at(60.0));
        assert!(at(6.0) <= tables.crossing.longest);
    }

    #[test]
    fn duration_is_bounded() {
        let timing = CrossingTiming::new(&tables(), 1.0, 0.0);
        assert_eq!((timing.duration, timing.ramp), (60e-3, 30e-3));
    }

    #[test]
    fn joint_without_a_strike_speed_takes_the_longest_time() {
        let mut tables = tables();
        tables.crossing.strike_speed_per_torque = 0.0;
        assert_eq!(CrossingTiming::new(&tables, 2e-3, 5.0).duration, 60e-3);
    }

    #[test]
    fn ramp_takes_four_fifths_of_torque() {
        let tables = q1::<f64>();
        let CrossingTiming { ramp, .. } = CrossingTiming::at(1.0, 1.0, tables.crossing.ramp_per_speed, 0.0);
        // A ramp without a jump accelerates by one and a half times its mean.
        let torque = tables.body.motor_inertia * 1.5 / ramp;
        assert!((torque / tables.limits.motor - 0.8).abs() < 1e-9, "{torque}");
    }

    #[test]
    fn crossing_takes_at_most_three_guesses() {
        let tables = q1::<f64>();
        let duration =
            |half_backlash: f64| CrossingTiming::new(&tables, half_backlash * tables.gear.inverse_lever, 0.0).duration;
        assert!((duration(1.0) / duration(40e-6) - 3.0).abs() < 1e-9);
    }
}
