//! Variation of the half-gap around the turn (O20): worn gears vary by 30 %. A link that turns while one flank carries
//! does not reveal this variation, which is attributed to encoder errors and offset.
//!
//! Symbols: c half-gap, D angle of the link since a flank was last seen, e^2 the squared innovation of the first rest
//! after the return to that flank, less its variance.
//!
//! ```text
//! v^2 = (V0^2 N0 + sum of (e/c)^2) / (N0 + sum of D^2)       variation of the half-gap for a radian (1)
//! var = v^2 c^2 D^2                                           D to the flank that is further away   (2)
//! ```

use crate::gears::Flank;
use crate::numbers::Real;
use crate::observer::tables::CountTable;

/// Place of the last rest on each flank, and the observed variation of the half-gap.
#[derive(Debug, Clone, Copy)]
pub struct Places<T: Real> {
    /// Present place of the link in its turn [2^-32 turns].
    now: u32,
    /// Place of the last accepted rest on the drive flank and on the back flank [2^-32 turns].
    seen: [Option<u32>; 2],
    /// Flank of the last rest.
    last: Option<Flank>,
    /// Sums of (1): squared relative variations [-], and squared angles [rad^2].
    sums: [T; 2],
}

impl<T: Real> Places<T> {
    /// Initial relative variation of the half-gap per radian [-]: the steepest change of a variation of 25 % once per
    /// turn. Tuned on `hil/real-any.toml`.
    const VARIATION: T = T::QUARTER;

    /// Weight of the initial variation [rad^2].
    const WEIGHT: T = T::QUARTER;

    /// Largest weight of the sums, which are halved beyond, as gears wear [rad^2].
    const MOST: T = T::SIX;

    /// Least angle after which a rest shows the variation [rad].
    const ELSEWHERE: T = T::QUARTER;

    /// Angle beyond which the variance grows no further [rad].
    const FURTHEST: T = T::TWO;

    pub fn new() -> Self {
        Self {
            now: 0,
            seen: [None; 2],
            last: None,
            sums: [Self::VARIATION * Self::VARIATION * Self::WEIGHT, Self::WEIGHT],
        }
    }

    /// Sets the link's place in its turn [2^-32 turns].
    pub fn go_to(&mut self, phase: u32) {
        self.now = phase;
    }

    /// Updates the variation with a rest on a flank: its squared deviation with the variance expected [m^2], the
    /// half-gap [m], and whether the rest was accepted.
    pub fn take(
        &mut self,
        table: &CountTable<T>,
        flank: Flank,
        [square, variance]: [T; 2],
        half_gap: T,
        belongs: bool,
    ) {
        let came_back = self.last != Some(flank);
        self.last = Some(flank);
        let angle = self.angle(table, flank);
        if came_back && angle > Self::ELSEWHERE && half_gap > T::ZERO {
            let beyond = if square > variance { square - variance } else { T::ZERO };
            let [squares, angles] = &mut self.sums;
            let variation = beyond.over(half_gap * half_gap);
            *squares += if variation.is_finite() { variation } else { T::ONE };
            *angles += angle * angle;
            if *angles > Self::MOST {
                *squares *= T::HALF;
                *angles *= T::HALF;
            }
        }
        if belongs {
            let [drive, back] = &mut self.seen;
            *(if flank == Flank::Drive { drive } else { back }) = Some(self.now);
        }
    }

    /// Variance of the half-gap at this place by its variation around the turn (2) [m^2].
    pub fn variance(&self, table: &CountTable<T>, half_gap: T) -> T {
        let [drive, back] = [Flank::Drive, Flank::Back].map(|flank| self.angle(table, flank));
        let angle = if drive > back { drive } else { back };
        let [squares, angles] = self.sums;
        let deviation = half_gap * angle;
        squares.over(angles) * deviation * deviation
    }

    /// Angle of the link since a flank was last seen; 0 for a flank never seen [rad].
    fn angle(&self, table: &CountTable<T>, flank: Flank) -> T {
        let [drive, back] = self.seen;
        let Some(seen) = (if flank == Flank::Drive { drive } else { back }) else { return T::ZERO };
        let apart = T::from_i32(self.now.wrapping_sub(seen) as i32).abs() * T::PHASE_UNIT;
        let angle = apart.over(table.output.turns);
        if angle < Self::FURTHEST { angle } else { Self::FURTHEST }
    }
}
