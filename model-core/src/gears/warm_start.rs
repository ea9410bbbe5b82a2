//! Tick of a joint with sharp dead zone and without Verlet sub-steps (for these see `light`): an exponential tick while the
//! contact set holds, otherwise sub-steps. A tick in sub-steps stores contact laws and accelerations, from which the next
//! tick in sub-steps starts (warm start); without these a tick evaluates its start (cold start).

use crate::gears::contact::{AppliedAcceleration, Law, Laws};
use crate::gears::excitation::{MeshPhase, PhaseHarmonics, Phasor};
use crate::gears::fixed_contact_set::FixedContactSet;
use crate::gears::flow;
use crate::gears::stages::SubstepState;
use crate::gears::state::MotionInPlace;
use crate::gears::substep;
use crate::gears::tables::{Mobility, Tables};
use crate::numbers::Real;
use parameters::DampingLaw;

/// Quantities at the start of a tick known from the last tick.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Known {
    /// No quantity.
    Nothing,
    /// Laws of the meshes.
    Laws,
    /// Laws and accelerations, under the torques of the last tick.
    Accelerations,
}

/// Data that a tick stores for the next tick in addition to position and rate. Optional: without it the next tick
/// evaluates its start.
#[derive(Debug, Clone)]
pub struct WarmStart<T, const N: usize> {
    laws: Laws<T, N>,
    state: SubstepState<T, N>,
    /// Accelerations by the torques of the last tick, in stage units.
    applied: AppliedAcceleration<T>,
    known: Known,
}

impl<T: Real, const N: usize> WarmStart<T, N> {
    /// Warm start without any known quantity.
    pub const EMPTY: Self = Self {
        laws: [[Law::ZERO; N]; 2],
        state: SubstepState::EMPTY,
        applied: AppliedAcceleration::NONE,
        known: Known::Nothing,
    };

    /// Discards laws and accelerations; to be called when the motion is changed from outside.
    pub fn invalidate(&mut self) {
        self.known = Known::Nothing;
    }

    /// Advances the motion in place by one tick. `OVERTONES` is 0 for ripple of one harmonic: this instance omits the test for
    /// overtones at every mesh.
    #[inline(always)]
    pub fn tick<const OVERTONES: usize>(
        &mut self,
        tables: &Tables<T, N>,
        applied: &AppliedAcceleration<T>,
        phase: &MeshPhase<T>,
        mut motion: MotionInPlace<T, N>,
    ) {
        let stage = &tables.stage;
        let contact_law = if tables.damping_law == DampingLaw::Contact { T::ONE } else { T::ZERO };
        let fixed = FixedContactSet::<T, N, OVERTONES> {
            tables,
            applied: applied.times(stage.square_sixth),
            contact_law,
            paper_law: T::ONE - contact_law,
        };
        let Self { laws, state, known, .. } = self;
        if *known == Known::Accelerations {
            state.set_rates(motion.rate, tables.substep);
        } else {
            state.set_motion(&motion, tables.substep);
        }
        let slow = phase.advance.abs() < tables.flow.longest_advance;
        if *known == Known::Accelerations && (!slow || fixed.is_open(laws)) {
            shift(state, &fixed.applied.minus(&self.applied), &stage.mobility);
        } else {
            let rate = tables.substep * phase.rate;
            let harmonics_now = PhaseHarmonics::new(Phasor::at(phase.start), rate, tables.excitation.harmonics);
            if *known == Known::Nothing {
                fixed.find_laws(&harmonics_now, state, laws);
            }
            let start =
                if slow && !fixed.is_open(laws) { flow::start(&fixed, &harmonics_now, laws, state) } else { None };
            if let Some(start) = start {
                let held = if tables.mobility.wind_up > T::ZERO {
                    flow::tick::<T, N, 3, OVERTONES>(&fixed, applied, phase, laws, &start, &mut motion)
                } else {
                    flow::tick::<T, N, 2, OVERTONES>(&fixed, applied, phase, laws, &start, &mut motion)
                };
                if held {
                    *known = Known::Laws;
                    return;
                }
            }
            if *known == Known::Accelerations {
                shift(state, &fixed.applied.minus(&self.applied), &stage.mobility);
            } else {
                if *known == Known::Laws {
                    fixed.find_laws(&harmonics_now, state, laws);
                }
                substep::begin(&fixed, phase, &harmonics_now, laws, state);
            }
        }
        substep::advance(&fixed, phase, laws, state);
        (self.applied, *known) = (fixed.applied, Known::Accelerations);
        state.move_to(tables.substep, stage.rate, motion);
    }
}

/// Adds a change of torque to the stored accelerations. Controllers are often slower than ticks, so the change is often
/// zero.
#[inline(always)]
fn shift<T: Real, const N: usize>(
    state: &mut SubstepState<T, N>,
    change: &AppliedAcceleration<T>,
    mobility: &Mobility<T>,
) {
    if *change != AppliedAcceleration::NONE {
        state.shift_accelerations(change, mobility);
    }
}
