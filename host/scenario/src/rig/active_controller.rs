//! A running controller: the compensation behind its port, a rival, the compensation fed with the true state, the width
//! probe, or no controller.

use model_core::observer::Memory;
use reference::closed_loop::rivals::Knowledge;
use reference::closed_loop::{
    Controller, Impedance, ImpedanceLaw, LoadCascade, MotorPid, OutputIntegral, SetPoint, VelocitySign,
};
use reference::drive_train::{Measurement, TrueTorques};
use reference::joint::Observation;

use super::true_state::TrueStateCompensation;
use crate::controller::ControllerName;
use crate::faults::ControllerInputs;
use crate::port::{Answer, ControllerPort, Translator};
use report::failure::Outcome;

/// A running controller.
pub enum ActiveController<'p> {
    /// Observer and compensation.
    Compensation(Box<dyn ControllerPort + 'p>, Translator),
    /// Observer with its width probe.
    Probe(Box<dyn ControllerPort + 'p>, Translator),
    /// A rival, and the last reading of the output encoder, which holds while no reading arrives.
    Rival(Box<dyn Controller + 'p>, i64),
    /// Compensation fed with the true state.
    TrueState(Box<TrueStateCompensation<'p>>),
    /// No controller: the motor gives no torque.
    Off,
}

impl<'p> ActiveController<'p> {
    /// Rival by its name.
    pub fn rival(name: ControllerName, knowledge: Knowledge, bandwidth: f64) -> Self {
        let law = |law| Box::new(Impedance::new(knowledge.clone(), law, bandwidth)) as Box<dyn Controller>;
        let controller: Box<dyn Controller> = match name {
            ControllerName::VelocitySign => Box::new(VelocitySign::new(knowledge, bandwidth)),
            ControllerName::LoadCascade => Box::new(LoadCascade::new(knowledge, bandwidth)),
            ControllerName::OutputIntegral => Box::new(OutputIntegral::new(knowledge, bandwidth)),
            ControllerName::MotorSide => law(ImpedanceLaw::MotorSide),
            ControllerName::LinkSpring => law(ImpedanceLaw::LinkSpring),
            ControllerName::LinkSide => law(ImpedanceLaw::LinkSide),
            ControllerName::Off => return Self::Off,
            _ => Box::new(MotorPid::new(knowledge, bandwidth)),
        };
        Self::from_rival(controller)
    }

    /// Controller that uses counts and set-points only, as rivals do.
    pub fn from_rival(controller: Box<dyn Controller + 'p>) -> Self {
        Self::Rival(controller, 0)
    }

    /// Restarts from the estimated parameters, as after a power cycle, and returns their memory; a controller without
    /// an observer continues.
    pub fn restart_from_memory(&mut self) -> Outcome<Option<Memory>> {
        let (Self::Compensation(port, translator) | Self::Probe(port, translator)) = self else { return Ok(None) };
        let memory = port.restart_from_memory()?;
        translator.reset();
        Ok(Some(memory))
    }

    /// Memory of the estimated parameters, if the observer runs in this process.
    pub fn memory(&self) -> Option<Memory> {
        match self {
            Self::Compensation(port, _) | Self::Probe(port, _) => port.memory(),
            _ => None,
        }
    }

    /// Passes the true state before a period to the compensation that uses it.
    pub fn set_true_state(&mut self, joint: &Observation, torques: &TrueTorques) {
        if let Self::TrueState(from_truth) = self {
            from_truth.set_true_state(joint, torques);
        }
    }

    /// Torque for the period that begins [N m], and the port's answer.
    pub fn step(&mut self, seen: &ControllerInputs, set_point: &SetPoint) -> Outcome<(f64, Option<Answer>)> {
        match self {
            Self::Off => Ok((0.0, None)),
            Self::TrueState(from_truth) => Ok((from_truth.step(set_point), None)),
            Self::Rival(controller, output) => {
                *output = seen.output.map_or(*output, |frame| frame.counts);
                let measurement =
                    Measurement { period: seen.period, motor_counts: seen.motor.counts, output_counts: *output };
                Ok((controller.period(&measurement, set_point), None))
            }
            Self::Compensation(port, translator) => {
                let samples = translator.samples(seen);
                let answer = port.exchange(&samples, &translator.command(set_point))?;
                translator.note(answer.shaped.torque);
                Ok((f64::from(answer.shaped.torque), Some(answer)))
            }
            Self::Probe(port, translator) => {
                let answer = port.probe(&translator.samples(seen))?;
                translator.note(answer.shaped.torque);
                Ok((f64::from(answer.shaped.torque), Some(answer)))
            }
        }
    }
}
