//! The history of a run: the true values in every control period, and the observer's outputs.

use model_core::gears::{Flank, sign};
use model_core::numbers::digest;
use model_core::observer::{Memory, Samples, Source, TorqueResponse};
use model_core::width_probe::{ProbeProgress, ProbeRefusal};
use reference::closed_loop::{Motion, Run, Sample, SetPoint};

use super::controller_log::ControllerPeriod;
use super::port::{Answer, Translator};
use super::rig::Period;

/// The history of a run.
#[derive(Debug, Clone, PartialEq)]
pub struct RunHistory {
    /// The truth, one sample for each control period.
    pub run: Run,
    /// What the observer made of it, in the same order; empty for controllers without one.
    pub observer_outputs: Vec<ObserverOutput>,
    /// Half of the true gap at every period [m]: teeth may wear.
    pub truths: Vec<TrueValues>,
    /// What the controller was shown and said, in the same order.
    pub controller: Vec<ControllerPeriod>,
    /// What it was asked for, likewise.
    pub asked: Vec<Asked>,
    /// Digest over every bit of all of it.
    pub digest: u64,
    /// What the observer began with, if that is not what was designed.
    pub memory_at_start: Option<Memory>,
    /// What the observer had learnt at the end, if it ran in this process.
    pub memory: Option<Memory>,
}

/// True values beside the sample.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct TrueValues {
    /// Gap coordinate [m].
    pub gap: f64,
    /// Half-backlash now [m].
    pub half_backlash: f64,
    /// What brakes the link [N m].
    pub load_torque: f64,
    /// Motor angle [rad].
    pub motor: f64,
}

/// What a controller was asked for in one period, turns counted from the joint's own zero.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Asked {
    /// Angle, speed and acceleration of the link [rad, rad/s, rad/s^2].
    pub motion: Motion,
    /// Torque on top [N m].
    pub torque: f64,
    /// Of an impedance, or zero [N m/rad].
    pub stiffness: f64,
    /// Likewise [N m s/rad].
    pub damping: f64,
}

impl From<&SetPoint> for Asked {
    fn from(set_point: &SetPoint) -> Self {
        match *set_point {
            SetPoint::Position { now, .. } => Self { motion: now, ..Self::default() },
            SetPoint::Impedance { about, torque, stiffness, damping } => {
                Self { motion: about, torque, stiffness, damping }
            }
        }
    }
}

/// The observer's estimates in one period.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct ObserverOutput {
    /// Gap coordinate [m].
    pub gap: f32,
    /// Its variance [m^2].
    pub gap_variance: f32,
    /// Whether it may be used.
    pub valid: bool,
    /// -1, 0, 1.
    pub side: i8,
    /// Between carrier and link [N m].
    pub mesh_torque: f32,
    /// What brakes the link [N m].
    pub load_torque: f32,
    /// [m].
    pub half_backlash: f32,
    /// [rad/(N m)].
    pub compliance: f32,
    /// [s].
    pub skew: f32,
    /// Both encoders are trusted.
    pub both: bool,
    /// Share of the compensation in the torque.
    pub trust: f32,
    /// The law asked for more torque than there is, or brakes early because of that.
    pub short_of_torque: bool,
    /// Plain control has taken over because the loop hunted.
    pub stepped_back: bool,
    /// The motor ran against its torque, which was taken away for that.
    pub reversed: bool,
    /// Which of the outputs may be used.
    pub validity: Validity,
    /// Where the width probe stands, if there is one.
    pub probed: Option<ProbeProgress<f32>>,
}

/// Which outputs of an observer may be used, the gap coordinate left out.
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
    /// Nothing has happened yet.
    pub fn begin(period: f64, periods: u64) -> Self {
        Self {
            run: Run { samples: Vec::with_capacity(periods as usize), period },
            observer_outputs: Vec::new(),
            truths: Vec::with_capacity(periods as usize),
            controller: Vec::with_capacity(periods as usize),
            asked: Vec::with_capacity(periods as usize),
            digest: digest::START,
            memory_at_start: None,
            memory: None,
        }
    }

    /// Why the width probe refused, if it did.
    pub fn refusal(&self) -> Option<ProbeRefusal> {
        match self.observer_outputs.last()?.probed {
            Some(ProbeProgress::Refused(refusal)) => Some(refusal),
            _ => None,
        }
    }

    /// Control periods between samples of a rate [Hz].
    pub fn every(&self, rate: f64) -> usize {
        (1.0 / (rate * self.run.period)).round().max(1.0) as usize
    }

    /// Samples at a rate [Hz], each with what is true beside it, what the observer made of it, and the largest net force of
    /// the sun's meshes since the one before [N].
    pub fn thinned(&self, rate: f64) -> impl Iterator<Item = (&Sample, &TrueValues, Option<&ObserverOutput>, f64)> {
        let every = self.every(rate);
        self.run.samples.chunks_exact(every).zip(1..).map(move |(chunk, number)| {
            let last = number * every - 1;
            let peak = chunk.iter().map(|sample| sample.mesh_force.abs()).fold(0.0, f64::max);
            (&self.run.samples[last], &self.truths[last], self.observer_outputs.get(last), peak)
        })
    }

    /// Adds a period of a rig, whose readings the translator makes samples of.
    pub fn note(&mut self, period: &Period<'_>, translator: &mut Translator) {
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
        asked: Asked,
        answer: Option<&Answer>,
    ) {
        self.controller.push(ControllerPeriod {
            samples,
            torque: sample.command as f32,
            estimates: answer.map(|answer| answer.estimates),
        });
        self.asked.push(asked);
        for value in [sample.link, sample.mesh_force, sample.command, truth.gap, truth.motor] {
            self.digest = digest::chain(self.digest, value.to_bits());
        }
        if let Some(answer) = answer {
            let observed = ObserverOutput::of(answer);
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
    fn of(answer: &Answer) -> Self {
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
            both: estimates.source == Source::Both,
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
