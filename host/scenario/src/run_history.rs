//! History of a run: true values and observer outputs in every control period.

use model_core::gears::{Flank, sign};
use model_core::numbers::digest;
use model_core::observer::{Memory, Samples, Source, TorqueResponse};
use model_core::width_probe::{ProbeProgress, ProbeRefusal};
use reference::closed_loop::{Motion, Run, Sample, SetPoint};

use super::controller_log::ControllerPeriod;
use super::port::{Answer, Translator};
use super::rig::Period;

/// History of a run.
#[derive(Debug, Clone, PartialEq)]
pub struct RunHistory {
    /// True motion, one sample for each control period.
    pub run: Run,
    /// Observer outputs, in the order of the samples; empty for controllers without an observer.
    pub observer_outputs: Vec<ObserverOutput>,
    /// True gap, backlash, load and motor angle, in the order of the samples.
    pub truths: Vec<TrueValues>,
    /// Inputs and outputs of the controller, in the order of the samples.
    pub controller: Vec<ControllerPeriod>,
    /// Set-points of the controller, in the order of the samples.
    pub set_points: Vec<LoggedSetPoint>,
    /// Digest over every bit of the run.
    pub digest: u64,
    /// Memory that the observer started from, if any.
    pub memory_at_start: Option<Memory>,
    /// Memory of the observer at the end, if it ran in this process.
    pub memory: Option<Memory>,
}

/// True values beside the sample.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct TrueValues {
    /// Gap coordinate [m].
    pub gap: f64,
    /// Current half-backlash [m].
    pub half_backlash: f64,
    /// Torque that brakes the link [N m].
    pub load_torque: f64,
    /// Motor angle [rad].
    pub motor: f64,
}

/// Set-point of a controller in one period; angles are relative to the joint's own zero.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct LoggedSetPoint {
    /// Angle, speed and acceleration of the link [rad, rad/s, rad/s^2].
    pub motion: Motion,
    /// Feed-forward torque [N m].
    pub torque: f64,
    /// Stiffness of an impedance, or zero [N m/rad].
    pub stiffness: f64,
    /// Damping of an impedance, or zero [N m s/rad].
    pub damping: f64,
}

impl From<&SetPoint> for LoggedSetPoint {
    fn from(set_point: &SetPoint) -> Self {
        match *set_point {
            SetPoint::Position { now, .. } => Self { motion: now, ..Self::default() },
            SetPoint::Impedance { about, torque, stiffness, damping } => {
                Self { motion: about, torque, stiffness, damping }
            }
        }
    }
}

/// Estimates of the observer in one period.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct ObserverOutput {
    /// Gap coordinate [m].
    pub gap: f32,
    /// Variance of the gap coordinate [m^2].
    pub gap_variance: f32,
    /// Validity of the gap coordinate.
    pub valid: bool,
    /// Contact side: -1, 0 or 1.
    pub side: i8,
    /// Torque between carrier and link [N m].
    pub mesh_torque: f32,
    /// Torque that brakes the link [N m].
    pub load_torque: f32,
    /// Half-backlash [m].
    pub half_backlash: f32,
    /// Compliance [rad/(N m)].
    pub compliance: f32,
    /// Skew of the encoders [s].
    pub skew: f32,
    /// True if both encoders are in use.
    pub both_encoders: bool,
    /// Share of the compensation in the torque.
    pub trust: f32,
    /// The law demands more torque than the limit, or brakes early because of the limit.
    pub short_of_torque: bool,
    /// Plain control has taken over because the loop hunted.
    pub stepped_back: bool,
    /// The motor ran against its torque, which was removed.
    pub reversed: bool,
    /// Validity of the other outputs.
    pub validity: Validity,
    /// State of the width probe, if there is one.
    pub probed: Option<ProbeProgress<f32>>,
}

/// Validity of an observer's outputs, except the gap coordinate.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Validity {
    /// Contact side.
    pub contact: bool,
    /// Half-backlash.
    pub half_backlash: bool,
    /// Transmitted torque.
    pub mesh_torque: bool,
    /// Load torque.
    pub load_torque: bool,
    /// Compliance.
    pub compliance: bool,
    /// Skew of the encoders.
    pub skew: bool,
}

impl RunHistory {
    /// Empty history with room for the given number of periods.
    pub fn begin(period: f64, periods: u64) -> Self {
        Self {
            run: Run { samples: Vec::with_capacity(periods as usize), period },
            observer_outputs: Vec::new(),
            truths: Vec::with_capacity(periods as usize),
            controller: Vec::with_capacity(periods as usize),
            set_points: Vec::with_capacity(periods as usize),
            digest: digest::START,
            memory_at_start: None,
            memory: None,
        }
    }

    /// Reason why the width probe refused, if it did.
    pub fn refusal(&self) -> Option<ProbeRefusal> {
        match self.observer_outputs.last()?.probed {
            Some(ProbeProgress::Refused(refusal)) => Some(refusal),
            _ => None,
        }
    }

    /// Control periods between samples at a rate [Hz].
    pub fn periods_per_sample(&self, rate: f64) -> usize {
        (1.0 / (rate * self.run.period)).round().max(1.0) as usize
    }

    /// Samples at a rate [Hz], each with true values, observer output, and the largest net force of the sun's meshes
    /// since the previous sample [N].
    pub fn samples_at(&self, rate: f64) -> impl Iterator<Item = (&Sample, &TrueValues, Option<&ObserverOutput>, f64)> {
        let every = self.periods_per_sample(rate);
        self.run.samples.chunks_exact(every).zip(1..).map(move |(chunk, number)| {
            let last = number * every - 1;
            let peak = chunk.iter().map(|sample| sample.mesh_force.abs()).fold(0.0, f64::max);
            (&self.run.samples[last], &self.truths[last], self.observer_outputs.get(last), peak)
        })
    }

    /// Adds a period of a rig, with its readings converted to samples.
    pub fn add_period(&mut self, period: &Period<'_>, translator: &mut Translator) {
        let joint = period.plant.joint();
        let sample = Sample::of(joint, period.wanted, period.half_backlash, period.command);
        let truth = TrueValues {
            gap: joint.gap,
            half_backlash: period.half_backlash,
            load_torque: period.load_torque(),
            motor: joint.motor_angle,
        };
        let samples = translator.samples(period.seen);
        translator.note(period.command as f32);
        self.add(sample, truth, samples, period.set_point.into(), period.answer);
    }

    /// Adds a period.
    pub fn add(
        &mut self,
        sample: Sample,
        truth: TrueValues,
        samples: Samples<f32>,
        set_points: LoggedSetPoint,
        answer: Option<&Answer>,
    ) {
        self.controller.push(ControllerPeriod {
            samples,
            torque: sample.command as f32,
            estimates: answer.map(|answer| answer.estimates),
        });
        self.set_points.push(set_points);
        for value in [sample.link, sample.mesh_force, sample.command, truth.gap, truth.motor] {
            self.digest = digest::chain(self.digest, value.to_bits());
        }
        if let Some(answer) = answer {
            let observed = ObserverOutput::new(answer);
            for value in [observed.gap, observed.half_backlash, observed.load_torque, observed.trust] {
                self.digest = digest::chain(self.digest, value.to_bits().into());
            }
            self.observer_outputs.push(observed);
        }
        self.run.samples.push(sample);
        self.truths.push(truth);
    }
}

impl ObserverOutput {
    fn new(answer: &Answer) -> Self {
        let Answer { estimates, shaped, probed } = *answer;
        Self {
            gap: estimates.gap.value,
            gap_variance: estimates.gap.variance,
            valid: estimates.gap.valid,
            side: sign::<f32>(Flank::touched(estimates.reported_contact)) as i8,
            mesh_torque: estimates.mesh_torque.value,
            load_torque: estimates.load_torque.value,
            half_backlash: estimates.half_backlash.value,
            compliance: estimates.compliance.value,
            skew: estimates.skew.value,
            both_encoders: estimates.source == Source::Both,
            trust: shaped.trust,
            short_of_torque: shaped.short_of_torque,
            stepped_back: shaped.stepped_back,
            reversed: estimates.torque_response == TorqueResponse::Reversed,
            validity: Validity {
                contact: estimates.contact_valid,
                half_backlash: estimates.half_backlash.valid,
                mesh_torque: estimates.mesh_torque.valid,
                load_torque: estimates.load_torque.valid,
                compliance: estimates.compliance.valid,
                skew: estimates.skew.valid,
            },
            probed,
        }
    }
}
