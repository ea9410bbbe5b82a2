//! The recommended test, simulated: the f64 reference of a joint file in its drive train, reversed by torque steps,
//! recorded as by a drive. It shares only the joint file with the fits.

use model_core::gears::Kinematics;
use std::fmt::Write as _;

use joint_file::JointFile;
use reference::drive_train::Measurement;

use super::prior::PriorModel;
use report::failure::{Failure, Outcome};
use report::interruption;
use scenario::plant::{PlantName, plant};
use scenario::surroundings::train;

/// Torques of the quick reversals as shares of the largest; the compliance needs several.
const QUICK_TORQUE_SHARES: [f64; 4] = [1.0, 0.7, 0.45, 0.25];
/// Quick reversals per share.
const QUICK_REVERSALS: usize = 8;
/// Time between quick reversals [s].
const QUICK_INTERVAL: f64 = 0.12;
/// Largest speed of the output by quick reversals [rad/s].
const QUICK_SPEED_MAX: f64 = 12.0;
/// Time between slow reversals, which turn the output [s].
const SLOW_INTERVAL: f64 = 1.5;
/// Travel between slow reversals [rad].
const SLOW_TRAVEL: f64 = 7.5;
/// Shares of the slow torque of the two series of slow reversals.
const SLOW_TORQUE_SHARES: [f64; 2] = [1.0, 0.7];

/// One sample.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// Motor and output counts.
    pub seen: Measurement,
    /// Commanded motor torque [N m].
    pub torque: f64,
    /// Torque from the joint to its link [N m].
    pub output_torque: f64,
}

/// Recording of a simulated test.
#[derive(Debug, Clone, PartialEq)]
pub struct VirtualRecording {
    /// Samples in order of time.
    pub samples: Vec<Sample>,
    /// Sampling rate [Hz].
    pub rate: f64,
}

/// Torque steps of the test: duration [s] and torque [N m].
pub fn torque_sequence(file: &JointFile) -> Vec<(f64, f64)> {
    let prior = PriorModel::from_file(file);
    let inertia = prior.total_inertia();
    let dry = prior.surroundings.load_friction.coulomb + prior.ratio() * prior.surroundings.motor_friction.coulomb;
    let at_motor = |acceleration: f64, brake: f64| {
        ((inertia * acceleration + brake) / prior.ratio()).min(file.profile.motor_torque_limit)
    };
    let strongest = at_motor(2.0 * QUICK_SPEED_MAX / QUICK_INTERVAL, dry).min(file.profile.drive_torque.abs());
    // Between opposite speeds the output describes a parabola.
    let brake = dry + 1.2 * prior.surroundings.gravity_torque.abs();
    let slow = at_motor(8.0 * SLOW_TRAVEL / (SLOW_INTERVAL * SLOW_INTERVAL), brake);
    let mut torque_sequence = vec![(0.05, 0.0)];
    let mut series = |time: f64, torque: f64, reversals: usize| {
        torque_sequence.push((0.5 * time, torque));
        torque_sequence.extend((1..reversals).map(|index| (time, if index % 2 == 1 { -torque } else { torque })));
        torque_sequence.push((0.5 * time, if reversals % 2 == 1 { -torque } else { torque }));
    };
    QUICK_TORQUE_SHARES.iter().for_each(|share| series(QUICK_INTERVAL, share * strongest, QUICK_REVERSALS));
    SLOW_TORQUE_SHARES
        .iter()
        .for_each(|share| series(SLOW_INTERVAL, (share * slow).max(0.3 * slow + brake / prior.ratio()), 3));
    torque_sequence
}

/// Simulates the test.
pub fn record(file: &JointFile, seed: u64, at: &dyn Fn(f64)) -> Outcome<VirtualRecording> {
    let train = train(&file.surroundings, seed);
    let rate = f64::from(file.surroundings.control_rate);
    let lever = file.parameters.geometry.carrier_base_radius();
    let mut plant = plant(PlantName::Reference, &file.parameters, &train, Vec::new(), seed)?;
    let torque_sequence = torque_sequence(file);
    let whole: f64 = torque_sequence.iter().map(|(time, _)| time).sum();
    let mut samples = Vec::new();
    for (time, torque) in torque_sequence {
        for _ in 0..(time * rate).round() as usize {
            if samples.len() % 1000 == 0 {
                at(samples.len() as f64 / rate / whole);
                if interruption::requested() {
                    return Err(Failure::interrupted("stopped by the user"));
                }
            }
            let joint = plant.joint();
            let output_torque = if file.parameters.compliance.is_some() {
                joint.wind_up_torque
            } else {
                joint.mesh_forces.iter().flatten().sum::<f64>() * lever
            };
            samples.push(Sample { seen: plant.measure(), torque, output_torque });
            plant.advance(torque).map_err(|error| Failure::new(format!("the joint cannot be simulated: {error}")))?;
        }
    }
    Ok(VirtualRecording { samples, rate })
}

impl VirtualRecording {
    /// Log as CSV.
    pub fn csv(&self, with_output_torque: bool) -> String {
        let more = if with_output_torque { ",output_torque_N_m" } else { "" };
        let mut text = format!("time_s,motor_counts,output_counts,motor_torque_N_m{more}\n");
        for Sample { seen, torque, output_torque } in &self.samples {
            let time = seen.period as f64 / self.rate;
            // Writing to a string cannot fail.
            let _ = write!(text, "{time:.6},{},{},{torque:.6}", seen.motor_counts, seen.output_counts);
            let _ = if with_output_torque { writeln!(text, ",{output_torque:.6}") } else { writeln!(text) };
        }
        text
    }
}
