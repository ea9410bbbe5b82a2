//! Case R, what a robot joint does: joint Q1 with ripple and error run up and down, reversed through its gap at three
//! torques and three frequencies, struck at the link and left to fly in its gap, at ten thousand ticks a second. Open
//! loop, without friction and sensors, so that two integrators can be held against each other.
//!
//! Q1's planets weigh 0.6 % of what moves with the motor and rattle without rule after every crossing of the gap: two
//! integrators agree on the link's angle, on the gap and on the net force, hardly on a single planet's mesh.

use std::f64::consts::{PI, TAU};
use std::ops::Range;

use model_core::joint::JointParameters;
use model_core::mesh::{DampingLaw, MeshPhases, StiffnessWave};

use super::joints::{q1, same};
use crate::reference::{Reference, ReferenceError, Start};

/// Ticks in one second [Hz].
pub const TICK_RATE: u32 = 10_000;

/// Rated torque at the link [N m].
const RATED: f64 = 12.0;

/// Speed of the run [rad/s].
const RUN_SPEED: f64 = TAU;

/// From rest to rest again [s].
const RUN_TIME: f64 = 0.4;

/// Frequency of the reversals [Hz], and how many periods of each.
const REVERSALS: [(f64, f64); 3] = [(1.0, 1.0), (5.0, 2.0), (20.0, 4.0)];

/// Torque of the reversals over the rated one.
const SHARES: [f64; 3] = [1.0, 0.2, 0.05];

/// A joint, its torques tick by tick, and where each part of the motion begins and ends.
#[derive(Debug, Clone, PartialEq)]
pub struct CaseR {
    /// The joint; it starts still.
    pub joint: JointParameters,
    /// Drive torque on the sun and load torque braking the link, held over each tick [N m].
    pub torques: Vec<[f64; 2]>,
    /// Parts of the motion, in order and without gaps.
    pub parts: Vec<Part>,
}

/// A part of the motion.
#[derive(Debug, Clone, PartialEq)]
pub struct Part {
    /// What is done.
    pub name: String,
    /// Its ticks.
    pub ticks: Range<usize>,
}

/// What is compared, at the end of a tick.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// Angle of the link [rad].
    pub link_angle: f64,
    /// Largest force in any mesh, whatever its sign [N].
    pub mesh_force: f64,
    /// Mesh forces that the sun feels, together [N].
    pub sun_force: f64,
}

/// How far a motion is from the reference's.
#[derive(Debug, Clone, PartialEq)]
pub struct Distance {
    /// Root mean square of the error of the link's angle, over the lost motion.
    pub angle_rms: f64,
    /// Its largest size, likewise.
    pub angle_worst: f64,
    /// Error of the largest force in any mesh, for each part, over that force.
    pub peaks: Vec<f64>,
    /// Error of the largest net force on the sun, likewise.
    pub sun_peaks: Vec<f64>,
}

/// Case R on joint Q1 with stiffness ripple 0.15 and errors of 3 um, phases by tooth counts.
pub fn case_r() -> CaseR {
    let mut joint = q1();
    joint.damping_law = DampingLaw::Contact;
    joint.rated_output_torque = RATED;
    for mesh in [&mut joint.sun_planet, &mut joint.ring_planet] {
        mesh.stiffness_wave = StiffnessWave::Harmonic { stiffness_ratio: 0.15 };
        mesh.transmission_error = same(joint.geometry.planets, 3e-6);
        mesh.phases = MeshPhases::FromTeeth { stiffness: 0.0, error: 0.0 };
    }
    on(joint)
}

/// The same motion on another joint: torques are parts of its rated one, the run is as fast.
pub fn on(joint: JointParameters) -> CaseR {
    let ratio = ratio(&joint);
    let rated = joint.rated_output_torque;
    let mut case = CaseR { torques: Vec::new(), parts: Vec::new(), joint };
    // A sine of torque whose half wave takes the whole joint to its speed.
    let run = PI * RUN_SPEED * case.inertia() / RUN_TIME;
    case.part("run up and down", RUN_TIME, |time| [run * (TAU * time / RUN_TIME).sin() / ratio, 0.0]);
    for (frequency, periods) in REVERSALS {
        for share in SHARES {
            let name = format!("reversals of {:.0} % at {frequency:.0} Hz", 100.0 * share);
            let torque = share * rated / ratio;
            // A cosine's sign: the joint is at rest again after each period.
            let sign = |time: f64| (TAU * frequency * time).cos().signum();
            case.part(&name, periods / frequency, |time| [torque * sign(time), 0.0]);
        }
    }
    let held = 0.5 * rated;
    case.part("held at half torque", 0.1, |_| [held / ratio, held]);
    for (name, impact) in [("impact against the drive", 3.0 * rated), ("impact along the drive", -3.0 * rated)] {
        case.part(name, 0.1, |time| [held / ratio, if time < 0.01 { held + impact } else { held }]);
    }
    case.part("free flight", 0.1, |_| [0.0, 0.0]);
    case
}

fn ratio(joint: &JointParameters) -> f64 {
    1.0 + f64::from(joint.geometry.ring_teeth) / f64::from(joint.geometry.sun_teeth)
}

impl CaseR {
    /// Length in ticks.
    pub fn ticks(&self) -> usize {
        self.torques.len()
    }

    /// Lost motion at the output, 2b / (r_c cos alpha) [rad].
    pub fn lost_motion(&self) -> f64 {
        2.0 * self.joint.sun_planet.half_backlash[0] / self.lever()
    }

    /// The reference's motion: one sample for the end of each tick.
    pub fn reference(&self, start: &Start) -> Result<Vec<Sample>, ReferenceError> {
        let mut reference = Reference::start(&self.joint, start)?;
        let mut samples = Vec::with_capacity(self.ticks());
        for (tick, [drive, load]) in self.torques.iter().enumerate() {
            reference.advance((tick + 1) as f64 / f64::from(TICK_RATE), *drive, *load)?;
            let now = reference.observe();
            let forces = now.mesh_forces.iter().flatten();
            samples.push(Sample {
                link_angle: now.link_angle,
                mesh_force: forces.fold(0.0, |peak: f64, force| peak.max(force.abs())),
                sun_force: now.sun_force(),
            });
        }
        Ok(samples)
    }

    /// How far a motion is from the reference's.
    ///
    /// # Panics
    /// If either has not one sample for each tick.
    pub fn distance(&self, reference: &[Sample], motion: &[Sample]) -> Distance {
        assert_eq!(reference.len(), self.ticks(), "one sample a tick");
        assert_eq!(motion.len(), self.ticks(), "one sample a tick");
        let (mut squares, mut worst) = (0.0, 0.0);
        for (right, found) in reference.iter().zip(motion) {
            let error = (found.link_angle - right.link_angle) / self.lost_motion();
            squares += error * error;
            // Not `max`, which would pass over what is no number.
            worst = if error.abs() <= worst { worst } else { error.abs() };
        }
        let peaks = |of: fn(&Sample) -> f64| -> Vec<f64> {
            let peak = |samples: &[Sample]| samples.iter().fold(0.0, |peak: f64, sample| peak.max(of(sample).abs()));
            self.parts
                .iter()
                .map(|part| peak(&motion[part.ticks.clone()]) / peak(&reference[part.ticks.clone()]) - 1.0)
                .collect()
        };
        Distance {
            angle_rms: (squares / self.ticks() as f64).sqrt(),
            angle_worst: worst,
            peaks: peaks(|sample| sample.mesh_force),
            sun_peaks: peaks(|sample| sample.sun_force),
        }
    }

    /// r_c cos(alpha) [m].
    fn lever(&self) -> f64 {
        self.joint.geometry.carrier_radius * self.joint.geometry.working_pressure_angle.cos()
    }

    /// Of everything that turns, felt at the link [kg m^2].
    fn inertia(&self) -> f64 {
        let joint = &self.joint;
        let (bodies, planets) = (&joint.bodies, joint.geometry.planets as f64);
        let sun = joint.rotor_inertia + bodies.sun_equivalent_mass * joint.geometry.sun_base_radius.powi(2);
        let carrier = bodies.carrier_inertia_over_radius_squared + planets * bodies.planet_mass;
        joint.link_inertia
            + ratio(joint).powi(2) * sun
            + planets * bodies.planet_equivalent_mass * self.lever().powi(2)
            + carrier * joint.geometry.carrier_radius.powi(2)
    }

    /// Adds a part; torques are those in the middle of each tick.
    fn part(&mut self, name: &str, duration: f64, torques: impl Fn(f64) -> [f64; 2]) {
        let from = self.ticks();
        let ticks = (duration * f64::from(TICK_RATE)).round() as usize;
        self.torques.extend((0..ticks).map(|tick| torques((tick as f64 + 0.5) / f64::from(TICK_RATE))));
        self.parts.push(Part { name: name.into(), ticks: from..self.ticks() });
    }
}
