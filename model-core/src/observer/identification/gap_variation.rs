//! Variation of the half-gap around the turn, v_c and D_l of (O20): worn gears vary by 30 %. A link that turns while
//! one flank carries does not reveal this variation, which is attributed to encoder errors and offset.
//!
//! Symbols: c half-gap, D angle of the link since the last dwell on a flank, e^2 the squared innovation of the first
//! dwell after the return to that flank, less its variance.
//!
//! ```text
//! v^2 = (V0^2 N0 + sum of (e/c)^2) / (N0 + sum of D^2)       variation of the half-gap for a radian (1)
//! var = v^2 c^2 D^2                                           D to the flank that is further away   (2)
//! ```

use super::thresholds::GapVariationThresholds;
use crate::gears::Flank;
use crate::numbers::Real;
use crate::numbers::state_words::state_words;
use crate::observer::tables::CountTable;

/// Place of the last dwell on each flank, and the observed variation of the half-gap.
#[derive(Debug, Clone, Copy)]
pub struct GapVariation<T: Real> {
    /// Present place of the link in its turn [2^-32 turns].
    position: u32,
    /// Place of the last accepted dwell on the drive flank and on the back flank [2^-32 turns].
    dwell_positions: [Option<u32>; 2],
    /// Flank of the last dwell.
    last_flank: Option<Flank>,
    /// Sums of (1): squared relative variations [-], and squared angles [rad^2].
    sums: [T; 2],
}
state_words! { struct GapVariation<T> { position, dwell_positions, last_flank, sums } }

impl<T: Real> GapVariation<T> {
    const LIMITS: GapVariationThresholds<T> = GapVariationThresholds::TUNED;

    pub fn new() -> Self {
        Self {
            position: 0,
            dwell_positions: [None; 2],
            last_flank: None,
            sums: [
                Self::LIMITS.initial_variation * Self::LIMITS.initial_variation * Self::LIMITS.initial_weight,
                Self::LIMITS.initial_weight,
            ],
        }
    }

    /// Sets the link's place in its turn [2^-32 turns].
    pub fn set_position(&mut self, phase: u32) {
        self.position = phase;
    }

    /// Updates the variation with a dwell on a flank: its squared deviation with the variance expected [m^2], the
    /// half-gap [m], and whether the dwell was accepted.
    pub fn add_dwell(
        &mut self,
        table: &CountTable<T>,
        flank: Flank,
        [square, variance]: [T; 2],
        half_gap: T,
        is_accepted: bool,
    ) {
        let flank_changed = self.last_flank != Some(flank);
        self.last_flank = Some(flank);
        let angle = self.angle(table, flank);
        if flank_changed && angle > Self::LIMITS.min_angle && half_gap > T::ZERO {
            let excess = if square > variance { square - variance } else { T::ZERO };
            let [squares, angles] = &mut self.sums;
            let variation = excess / (half_gap * half_gap);
            *squares += if variation.is_finite() { variation } else { T::ONE };
            *angles += angle * angle;
            if *angles > Self::LIMITS.max_weight {
                *squares *= T::HALF;
                *angles *= T::HALF;
            }
        }
        if is_accepted {
            let [drive, back] = &mut self.dwell_positions;
            *(if flank == Flank::Drive { drive } else { back }) = Some(self.position);
        }
    }

    /// Variance of the half-gap at this place by its variation around the turn (2) [m^2].
    pub fn variance(&self, table: &CountTable<T>, half_gap: T) -> T {
        let [drive, back] = [Flank::Drive, Flank::Back].map(|flank| self.angle(table, flank));
        let angle = if drive > back { drive } else { back };
        let [squares, angles] = self.sums;
        let deviation = half_gap * angle;
        (squares / angles) * deviation * deviation
    }

    /// Angle of the link since the last dwell on a flank; 0 without a dwell [rad].
    fn angle(&self, table: &CountTable<T>, flank: Flank) -> T {
        let [drive, back] = self.dwell_positions;
        let Some(dwell_positions) = (if flank == Flank::Drive { drive } else { back }) else { return T::ZERO };
        let apart = T::from_i32(self.position.wrapping_sub(dwell_positions) as i32).abs() * T::PHASE_UNIT;
        let angle = apart / table.output.turns;
        if angle < Self::LIMITS.max_angle { angle } else { Self::LIMITS.max_angle }
    }
}
