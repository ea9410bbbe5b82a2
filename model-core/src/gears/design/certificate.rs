//! Computes the certificate: instructions from `cost`, stability from `stability`. The certificate contains no errors:
//! measuring these takes the fixed step, some motions and a second on the host.

use core::f64::consts::FRAC_PI_2;

use crate::gears::certificate::{Certificate, Instructions, Unseen};
use crate::gears::design::error::DesignError;
use crate::gears::design::step_size::{Effort, StepSize, Substeps};
use crate::gears::design::validate::validate;
use crate::gears::model::Model;
use crate::gears::tables::Tables;
use parameters::JointParameters;

/// Computes the certificate of a joint at a tick rate.
pub fn certificate(parameters: &JointParameters, tick_rate: u32, effort: Effort) -> Result<Certificate, DesignError> {
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
    })
}

fn unseen(step_size: &StepSize, tick_rate: u32, substeps: Substeps) -> Unseen {
    let checks = match substeps {
        // An exponential tick checks its meshes at two nodes, half a tick apart.
        Substeps::Corrected(substeps) => substeps.min(2),
        Substeps::Verlet(substeps) => substeps,
    };
    let duration = 1.0 / (f64::from(tick_rate) * f64::from(checks));
    let departure = match substeps {
        Substeps::Corrected(_) => departure(step_size.phase(tick_rate, checks)),
        // The path of a Verlet sub-step is straight from its middle: cos x + x sin x >= 1 up to x = 2.3, so every mesh
        // that leaves its flank is detected.
        Substeps::Verlet(_) => Some(0.0),
    };
    Unseen { duration, departure }
}

/// Returns the largest undetected (A - D) / D. A mesh deflected by D under load oscillates as D + A cos(omega t) at the
/// fastest mode; with A > D it is off its flank for 2 acos(D / A) / omega, by up to A - D, between two checks.
fn departure(phase: f64) -> Option<f64> {
    let half = 0.5 * phase;
    (half < FRAC_PI_2).then(|| 1.0 / libm::cos(half) - 1.0)
}

/// Returns the sizes of tables and model [byte].
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

    /// Returns true if a mesh at 1 - amplitude cos(angle) is on its flank at both checks around its largest departure.
    fn slips_between(phase: f64, amplitude: f64) -> bool {
        [-0.5, 0.5].iter().all(|side| 1.0 - amplitude * libm::cos(side * phase) >= 0.0)
    }

    /// A departure up to the stated depth goes unseen between two checks, a deeper one does not.
    #[test]
    fn departure_up_to_stated_depth_is_unseen() {
        for phase in [0.2, 0.5, 1.0, 2.0, 3.0] {
            let depth = departure(phase).expect("checks are close enough");
            assert!(slips_between(phase, 1.0 + 0.99 * depth), "{phase}");
            assert!(!slips_between(phase, 1.0 + 1.01 * depth), "{phase}");
        }
        assert_eq!(departure(3.2), None);
    }
}
