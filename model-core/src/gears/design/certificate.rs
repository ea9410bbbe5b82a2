//! Makes the certificate: errors predicted from the phase of the fastest mode, instructions from `cost`, stability
//! from `stability`. It knows the joint and the rate but not the motion, so errors are stated for half of all motions
//! and for nine in ten.

use core::f64::consts::{FRAC_PI_2, TAU};

use crate::gears::certificate::{Certificate, ErrorQuantiles, Instructions, Unseen};
use crate::gears::design::cost::Cost;
use crate::gears::design::error::DesignError;
use crate::gears::design::flow_tables::LARGEST_ADVANCE;
use crate::gears::design::processor::Processor;
use crate::gears::design::step_size::{Effort, StepSize, Substeps};
use crate::gears::design::validate::validate;
use crate::gears::model::Model;
use crate::gears::stiffness_series::StiffnessSeries;
use crate::gears::tables::Tables;
use parameters::{DampingLaw, JointParameters, MESH_KINDS};

/// Error = floor + factor * shape, each for half of all motions and for nine in ten. Shapes follow the step's orders and
/// a fit over 2,400 random joints and motions (f32 against sixteen times finer steps in f64); factors are quantiles.
struct Fit {
    floor: [f64; 2],
    factor: [f64; 2],
}

/// Exponential ticks: of third order in the tick's phase, next to nothing without ripple.
const FLOW: Fit = Fit { floor: [1e-5, 2e-4], factor: [5e-5, 3.5e-4] };
/// Contact holds, but excitation is so fast that it is followed in sub-steps.
const FAST: Fit = Fit { floor: [1e-5, 2e-4], factor: [5e-3, 2.5e-2] };
/// Contact changes: meshes part and hit, law `paper`, and `contact`, under which light planets rattle.
const CHANGING_PAPER: Fit = Fit { floor: [1e-5, 1e-4], factor: [2e-4, 1.5e-3] };
const CHANGING_CONTACT: Fit = Fit { floor: [5e-5, 1.5e-3], factor: [5.2e-4, 3.9e-3] };
/// The same three for light planets, whose ringing a tick does not resolve: exponential ticks with one node,
/// and Verlet sub-steps. Fit over 860 random joints and motions against sixteen times finer corrected sub-steps.
const LINEAR_CONTACT: Fit = Fit { floor: [1e-5, 2e-4], factor: [7.5e-4, 8e-3] };
const VERLET_PAPER: Fit = Fit { floor: [1e-5, 1e-4], factor: [1.2e-3, 6.5e-3] };
const VERLET_CONTACT: Fit = Fit { floor: [5e-5, 1.5e-3], factor: [2.2e-3, 1.5e-2] };
/// An equivalent gear: while its contact holds nothing is left but rounding; where it changes, parts of a tick are of fifth
/// order in the contact's phase. Fit over 490 random gears and motions (f32 against the reference).
const EQUIVALENT_HOLDS: Fit = Fit { floor: [5e-7, 1e-5], factor: [0.0, 0.0] };
const EQUIVALENT_CHANGES: Fit = Fit { floor: [5e-7, 1e-5], factor: [1e-4, 5e-3] };
/// Joints whose teeth are damped less are taken as damped so much: the fit knows none.
const LEAST_DAMPING: f64 = 0.02;
/// What errors of excitation add to the ripple.
const LEAST_RIPPLE: f64 = 0.01;
/// Beyond this the motion has nothing in common with the true one, and the error says no more.
const LARGEST_ERROR: f64 = 1.5;

impl Fit {
    fn at(&self, shape: f64) -> ErrorQuantiles {
        let [typical, nine_in_ten] =
            [0, 1].map(|which| (self.floor[which] + self.factor[which] * shape).min(LARGEST_ERROR));
        ErrorQuantiles { typical, nine_in_ten }
    }
}

/// The certificate of tables at a tick rate, on a processor.
pub fn certificate(
    parameters: &JointParameters,
    tick_rate: u32,
    effort: Effort,
    processor: &Processor,
) -> Result<Certificate, DesignError> {
    validate(parameters)?;
    let step_size = StepSize::new(parameters);
    let cost = step_size.cost();
    let substeps = step_size.substeps(tick_rate, effort)?;
    let phase = step_size.phase(tick_rate, substeps.count());
    let whole = |instructions: f64| libm::ceil(instructions) as u32;
    let (table_bytes, model_bytes) = sizes(parameters.geometry.planets);
    Ok(Certificate {
        tick_rate,
        substeps,
        contact_holds: contact_holds(parameters, &step_size, tick_rate, substeps),
        contact_changes: contact_changes(parameters, phase, substeps),
        instructions: Instructions {
            contact_holds: whole(cost.contact_holds(substeps)),
            contact_changes: whole(cost.contact_changes(substeps)),
            all_crossing: whole(cost.all_crossing(substeps)),
            bound: whole(cost.bound(substeps)),
        },
        table_bytes,
        model_bytes,
        phase,
        largest_phase: step_size.largest_phase(substeps),
        unseen: unseen(&step_size, tick_rate, substeps),
        lowest_rate: step_size.lowest_rate(effort),
        highest_rate: highest_rate(cost, processor),
    })
}

/// The highest rate at which one sub-step is affordable.
fn highest_rate(cost: &Cost, processor: &Processor) -> u32 {
    libm::floor(processor.affordable(1) / cost.all_crossing(Substeps::Corrected(1))) as u32
}

fn unseen(step_size: &StepSize, tick_rate: u32, substeps: Substeps) -> Unseen {
    let checks = match substeps {
        // An exponential tick checks its meshes in the middle and at its end.
        Substeps::Corrected(substeps) => substeps.min(2),
        Substeps::Verlet(substeps) => substeps,
    };
    let duration = 1.0 / (f64::from(tick_rate) * f64::from(checks));
    let departure = match substeps {
        Substeps::Corrected(_) => departure(step_size.phase(tick_rate, checks)),
        // A Verlet sub-step goes straight on from its middle: cos x + x sin x >= 1 up to x = 2.3 sees every mesh that leaves.
        Substeps::Verlet(_) => Some(0.0),
    };
    Unseen { duration, departure }
}

/// A mesh under a load that deflects it by D oscillates by A > D at the fastest mode, D + A cos(omega t): it is off its
/// flank for 2 acos(D / A) / omega and goes A - D beyond. All of that falls between two checks up to this (A - D) / D.
fn departure(phase: f64) -> Option<f64> {
    let half = 0.5 * phase;
    (half < FRAC_PI_2).then(|| 1.0 / libm::cos(half) - 1.0)
}

fn damping(parameters: &JointParameters) -> f64 {
    MESH_KINDS.map(|kind| parameters.mesh(kind).damping_ratio).into_iter().fold(LEAST_DAMPING, f64::max)
}

/// Coarse steps are worse than their order says.
fn coarse(phase: f64) -> f64 {
    1.0 + 0.25 * phase * phase
}

fn contact_holds(
    parameters: &JointParameters,
    step_size: &StepSize,
    tick_rate: u32,
    substeps: Substeps,
) -> ErrorQuantiles {
    if parameters.equivalent_gear().is_some() {
        return EQUIVALENT_HOLDS.at(0.0);
    }
    let phase = step_size.phase(tick_rate, substeps.count());
    if step_size.mesh_frequency() > LARGEST_ADVANCE * TAU * f64::from(tick_rate) {
        return FAST.at(libm::pow(phase, 3.0) * coarse(phase));
    }
    let swings = MESH_KINDS.map(|kind| parameters.mesh(kind).stiffness_wave.swing());
    let ripple = swings[0].max(swings[1]) + LEAST_RIPPLE;
    let tick = step_size.phase(tick_rate, 1);
    let (fit, order) = match substeps {
        Substeps::Corrected(_) => (FLOW, 2.5),
        Substeps::Verlet(_) => (LINEAR_CONTACT, 2.2),
    };
    let shape = libm::pow(tick, order) * libm::pow(ripple, 0.75) * libm::pow(damping(parameters), -0.7);
    fit.at(shape * coarse(phase))
}

fn contact_changes(parameters: &JointParameters, phase: f64, substeps: Substeps) -> ErrorQuantiles {
    if parameters.equivalent_gear().is_some() {
        return EQUIVALENT_CHANGES.at(libm::pow(phase, 4.0));
    }
    let (fit, order) = match (substeps, parameters.damping_law) {
        (Substeps::Corrected(_), DampingLaw::Paper) => (CHANGING_PAPER, 3.0),
        (Substeps::Corrected(_), DampingLaw::Contact) => (CHANGING_CONTACT, 3.0),
        (Substeps::Verlet(_), DampingLaw::Paper) => (VERLET_PAPER, 1.6),
        (Substeps::Verlet(_), DampingLaw::Contact) => (VERLET_CONTACT, 1.6),
    };
    // Between changes there are whole ticks by the exponential flow: more sub-steps to a tick make these longer.
    let substeps = f64::from(substeps.count());
    let shape = libm::pow(phase, order) * substeps * libm::pow(damping(parameters), -2.0 / 3.0);
    fit.at(shape * coarse(phase))
}

/// Bytes of tables and model.
fn sizes(planets: usize) -> (u32, u32) {
    fn of<const N: usize>() -> (u32, u32) {
        (size_of::<Tables<f32, N>>() as u32, size_of::<Model<'_, f32, N>>() as u32)
    }
    match planets {
        1 => of::<1>(),
        3 => of::<3>(),
        4 => of::<4>(),
        _ => of::<5>(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Whether a mesh at 1 + amplitude cos(angle) is still on its flank at both of two checks about its deepest point.
    fn slips_between(phase: f64, amplitude: f64) -> bool {
        [-0.5, 0.5].iter().all(|side| 1.0 - amplitude * libm::cos(side * phase) >= 0.0)
    }

    #[test]
    fn a_departure_slips_between_two_looks_up_to_the_stated_depth_and_not_beyond() {
        for phase in [0.2, 0.5, 1.0, 2.0, 3.0] {
            let depth = departure(phase).expect("checks are close enough");
            assert!(slips_between(phase, 1.0 + 0.99 * depth), "{phase}");
            assert!(!slips_between(phase, 1.0 + 1.01 * depth), "{phase}");
        }
        assert_eq!(departure(3.2), None);
    }
}
