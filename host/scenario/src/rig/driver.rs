//! A controller at work: the compensation behind its port, one that controls as rivals do, the compensation on the
//! truth, or nobody.

use reference::closed_loop::rivals::Knowledge;
use reference::closed_loop::{
    Controller, Impedance, ImpedanceLaw, LoadCascade, MotorPid, OutputIntegral, SetPoint, VelocitySign,
};
use reference::drive_train::{Measurement, TrueTorques};
use reference::joint::Observation;

use super::perfect_sight::PerfectSight;
use crate::controller::ControllerName;
use crate::faults::Seen;
use crate::port::{Answer, ControllerPort, Translator};
use report::failure::Outcome;

/// A controller at work.
pub enum Driver<'p> {
    /// Observer and compensation.
    Ours(Box<dyn ControllerPort + 'p>, Translator),
    /// The observer and its width probe.
    Probe(Box<dyn ControllerPort + 'p>, Translator),
    /// A controller of the reference's kind, and the last reading of the output encoder, which it holds while none comes.
    Rival(Box<dyn Controller + 'p>, i64),
    /// The compensation on the truth.
    Perfect(Box<PerfectSight<'p>>),
    /// Nobody.
    Off,
}

impl<'p> Driver<'p> {
    /// A rival by its name.
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
        Self::of(controller)
    }

    /// Whoever controls as rivals do: from counts and set-points alone.
    pub fn of(controller: Box<dyn Controller + 'p>) -> Self {
        Self::Rival(controller, 0)
    }

    /// Begins anew with what was learnt so far, as after the power was off; who learns nothing just goes on.
    pub fn begin_again(&mut self) -> Outcome<()> {
        if let Self::Ours(port, translator) | Self::Probe(port, translator) = self {
            port.begin_again()?;
            translator.begin_again();
        }
        Ok(())
    }

    /// Shows the truth, before a period, to whom it is meant for.
    pub fn show(&mut self, joint: &Observation, torques: &TrueTorques) {
        if let Self::Perfect(perfect) = self {
            perfect.show(joint, torques);
        }
    }

    /// Torque for the period that begins now [N m], and what a port answered.
    pub fn period(&mut self, seen: &Seen, set_point: &SetPoint) -> Outcome<(f64, Option<Answer>)> {
        match self {
            Self::Off => Ok((0.0, None)),
            Self::Perfect(perfect) => Ok((perfect.period(set_point), None)),
            Self::Rival(controller, output) => {
                *output = seen.output.map_or(*output, |frame| frame.counts);
                let measurement =
                    Measurement { period: seen.period, motor_counts: seen.motor.counts, output_counts: *output };
                Ok((controller.period(&measurement, set_point), None))
            }
            Self::Ours(port, translator) => {
                let samples = translator.samples(seen);
                let answer = port.exchange(&samples, &translator.command(set_point))?;
                translator.note(&answer);
                Ok((f64::from(answer.shaped.torque), Some(answer)))
            }
            Self::Probe(port, translator) => {
                let answer = port.probe(&translator.samples(seen))?;
                translator.note(&answer);
                Ok((f64::from(answer.shaped.torque), Some(answer)))
            }
        }
    }
}
