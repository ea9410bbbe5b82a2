//! What the deflection between motor and link depends on: teeth that touch, offset, skew and the encoders' errors once
//! and twice a turn. The learner estimates how much of each there is.

use crate::gears::{Flank, sign};
use crate::numbers::Real;
use crate::numbers::phase::sine_cosine;

/// Parameters learnt when the encoders count as free of harmonics: half-gap, offset, compliance, skew, and sine and cosine
/// of the gears' transmission error.
pub const PLAIN: usize = 6;

/// Parameters learnt with the error maps: the plain ones, then sine and cosine once and twice a turn of the motor, once
/// and twice a turn of the output.
pub const MAPPED: usize = PLAIN + 8;

/// What the deflection depends on, one for each parameter.
pub type Regressors<T, const P: usize> = [T; P];

/// Where the half-gap stands among the parameters.
pub const HALF_GAP: usize = 0;
/// The offset.
pub const OFFSET: usize = 1;
/// The compliance.
pub const COMPLIANCE: usize = 2;
/// The skew.
pub const SKEW: usize = 3;
/// Sine and cosine of the transmission error.
pub const ERROR: usize = 4;
/// Entries that an encoder has in the map.
pub const MAP: usize = 4;

/// Regressors of teeth that do not touch; phases in 2^-32 turns. Without an output encoder its own are zero.
pub fn free<T: Real, const P: usize>(link_speed: T, motor: u32, output: Option<u32>) -> Regressors<T, P> {
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

/// What touching teeth add: flank, force, sine and cosine of the mesh phase.
#[derive(Debug, Clone, Copy)]
pub struct Touch<T: Real> {
    /// The flank, if it is known.
    pub flank: Option<Flank>,
    /// Mesh force [N].
    pub force: T,
    /// Sine and cosine of the mesh phase.
    pub mesh: [T; 2],
}

impl<T: Real> Touch<T> {
    /// Teeth that do not touch.
    pub const NONE: Self = Self { flank: None, force: T::ZERO, mesh: [T::ZERO; 2] };

    /// Regressors with this added.
    pub fn on<const P: usize>(&self, free: &Regressors<T, P>) -> Regressors<T, P> {
        let mut regressors = *free;
        if let [half_gap, _, compliance, _, sine, cosine, ..] = regressors.as_mut_slice() {
            *half_gap = sign(self.flank);
            *compliance = self.force;
            [*sine, *cosine] = self.mesh;
        }
        regressors
    }
}
