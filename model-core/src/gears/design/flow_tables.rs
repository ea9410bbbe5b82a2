//! Tables of the exponential flow (S7), (S8). All planets are alike, so the in-phase motion (mean planet, gap, wind-up)
//! decouples from the planets' deviations from the mean: 36 + 4 numbers for any number of planets, where a dense matrix has
//! 64 for three planets and 144 for five.

use core::array;
use std::vec;
use std::vec::Vec;

use nalgebra::{DMatrix, DVectorView, SMatrix};

use crate::gears::design::dynamics::Dynamics;
use crate::gears::design::exponential::{self, flow as integrate};
use crate::gears::design::hamiltonian;
use crate::gears::tables::{Block, FlowTable, Inputs, TransitionTable};
use crate::numbers::Real;

/// Largest advance of the mesh phase per step [periods]: the error of a parabola through the excitation is about 1e-3 of the
/// amplitude.
pub const LARGEST_ADVANCE: f64 = 0.06;

/// Steps of travel at its speed that every mesh must overlap for an exponential tick (joints with corrected sub-steps). With
/// one step, bouncing meshes leave their flanks undetected between the nodes: error of a reversal 6e-4 (case L, 20 kHz);
/// with four steps 6e-5, as with sub-steps.
const REACH: f64 = 4.0;

/// Travel at its speed that every mesh must overlap for an exponential tick of light planets: at least one step, and at
/// least this many radians of a planet's own mode (S13). The slower the mode, the more the other bodies help to open a
/// mesh. Measured on case L at 20 kHz, one radian per step: error 1.1e-3, with one step alone 1.9e-3.
const RINGING_REACH: f64 = 4.0;

/// Use of exponential ticks.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum WholeTicks {
    /// No exponential ticks.
    Never,
    /// Exponential ticks while contacts hold, otherwise corrected sub-steps.
    Held,
    /// Exponential ticks while light planets stay in contact, otherwise Verlet sub-steps.
    Light,
}

/// Nodes of the pseudo-force as fractions of the tick, chosen for the smallest error of the cubic through these nodes and
/// value and rate at the start. Tuned over the unit square on a ringing joint: about half the error of nodes at 1/2 and 1.
const NODES: [f64; 2] = [0.4, 0.9];

/// Computes the flow over `step` (dimensionless); `substeps` is the number of sub-steps of the step, the unit of rates.
pub fn flow<T: Real>(dynamics: &Dynamics, step: f64, substeps: u32, whole_ticks: WholeTicks) -> FlowTable<T> {
    let sorting = Sorting::new(dynamics);
    let [first, second] = NODES;
    let whole = sorting.integrate(step, 4);
    let early = sorting.integrate(first * step, 2);
    let late = sorting.integrate(second * step, 3);
    let half = sorting.integrate(0.5 * step, 1);
    let [constant, linear] = [0, 1].map(|power| &whole.input_integrals[power]);
    // Input integrals up to a node for each value that the polynomial passes through, from its powers of time.
    let inputs = |flow: &exponential::Flow, node: f64, values: &[Vec<f64>]| -> Vec<Inputs<T>> {
        let of = |powers: &Vec<f64>| {
            let zero = &flow.input_integrals[0] * 0.0;
            powers.iter().enumerate().fold(zero, |sum, (power, weight)| {
                sum + &flow.input_integrals[power] * (weight * libm::pow(node, power as f64))
            })
        };
        values.iter().map(|powers| sorting.inputs(&of(powers))).collect()
    };
    let rate = f64::from(substeps);
    let square = first * first;
    let parabola = [vec![1.0, 0.0, -1.0 / square], vec![0.0, rate, -rate / first], vec![0.0, 0.0, 1.0 / square]];
    let early_inputs = inputs(&early, first, &[vec![1.0], vec![0.0, rate]]);
    let late_inputs = inputs(&late, second, &parabola);
    let whole_inputs = inputs(&whole, 1.0, &cubic(first, second, rate));
    FlowTable {
        whole_constant: sorting.inputs(constant),
        whole_linear: [sorting.inputs(&(constant - linear * 2.0)), sorting.inputs(&(linear * 2.0))],
        half_constant: sorting.inputs(&half.input_integrals[0]),
        half: sorting.transition(&half),
        whole: sorting.transition(&whole),
        early: sorting.transition(&early),
        late: sorting.transition(&late),
        early_inputs: array::from_fn(|i| early_inputs[i].clone()),
        late_inputs: array::from_fn(|i| late_inputs[i].clone()),
        whole_inputs: array::from_fn(|i| whole_inputs[i].clone()),
        nodes: NODES.map(T::from_f64),
        step: T::from_f64(step),
        // An overlap above the longest relaxation time times the speed presses under the law `contact`.
        reach: T::from_f64(match whole_ticks {
            WholeTicks::Never | WholeTicks::Held => (REACH * step).max(dynamics.longest_relaxation),
            WholeTicks::Light => step.max(RINGING_REACH / ringing(dynamics)).max(dynamics.longest_relaxation),
        }),
        longest_advance: T::from_f64(match whole_ticks {
            WholeTicks::Never => 0.0,
            WholeTicks::Held | WholeTicks::Light => LARGEST_ADVANCE * 4_294_967_296.0,
        }),
    }
}

/// Returns the powers of time of the cubic through value and rate (per `rate`-th of the step) at the start and values at
/// two nodes: one row for each of these four.
fn cubic(first: f64, second: f64, rate: f64) -> [Vec<f64>; 4] {
    // The cubic without value and rate, divided by the square of time, is linear through both nodes.
    let line = |at_first: f64, at_second: f64| {
        let slope = (at_second - at_first) / (second - first);
        [at_first - first * slope, slope]
    };
    let [value, slope] = [line(-1.0 / (first * first), -1.0 / (second * second)), line(-1.0 / first, -1.0 / second)];
    let [early, late] = [line(1.0 / (first * first), 0.0), line(0.0, 1.0 / (second * second))];
    [
        vec![1.0, 0.0, value[0], value[1]],
        vec![0.0, rate, rate * slope[0], rate * slope[1]],
        vec![0.0, 0.0, early[0], early[1]],
        vec![0.0, 0.0, late[0], late[1]],
    ]
}

/// Returns the frequency of a planet that oscillates against the other planets between sun and ring.
fn ringing(dynamics: &Dynamics) -> f64 {
    libm::sqrt(dynamics.stiffness[(0, 0)] - dynamics.stiffness[(0, 1)])
}

struct Sorting<'a> {
    dynamics: &'a Dynamics,
    /// In-phase part of a full state, and the full state of an in-phase part.
    average: DMatrix<f64>,
    spread: DMatrix<f64>,
}

impl<'a> Sorting<'a> {
    fn new(dynamics: &'a Dynamics) -> Self {
        let (planets, size) = (dynamics.planets, dynamics.coordinates());
        let mut average = DMatrix::zeros(6, 2 * size);
        let mut spread = DMatrix::zeros(2 * size, 6);
        for half in 0..2 {
            for planet in 0..planets {
                average[(3 * half, size * half + planet)] = 1.0 / planets as f64;
                spread[(size * half + planet, 3 * half)] = 1.0;
            }
            for other in planets..size {
                average[(3 * half + 1 + other - planets, size * half + other)] = 1.0;
                spread[(size * half + other, 3 * half + 1 + other - planets)] = 1.0;
            }
        }
        Self { dynamics, average, spread }
    }

    /// Computes the flow in (X, X'), integrated in the form of eq. 20. Inputs: pseudo-forces of the meshes, then accelerations
    /// of sun, carrier and link.
    fn integrate(&self, step: f64, powers: usize) -> exponential::Flow {
        let dynamics = self.dynamics;
        let (size, meshes) = (dynamics.coordinates(), dynamics.mesh_gain.ncols());
        let mut inputs = DMatrix::zeros(2 * size, meshes + 3);
        inputs.view_mut((size, 0), (size, meshes)).copy_from(&dynamics.mesh_gain);
        inputs.view_mut((size, meshes), (size, 3)).copy_from(&dynamics.torque_gain);
        let (forward, backward) = hamiltonian::from_rates(dynamics);
        let flow = integrate(&hamiltonian::matrix(dynamics), &inputs, step, powers);
        exponential::Flow {
            transition: &backward * flow.transition * forward,
            input_integrals: flow.input_integrals.iter().map(|integral| &backward * integral).collect(),
        }
    }

    fn transition<T: Real>(&self, flow: &exponential::Flow) -> TransitionTable<T> {
        let size = self.dynamics.coordinates();
        let full = &flow.transition;
        // Effect on a deviation: effect of a planet on itself minus the effect of another planet.
        let deviation = SMatrix::<f64, 2, 2>::from_fn(|row, column| {
            full[(size * row, size * column)] - full[(size * row, size * column + 1)]
        });
        let torques = self.dynamics.mesh_gain.ncols();
        TransitionTable {
            in_phase: narrow(&(&self.average * full * &self.spread)),
            deviation: Block(deviation.map(T::from_f64)),
            torques: narrow(&(&self.average * flow.input_integrals[0].columns(torques, 3))),
        }
    }

    fn inputs<T: Real>(&self, integral: &DMatrix<f64>) -> Inputs<T> {
        let (planets, size) = (self.dynamics.planets, self.dynamics.coordinates());
        // All planets have equal effect on the in-phase motion, so one column serves the sum over planets.
        let column = |mesh: usize| -> DVectorView<'_, f64> { integral.column(mesh) };
        let in_phase = DMatrix::from_columns(&[&self.average * column(0), &self.average * column(planets)]);
        let own_less_other = |row: usize| T::from_f64(integral[(row, 0)] - integral[(row, 1)]);
        Inputs { in_phase: narrow(&in_phase), deviation: [own_less_other(0), own_less_other(size)] }
    }
}

fn narrow<T: Real, const R: usize, const C: usize>(matrix: &DMatrix<f64>) -> Block<T, R, C> {
    Block(SMatrix::from_fn(|row, column| T::from_f64(matrix[(row, column)])))
}
