//! Joint under the controller, attacks on the controller's inputs, and the guarantees that have to hold.

use std::f64::consts::TAU;

use model_core::compensation::design::{compensation_settings, design_compensation};
use model_core::compensation::{Command, CompensationTables, ImpedancePoint, Motion, Position};
use model_core::controller::{Answer, Controller};
use model_core::gears::{Tables, design::design};
use model_core::observer::design::{design_observer, observer_settings};
use model_core::observer::{Estimate, Estimates, ObserverTables, Samples};
use model_core::virtual_joint::{SurroundingsTable, VirtualJoint, design::design_surroundings};
use scenario::random::RandomStream;

/// Presets under attack.
pub const PRESETS: [&str; 4] = ["q1", "s1", "l1", "d2"];

/// Corruption of the controller's inputs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Attack {
    /// Torques of any size, infinities and NaN.
    Torque,
    /// Torques up to three times the limit.
    StrongTorque,
    /// Random counts of the output encoder.
    OutputCounts,
    /// Output readings missing at random.
    OutputMissing,
    /// Time stamps in any order.
    Times,
    /// Set-points of random bits.
    SetPoints,
    /// All corruptions at once, with random counts of the motor encoder.
    Everything,
}

/// Tables of a preset.
pub struct Subject {
    pub observer: ObserverTables<f32>,
    compensation: CompensationTables<f32>,
    gears: Tables<f32, 3>,
    around: SurroundingsTable<f32>,
    /// Torque limit of the motor [N m].
    pub limit: f32,
    rate: u32,
    parameters: parameters::JointParameters,
    /// Largest torque of the link's weight [N m].
    gravity: f64,
}

impl Subject {
    pub fn preset(name: &str) -> Self {
        let joint = joint_file::read(joint_file::preset(name).expect("a preset")).expect("a joint");
        let around = &joint.surroundings;
        let gears: Tables<f32, 3> = design(&joint.parameters, around.control_rate).expect("tables");
        Self {
            observer: design_observer(&joint.parameters, &observer_settings(around)).expect("tables"),
            compensation: design_compensation(&joint.parameters, &compensation_settings(around, 60.0)).expect("tables"),
            around: design_surroundings(&joint.parameters, around, &gears).expect("tables"),
            gears,
            limit: around.torque_limit as f32,
            rate: around.control_rate,
            parameters: joint.parameters.clone(),
            gravity: around.gravity_torque,
        }
    }

    pub fn controller(&self) -> Controller<'_, f32> {
        Controller::with_tables(&self.observer, &self.compensation)
    }

    pub fn joint(&self) -> VirtualJoint<'_, f32, 3> {
        VirtualJoint::new(&self.gears, &self.around)
    }

    /// Control rate [Hz].
    pub fn rate(&self) -> f64 {
        f64::from(self.rate)
    }

    /// Angle of the link between the flanks, and the wind-up under the largest torque [rad].
    pub fn lost_motion(&self) -> f64 {
        let backlash = |halves: &[f64]| halves.iter().copied().fold(f64::INFINITY, f64::min);
        let [sun, ring] = [&self.parameters.sun_planet, &self.parameters.ring_planet];
        let gap = 2.0 * (backlash(&sun.half_backlash) + backlash(&ring.half_backlash));
        let wound_up = self.parameters.compliance.map_or(0.0, |compliance| 2.0 / compliance.stiffness);
        f64::from(self.observer.levers.per_output) * gap + wound_up * self.largest_at_link()
    }

    /// Lost motion with the widest gap that the observer considers possible before it has estimated the gap [rad].
    pub fn widest_lost_motion(&self) -> f64 {
        let [half_gap, uncertain] = [self.observer.learner.mean[0], self.observer.learner.deviation[0]].map(f64::from);
        let [margin, lever] = [self.observer.supervisor.margin, self.observer.levers.per_output].map(f64::from);
        self.lost_motion() + lever * 2.0 * (half_gap + 3.0 * uncertain + 2.0 * margin)
    }

    /// Torque limit of the motor at the link [N m].
    pub fn largest_at_link(&self) -> f64 {
        f64::from(self.limit * self.observer.levers.ratio)
    }

    /// Largest acceleration of the link by its weight alone [rad/s^2].
    pub fn fall(&self) -> f64 {
        self.gravity / self.parameters.link_inertia
    }

    /// Number of periods in a time [s].
    pub fn periods(&self, seconds: f64) -> u32 {
        (seconds * f64::from(self.rate)) as u32
    }

    /// Swing of 0.03 turns to either side with a period of 2 s.
    pub fn swing(&self, period: u32) -> Command<f32> {
        self.swing_by(period, 0.03, 2.0)
    }

    /// Swing of `turns` to either side with a period of `seconds`.
    pub fn swing_by(&self, period: u32, turns: f64, seconds: f64) -> Command<f32> {
        let rate = TAU / seconds;
        let motion = |time: f64| {
            let (sine, cosine) = (rate * time).sin_cos();
            Motion {
                position: Position { turns: 0, fraction: (turns * sine) as f32 },
                speed: (TAU * turns * rate * cosine) as f32,
                acceleration: (-TAU * turns * rate * rate * sine) as f32,
            }
        };
        let time = f64::from(period) / f64::from(self.rate);
        let lead = f64::from(self.compensation.crossing.lead);
        Command::Position { now: motion(time), ahead: Some(motion(time + lead)) }
    }
}

/// Angle of the link [rad].
pub fn link_angle(joint: &VirtualJoint<'_, f32, 3>) -> f64 {
    let outputs = joint.outputs();
    TAU * (f64::from(outputs.carrier_turns) + f64::from(outputs.carrier_fraction) / 4_294_967_296.0)
}

/// Random bits and numbers of all sizes.
pub struct RandomValues(RandomStream);

impl RandomValues {
    /// Random numbers of an attack for a seed.
    pub fn new(seed: u64, attack: &str) -> Self {
        Self(RandomStream::new(seed, attack))
    }

    pub fn word(&mut self) -> u64 {
        self.0.word()
    }

    pub fn below(&mut self, choices: u64) -> u64 {
        self.word() % choices
    }

    /// Uniform number from -1 to 1.
    pub fn unit(&mut self) -> f32 {
        (2.0 * self.0.uniform() - 1.0) as f32
    }

    /// Any f32, or an especially harmful one.
    pub fn any_f32(&mut self) -> f32 {
        match self.below(8) {
            0 => f32::NAN,
            1 => f32::INFINITY.copysign(self.unit()),
            2 => f32::MAX.copysign(self.unit()),
            3 => 1e34_f32.copysign(self.unit()),
            4 => 1e30 * self.unit(),
            5 => 100.0 * self.unit(),
            _ => f32::from_bits(self.word() as u32),
        }
    }
}

impl Attack {
    /// Corrupts the controller's inputs of one period.
    pub fn apply(self, random: &mut RandomValues, limit: f32, samples: &mut Samples<f32>, command: &mut Command<f32>) {
        let all = self == Self::Everything;
        let mut does = |which| self == which || all && random.below(3) == 0;
        let [torque, strong, output, missing, times, points] =
            [Self::Torque, Self::StrongTorque, Self::OutputCounts, Self::OutputMissing, Self::Times, Self::SetPoints]
                .map(&mut does);
        if torque {
            samples.torque = random.any_f32();
        }
        if strong {
            samples.torque = 3.0 * limit * random.unit();
        }
        if output && let Some(reading) = &mut samples.output {
            reading.counts = random.word() as u32;
        }
        if missing && random.below(2) == 0 {
            samples.output = None;
        }
        if times {
            samples.time = samples.time.wrapping_add(random.word() as u32 >> random.below(32));
            samples.motor.time = samples.motor.time.wrapping_sub(random.word() as u32 >> random.below(32));
        }
        if all && random.below(2) == 0 {
            samples.motor.counts = random.word() as u32;
        }
        if points {
            *command = wild_command(random);
        }
    }
}

fn wild_command(random: &mut RandomValues) -> Command<f32> {
    let mut motion = || Motion {
        position: Position { turns: random.word() as i32 >> random.below(32), fraction: random.any_f32() },
        speed: random.any_f32(),
        acceleration: random.any_f32(),
    };
    let (now, ahead) = (motion(), motion());
    match random.below(3) {
        0 => Command::Position { now, ahead: None },
        1 => Command::Position { now, ahead: Some(ahead) },
        _ => Command::Impedance(ImpedancePoint {
            position: now.position,
            speed: now.speed,
            torque: random.any_f32(),
            stiffness: random.any_f32(),
            damping: random.any_f32(),
        }),
    }
}

/// Checks that the torque is within the limit and every estimate finite.
pub fn check_answer(answer: &Answer<f32>, limit: f32, when: &dyn Fn() -> String) {
    let torque = answer.shaped.torque;
    assert!(torque.abs() <= limit * 1.0001, "a torque of {torque} N m, the limit is {limit}: {}", when());
    assert!(answer.shaped.load.iter().all(|load| load.is_finite()), "{:?}: {}", answer.shaped, when());
    assert!(finite(&answer.estimates), "{:#?}: {}", answer.estimates, when());
}

/// Returns true if all estimates are finite.
pub fn finite(published: &Estimates<f32>) -> bool {
    let estimates: [&Estimate<f32>; 9] = [
        &published.gap,
        &published.mesh_torque,
        &published.load_torque,
        &published.half_backlash,
        &published.encoder_offset,
        &published.compliance,
        &published.skew,
        &published.torque_bias,
        &published.motor_friction,
    ];
    let shafts = [published.motor, published.link];
    let [sine, cosine] = published.cogging;
    let others = [
        published.gap_rate,
        published.flank_shift,
        published.flank_shift_slope,
        published.link_inertia_ratio.value,
        sine,
        cosine,
    ];
    estimates.iter().all(|estimate| estimate.value.is_finite() && estimate.variance.is_finite())
        && shafts.iter().all(|shaft| shaft.fraction.is_finite() && shaft.speed.is_finite())
        && others.iter().all(|other| other.is_finite())
        && published.link_inertia_ratio.variance.is_finite()
}
