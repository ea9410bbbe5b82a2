//! Makes the certificate: errors predicted from the phase of the fastest mode, instructions from `cost`, stability
//! from `stability`. It knows the joint and the rate but not the motion, so errors are stated for half of all motions
//! and for nine in ten.

use core::f64::consts::{FRAC_PI_2, TAU};

use crate::gears::certificate::{Certificate, ErrorPromise, Instructions, Unseen};
use crate::gears::design::cost::Cost;
use crate::gears::design::error::DesignError;
use crate::gears::design::flow_tables::LARGEST_WAY;
use crate::gears::design::pace::{Effort, Pace, Parts};
use crate::gears::design::processor::Processor;
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
/// Meshes part and hit, law `paper`, and `contact`, under which light planets rattle.
const LOSING_PAPER: Fit = Fit { floor: [1e-5, 1e-4], factor: [2e-4, 1.5e-3] };
const LOSING_CONTACT: Fit = Fit { floor: [5e-5, 1.5e-3], factor: [5.2e-4, 3.9e-3] };
/// The same three for light planets, whose ringing a tick does not resolve: exponential ticks with one look, and leaps. Fit
/// over 860 random joints and motions against sixteen times finer corrected sub-steps.
const PRESSED: Fit = Fit { floor: [1e-5, 2e-4], factor: [7.5e-4, 8e-3] };
const LEAPING_PAPER: Fit = Fit { floor: [1e-5, 1e-4], factor: [1.2e-3, 6.5e-3] };
const LEAPING_CONTACT: Fit = Fit { floor: [5e-5, 1.5e-3], factor: [2.2e-3, 1.5e-2] };
/// Joints whose teeth are damped less are taken as damped so much: the fit knows none.
const LEAST_DAMPING: f64 = 0.02;
/// What errors of excitation add to the ripple.
const LEAST_RIPPLE: f64 = 0.01;
/// An error beyond this is no error of the motion any more but another motion.
const LARGEST_ERROR: f64 = 1.5;

impl Fit {
    fn at(&self, shape: f64) -> ErrorPromise {
        let [typical, nine_in_ten] =
            [0, 1].map(|which| (self.floor[which] + self.factor[which] * shape).min(LARGEST_ERROR));
        ErrorPromise { typical, nine_in_ten }
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
    let pace = Pace::new(parameters);
    let cost = pace.cost();
    let parts = pace.parts(tick_rate, effort)?;
    let phase = pace.phase(tick_rate, parts.count());
    let whole = |instructions: f64| libm::ceil(instructions) as u32;
    let (table_bytes, model_bytes) = sizes(parameters.geometry.planets);
    Ok(Certificate {
        tick_rate,
        parts,
        holding: holding(parameters, &pace, tick_rate, parts),
        losing: losing(parameters, phase, parts),
        instructions: Instructions {
            holding: whole(cost.holding(parts)),
            losing: whole(cost.losing(parts)),
            all_crossing: whole(cost.all_crossing(parts)),
            bound: whole(cost.bound(parts)),
        },
        table_bytes,
        model_bytes,
        phase,
        largest_phase: pace.largest_phase(parts),
        unseen: unseen(&pace, tick_rate, parts),
        lowest_rate: pace.lowest_rate(effort),
        highest_rate: highest_rate(cost, processor),
    })
}

/// The highest rate at which one sub-step is affordable.
fn highest_rate(cost: &Cost, processor: &Processor) -> u32 {
    libm::floor(processor.affordable(1) / cost.all_crossing(Parts::Substeps(1))) as u32
}

fn unseen(pace: &Pace, tick_rate: u32, parts: Parts) -> Unseen {
    let looks = match parts {
        // An exponential tick looks at its meshes in the middle and at its end.
        Parts::Substeps(substeps) => substeps.min(2),
        Parts::Leaps(leaps) => leaps,
    };
    let duration = 1.0 / (f64::from(tick_rate) * f64::from(looks));
    let departure = match parts {
        Parts::Substeps(_) => departure(pace.phase(tick_rate, looks)),
        // A leap goes straight on from its middle: cos x + x sin x >= 1 up to x = 2.3 sees every mesh that leaves.
        Parts::Leaps(_) => Some(0.0),
    };
    Unseen { duration, departure }
}

/// A mesh under a load that deflects it by D oscillates by A > D at the fastest mode, D + A cos(omega t): it is off its
/// flank for 2 acos(D / A) / omega and goes A - D beyond. All of that falls between two looks up to this (A - D) / D.
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

fn holding(parameters: &JointParameters, pace: &Pace, tick_rate: u32, parts: Parts) -> ErrorPromise {
    let phase = pace.phase(tick_rate, parts.count());
    if pace.mesh_frequency() > LARGEST_WAY * TAU * f64::from(tick_rate) {
        return FAST.at(libm::pow(phase, 3.0) * coarse(phase));
    }
    let swings = MESH_KINDS.map(|kind| parameters.mesh(kind).stiffness_wave.swing());
    let ripple = swings[0].max(swings[1]) + LEAST_RIPPLE;
    let tick = pace.phase(tick_rate, 1);
    let (fit, order) = match parts {
        Parts::Substeps(_) => (FLOW, 2.5),
        Parts::Leaps(_) => (PRESSED, 2.2),
    };
    let shape = libm::pow(tick, order) * libm::pow(ripple, 0.75) * libm::pow(damping(parameters), -0.7);
    fit.at(shape * coarse(phase))
}

fn losing(parameters: &JointParameters, phase: f64, parts: Parts) -> ErrorPromise {
    let (fit, order) = match (parts, parameters.damping_law) {
        (Parts::Substeps(_), DampingLaw::Paper) => (LOSING_PAPER, 3.0),
        (Parts::Substeps(_), DampingLaw::Contact) => (LOSING_CONTACT, 3.0),
        (Parts::Leaps(_), DampingLaw::Paper) => (LEAPING_PAPER, 1.6),
        (Parts::Leaps(_), DampingLaw::Contact) => (LEAPING_CONTACT, 1.6),
    };
    // Between losses there are whole ticks by the exponential flow: more parts to a tick make these longer.
    let parts = f64::from(parts.count());
    let shape = libm::pow(phase, order) * parts * libm::pow(damping(parameters), -2.0 / 3.0);
    fit.at(shape * coarse(phase))
}

/// Bytes of tables and model.
fn sizes(planets: usize) -> (u32, u32) {
    fn of<const N: usize>() -> (u32, u32) {
        (size_of::<Tables<f32, N>>() as u32, size_of::<Model<'_, f32, N>>() as u32)
    }
    match planets {
        3 => of::<3>(),
        4 => of::<4>(),
        _ => of::<5>(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Whether a mesh at 1 + amplitude cos(angle) is still on its flank at both of two looks about its deepest point.
    fn slips_between(phase: f64, amplitude: f64) -> bool {
        [-0.5, 0.5].iter().all(|side| 1.0 - amplitude * libm::cos(side * phase) >= 0.0)
    }

    #[test]
    fn a_departure_slips_between_two_looks_up_to_the_stated_depth_and_not_beyond() {
        for phase in [0.2, 0.5, 1.0, 2.0, 3.0] {
            let depth = departure(phase).expect("looks are close enough");
            assert!(slips_between(phase, 1.0 + 0.99 * depth), "{phase}");
            assert!(!slips_between(phase, 1.0 + 1.01 * depth), "{phase}");
        }
        assert_eq!(departure(3.2), None);
    }
}
