//! Compared quantities of a motion at one moment, with their bounds.

use link::messages::Sample;
use reference::joint::Observation;

use crate::record::MotionSample;

/// Compared quantities.
pub const QUANTITIES: [ComparedQuantity; 4] = [
    // Measured on joint Q1: 7.2e-6. The rigid body is exact except for the rounding of torque gains to f32.
    ComparedQuantity { name: "link angle", limit: 1e-4 },
    // Measured: 5.7e-3. Planets bounce for milliseconds after every crossing of the gap, which amplifies the step's
    // error.
    ComparedQuantity { name: "twist of motor against link", limit: 1e-2 },
    // Measured: 2.5e-3. As for the twist; 1 % is the strictest requirement on 20 kHz.
    ComparedQuantity { name: "gap", limit: 1e-2 },
    // Measured: 6.5e-3. As for the twist; the planets' own motion is the fastest of all.
    ComparedQuantity { name: "mesh deflections", limit: 1e-2 },
];

/// Compared quantity.
pub struct ComparedQuantity {
    /// Name of the quantity.
    pub name: &'static str,
    /// Bound of a board's root mean square error against the reference, over the standard deviation [-].
    pub limit: f64,
}

/// Values of the compared quantities at one moment.
#[derive(Debug, Clone, PartialEq)]
pub struct Row([Vec<f64>; QUANTITIES.len()]);

impl Row {
    /// Row of the reference.
    pub fn of_reference(observation: &Observation, ratio: f64) -> Self {
        let deflections = observation.deflections.iter().flatten().copied().collect();
        let twist = observation.motor_offset / ratio - observation.link_offset;
        Self([vec![observation.link_angle], vec![twist], vec![observation.gap], deflections])
    }

    /// Row of a board.
    pub fn of_board(sample: &Sample, ratio: f64) -> Self {
        let motion = MotionSample::from_board(sample, 1);
        let deflections = motion.deflections.iter().copied().map(f64::from).collect();
        let twist = motion.motor_offset / ratio - motion.link_offset;
        Self([vec![motion.carrier_angle + motion.link_offset], vec![twist], vec![motion.gap.into()], deflections])
    }

    /// Distance in one quantity: signed for a single value, otherwise the root mean square over its values.
    pub fn distance(&self, other: &Self, place: usize) -> f64 {
        match (self.0[place].as_slice(), other.0[place].as_slice()) {
            (&[one], &[other]) => one - other,
            (ones, others) => {
                let square: f64 = ones.iter().zip(others).map(|(one, other)| (one - other).powi(2)).sum();
                (square / ones.len() as f64).sqrt()
            }
        }
    }
}

/// Standard deviation of one quantity over time, as a root mean square over its values.
pub fn standard_deviation(rows: &[Row], place: usize) -> f64 {
    let values = rows.first().map_or(0, |row| row.0[place].len());
    let count = rows.len() as f64;
    let variance = |value: usize| {
        let mean = rows.iter().map(|row| row.0[place][value]).sum::<f64>() / count;
        rows.iter().map(|row| (row.0[place][value] - mean).powi(2)).sum::<f64>() / count
    };
    ((0..values).map(variance).sum::<f64>() / values as f64).sqrt()
}
