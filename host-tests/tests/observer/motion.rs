//! Joints in motion under a plain motor controller, recorded with what is measured and what is true. The controller
//! uses the motor encoder alone, so that no recording depends on the observer that it is to judge.

use model_core::gears::{Kinematics, Mechanics};
use std::f64::consts::TAU;

use parameters::JointParameters;
use reference::drive_train::{Disturbance, DriveTrain, DriveTrainParameters};
use reference::joint::Start;

/// Poles of the motor controller [rad/s].
const BANDWIDTH: f64 = 60.0;

/// Poles of its observer of the motor alone, fast enough for a motor that is alone inside the gap [rad/s].
const TRACKING: f64 = 1200.0;

/// One control period: what was measured at its end, and the truth then.
#[derive(Debug, Clone, Copy)]
pub struct Moment {
    /// Command that was in force during the period [N m].
    pub command: f64,
    /// Motor encoder at the end.
    pub motor_counts: i64,
    /// Output encoder at the end.
    pub output_counts: i64,
    /// True gap coordinate [m].
    pub gap: f64,
    /// True net sun mesh force [N].
    pub sun_force: f64,
    /// True torque that brakes the link [N m].
    pub load_torque: f64,
    /// True angle and speed of the link [rad, rad/s].
    pub link: [f64; 2],
    /// True angle and speed of the motor [rad, rad/s].
    pub motor: [f64; 2],
}

/// What the link is to do.
#[derive(Debug, Clone)]
pub enum Profile {
    /// Amplitude times a sine [rad, Hz].
    Sine(f64, f64),
    /// Sines from 0.2 Hz up to the highest given, phases and sizes by the seed: [largest acceleration rad/s^2, Hz].
    Random(f64, f64),
    /// Standing still.
    Hold,
}

/// A recording to make.
#[derive(Debug, Clone)]
pub struct Run {
    /// The joint.
    pub joint: JointParameters,
    /// What surrounds it.
    pub train: DriveTrainParameters,
    /// What it does.
    pub profile: Profile,
    /// What acts on it.
    pub disturbances: Vec<Disturbance>,
    /// Of noise, phases and profiles.
    pub seed: u64,
    /// [s].
    pub duration: f64,
    /// A fifth of the motion until then, all of it half a second later [s].
    pub grows_at: Option<f64>,
    /// From when on every mesh has another half-backlash, and which [s, m].
    pub worn: Option<(f64, f64)>,
}

/// Position, speed and acceleration to follow.
pub struct Reference(Vec<[f64; 3]>);

impl Reference {
    /// Of a profile.
    pub fn new(profile: &Profile, seed: u64) -> Self {
        match *profile {
            Profile::Hold => Self(Vec::new()),
            Profile::Sine(amplitude, frequency) => Self(vec![[amplitude, TAU * frequency, 0.0]]),
            Profile::Random(acceleration, highest) => {
                let mut uniform = uniform(seed);
                let tones = 5;
                Self(
                    (0..tones)
                        .map(|_| {
                            let rate = TAU * 0.2 * (highest / 0.2).powf(uniform());
                            // Slow tones are kept to a turn or less.
                            let amplitude = (acceleration / f64::from(tones) / (rate * rate)).min(0.3);
                            [amplitude * (0.6 + 0.8 * uniform()), rate, TAU * uniform()]
                        })
                        .collect(),
                )
            }
        }
    }

    /// At a time [rad, rad/s, rad/s^2].
    pub fn at(&self, time: f64) -> [f64; 3] {
        // Begins at rest and is all there after 0.2 s.
        let s = (time / 0.2).min(1.0);
        let start = [
            s * s * s * (10.0 - 15.0 * s + 6.0 * s * s),
            30.0 * s * s * (1.0 - s).powi(2) / 0.2,
            60.0 * s * (1.0 - s) * (1.0 - 2.0 * s) / 0.04,
        ];
        let mut sum = [0.0; 3];
        for [amplitude, rate, phase] in &self.0 {
            let (sine, cosine) = (rate * time + phase).sin_cos();
            let (zero, _) = phase.sin_cos();
            sum[0] += amplitude * (sine - zero);
            sum[1] += amplitude * rate * cosine;
            sum[2] -= amplitude * rate * rate * sine;
        }
        [
            sum[0] * start[0],
            sum[1] * start[0] + sum[0] * start[1],
            sum[2] * start[0] + 2.0 * sum[1] * start[1] + sum[0] * start[2],
        ]
    }
}

/// Numbers from 0 to 1 that a seed determines.
pub fn uniform(seed: u64) -> impl FnMut() -> f64 {
    let mut state = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15).wrapping_add(0x1234_5678_9abc_def1);
    move || {
        state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut word = (state ^ (state >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        word = (word ^ (word >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((word ^ (word >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }
}

/// Inertia of the joint felt at its motor while it moves as one [kg m^2].
pub fn inertia_at_motor(joint: &JointParameters) -> f64 {
    let geometry = &joint.geometry;
    let planets = geometry.planets as f64 * joint.bodies.planet_equivalent_mass;
    let carrier = (joint.carrier_equivalent_mass() + planets) * geometry.carrier_base_radius().powi(2);
    joint.rotor_inertia
        + joint.bodies.sun_equivalent_mass * geometry.sun_base_radius.powi(2)
        + (joint.link_inertia + carrier) / geometry.ratio_by_teeth().powi(2)
}

/// The motor controller: a triple pole on the total inertia, with feed-forward and back-calculation, behind an observer of
/// the motor alone.
#[derive(Debug)]
pub struct MotorController {
    ratio: f64,
    inertia: f64,
    motor_inertia: f64,
    limit: f64,
    per_count: f64,
    /// Control period [s].
    pub period: f64,
    integral: f64,
    /// Angle, speed and disturbance of the motor.
    tracked: [f64; 3],
    before: f64,
}

impl MotorController {
    /// For a joint at rest.
    pub fn new(joint: &JointParameters, train: &DriveTrainParameters) -> Self {
        Self {
            ratio: joint.geometry.ratio_by_teeth(),
            inertia: inertia_at_motor(joint),
            motor_inertia: joint.rotor_inertia
                + joint.bodies.sun_equivalent_mass * joint.geometry.sun_base_radius.powi(2),
            limit: train.surroundings.torque_limit,
            per_count: TAU / f64::from(1_u32 << train.surroundings.motor_encoder.bits),
            period: 1.0 / f64::from(train.surroundings.control_rate),
            integral: 0.0,
            tracked: [0.0; 3],
            before: 0.0,
        }
    }

    /// The command after a reading of the motor's counts, to follow the link's position, speed and acceleration.
    pub fn step(&mut self, counts: i64, [angle, speed, acceleration]: [f64; 3]) -> f64 {
        let (ratio, inertia, period) = (self.ratio, self.inertia, self.period);
        let measured = (counts as f64 + 0.5) * self.per_count;
        // Angle, speed and disturbance from counts and the last command, with a triple pole.
        let tracked = &mut self.tracked;
        let lacking = measured - tracked[0];
        tracked[0] += (tracked[1] + 3.0 * TRACKING * lacking) * period;
        tracked[1] += (self.before / self.motor_inertia + tracked[2] + 3.0 * TRACKING.powi(2) * lacking) * period;
        tracked[2] += TRACKING.powi(3) * lacking * period;
        let (position_error, speed_error) = (ratio * angle - tracked[0], ratio * speed - tracked[1]);
        let wanted = inertia
            * (ratio * acceleration
                + 3.0 * BANDWIDTH * speed_error
                + 3.0 * BANDWIDTH.powi(2) * position_error
                + BANDWIDTH.powi(3) * self.integral);
        let command = wanted.clamp(-self.limit, self.limit);
        self.integral += position_error * period + (command - wanted) / (inertia * 3.0 * BANDWIDTH.powi(2)) * period;
        self.before = command;
        command
    }
}

impl Run {
    /// Makes the recording.
    pub fn record(&self) -> Vec<Moment> {
        let mut train =
            DriveTrain::new(&self.joint, &Start::Still, self.train.clone(), self.disturbances.clone(), self.seed)
                .expect("a sound drive train");
        let reference = Reference::new(&self.profile, self.seed);
        let mut controller = MotorController::new(&self.joint, &self.train);
        let period = controller.period;
        let mut moments = Vec::new();
        for k in 0..(self.duration / period).round() as u64 {
            let time = k as f64 * period;
            if let Some((_, half_backlash)) = self.worn.filter(|(at, _)| (at / period).round() as u64 == k) {
                train.inside().set_half_backlash(half_backlash);
            }
            let part = self.grows_at.map_or(1.0, |at| 0.2 + 0.8 * ((time - at) / 0.5).clamp(0.0, 1.0));
            let wanted = reference.at(time).map(|value| part * value);
            let command = controller.step(train.measure().motor_counts, wanted);
            train.advance(command).expect("it runs");
            let (measurement, joint, torques) = (train.measure(), train.joint(), train.torques());
            moments.push(Moment {
                command,
                motor_counts: measurement.motor_counts,
                output_counts: measurement.output_counts,
                gap: joint.gap,
                sun_force: joint.sun_force(),
                load_torque: torques.load_friction + torques.gravity + torques.disturbance,
                link: [joint.link_angle, joint.link_speed],
                motor: [joint.motor_angle, joint.motor_speed],
            });
        }
        moments
    }
}
