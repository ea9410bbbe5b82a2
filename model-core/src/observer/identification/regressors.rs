//! Regressors h of the deflection. The least squares estimate their coefficients.
//!
//! ```text
//! (O11) d = side c + o + κ F + s w_l + e_1 sin(mesh) + e_2 cos(mesh) + maps
//!       maps = m_1 sin + m_2 cos + m_3 sin twice + m_4 cos twice per turn, each for motor and output
//! ```
//!
//! Indices: c = `HALF_GAP`, o = `OFFSET`, κ = `COMPLIANCE`, s = `SKEW`, e_1, e_2 = `TRANSMISSION_ERROR`, maps from
//! `PLAIN`.

use crate::gears::{Flank, sign};
use crate::numbers::Real;
use crate::numbers::phase::sine_cosine;
use crate::numbers::state_words::state_words;

/// Number of parameters without error maps: half-gap, offset, compliance, skew, and sine and cosine of the transmission
/// error.
pub const PLAIN: usize = 6;

/// Number of parameters with error maps: those of `PLAIN`, then sine and cosine once and twice per turn of the motor,
/// then of the output.
pub const MAPPED: usize = PLAIN + 8;

/// Regressors, one for each parameter.
pub type Regressors<T, const P: usize> = [T; P];

/// Index of the half-gap.
pub const HALF_GAP: usize = 0;
/// Index of the offset.
pub const OFFSET: usize = 1;
/// Index of the compliance.
pub const COMPLIANCE: usize = 2;
/// Index of the skew.
pub const SKEW: usize = 3;
/// Index of the transmission error's sine; the cosine follows.
pub const TRANSMISSION_ERROR: usize = 4;
/// Parameters of an encoder's error map.
pub const MAP_PARAMETERS: usize = 4;

/// Regressors of an open gap; phases in 2^-32 turns. Without an output encoder the regressors of its map are zero.
pub fn open_gap<T: Real, const P: usize>(link_speed: T, motor: u32, output: Option<u32>) -> Regressors<T, P> {
    let mut regressors = [T::ZERO; P];
    if let [_, offset, _, skew, ..] = regressors.as_mut_slice() {
        *offset = T::ONE;
        *skew = link_speed;
    }
    if P == MAPPED {
        let (harmonics, _) = regressors.get_mut(PLAIN..).unwrap_or_default().as_chunks_mut::<MAP_PARAMETERS>();
        for (phase, harmonics) in [Some(motor), output].into_iter().zip(harmonics) {
            let Some(phase) = phase else { continue };
            let (sine, cosine) = sine_cosine::<T>(phase);
            *harmonics = [sine, cosine, T::TWO * sine * cosine, T::ONE - T::TWO * sine * sine];
        }
    }
    regressors
}

/// Regressors of touching teeth: flank, force, sine and cosine of the mesh phase.
#[derive(Debug, Clone, Copy)]
pub struct ContactSample<T: Real> {
    /// Flank, if known.
    pub flank: Option<Flank>,
    /// Mesh force [N].
    pub force: T,
    /// Sine and cosine of the mesh phase.
    pub mesh: [T; 2],
}
state_words! { struct ContactSample<T> { flank, force, mesh } }

impl<T: Real> ContactSample<T> {
    /// Open gap.
    pub const OPEN: Self = Self { flank: None, force: T::ZERO, mesh: [T::ZERO; 2] };

    /// Adds touching teeth to the regressors of an open gap.
    pub fn add_to<const P: usize>(&self, open_gap: &Regressors<T, P>) -> Regressors<T, P> {
        let mut regressors = *open_gap;
        if let [half_gap, _, compliance, _, sine, cosine, ..] = regressors.as_mut_slice() {
            *half_gap = sign(self.flank);
            *compliance = self.force;
            [*sine, *cosine] = self.mesh;
        }
        regressors
    }
}
