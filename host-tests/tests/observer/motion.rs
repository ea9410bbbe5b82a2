//! Motions of the observer's tests: profiles that excite all parameters quickly, and a plain motor controller that uses the motor encoder
//! alone, so that no recording depends on the observer under test.

use model_core::gears::{Kinematics, Mechanics};
use std::f64::consts::TAU;
use std::sync::Arc;

use parameters::JointParameters;
use reference::closed_loop::{Controller, Motion, MotionProfile, SetPoint, SharedProfile};
use reference::drive_train::{DriveTrainParameters, Measurement};

/// Poles of the motor controller [rad/s].
const BANDWIDTH: f64 = 60.0;

/// Poles of its observer of the motor, fast enough for a motor alone inside the gap [rad/s].
const TRACKING_BANDWIDTH: f64 = 1200.0;

/// Motion of the link.
#[derive(Debug, Clone)]
pub enum TestMotion {
    /// Sine of an amplitude [rad] and a frequency [Hz].
    Sine(f64, f64),
    /// Sines from 0.2 Hz up to a highest frequency, phases and amplitudes by the seed: [largest acceleration rad/s^2, Hz].
    Random(f64, f64),
    /// Standstill.
    Hold,
}

/// Sines that start from rest and reach full amplitude after 0.2 s: amplitude [rad], rate [rad/s] and phase [rad] of each.
struct Tones(Vec<[f64; 3]>);

/// Motion at a fifth of its amplitude until a time [s], and at full amplitude half a second later.
struct GrowingMotion(SharedProfile, f64);

impl TestMotion {
    /// Motion for a seed.
    pub fn motion(&self, seed: u64) -> SharedProfile {
        Arc::new(match *self {
            Self::Hold => Tones(Vec::new()),
            Self::Sine(amplitude, frequency) => Tones(vec![[amplitude, TAU * frequency, 0.0]]),
            Self::Random(acceleration, highest) => {
                let mut uniform = uniform(seed);
                let tones = 5;
                Tones(
                    (0..tones)
                        .map(|_| {
                            let rate = TAU * 0.2 * (highest / 0.2).powf(uniform());
                            // Slow tones stay below 0.3 rad.
                            let amplitude = (acceleration / f64::from(tones) / (rate * rate)).min(0.3);
                            [amplitude * (0.6 + 0.8 * uniform()), rate, TAU * uniform()]
                        })
                        .collect(),
                )
            }
        })
    }
}

/// Motion that grows from a fifth to full amplitude at a time [s].
pub fn growing(motion: SharedProfile, at: f64) -> SharedProfile {
    Arc::new(GrowingMotion(motion, at))
}

impl MotionProfile for Tones {
    fn at(&self, time: f64) -> Motion {
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
        Motion {
            position: sum[0] * start[0],
            speed: sum[1] * start[0] + sum[0] * start[1],
            acceleration: sum[2] * start[0] + 2.0 * sum[1] * start[1] + sum[0] * start[2],
        }
    }
}

impl MotionProfile for GrowingMotion {
    fn at(&self, time: f64) -> Motion {
        let Self(motion, at) = self;
        let part = 0.2 + 0.8 * ((time - at) / 0.5).clamp(0.0, 1.0);
        let Motion { position, speed, acceleration } = motion.at(time);
        Motion { position: part * position, speed: part * speed, acceleration: part * acceleration }
    }
}

/// Uniform random numbers from 0 to 1 for a seed.
pub fn uniform(seed: u64) -> impl FnMut() -> f64 {
    let mut state = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15).wrapping_add(0x1234_5678_9abc_def1);
    move || {
        state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut word = (state ^ (state >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        word = (word ^ (word >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((word ^ (word >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }
}

/// Inertia of the joint referred to its motor, moving as one body [kg m^2].
pub fn inertia_at_motor(joint: &JointParameters) -> f64 {
    let geometry = &joint.geometry;
    let planets = geometry.planets as f64 * joint.bodies.planet_equivalent_mass;
    let carrier = (joint.carrier_equivalent_mass() + planets) * geometry.carrier_base_radius().powi(2);
    joint.rotor_inertia
        + joint.bodies.sun_equivalent_mass * geometry.sun_base_radius.powi(2)
        + (joint.link_inertia + carrier) / geometry.ratio_by_teeth().powi(2)
}

/// Motor controller: triple pole on the total inertia, with feed-forward and back-calculation, on the angle of an observer of the motor
/// alone.
#[derive(Debug)]
pub struct MotorController {
    ratio: f64,
    inertia: f64,
    motor_inertia: f64,
    limit: f64,
    per_count: f64,
    /// Home of the motor encoder [counts].
    home: i64,
    /// Control period [s].
    pub period: f64,
    integral: f64,
    /// Angle, speed and disturbance of the motor.
    tracked: [f64; 3],
    before: f64,
}

impl MotorController {
    /// Controller of a joint at rest.
    pub fn new(joint: &JointParameters, train: &DriveTrainParameters) -> Self {
        Self {
            ratio: joint.geometry.ratio_by_teeth(),
            inertia: inertia_at_motor(joint),
            motor_inertia: joint.rotor_inertia
                + joint.bodies.sun_equivalent_mass * joint.geometry.sun_base_radius.powi(2),
            limit: train.surroundings.torque_limit,
            per_count: TAU / train.surroundings.motor_encoder.counts_per_turn as f64,
            home: 0,
            period: 1.0 / f64::from(train.surroundings.control_rate),
            integral: 0.0,
            tracked: [0.0; 3],
            before: 0.0,
        }
    }

    /// Controller whose readings are counted from a home; its angles are the encoder's.
    pub fn homed(self, home: &Measurement) -> Self {
        Self { home: home.motor_counts, ..self }
    }

    /// Motor torque after a reading of the motor's counts, to follow a motion of the link [N m].
    pub fn step(&mut self, counts: i64, Motion { position: angle, speed, acceleration }: Motion) -> f64 {
        let (ratio, inertia, period) = (self.ratio, self.inertia, self.period);
        let measured = (counts as f64 + 0.5) * self.per_count;
        // Angle, speed and disturbance from the counts and the last command, with a triple pole.
        let tracked = &mut self.tracked;
        let innovation = measured - tracked[0];
        tracked[0] += (tracked[1] + 3.0 * TRACKING_BANDWIDTH * innovation) * period;
        tracked[1] +=
            (self.before / self.motor_inertia + tracked[2] + 3.0 * TRACKING_BANDWIDTH.powi(2) * innovation) * period;
        tracked[2] += TRACKING_BANDWIDTH.powi(3) * innovation * period;
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

impl Controller for MotorController {
    fn period(&mut self, measurement: &Measurement, set_point: &SetPoint) -> f64 {
        self.step(self.home + measurement.motor_counts, set_point.motion())
    }
}
