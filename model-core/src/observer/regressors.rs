//! What the way between motor and link depends on: teeth that touch, offset, skew and the encoders' errors once and twice
//! a turn. Their sizes are the learner's.

use crate::numbers::Real;
use crate::numbers::phase::sine_cosine;

/// Parameters learnt when the encoders count as free of harmonics: half-gap, offset, compliance, skew, and sine and cosine
/// of the gears' transmission error.
pub const PLAIN: usize = 6;

/// Parameters learnt with the error maps: the plain ones, then sine and cosine once and twice a turn of the motor, once
/// and twice a turn of the output.
pub const MAPPED: usize = PLAIN + 8;

/// What the way depends on, one for each parameter.
pub(super) type Regressors<T, const P: usize> = [T; P];

/// Where the half-gap stands among the parameters.
pub(super) const HALF_GAP: usize = 0;
/// The offset.
pub(super) const OFFSET: usize = 1;
/// The compliance.
pub(super) const COMPLIANCE: usize = 2;
/// The skew.
pub(super) const SKEW: usize = 3;
/// Sine and cosine of the transmission error.
pub(super) const ERROR: usize = 4;
/// Entries that an encoder has in the map.
pub(super) const MAP: usize = 4;

/// Regressors of teeth that do not touch; phases in 2^-32 turns. Without an output encoder its own are zero.
pub(super) fn free<T: Real, const P: usize>(link_speed: T, motor: u32, output: Option<u32>) -> Regressors<T, P> {
    let mut regressors = [T::ZERO; P];
    if let [_, offset, _, skew, ..] = regressors.as_mut_slice() {
        *offset = T::ONE;
        *skew = link_speed;
    }
    if P == MAPPED {
        let (places, _) = regressors.get_mut(PLAIN..).unwrap_or_default().as_chunks_mut::<MAP>();
        for (phase, places) in [Some(motor), output].into_iter().zip(places) {
            let Some(phase) = phase else { continue };
            let (sine, cosine) = sine_cosine::<T>(phase);
            *places = [sine, cosine, T::TWO * sine * cosine, T::ONE - T::TWO * sine * sine];
        }
    }
    regressors
}

/// What touching teeth add: side, force, sine and cosine of the mesh phase.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Touch<T: Real> {
    /// 1 on the drive side, -1 on the back side.
    pub side: T,
    /// Mesh force [N].
    pub force: T,
    /// Sine and cosine of the mesh phase.
    pub mesh: [T; 2],
}

impl<T: Real> Touch<T> {
    /// Regressors with this added.
    pub fn on<const P: usize>(&self, free: &Regressors<T, P>) -> Regressors<T, P> {
        let mut regressors = *free;
        if let [half_gap, _, compliance, _, sine, cosine, ..] = regressors.as_mut_slice() {
            *half_gap = self.side;
            *compliance = self.force;
            [*sine, *cosine] = self.mesh;
        }
        regressors
    }
}
