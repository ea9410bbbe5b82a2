//! A tick of the sharp dead zone: by exponential while its contact set holds, otherwise in sub-steps, with a warm start: a
//! tick in sub-steps leaves contact laws and accelerations from which the next one continues, so that only the first of
//! several has to evaluate its start. Joints with light planets are stepped by `light`.

use crate::gears::contact::AppliedAcceleration;
use crate::gears::excitation::{MeshPhase, PhaseHarmonics, Phasor};
use crate::gears::fixed_contact_set::{FixedContactSet, Start};
use crate::gears::flow::{self, ExponentialTick};
use crate::gears::stages::SubstepState;
use crate::gears::state::Motion;
use crate::gears::substep;
use crate::gears::tables::Tables;
use crate::numbers::Real;
use parameters::DampingLaw;

/// What a tick leaves for the next one besides position and rate. It may be dropped at any time: the next tick then
/// evaluates its start again.
#[derive(Debug, Clone)]
pub struct WarmStart<T, const N: usize> {
    start: Start<T, N>,
    state: SubstepState<T, N>,
    /// Accelerations by the torques of the last tick, in units of a stage.
    applied: AppliedAcceleration<T>,
    /// Laws, accelerations and torques are those of the end of the last tick.
    valid: bool,
}

impl<T: Real, const N: usize> WarmStart<T, N> {
    /// Nothing to continue from.
    pub const EMPTY: Self =
        Self { start: Start::EMPTY, state: SubstepState::EMPTY, applied: AppliedAcceleration::NONE, valid: false };

    /// To be called when the motion is changed from outside.
    pub fn invalidate(&mut self) {
        self.valid = false;
    }

    /// One tick. Ripple of one harmonic has a copy of its own, which skips the test for more at every mesh.
    pub fn tick<const OVERTONES: usize>(
        &mut self,
        tables: &Tables<T, N>,
        applied: &AppliedAcceleration<T>,
        phase: &MeshPhase<T>,
        motion: &Motion<T, N>,
    ) -> Motion<T, N> {
        let stage = &tables.stage;
        let contact_law = if tables.damping_law == DampingLaw::Contact { T::ONE } else { T::ZERO };
        let fixed = FixedContactSet::<T, N, OVERTONES> {
            tables,
            applied: applied.times(stage.square_sixth),
            contact_law,
            paper_law: T::ONE - contact_law,
        };
        let Self { start, state, .. } = self;
        state.set_motion(motion, tables.substep);
        if self.valid && start.is_open() {
            state.shift_accelerations(&fixed.applied.minus(&self.applied), &stage.mobility);
        } else {
            self.valid = false;
            let rate = tables.substep * phase.rate;
            fixed.start(&PhaseHarmonics::new(Phasor::at(phase.start), rate, tables.excitation.harmonics), state, start);
            let held = if tables.mobility.wind_up > T::ZERO {
                flow::tick::<T, N, 3, OVERTONES>(&fixed, applied, phase, start, state, motion)
            } else {
                flow::tick::<T, N, 2, OVERTONES>(&fixed, applied, phase, start, state, motion)
            };
            match held {
                ExponentialTick::Held(end) => return end,
                ExponentialTick::OpenedLate(end) => return flow::corrected(&fixed, &mut start.laws, phase, &end),
                ExponentialTick::Refused => {}
            }
            substep::begin(&fixed, start, phase, state);
        }
        substep::advance(&fixed, phase, &mut start.laws, state);
        (self.applied, self.valid) = (fixed.applied, true);
        state.motion(tables.substep, stage.rate, motion)
    }
}
