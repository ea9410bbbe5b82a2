//! The candidate in the loop: the compensation acts on what the candidate says of gap, contact, joint, motor and encoders.
//! Where the shafts are, the load torque and the link's inertia it takes from the present observer, which runs beside.

use std::time::{Duration, Instant};

use model_core::compensation::{Command, Compensation};
use model_core::gears::{Flank, contact_state};
use model_core::observer::design::{design_observer, observer_settings};
use model_core::observer::{Estimate, Estimates, MAPPED, Memory, MotorFault, Observer, ObserverTables, OutputFault, Samples, Source};
use report::failure::{Failure, Outcome};
use scenario::case::{Case, Designed};
use scenario::execution::{RunSpec, execute_with};
use scenario::plant::PlantName;
use scenario::port::{Answer, ControllerPort, HostPort};
use scenario::suite::Test;

use crate::candidate::{Candidate, Variant};
use crate::runs::Stands;

/// Figures of a run in the loop.
#[derive(Debug, Clone, Copy)]
pub struct Loop {
    /// RMS error of the link [mrad].
    pub rms: f64,
    /// Largest error of the link [mrad].
    pub peak: f64,
    /// Largest mesh force [N].
    pub force: f64,
}

struct CandidatePort<'t> {
    observer: Observer<'t, f32, MAPPED>,
    candidate: Candidate<'static>,
    compensation: Compensation<'t, f32>,
}

impl ControllerPort for CandidatePort<'_> {
    fn exchange(&mut self, samples: &Samples<f32>, command: &Command<f32>) -> Outcome<Answer> {
        let present = *self.observer.step(samples);
        let said = self.candidate.step(samples);
        let learnt = self.candidate.learnt();
        let estimate = |value: f64, variance: f64, valid: bool| Estimate {
            value: value as f32,
            variance: variance as f32,
            valid,
        };
        let flank = match said.side {
            1 => Some(Flank::Drive),
            -1 => Some(Flank::Back),
            _ => None,
        };
        let source = match said.stands {
            Stands::Both => Source::Both,
            Stands::MotorOnly => Source::MotorOnly(OutputFault::OutOfRange),
            Stands::Nothing => Source::Nothing(MotorFault::Jumped),
        };
        let known = present.source != Source::Nothing(MotorFault::Silent);
        let estimates = Estimates {
            source: if known { source } else { present.source },
            gap: estimate(said.gap, said.gap_variance, said.gap_valid),
            reported_contact: contact_state(flank),
            contact_valid: (said.side != 0 || said.gap_valid) && !learnt.flanks_swap,
            half_backlash: estimate(said.width, said.width_variance, said.width_valid),
            encoder_offset: estimate(learnt.offset, 0.0, said.stands == Stands::Both && said.width_valid),
            compliance: estimate(learnt.compliance, 0.0, true),
            mesh_torque: estimate(learnt.mesh_torque, 0.0, true),
            torque_bias: estimate(learnt.bias, 0.0, true),
            motor_friction: estimate(learnt.friction, 0.0, true),
            flank_shift: learnt.flank_shift as f32,
            flank_shift_slope: learnt.flank_shift_slope as f32,
            ..present
        };
        let mix = std::env::var("MIX").map_or(0, |mix| mix.parse().unwrap_or(0));
        let mut estimates = estimates;
        if mix & 1 == 1 {
            (estimates.torque_bias, estimates.motor_friction) = (present.torque_bias, present.motor_friction);
        }
        if mix & 2 == 2 {
            estimates.mesh_torque = present.mesh_torque;
        }
        if mix & 4 == 4 {
            (estimates.reported_contact, estimates.contact_valid) = (present.reported_contact, present.contact_valid);
        }
        if mix & 8 == 8 {
            estimates.encoder_offset = present.encoder_offset;
        }
        if mix & 16 == 16 {
            estimates.compliance = present.compliance;
        }
        if mix & 32 == 32 {
            estimates.source = present.source;
        }
        let shaped = self.compensation.step(&estimates, command);
        Ok(Answer { estimates, shaped, probed: None })
    }

    fn probe(&mut self, _samples: &Samples<f32>) -> Outcome<Answer> {
        Err(Failure::new("the candidate has no probe"))
    }

    fn restart_from_memory(&mut self) -> Outcome<Memory> {
        Err(Failure::new("the candidate has no memory"))
    }
}

/// Runs one seed with the present observer, or with a variant of the candidate, in the loop.
pub fn run(test: &Test, seed: u64, variant: Option<Variant>) -> Outcome<Loop> {
    let file = &test.file;
    let case = Case::new(file, &test.joint.text, seed, test.motion.as_ref())?;
    let spec = RunSpec { controller: file.controller, plant: PlantName::Reference, without_gap: false };
    let deadline = Instant::now() + Duration::from_secs(3600);
    let history = execute_with(file, &case, seed, spec, deadline, &|designed| match variant {
        Some(variant) => Ok(Box::new(port(&case, designed, variant)?)),
        None => Ok(Box::new(HostPort::new(designed)) as Box<dyn ControllerPort>),
    })
    .map_err(|error| Failure::new(format!("seed {seed}: {error}")))?;
    if std::env::var_os("TELL").is_some() && variant.is_some() {
        for (index, (sample, truth)) in history.run.samples.iter().zip(&history.truths).enumerate().step_by(500) {
            let Some(said) = history.controller.get(index + 1).and_then(|period| period.estimates) else { continue };
            eprintln!(
                "{:.2} error {:.2} mrad gap {:.1} of {:.1}: {:.1} valid {} side {:?} force {:.0} width {:.1} command {:.2}",
                sample.time,
                1e3 * (sample.link - sample.wanted),
                1e6 * truth.gap,
                2e6 * truth.half_backlash,
                1e6 * said.gap.value,
                said.gap.valid,
                said.reported_contact,
                sample.mesh_force,
                1e6 * said.half_backlash.value,
                sample.command
            );
        }
    }
    let judged = history.run.samples.iter().filter(|sample| sample.time >= file.settle);
    let mut figures = Loop { rms: 0.0, peak: 0.0, force: 0.0 };
    let mut count = 0.0;
    for sample in judged {
        let error = 1e3 * (sample.link - sample.wanted);
        figures.rms += error * error;
        figures.peak = figures.peak.max(error.abs());
        figures.force = figures.force.max(sample.mesh_force.abs());
        count += 1.0;
    }
    figures.rms = (figures.rms / f64::max(count, 1.0)).sqrt();
    Ok(figures)
}

fn port<'d>(case: &Case, designed: &'d Designed, variant: Variant) -> Outcome<CandidatePort<'d>> {
    let settings = observer_settings(&case.nominal_surroundings);
    let tables: ObserverTables<f64> =
        design_observer(&case.nominal, &settings).map_err(|error| Failure::new(error.to_string()))?;
    // A run's tables, for as long as the program runs: it is an experiment.
    let tables: &'static ObserverTables<f64> = Box::leak(Box::new(tables));
    Ok(CandidatePort {
        observer: Observer::new(&designed.observer),
        candidate: Candidate::new(tables, variant),
        compensation: Compensation::new(&designed.compensation),
    })
}
