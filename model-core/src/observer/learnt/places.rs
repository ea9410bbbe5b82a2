//! How much the half-gap may be another one than where it was learnt. Gears vary around the turn, worn ones by 30 %, and a link that goes
//! on while one flank carries shows nothing of that: what it sees it puts down to encoder errors and offset.
//!
//! Symbols: c half-gap, D angle of the link from where a flank was seen last, e what the first rest on that flank is off by when the teeth
//! come back to it, less what noise and ignorance make of that.
//!
//! ```text
//! v^2 = (V0^2 N0 + sum of (e/c)^2) / (N0 + sum of D^2)       variation of the half-gap for a radian (1)
//! var = v^2 c^2 D^2                                           D to the flank that is further away   (2)
//! ```

use crate::gears::Flank;
use crate::numbers::Real;
use crate::observer::tables::CountTable;

/// Where each flank was seen last, and how much the half-gap has varied so far.
#[derive(Debug, Clone, Copy)]
pub struct Places<T: Real> {
    /// The link's place in its turn now [2^-32 turns].
    now: u32,
    /// The same at the last rest on the drive flank and on the back flank.
    seen: [Option<u32>; 2],
    /// The flank of the last rest.
    last: Option<Flank>,
    /// Sums of (1): squares of variations [-], and of angles [rad^2].
    sums: [T; 2],
}

impl<T: Real> Places<T> {
    /// Variation of the half-gap for a radian before any flank was seen again, over the half-gap [-]. A variation of 25 % once a turn changes by
    /// that at its steepest. Tuned on `hil/real-any.toml`.
    const VARIATION: T = T::QUARTER;

    /// Weight of that [rad^2].
    const WEIGHT: T = T::QUARTER;

    /// Weight up to which is summed [rad^2]: gears wear.
    const MOST: T = T::SIX;

    /// Angle from which on a rest tells of another place [rad].
    const ELSEWHERE: T = T::QUARTER;

    /// An angle beyond which places are alike far away [rad].
    const FURTHEST: T = T::TWO;

    pub fn new() -> Self {
        Self {
            now: 0,
            seen: [None; 2],
            last: None,
            sums: [Self::VARIATION * Self::VARIATION * Self::WEIGHT, Self::WEIGHT],
        }
    }

    /// The link's place in its turn [2^-32 turns].
    pub fn go_to(&mut self, phase: u32) {
        self.now = phase;
    }

    /// Takes a rest on a flank, the square of what it is off by with its variance [m^2], the half-gap [m], and whether it belongs to what was
    /// learnt.
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

    /// Variance of the half-gap here by how much it varies around the turn [m^2].
    pub fn variance(&self, table: &CountTable<T>, half_gap: T) -> T {
        let [drive, back] = [Flank::Drive, Flank::Back].map(|flank| self.angle(table, flank));
        let angle = if drive > back { drive } else { back };
        let [squares, angles] = self.sums;
        let deviation = half_gap * angle;
        squares.over(angles) * deviation * deviation
    }

    /// Angle of the link from where a flank was seen last; none where it was not [rad].
    fn angle(&self, table: &CountTable<T>, flank: Flank) -> T {
        let [drive, back] = self.seen;
        let Some(seen) = (if flank == Flank::Drive { drive } else { back }) else { return T::ZERO };
        let apart = T::from_i32(self.now.wrapping_sub(seen) as i32).abs() * T::PHASE_UNIT;
        let angle = apart.over(table.output.turns);
        if angle < Self::FURTHEST { angle } else { Self::FURTHEST }
    }
}
