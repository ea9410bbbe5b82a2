//! The core against closed forms without any integrator, for three, four and five planets: oracles 1 to 4, 7 and 8. Oracles 5 and 6 are in
//! `invariants`; the reference's tests are in `the_reference`.

pub mod closed_forms;
mod linear;
mod periods;
mod teeth;

use model_core::gears::design::{Effort, design_scheme};
use model_core::gears::{Mechanics, Model, Outputs, Relative, Scheme, State, Tables, Torques};
use parameters::JointParameters;

/// Initial state of a run, in units of b_c and b_c omega_n, and its torque.
#[derive(Clone, Copy)]
struct Start<const N: usize> {
    position: Relative<f64, N>,
    rate: Relative<f64, N>,
    /// Torque on the sun [N m]; the load balances it.
    drive: f64,
}

impl<const N: usize> Start<N> {
    /// Start at rest with every tooth in the middle of its gap.
    fn centred(drive: f64) -> Self {
        Self { position: Relative::ZERO, rate: Relative::ZERO, drive }
    }
}

/// Runs the core in f64 for `skipped` ticks, then samples every tick; the first sample is the state reached.
fn run<const N: usize>(
    joint: &JointParameters,
    tick_rate: u32,
    start: &Start<N>,
    skipped: usize,
    samples: usize,
) -> Vec<(Outputs<f64, N>, State<f64, N>)> {
    let tables: Tables<f64, N> =
        design_scheme(joint, tick_rate, Scheme::Realtime, Effort::Accurate).expect("a sound joint");
    let torques = Torques { drive: start.drive, load: joint.balanced_load_torque(start.drive) };
    let mut model = Model::new(&tables);
    model.set_state(State::from_deflections(&tables, &start.position, &start.rate, 0.0));
    (0..skipped).for_each(|_| model.step(torques));
    let sample = |_| {
        let now = (model.outputs(), *model.state());
        model.step(torques);
        now
    };
    (0..samples).map(sample).collect()
}
