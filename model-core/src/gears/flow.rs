//! Exponential tick (S6), (S7): advances the joint by a whole tick while every mesh stays on its flank. The linear motion
//! is exact. Ripple, backlash and imposed error act as a pseudo-force, a cubic in time through value and rate at the start
//! and the values at two nodes within the tick.

use core::array;

use crate::gears::contact::{AppliedAcceleration, Laws, NetForces};
use crate::gears::excitation::{MeshExcitation, MeshPhase, PhaseHarmonics};
use crate::gears::fixed_contact_set::FixedContactSet;
use crate::gears::planets::each_planet;
use crate::gears::stages::{Point, SubstepState};
use crate::gears::state::{MotionInPlace, Relative};
use crate::gears::tables::{Block, Inputs, TransitionTable};
use crate::numbers::Real;

/// Pseudo-force at the start of a tick, k_mean x + c x' - F (S6): linear mesh force of the flow minus true mesh force.
pub struct Start<T, const N: usize> {
    value: PseudoForce<T, N>,
    /// Rate of the pseudo-force per sub-step.
    rate: PseudoForce<T, N>,
}

/// Evaluates the pseudo-force at the start of a tick in which every mesh is closed. Returns `None` unless the overlap of
/// every mesh exceeds `flow.reach` times the mesh's speed.
#[inline(never)]
pub fn start<T: Real, const N: usize, const OVERTONES: usize>(
    fixed: &FixedContactSet<T, N, OVERTONES>,
    harmonics_now: &PhaseHarmonics<T, OVERTONES>,
    laws: &Laws<T, N>,
    state: &SubstepState<T, N>,
) -> Option<Start<T, N>> {
    let tables = fixed.tables;
    let reach = tables.flow.reach * tables.stage.rate;
    let square = harmonics_now.rate * harmonics_now.rate;
    let rates = &harmonics_now.rates;
    let mut least_room = T::ONE;
    let mut mesh = |(kind, i): (usize, usize), at: Point<T>| {
        let (spring, damping) = (tables.springs[kind].stiffness, tables.stage.damping[kind]);
        let law = &laws[kind][i];
        let MeshExcitation { stiffness, error, .. } = fixed.wave((kind, i), harmonics_now);
        let stiffness_rate = tables.meshes[kind][i].stiffness_rate(harmonics_now, tables.excitation.harmonics);
        let error_rate = tables.meshes[kind][i].error_at(rates);
        let overlap = at.position - law.offset - error;
        let speed = at.rate - error_rate;
        let room = law.side * overlap - reach * speed.abs();
        least_room = if room < least_room { room } else { least_room };
        // e'' = -rate^2 e.
        (
            spring * at.position - stiffness * overlap + damping * error_rate,
            spring * at.rate - stiffness * speed - stiffness_rate * overlap - damping * (square * error),
        )
    };
    let (mut value, mut rate) = (NetForces::NONE, NetForces::NONE);
    each_planet!(N, i => {
        let sun = state.planets[i].point();
        let ring = mesh((1, i), state.gap.point().minus(sun));
        let sun = mesh((0, i), sun);
        value.add(i, sun.0, ring.0);
        rate.add(i, sun.1, ring.1);
    });
    (least_room > T::ZERO).then(|| Start {
        value: PseudoForce::from_net_forces(tables.planet_share, &value),
        rate: PseudoForce::from_net_forces(tables.planet_share, &rate),
    })
}

/// Advances the motion in place by one tick with the contact set of the start. Returns false and leaves the motion
/// unchanged if a mesh leaves its flank at a node. `K` is the number of in-phase coordinates: 3 with compliance, else 2.
#[inline(never)]
pub fn tick<T: Real, const N: usize, const K: usize, const OVERTONES: usize>(
    fixed: &FixedContactSet<T, N, OVERTONES>,
    applied: &AppliedAcceleration<T>,
    phase: &MeshPhase<T>,
    laws: &Laws<T, N>,
    start: &Start<T, N>,
    motion: &mut MotionInPlace<T, N>,
) -> bool {
    let tables = fixed.tables;
    let flow = &tables.flow;
    let Start { value, rate } = start;
    let modes = Modes::<T, N, K>::from_motion(tables.planet_share, motion);
    let torques = [applied.sun, applied.carrier, applied.link];
    let node = |part: T| PhaseHarmonics::new(phase.at(part), phase.rate, tables.excitation.harmonics);

    let [first, second] = &flow.early_inputs;
    let positions = modes.positions(&flow.early, &torques).with([(first, value), (second, rate)]);
    let (early, violation) = fixed.pseudo_force(laws, &node(flow.nodes[0]), &positions);
    if violation > T::ZERO {
        return false;
    }

    let [first, second, third] = &flow.late_inputs;
    let positions = modes.positions(&flow.late, &torques).with([(first, value), (second, rate), (third, &early)]);
    let (late, violation) = fixed.pseudo_force(laws, &node(flow.nodes[1]), &positions);

    if violation > T::ZERO {
        return false;
    }

    let [first, second, third, fourth] = &flow.whole_inputs;
    let forces = [(first, value), (second, rate), (third, &early), (fourth, &late)];
    modes.flow(&flow.whole, &torques).with(forces).move_to(motion);
    true
}

impl<T: Real, const N: usize, const OVERTONES: usize> FixedContactSet<'_, T, N, OVERTONES> {
    /// Returns the pseudo-force of closed meshes at a node (offset, imposed error, ripple), and a violation, which is positive
    /// if a mesh has left its flank.
    #[inline(never)]
    fn pseudo_force(
        &self,
        laws: &Laws<T, N>,
        harmonics_now: &PhaseHarmonics<T, OVERTONES>,
        positions: &MeshPositions<T, N>,
    ) -> (PseudoForce<T, N>, T) {
        let tables = self.tables;
        let (mut net, mut violation) = (NetForces::NONE, T::ZERO);
        let mut mesh = |(kind, i): (usize, usize), position: T| {
            let law = &laws[kind][i];
            let MeshExcitation { stiffness, error, error_rate } = self.wave((kind, i), harmonics_now);
            let overlap = position - error - law.offset;
            let room = law.side * overlap;
            violation += room.abs() - room;
            let spring = &tables.springs[kind];
            spring.stiffness * position - stiffness * overlap + spring.damping * error_rate
        };
        for i in 0..N {
            let sun = positions.planets[i];
            net.add(i, mesh((0, i), sun), mesh((1, i), positions.gap - sun));
        }
        (PseudoForce::from_net_forces(tables.planet_share, &net), violation)
    }
}

/// Pseudo-force as input of the flow.
struct PseudoForce<T, const N: usize> {
    /// Sums over planets: sun-planet, ring-planet.
    sums: [T; 2],
    /// Sun-planet minus ring-planet force of every planet, minus the mean over planets.
    deviations: [T; N],
}

impl<T: Real, const N: usize> PseudoForce<T, N> {
    #[inline(always)]
    fn from_net_forces(share: T, net: &NetForces<T, N>) -> Self {
        let mean = share * net.difference();
        let mut deviations = [T::ZERO; N];
        each_planet!(N, i => {
            deviations[i] = net.difference_of(i) - mean;
        });
        Self { sums: net.sums(), deviations }
    }
}

/// Positions of planets and gap at a node.
struct MeshPositions<T, const N: usize> {
    planets: [T; N],
    gap: T,
}

/// Positions at a node: mean planet and gap, and every planet's deviation from the mean.
struct ModalPositions<T, const N: usize> {
    in_phase: [T; 2],
    deviations: [T; N],
}

/// Motion split into in-phase motion (mean planet, gap, wind-up; then their rates) and the planets' deviations from the
/// mean (deviation, rate). The flow decouples the two parts.
struct Modes<T, const N: usize, const K: usize> {
    in_phase: [[T; K]; 2],
    deviations: [[T; 2]; N],
}

impl<T: Real, const N: usize, const K: usize> Modes<T, N, K> {
    #[inline]
    fn from_motion(share: T, motion: &MotionInPlace<T, N>) -> Self {
        let means = [&*motion.position, &*motion.rate].map(|part| share * total(&part.planets));
        let part = |half: usize, part: &Relative<T, N>| {
            let all = [means[half], part.gap, part.wind_up];
            array::from_fn(|k| all[k])
        };
        let (position, rate) = (&*motion.position, &*motion.rate);
        Self {
            in_phase: [part(0, position), part(1, rate)],
            deviations: array::from_fn(|i| [position.planets[i] - means[0], rate.planets[i] - means[1]]),
        }
    }

    /// Returns one in-phase coordinate after the linear flow under constant torques.
    #[inline(always)]
    fn coordinate(&self, transition: &TransitionTable<T>, torques: &[T; 3], half: usize, k: usize) -> T {
        let row = 3 * half + k;
        let mut change = T::ZERO;
        for from in 0..2 {
            for other in 0..K {
                change += entry(&transition.in_phase, row, 3 * from + other) * self.in_phase[from][other];
            }
        }
        // The load acts on the carrier without compliance, on the link with compliance.
        for torque in [0, K - 1] {
            change += entry(&transition.torques, row, torque) * torques[torque];
        }
        self.in_phase[half][k] + change
    }

    /// Returns one deviation after the linear flow.
    #[inline(always)]
    fn deviation(&self, transition: &TransitionTable<T>, i: usize, half: usize) -> T {
        let [position, rate] = self.deviations[i];
        self.deviations[i][half]
            + (entry(&transition.deviation, half, 0) * position + entry(&transition.deviation, half, 1) * rate)
    }

    /// Returns the positions of mean planet, gap and deviations after the linear flow.
    #[inline]
    fn positions(&self, transition: &TransitionTable<T>, torques: &[T; 3]) -> ModalPositions<T, N> {
        let in_phase = [self.coordinate(transition, torques, 0, 0), self.coordinate(transition, torques, 0, 1)];
        let mut deviations = [T::ZERO; N];
        each_planet!(N, i => {
            deviations[i] = self.deviation(transition, i, 0);
        });
        ModalPositions { in_phase, deviations }
    }

    /// Returns all positions and rates after the linear flow.
    #[inline]
    fn flow(&self, transition: &TransitionTable<T>, torques: &[T; 3]) -> Self {
        let (mut in_phase, mut deviations) = ([[T::ZERO; K]; 2], [[T::ZERO; 2]; N]);
        for half in 0..2 {
            for k in 0..K {
                in_phase[half][k] = self.coordinate(transition, torques, half, k);
            }
            each_planet!(N, i => {
                deviations[i][half] = self.deviation(transition, i, half);
            });
        }
        Self { in_phase, deviations }
    }

    /// Adds the response to pseudo-forces, each with its weight function of time.
    #[inline]
    fn with<const M: usize>(mut self, terms: [(&Inputs<T>, &PseudoForce<T, N>); M]) -> Self {
        for (inputs, force) in terms {
            for half in 0..2 {
                for k in 0..K {
                    self.in_phase[half][k] += in_phase_response(inputs, force, 3 * half + k);
                }
            }
            for i in 0..N {
                for half in 0..2 {
                    self.deviations[i][half] += inputs.deviation[half] * force.deviations[i];
                }
            }
        }
        self
    }

    #[inline]
    fn move_to(&self, motion: &mut MotionInPlace<T, N>) {
        for (half, part) in [(0, &mut *motion.position), (1, &mut *motion.rate)] {
            let in_phase = &self.in_phase[half];
            each_planet!(N, i => {
                part.planets[i] = in_phase[0] + self.deviations[i][half];
            });
            part.gap = in_phase[1];
            part.wind_up = if K > 2 { in_phase[K - 1] } else { T::ZERO };
        }
    }
}

impl<T: Real, const N: usize> ModalPositions<T, N> {
    /// Adds the response to pseudo-forces, each with its weight function of time.
    #[inline]
    fn with<const M: usize>(mut self, terms: [(&Inputs<T>, &PseudoForce<T, N>); M]) -> MeshPositions<T, N> {
        for (inputs, force) in terms {
            for k in 0..2 {
                self.in_phase[k] += in_phase_response(inputs, force, k);
            }
            for i in 0..N {
                self.deviations[i] += inputs.deviation[0] * force.deviations[i];
            }
        }
        let [mean, gap] = self.in_phase;
        MeshPositions { planets: self.deviations.map(|deviation| mean + deviation), gap }
    }
}

/// Returns the in-phase response to the sums of the pseudo-force.
#[inline(always)]
fn in_phase_response<T: Real, const N: usize>(inputs: &Inputs<T>, force: &PseudoForce<T, N>, row: usize) -> T {
    let [sun_planet, ring_planet] = force.sums;
    entry(&inputs.in_phase, row, 0) * sun_planet + entry(&inputs.in_phase, row, 1) * ring_planet
}

#[inline(always)]
fn entry<T: Real, const R: usize, const C: usize>(block: &Block<T, R, C>, row: usize, column: usize) -> T {
    block.0.data.0[column][row]
}

fn total<T: Real, const N: usize>(values: &[T; N]) -> T {
    values.iter().fold(T::ZERO, |sum, value| sum + *value)
}
