//! A case as the board steps it, and in sixteen times finer steps in f64: how far apart they are, whether contact held,
//! and whether the motion can be predicted at all. The finer steps' own error is smaller by three orders.

use std::array;

use model_core::gears::design::{Effort, design_scheme};
use model_core::gears::{Model, Relative, Scales, Scheme, State, Tables, Torques};
use model_core::numbers::Real;
use parameters::ContactState;

use super::random::Case;

/// Length of a motion in dimensionless time, tau = omega_n t.
const LENGTH: f64 = 200.0;
/// Steps of the finer run in one of the coarse.
const FINER: u32 = 16;
/// A vanishing change [b_c], and how much it may grow before a motion counts as unpredictable.
const CHANGE: f64 = 1e-8;
const GROWTH: f64 = 100.0;

/// The result of a case.
#[derive(Debug, Clone, Copy)]
pub struct Outcome {
    /// RMS error of the mesh deflections over their standard deviations.
    pub error: f64,
    /// Whether every mesh stayed on its flank.
    pub holds: bool,
}

fn model<T: Real, const N: usize>(case: &Case, tables: &'static Tables<T, N>, change: f64) -> Model<'static, T, N> {
    let length = case.joint.characteristic_length;
    let real = T::from_f64;
    let deflections: [T; N] =
        array::from_fn(|i| real((case.joint.sun_planet.half_backlash[i] + case.deflection) / length));
    let far = case.joint.ring_planet.half_backlash[0]
        + case.joint.sun_planet.half_backlash[0]
        + case.deflection * (1.0 + case.joint.sun_planet.mean_stiffness / case.joint.ring_planet.mean_stiffness);
    let position = Relative { planets: deflections, gap: real(far / length + change), wind_up: T::ZERO };
    let mut model = Model::new(tables);
    model.set_state(State::from_deflections(tables, &position, &Relative::ZERO, real(case.speed)));
    model
}

fn tables<T: Real, const N: usize>(case: &Case, rate: u32, effort: Effort) -> &'static Tables<T, N> {
    let tables = design_scheme(&case.joint, rate, Scheme::Realtime, effort);
    Box::leak(Box::new(tables.expect("a sound joint")))
}

/// Follows a case at a tick rate; `None` if it cannot be predicted by anyone.
pub fn follow<const N: usize>(case: &Case, rate: u32) -> Option<Outcome> {
    let coarse_tables = tables::<f32, N>(case, rate, case.effort());
    // Of corrected sub-steps in either case: Verlet sub-steps have nothing in common with them.
    let fine_tables = tables::<f64, N>(case, FINER * rate, Effort::Substeps(case.parts.count()));
    let mut coarse = model(case, coarse_tables, 0.0);
    let (mut fine, mut changed) = (model(case, fine_tables, 0.0), model(case, fine_tables, CHANGE));
    let length = case.joint.characteristic_length;
    let ticks = (LENGTH / Scales::new(&case.joint).frequency * f64::from(rate)).ceil() as u32;
    let (mut sums, mut squares, mut errors) = ([[0.0; N]; 2], [[0.0; N]; 2], [[0.0; N]; 2]);
    let (mut holds, mut growth) = (true, 0.0_f64);
    for tick in 0..ticks {
        let part = usize::from(tick >= ticks / 3);
        let (drive, load) = (case.drive[part], case.load[part]);
        coarse.step(Torques { drive: drive as f32, load: load as f32 });
        for _ in 0..FINER {
            let torques = Torques { drive, load };
            fine.step(torques);
            changed.step(torques);
            holds &= fine.outputs().contacts.iter().flatten().all(|contact| *contact == ContactState::DriveSide);
        }
        let (is, should, other) = (coarse.outputs(), fine.outputs(), changed.outputs());
        for kind in 0..2 {
            for i in 0..N {
                let value = should.deflections[kind][i];
                sums[kind][i] += value;
                squares[kind][i] += value * value;
                errors[kind][i] += (f64::from(is.deflections[kind][i]) - value).powi(2);
                growth = growth.max((other.deflections[kind][i] - value).abs() / (CHANGE * length));
            }
        }
    }
    let count = f64::from(ticks);
    let mut total = 0.0;
    for kind in 0..2 {
        for i in 0..N {
            let mean = sums[kind][i] / count;
            total += errors[kind][i] / (squares[kind][i] - count * mean * mean);
        }
    }
    let error = (total / (2 * N) as f64).sqrt();
    (growth < GROWTH && error.is_finite()).then_some(Outcome { error, holds })
}
