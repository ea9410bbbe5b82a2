//! Angles over any number of turns without rounding: whole turns and fraction in one integer.

use core::f32::consts::TAU;

/// Fraction bits of an angle.
const FRACTION_BITS: u32 = 32;

/// Angle [turns] as a whole number of 2^-32 turns. Covers 2^31 turns to either side; beyond, it stays at the end.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct Turns(i64);

impl Turns {
    /// Angle zero.
    pub const ZERO: Self = Self(0);

    /// Angle of a number of 2^-32 turns.
    pub const fn from_bits(bits: i64) -> Self {
        Self(bits)
    }

    /// Number of 2^-32 turns.
    pub const fn to_bits(self) -> i64 {
        self.0
    }

    /// Nearest angle to a number of turns; NaN gives zero, numbers out of range the nearest end.
    ///
    /// ```
    /// use drives::Turns;
    /// assert_eq!(Turns::new(-1.25).to_f32(), -1.25);
    /// assert_eq!(Turns::new(f32::NAN), Turns::ZERO);
    /// ```
    pub fn new(turns: f32) -> Self {
        // A power of two changes the exponent only, so the product is exact; the cast saturates.
        Self((turns * (1u64 << FRACTION_BITS) as f32) as i64)
    }

    /// Angle of `counts` of an encoder with `counts_per_turn`, rounded down; zero for an encoder without counts.
    pub fn from_counts(counts: i64, counts_per_turn: u32) -> Self {
        let per_turn = i64::from(counts_per_turn);
        let (Some(whole), Some(rest)) = (counts.checked_div_euclid(per_turn), counts.checked_rem_euclid(per_turn))
        else {
            return Self::ZERO;
        };
        // The rest is below 2^32, so the shifted rest fits an unsigned integer.
        let fraction = ((rest.cast_unsigned()) << FRACTION_BITS).checked_div(per_turn.cast_unsigned()).unwrap_or(0);
        Self(whole.saturating_mul(1 << FRACTION_BITS).saturating_add(fraction.cast_signed()))
    }

    /// Counts of an encoder with `counts_per_turn` at this angle, rounded down.
    pub fn to_counts(self, counts_per_turn: u32) -> i64 {
        let (whole, fraction) = (self.0 >> FRACTION_BITS, self.0.cast_unsigned() & u64::from(u32::MAX));
        whole * i64::from(counts_per_turn) + ((fraction * u64::from(counts_per_turn)) >> FRACTION_BITS).cast_signed()
    }

    /// Number of turns, rounded to f32.
    pub fn to_f32(self) -> f32 {
        self.0 as f32 / (1u64 << FRACTION_BITS) as f32
    }

    /// Angle [rad], rounded to f32.
    pub fn to_rad(self) -> f32 {
        TAU * self.to_f32()
    }

    /// Nearest angle to a number of radians.
    pub fn from_rad(angle: f32) -> Self {
        Self::new(angle / TAU)
    }

    /// Sum with another angle.
    pub fn plus(self, other: Self) -> Self {
        Self(self.0.saturating_add(other.0))
    }

    /// Difference to another angle.
    pub fn minus(self, other: Self) -> Self {
        Self(self.0.saturating_sub(other.0))
    }

    /// Angle of the other shaft of a gear: this angle times `ratio`.
    pub fn times(self, ratio: Ratio) -> Self {
        Self(scaled(self.0, ratio.numerator, ratio.denominator))
    }

    /// Angle of the other shaft of a gear: this angle over `ratio`.
    pub fn over(self, ratio: Ratio) -> Self {
        Self(scaled(self.0, ratio.denominator, ratio.numerator))
    }
}

/// `value * numerator / denominator`, rounded down, at the end of the range if it is out of range.
fn scaled(value: i64, numerator: u16, denominator: u16) -> i64 {
    let (numerator, denominator) = (i64::from(numerator), i64::from(denominator));
    let (Some(quotient), Some(rest)) = (value.checked_div_euclid(denominator), value.checked_rem_euclid(denominator))
    else {
        return 0;
    };
    // Both factors of the second product are below 2^16.
    quotient.saturating_mul(numerator).saturating_add((rest * numerator).checked_div(denominator).unwrap_or(0))
}

/// Reduction of a gear as a fraction of two whole numbers, so that an angle over many turns does not drift.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Ratio {
    numerator: u16,
    denominator: u16,
}

impl Ratio {
    /// Ratio 1.
    pub const ONE: Self = Self { numerator: 1, denominator: 1 };

    /// Fraction next to a positive number by its continued fraction; tooth counts come back exactly. Numbers below
    /// 1/65535 or above 65535 give the nearest end; NaN and negative numbers give 1.
    ///
    /// ```
    /// use drives::turns::Ratio;
    /// assert_eq!(Ratio::new(6.0).to_f32(), 6.0);
    /// assert_eq!(Ratio::new(87.0 / 17.0).parts(), (87, 17));
    /// ```
    pub fn new(ratio: f64) -> Self {
        if ratio.is_nan() || ratio <= 0.0 {
            return Self::ONE;
        }
        let clamped = ratio.clamp(1.0 / f64::from(u16::MAX), f64::from(u16::MAX));
        let (mut above, mut below) = ((1_u64, 0_u64), (0_u64, 1_u64));
        let (mut rest, mut best) = (clamped, (1_u64, 1_u64));
        for _ in 0..16 {
            let whole = rest as u64;
            let next = |(last, before): (u64, u64)| whole.saturating_mul(last).saturating_add(before);
            let convergent = (next(above), next(below));
            if convergent.0 > u64::from(u16::MAX) || convergent.1 > u64::from(u16::MAX) {
                break;
            }
            if convergent.0 > 0 {
                best = convergent;
            }
            (above, below) = ((convergent.0, above.0), (convergent.1, below.0));
            let fraction = rest - whole as f64;
            // A smaller rest is the rounding of the number itself.
            if fraction < 1e-7 {
                break;
            }
            rest = 1.0 / fraction;
        }
        Self { numerator: best.0 as u16, denominator: best.1 as u16 }
    }

    /// Fraction of two positive numbers as they are; a zero gives 1.
    pub const fn of(numerator: u16, denominator: u16) -> Self {
        if numerator == 0 || denominator == 0 { Self::ONE } else { Self { numerator, denominator } }
    }

    /// Numerator and denominator.
    pub fn parts(self) -> (u16, u16) {
        (self.numerator, self.denominator)
    }

    /// Turns of the motor in a turn of the output [-].
    pub fn to_f32(self) -> f32 {
        f32::from(self.numerator) / f32::from(self.denominator)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn counts_round_trip() {
        for counts_per_turn in [1, 4096, 4000, 1 << 17, u32::MAX] {
            for counts in [-1_000_003_i64, -1, 0, 1, 4095, 77_777_777] {
                let counts = counts.min(1 << 40);
                let there = Turns::from_counts(counts, counts_per_turn);
                let back = there.to_counts(counts_per_turn);
                assert!((counts - 1..=counts).contains(&back), "{counts_per_turn}: {counts} {back}");
            }
        }
        assert_eq!(Turns::from_counts(5, 0), Turns::ZERO);
    }

    #[test]
    fn gear_does_not_drift() {
        let ratio = Ratio::new(87.0 / 17.0);
        let motor = Turns::new(87_000.0);
        assert_eq!(motor.over(ratio).to_f32(), 17_000.0);
        assert_eq!(motor.over(ratio).times(ratio), motor);
    }

    proptest! {
        #[test]
        fn no_angle_panics(bits: i64, other: i64, ratio: f64, counts: u32, turns: f32) {
            let (a, b, ratio) = (Turns::from_bits(bits), Turns::from_bits(other), Ratio::new(ratio));
            let _ = (a.plus(b), a.minus(b), a.over(ratio), a.times(ratio), a.to_counts(counts), Turns::new(turns));
            let _ = Turns::from_counts(bits, counts);
        }

        #[test]
        fn ratio_is_close(value in 0.01_f64..1000.0) {
            let found = f64::from(Ratio::new(value).to_f32());
            prop_assert!((found / value - 1.0).abs() < 1e-4, "{} {}", value, found);
        }
    }
}
