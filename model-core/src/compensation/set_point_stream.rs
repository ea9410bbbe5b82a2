//! Stream of impedance set-points: interval between set-points, and extrapolation between two of them.

use super::set_point::ImpedancePoint;
use crate::compensation::tables::CompensationTables;
use crate::numbers::Real;
use crate::numbers::arithmetic::clamp;
use crate::numbers::state_words::state_words;

/// State of the stream.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct SetPointStream<T: Real> {
    last: Option<ImpedancePoint<T>>,
    /// Time for which the last set-point has been held [s].
    hold_time: T,
    /// Usual interval between set-points [s].
    interval: T,
    /// Rate of the commanded torque [N m/s].
    torque_rate: T,
    /// Travel of the point between the last two set-points [turns].
    travel: T,
}
state_words! { struct SetPointStream<T> { last, hold_time, interval, torque_rate, travel } }

impl<T: Real> SetPointStream<T> {
    /// Updates the stream by the set-point of a period.
    pub fn step(&mut self, tables: &CompensationTables<T>, point: &ImpedancePoint<T>) {
        match self.last {
            Some(last) if last == *point => {
                self.hold_time = clamp(self.hold_time + tables.clock.period, T::ZERO, tables.law.longest_hold);
                if self.rests(tables) {
                    self.torque_rate = T::ZERO;
                }
            }
            Some(last) => {
                // A set-point held for the longest time gives no interval; a shorter hold gives a new interval.
                if self.hold_time < tables.law.longest_hold {
                    self.interval = self.hold_time + tables.clock.period;
                }
                let between = if self.interval > tables.clock.period { self.interval } else { tables.clock.period };
                let rate = (point.torque - last.torque) / between;
                // Half of the change: jitter between set-points is no trend.
                self.torque_rate = T::HALF * (self.torque_rate + rate);
                self.travel = point.position.difference(last.position.turns, last.position.fraction);
                self.hold_time = T::ZERO;
            }
            None => {}
        }
        self.last = Some(*point);
    }

    /// Rate of the commanded torque [N m/s].
    pub fn torque_rate(&self) -> T {
        self.torque_rate
    }

    /// Speed of the set-point or, if zero, the last travel of the point: only the sign is used.
    pub fn direction(&self) -> T {
        match self.last {
            Some(last) if last.speed != T::ZERO => last.speed,
            _ => self.travel,
        }
    }

    /// Time for which the set-point has been held beyond the mean hold [s]: a moving point is extrapolated over it;
    /// zero at rest.
    pub fn extrapolation_time(&self, tables: &CompensationTables<T>) -> T {
        if self.rests(tables) { T::ZERO } else { self.hold_time - T::HALF * self.interval }
    }

    /// True if the set-point has been held so long that it stands still or the stream has ended.
    pub fn rests(&self, tables: &CompensationTables<T>) -> bool {
        let missed = self.interval > T::ZERO && self.hold_time > T::TWO * self.interval;
        missed || self.hold_time >= tables.law.longest_hold
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compensation::set_point::Position;
    use crate::compensation::test_bench::{q1, tables};

    /// Returns a stream of set-points with a torque [N m], each held for a number of periods.
    fn stream(torques: &[f64], periods: u32) -> SetPointStream<f64> {
        let mut stream = SetPointStream::default();
        for torque in torques {
            let point = ImpedancePoint { torque: *torque, speed: 1.0, ..ImpedancePoint::default() };
            (0..periods).for_each(|_| stream.step(&tables(), &point));
        }
        stream
    }

    #[test]
    fn first_set_point_has_no_rate() {
        assert_eq!(stream(&[5.0], 1).torque_rate(), 0.0);
    }

    #[test]
    fn change_of_torque_counts_by_half() {
        // 1 N m in two periods.
        assert_eq!(stream(&[0.0, 1.0], 2).torque_rate(), 250.0);
    }

    #[test]
    fn set_point_held_twice_its_interval_rests() {
        let mut stream = stream(&[0.0, 1.0], 2);
        let point = ImpedancePoint { torque: 1.0, speed: 1.0, ..ImpedancePoint::default() };
        assert!(!stream.rests(&tables()));
        (0..3).for_each(|_| stream.step(&tables(), &point));
        assert!(!stream.rests(&tables()), "held for exactly twice the interval");
        stream.step(&tables(), &point);
        assert!(stream.rests(&tables()));
        assert_eq!((stream.torque_rate(), stream.extrapolation_time(&tables())), (0.0, 0.0));
    }

    #[test]
    fn set_point_held_for_the_longest_time_rests() {
        assert!(!stream(&[1.0], 5).rests(&tables()) && stream(&[1.0], 6).rests(&tables()));
    }

    #[test]
    fn moving_point_is_extrapolated_beyond_the_mean_hold() {
        let mut stream = stream(&[0.0, 1.0], 2);
        let point = ImpedancePoint { torque: 1.0, speed: 1.0, ..ImpedancePoint::default() };
        stream.step(&tables(), &point);
        assert!((stream.extrapolation_time(&tables()) - 1e-3).abs() < 1e-12);
    }

    #[test]
    fn direction_without_speed_is_that_of_the_last_travel() {
        let mut stream = SetPointStream::default();
        for fraction in [0.0, -0.25] {
            let position = Position { turns: 0, fraction };
            stream.step(&tables(), &ImpedancePoint { position, ..ImpedancePoint::default() });
        }
        assert_eq!(stream.direction(), -0.25);
    }

    #[test]
    fn set_point_held_for_5_ms_rests() {
        let tables = q1::<f64>();
        let rests = |periods: u32| {
            let mut stream = SetPointStream::default();
            (0..=periods).for_each(|_| stream.step(&tables, &ImpedancePoint::default()));
            stream.rests(&tables)
        };
        // Periods of 0.1 ms. A stream sends at least 200 set-points per second.
        assert!(!rests(49) && rests(51));
    }
}
