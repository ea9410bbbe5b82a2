//! Case R, typical loads of a robot joint: joint Q1 with ripple and error is run up and down, reversed through its gap
//! at three torques and three frequencies, hit at the link and left free in its gap, at ten thousand ticks per second.
//! Open loop, without friction and sensors, for the comparison of two integrators.
//!
//! Q1's planets have 0.6 % of the inertia that moves with the motor. They rattle irregularly after every crossing of
//! the gap, and the motion is chaotic: a change of the torques by 1e-9 changes the final position in the gap. Hence the
//! windows: wherever torques jump, the compared integrator is reset to the reference's state and judged up to the next
//! jump.

use std::f64::consts::{PI, TAU};

use parameters::{DampingLaw, JointParameters, MeshPhases, StiffnessWave};

use super::joints::{q1, same};

/// Ticks in one second [Hz].
pub const TICK_RATE: u32 = 10_000;

/// Rated torque at the link [N m].
const RATED_TORQUE: f64 = 12.0;

/// Speed of the run [rad/s].
const RUN_SPEED: f64 = TAU;

/// From rest to rest again [s].
const RUN_TIME: f64 = 0.4;

/// Frequency of the reversals [Hz], and how many periods of each.
const REVERSALS: [(f64, f64); 3] = [(1.0, 1.0), (5.0, 2.0), (20.0, 4.0)];

/// Reversals of the brief form.
const BRIEF_REVERSALS: [(f64, f64); 2] = [(5.0, 0.5), (20.0, 1.0)];

/// Length of each part after the reversals [s].
const PAUSE: f64 = 0.1;
const BRIEF_PAUSE: f64 = 0.05;

/// Length of an impact [s].
const IMPACT_DURATION: f64 = 0.01;

/// Torques of the reversals relative to the rated torque.
const TORQUE_SHARES: [f64; 3] = [1.0, 0.2, 0.05];

/// Change from tick to tick that counts as a jump, relative to the largest torque.
const JUMP_SHARE: f64 = 0.1;

/// Joint, torques per tick, and limits of the parts of the motion.
#[derive(Debug, Clone, PartialEq)]
pub struct CaseR {
    /// Joint; starts at rest.
    pub joint: JointParameters,
    /// Drive torque on the sun and load torque braking the link, held over each tick [N m].
    pub torques: Vec<[f64; 2]>,
    /// Parts of the motion, in order and without gaps.
    pub parts: Vec<Part>,
    /// First ticks of the windows: each part, and each jump of the torques.
    pub windows: Vec<usize>,
}

/// Part of the motion.
#[derive(Debug, Clone, PartialEq)]
pub struct Part {
    /// Name of the part.
    pub name: String,
    /// First tick of the part.
    pub first: usize,
}

/// Case R on joint Q1 with stiffness ripple 0.15 and errors of 3 um, phases by tooth counts.
pub fn case_r() -> CaseR {
    let mut joint = q1();
    joint.damping_law = DampingLaw::Contact;
    joint.rated_output_torque = RATED_TORQUE;
    for mesh in [&mut joint.sun_planet, &mut joint.ring_planet] {
        mesh.stiffness_wave = StiffnessWave::Harmonic { stiffness_ratio: 0.15 };
        mesh.transmission_error = same(joint.geometry.planets, 3e-6);
        mesh.phases = MeshPhases::FromTeeth { stiffness: 0.0, error: 0.0 };
    }
    on(joint)
}

/// Case R on another joint: torques relative to its rated torque, the run at an equal speed.
pub fn on(joint: JointParameters) -> CaseR {
    with_reversals(joint, &REVERSALS, PAUSE)
}

/// Case R with fewer reversals and shorter pauses, a fifth of its length.
pub fn brief(joint: JointParameters) -> CaseR {
    with_reversals(joint, &BRIEF_REVERSALS, BRIEF_PAUSE)
}

fn with_reversals(joint: JointParameters, reversals: &[(f64, f64)], pause: f64) -> CaseR {
    let ratio = ratio(&joint);
    let rated = joint.rated_output_torque;
    let mut case = CaseR { torques: Vec::new(), parts: Vec::new(), windows: Vec::new(), joint };
    // Sine of torque whose half wave accelerates the joint to its speed.
    let run = PI * RUN_SPEED * case.inertia() / RUN_TIME;
    case.part("run up and down", RUN_TIME, |time| [run * (TAU * time / RUN_TIME).sin() / ratio, 0.0]);
    for (frequency, periods) in reversals {
        for share in TORQUE_SHARES {
            let name = format!("reversals of {:.0} % at {frequency:.0} Hz", 100.0 * share);
            let torque = share * rated / ratio;
            // Square wave by the sign of a cosine: the joint is at rest again after each period.
            let sign = |time: f64| (TAU * frequency * time).cos().signum();
            case.part(&name, periods / frequency, |time| [torque * sign(time), 0.0]);
        }
    }
    let held = 0.5 * rated;
    case.part("held at half torque", pause, |_| [held / ratio, held]);
    for (name, impact) in [("impact against the drive", 3.0 * rated), ("impact along the drive", -3.0 * rated)] {
        case.part(name, pause, |time| [held / ratio, if time < IMPACT_DURATION { held + impact } else { held }]);
    }
    case.part("free flight", pause, |_| [0.0, 0.0]);
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

    /// r_c cos(alpha) [m].
    fn lever(&self) -> f64 {
        self.joint.geometry.carrier_radius * self.joint.geometry.working_pressure_angle.cos()
    }

    /// Total inertia, referred to the link [kg m^2].
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

    /// Adds a part; torques are taken at the middle of each tick.
    fn part(&mut self, name: &str, duration: f64, torques: impl Fn(f64) -> [f64; 2]) {
        let first = self.ticks();
        let ticks = (duration * f64::from(TICK_RATE)).round() as usize;
        let added: Vec<[f64; 2]> = (0..ticks).map(|tick| torques((tick as f64 + 0.5) / f64::from(TICK_RATE))).collect();
        let least =
            [0, 1].map(|which| JUMP_SHARE * added.iter().fold(0.0, |most: f64, pair| most.max(pair[which].abs())));
        let jumps = |pair: &[[f64; 2]]| (0..2).any(|which| (pair[1][which] - pair[0][which]).abs() > least[which]);
        self.windows.push(first);
        self.windows.extend((1..ticks).filter(|tick| jumps(&added[tick - 1..=*tick])).map(|tick| first + tick));
        self.torques.extend(added);
        self.parts.push(Part { name: name.into(), first });
    }
}
