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
    /// Variation of the half-gap for a radian beforehand, over it [-]: 15 % of it once a turn change by that at most, and so much as two
    /// rests on either flank can say.
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
            *squares += beyond.over(half_gap * half_gap);
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::observer::design::{design_observer, observer_settings};

    const HALF_GAP: f32 = 80e-6;

    fn counts() -> CountTable<f32> {
        let q1 = joint_file::read(joint_file::preset("q1").expect("a preset")).expect("a joint");
        design_observer(&q1.parameters, &observer_settings(&q1.surroundings)).expect("tables").counts
    }

    /// The place of a link [2^-32 turns] that has turned by an angle [rad].
    fn phase(angle: f64) -> u32 {
        (angle / core::f64::consts::TAU * 4_294_967_296.0) as i64 as u32
    }

    /// Standard deviation of the half-gap over it, at an angle.
    fn deviation(places: &mut Places<f32>, table: &CountTable<f32>, angle: f64) -> f32 {
        places.go_to(phase(angle));
        places.variance(table, HALF_GAP).square_root() / HALF_GAP
    }

    /// Both flanks at an angle, each off by a part of the half-gap.
    fn see(places: &mut Places<f32>, table: &CountTable<f32>, angle: f64, off: f32) {
        places.go_to(phase(angle));
        for flank in [Flank::Drive, Flank::Back] {
            places.take(table, flank, [(off * HALF_GAP).powi(2), 0.0], HALF_GAP, true);
        }
    }

    #[test]
    fn nothing_is_added_where_both_flanks_were_seen() {
        let (table, mut places) = (counts(), Places::new());
        assert_eq!(
            deviation(&mut places, &table, 1.0),
            0.0,
            "nothing was seen yet: the half-gap itself says that it is not known"
        );
        see(&mut places, &table, -0.1, 0.0);
        assert_eq!(deviation(&mut places, &table, -0.1), 0.0);
    }

    #[test]
    fn what_is_further_away_is_known_less() {
        let (table, mut places) = (counts(), Places::new());
        see(&mut places, &table, -0.1, 0.0);
        let [near, far] = [0.2, 0.5].map(|angle| deviation(&mut places, &table, angle));
        assert!((near - 0.3 * 0.25).abs() < 1e-3 && (far - 0.6 * 0.25).abs() < 1e-3, "{near} {far}");
    }

    #[test]
    fn even_gears_are_trusted_and_worn_ones_are_not() {
        let table = counts();
        let [even, worn] = [0.0, 0.3].map(|off| {
            let mut places = Places::new();
            (0..8).for_each(|pass| see(&mut places, &table, if pass % 2 == 0 { 0.0 } else { 0.8 }, off));
            deviation(&mut places, &table, 0.4)
        });
        assert!(even < 0.04 && worn > 0.12, "{even} {worn}");
    }
}
