//! The standard trials, each a bench with a motion, and everyone who may stand at them. What must come out is not said.

use model_core::compensation::design::design_compensation;
use model_core::gears::design::DesignError;
use model_core::observer::design::design_observer;
use parameters::{Friction, JointParameters};

use super::compensated::{Compensated, compensation_settings, observer_settings};
use reference::closed_loop::Profile;
use reference::closed_loop::rivals::{
    Impedance, ImpedanceLaw, Knowledge, LoadCascade, MotorPid, OutputIntegral, VelocitySign,
};
use reference::closed_loop::{Bench, BenchError, ImpedanceGains, Run};
use reference::drive_train::{Disturbance, DriveTrainParameters};

/// Who is on trial.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Contender {
    /// Motor PID, teeth without backlash: the floor.
    NoGap,
    /// Motor PID: the baseline.
    MotorPid,
    /// Motor PID with an offset by the sign of the speed.
    VelocitySign,
    /// Load cascade.
    LoadCascade,
    /// Output integral, jump, feed-forward.
    OutputIntegral,
    /// An impedance law.
    Impedance(ImpedanceLaw),
    /// An impedance law, teeth without backlash.
    ImpedanceNoGap(ImpedanceLaw),
    /// Observer and compensation; whether the motion is known ahead.
    Compensated {
        /// Whether it is.
        preview: bool,
    },
    /// Compensation on the truth.
    PerfectSight {
        /// Whether the motion is known ahead.
        preview: bool,
    },
}

/// A bench, a motion, and from when on it counts.
#[derive(Debug, Clone)]
pub struct Trial {
    /// For reports.
    pub name: &'static str,
    /// What the controllers are designed for.
    pub nominal: (JointParameters, DriveTrainParameters),
    /// The truth.
    pub bench: Bench,
    /// What is asked.
    pub motion: Profile,
    /// Bandwidth of all contenders [rad/s].
    pub bandwidth: f64,
    /// Guessed over true half-backlash.
    pub width_factor: f64,
    /// When learning is over and figures begin [s].
    pub from: f64,
}

impl Trial {
    /// A trial on a joint that is as its controllers think but for its width.
    pub fn new(
        name: &'static str,
        joint: JointParameters,
        train: DriveTrainParameters,
        motion: Profile,
        duration: f64,
        seed: u64,
    ) -> Self {
        Self {
            name,
            nominal: (joint.clone(), train.clone()),
            bench: Bench::new(joint, train, duration, seed),
            motion,
            bandwidth: 60.0,
            width_factor: if seed.is_multiple_of(2) { 0.5 } else { 1.5 },
            from: 2.0,
        }
    }

    /// Slow and driven by friction: 0.2 Hz under 1 N m.
    pub fn slow(joint: &JointParameters, train: &DriveTrainParameters, seed: u64) -> Self {
        let mut train = weightless(train);
        train.surroundings.load_friction.coulomb = 1.0;
        Self::new("T1", joint.clone(), train, Profile::Sine { amplitude: 0.5, frequency: 0.2 }, 12.0, seed)
    }

    /// Driven by inertia: 1 Hz.
    pub fn inertial(joint: &JointParameters, train: &DriveTrainParameters, seed: u64) -> Self {
        let motion = Profile::Sine { amplitude: 0.5, frequency: 1.0 };
        Self::new("T2", joint.clone(), weightless(train), motion, 6.0, seed)
    }

    /// With the link's weight, at a frequency [Hz].
    pub fn weighty(joint: &JointParameters, train: &DriveTrainParameters, frequency: f64, seed: u64) -> Self {
        let motion = Profile::Sine { amplitude: 0.3, frequency };
        let mut trial = Self::new("T2b", joint.clone(), train.clone(), motion, 2.0 + 4.0 / frequency, seed);
        // The width is learnt from reversals, of which a slow motion has few.
        trial.from = 1.0 + (1.0 / frequency).max(1.0);
        trial
    }

    /// Sines at random up to 2 Hz.
    pub fn random(joint: &JointParameters, train: &DriveTrainParameters, seed: u64) -> Self {
        let motion = Profile::Random { amplitude: 0.2, highest: 2.0, seed };
        Self::new("random", joint.clone(), weightless(train), motion, 8.0, seed)
    }

    /// 0.05 rad in 60 ms, back and forth, rests between of random length.
    pub fn steps(joint: &JointParameters, train: &DriveTrainParameters, seed: u64) -> Self {
        let motion = Profile::Steps { height: 0.05, duration: 0.06, rest: 0.3, seed };
        Self::new("steps", joint.clone(), weightless(train), motion, 8.0, seed)
    }

    /// Stay where it is under +-1.5 N m at 1 Hz.
    pub fn disturbed_hold(joint: &JointParameters, train: &DriveTrainParameters, seed: u64) -> Self {
        let mut trial = Self::new("hold", joint.clone(), weightless(train), Profile::Hold(0.0), 8.0, seed);
        trial.bench.disturbances.push(Disturbance::Sine { amplitude: 1.5, frequency: 1.0 });
        trial
    }

    /// Stay where it is after a push, with so much dry friction at the link [N m].
    pub fn free_hold(joint: &JointParameters, train: &DriveTrainParameters, friction: f64, seed: u64) -> Self {
        let mut train = weightless(train);
        train.surroundings.load_friction = Friction { coulomb: friction, ..Friction::default() };
        if friction == 0.0 {
            train.surroundings.motor_friction = Friction::default();
            train.surroundings.cogging_torque = 0.0;
        }
        let mut trial = Self::new("free hold", joint.clone(), train, Profile::Hold(0.0), 14.0, seed);
        trial.bench.disturbances.push(Disturbance::Pulse { start: 2.0, duration: 0.02, torque: 1.5 });
        trial
    }

    /// Everyone but those who send impedances.
    pub fn standard(joint: &JointParameters, train: &DriveTrainParameters, seed: u64) -> Vec<Self> {
        vec![
            Self::slow(joint, train, seed),
            Self::inertial(joint, train, seed),
            Self::weighty(joint, train, 0.5, seed),
            Self::weighty(joint, train, 1.5, seed),
            Self::random(joint, train, seed),
            Self::steps(joint, train, seed),
            Self::disturbed_hold(joint, train, seed),
        ]
    }

    /// The same trial in impedance mode, torque for the motion's acceleration sent along.
    pub fn with_impedance(mut self, stiffness: f64, damping: f64) -> Self {
        let knowledge = Knowledge::of(&self.nominal.0, &self.nominal.1, 1.0);
        let inertia = knowledge.total_inertia * knowledge.ratio * knowledge.ratio;
        self.bench.impedance = Some(ImpedanceGains { stiffness, damping, rate: 1000.0, inertia });
        self
    }

    /// Runs it.
    pub fn run(&self, contender: Contender) -> Result<Run, TrialError> {
        let (joint, train) = &self.nominal;
        let knowledge = Knowledge::of(joint, train, self.width_factor);
        let bandwidth = self.bandwidth;
        let plain = |mut controller: Box<dyn reference::closed_loop::Controller>, bench: &Bench| {
            bench.run(controller.as_mut(), &self.motion).map_err(TrialError::from)
        };
        match contender {
            Contender::NoGap => plain(Box::new(MotorPid::new(knowledge, bandwidth)), &self.without_gap()),
            Contender::MotorPid => plain(Box::new(MotorPid::new(knowledge, bandwidth)), &self.bench),
            Contender::VelocitySign => plain(Box::new(VelocitySign::new(knowledge, bandwidth)), &self.bench),
            Contender::LoadCascade => plain(Box::new(LoadCascade::new(knowledge, bandwidth)), &self.bench),
            Contender::OutputIntegral => plain(Box::new(OutputIntegral::new(knowledge, bandwidth)), &self.bench),
            Contender::Impedance(law) => plain(Box::new(Impedance::new(knowledge, law, bandwidth)), &self.bench),
            Contender::ImpedanceNoGap(law) => {
                plain(Box::new(Impedance::new(knowledge, law, bandwidth)), &self.without_gap())
            }
            Contender::Compensated { preview } => {
                let guess = scaled(joint, self.width_factor);
                let tables = design_compensation::<f32>(&guess, &compensation_settings(train, bandwidth))?;
                let observer = design_observer::<f32>(&guess, &observer_settings(train))?;
                let mut controller = Compensated::observed(&tables, &observer, train);
                let preview = preview.then_some(f64::from(tables.lead));
                Ok(Bench { preview, ..self.bench.clone() }.run(&mut controller, &self.motion)?)
            }
            Contender::PerfectSight { preview } => {
                let tables = design_compensation::<f64>(joint, &compensation_settings(train, bandwidth))?;
                let mut controller = Compensated::perfect(&tables, &self.bench.joint);
                let preview = preview.then_some(tables.lead);
                Ok(Bench { preview, ..self.bench.clone() }.run(&mut controller, &self.motion)?)
            }
        }
    }

    fn without_gap(&self) -> Bench {
        Bench { joint: scaled(&self.bench.joint, 0.0), ..self.bench.clone() }
    }
}

/// Why a trial could not be held.
#[derive(Debug, Clone, PartialEq)]
pub enum TrialError {
    /// The bench.
    Bench(BenchError),
    /// No tables for a controller.
    Design(DesignError),
}

impl std::fmt::Display for TrialError {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Bench(error) => error.fmt(formatter),
            Self::Design(error) => error.fmt(formatter),
        }
    }
}

impl std::error::Error for TrialError {}

impl From<BenchError> for TrialError {
    fn from(error: BenchError) -> Self {
        Self::Bench(error)
    }
}

impl From<DesignError> for TrialError {
    fn from(error: DesignError) -> Self {
        Self::Design(error)
    }
}

/// A joint with all half-backlashes multiplied.
fn scaled(joint: &JointParameters, factor: f64) -> JointParameters {
    let mut joint = joint.clone();
    for mesh in [&mut joint.sun_planet, &mut joint.ring_planet] {
        mesh.half_backlash.iter_mut().for_each(|value| *value *= factor);
    }
    joint
}

/// A drive train whose link weighs nothing.
fn weightless(train: &DriveTrainParameters) -> DriveTrainParameters {
    let mut train = train.clone();
    train.surroundings.gravity_torque = 0.0;
    train
}
