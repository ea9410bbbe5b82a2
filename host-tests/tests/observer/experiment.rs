//! Experiments with the observer: a joint in motion, and an observer with a wrong nominal width and compliance and without knowledge of
//! offset, skew and encoder errors.

use host_tests::extent::short_or_long;
use model_core::gears::Kinematics;
use model_core::numbers::Real;
use model_core::observer::design::{ObserverSettings, design_observer};
use model_core::observer::{Estimates, MAPPED, Observer, ObserverTables, Samples};
use parameters::{AbsoluteEncoder, JointParameters};
use reference::drive_train::{DriveTrainParameters, Stepping};
use reference::joint::Start;
use scenario::rig::{ActiveController, Rig, Setup};
use scenario::set_point_source::SetPointSource;

use crate::motion::{MotorController, TestMotion, inertia_at_motor, uniform};
use crate::presets::{preset, with_backlash};
use crate::recording::{self, PeriodSample};
use crate::replay::{ObserverErrors, replay, samples, settings};

/// Encoders of an experiment.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Encoders {
    /// The preset's encoders, skew by the seed.
    Preset,
    /// 18 bits each and no error.
    Ideal,
    /// The preset's errors with other resolutions [bits]: motor, output.
    Bits(u32, u32),
}

/// Joint in motion, and the observer's knowledge of it.
#[derive(Clone)]
pub struct Experiment {
    /// Joint, drive train and motion of the plant.
    pub setup: Setup,
    /// Joint parameters given to the observer.
    pub nominal: JointParameters,
    /// Drive train settings given to the observer.
    pub settings: ObserverSettings,
}

/// Usual motions with their durations [s]: slow against friction, fast against inertia, faster with gravity, random with gravity. Friction
/// and gravity of each are parts of the preset's rated torque.
pub const MOTIONS: [(&str, f64); 4] = [("slow", 8.0), ("inertia", 5.0), ("gravity", 5.0), ("random", 6.0)];

impl Experiment {
    /// Experiment on a preset: name of a motion, encoders, half-backlash [m] and a seed for everything random.
    pub fn new(name: &str, motion: &str, encoders: Encoders, half_backlash: Option<f64>, seed: u64) -> Self {
        let (joint, mut train) = preset(name, seed);
        let joint = half_backlash.map_or(joint.clone(), |half_backlash| with_backlash(&joint, half_backlash));
        let mut uniform = uniform(seed ^ 0x7e57);
        match encoders {
            Encoders::Preset => {}
            Encoders::Ideal => {
                train.surroundings.motor_encoder = AbsoluteEncoder::ideal(18);
                train.surroundings.output_encoder = AbsoluteEncoder::ideal(18);
            }
            Encoders::Bits(motor, output) => {
                train.surroundings.motor_encoder.counts_per_turn = 1 << motor;
                train.surroundings.output_encoder.counts_per_turn = 1 << output;
            }
        }
        if encoders != Encoders::Ideal {
            train.surroundings.output_encoder.skew = 20e-6 + 70e-6 * uniform();
        }
        let (profile, friction, gravity, duration) = motion_of(motion, &joint, &train);
        train.surroundings.load_friction.coulomb = friction;
        train.surroundings.gravity_torque = gravity;
        let wrong = if uniform() < 0.5 { [0.5, 1.2] } else { [1.5, 0.8] };
        let mut nominal = with_backlash(&joint, joint.sun_planet.half_backlash[0] * wrong[0]);
        if let Some(compliance) = &mut nominal.compliance {
            compliance.stiffness *= wrong[1];
        }
        let settings = settings(&train);
        let motion = profile.motion(seed);
        let setup = Setup {
            start: Start::Still,
            stepping: short_or_long(Stepping::Fixed, Stepping::Adaptive),
            ..Setup::new(joint, train, motion, duration, seed)
        };
        Self { setup, nominal, settings }
    }

    /// Tables of the observer.
    pub fn tables<T: Real>(&self) -> ObserverTables<T> {
        design_observer(&self.nominal, &self.settings).expect("tables")
    }

    /// Experiment with another duration [s].
    pub fn lasting(mut self, duration: f64) -> Self {
        self.setup.duration = duration;
        self
    }

    /// Errors of the estimates of a recording from a time on [s]; `watch` sees every estimate.
    pub fn replay<const P: usize>(
        &self,
        log: &[PeriodSample],
        from: f64,
        watch: impl FnMut(usize, &PeriodSample, &Estimates<f64>),
    ) -> ObserverErrors {
        replay::<P>(&self.setup.joint, &self.tables(), &self.settings, log, from, watch)
    }

    /// Errors of the estimates of a recording from a time on [s], for the observer with its error maps.
    pub fn figures(&self, log: &[PeriodSample], from: f64) -> ObserverErrors {
        self.replay::<MAPPED>(log, from, |_, _, _| {})
    }

    /// Estimates of a recording, period by period, from samples that a test may modify.
    pub fn published<T: Real>(
        &self,
        log: &[PeriodSample],
        mut spoil: impl FnMut(usize, &mut Samples<T>),
    ) -> Vec<Estimates<T>> {
        let tables = self.tables();
        let mut observer = Observer::<T, MAPPED>::new(&tables);
        let step = |(period, moment): (usize, &PeriodSample)| {
            let mut samples = samples(&self.settings, moment, period);
            spoil(period, &mut samples);
            *observer.step(&samples)
        };
        log.iter().enumerate().map(step).collect()
    }

    /// Recording under a plain motor controller.
    pub fn record(&self) -> Vec<PeriodSample> {
        let Setup { joint, train, motion, .. } = &self.setup;
        let rig = Rig::new(&self.setup).expect("a sound drive train");
        let controller = MotorController::new(joint, train).homed(&rig.home());
        let mut controller = ActiveController::from_rival(Box::new(controller));
        recording::record(rig, &mut controller, &mut SetPointSource::of_positions(motion.clone()))
    }
}

/// Profile, dry friction, gravity and duration of a motion, scaled to the joint.
fn motion_of(name: &str, joint: &JointParameters, train: &DriveTrainParameters) -> (TestMotion, f64, f64, f64) {
    let rated = joint.rated_output_torque;
    let friction = train.surroundings.load_friction.coulomb;
    let gravity = 0.4 * rated;
    let inertia = joint.geometry.ratio_by_teeth().powi(2) * inertia_at_motor(joint);
    // Part of the rated torque at a frequency, and one radian at most.
    let amplitude =
        |frequency: f64, part: f64| (part * rated / inertia / (core::f64::consts::TAU * frequency).powi(2)).min(1.0);
    let duration = MOTIONS.iter().find(|(motion, _)| *motion == name).map_or(4.0, |(_, duration)| *duration);
    match name {
        "slow" => (TestMotion::Sine(0.5, 0.2), friction.max(0.07 * rated), 0.0, duration),
        "inertia" => (TestMotion::Sine(amplitude(1.0, 0.25), 1.0), friction, 0.0, duration),
        "gravity" => (TestMotion::Sine(amplitude(1.5, 0.3), 1.5), friction, gravity, duration),
        "random" => (TestMotion::Random(0.7 * rated / inertia, 3.0), friction, 0.2 * gravity, duration),
        _ => (TestMotion::Hold, friction, 0.0, duration),
    }
}
