//! Consistency of rests with the estimated parameters: a rest is accepted or rejected; repeated rejections reset the
//! half-gap, as teeth wear, and finally all parameters.

use crate::gears::Flank;

/// Normalised innovation of an outlier [standard deviations].
pub const GATE: i32 = 5;

/// Consecutive outliers after which the half-gap counts as wrong: a single outlier may be an impact.
const FEW: u8 = 2;

/// Consecutive outliers after which all parameters count as wrong.
const TOO_MANY: u8 = 12;

/// Learning intervals with force between the flanks after which the half-gap counts as wrong: three blocks.
const CONTRADICTED: u8 = 24;

/// Errors of a trusted half-gap attributed to its variation around the turn before another cause is assumed.
const FORGIVEN: u8 = 3;

/// Accepted rests after which this count is cleared: a quarter of a second of contact on both flanks.
const FORGOTTEN: u8 = 64;

/// Accepted rests on each flank after which a half-gap is trusted: a quarter of a second of contact.
const TRUSTED: u8 = 32;

/// Evidence against the estimated parameters.
#[derive(Debug, Clone, Copy, Default)]
pub struct Consistency {
    /// Consecutive intervals with force between the flanks.
    contradicted: u8,
    /// Consecutive outliers.
    outliers: u8,
    /// Accepted rests on the back flank and on the drive flank since the half-gap was last in doubt.
    trusted: [u8; 2],
    /// Recent errors that were attributed to the variation of the half-gap around the turn.
    forgiven: u8,
    /// Accepted rests since the last of these errors.
    sound: u8,
}

/// Deviation of a rest, or of a force between the flanks, from the estimated parameters.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Off {
    /// Less than the tolerance of a known half-gap.
    Little,
    /// Within the variation of a half-gap around the turn.
    AsInAnotherPlace,
    /// More than this variation.
    Far,
}

/// Consequence for the estimated parameters.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Verdict {
    /// No change.
    Keep,
    /// The variance of the half-gap grows: the half-gap may differ at this place of the turn, as in worn gears.
    LoosenHalfGap,
    /// The variance of the half-gap is reset; its value is kept.
    RelearnHalfGap,
    /// The variances of all parameters are reset.
    RelearnAll,
    /// The output encoder fails: the gap seems narrower than the half-gap trusted on both flanks, or no parameter
    /// agrees any more. Teeth do not grow, and shafts do not turn against each other.
    EncoderFails,
}

impl Consistency {
    /// Judges an interval: force at rest between the flanks, beyond bias and stiction, contradicts the estimated flanks
    /// by `Off`.
    pub fn step(&mut self, force_between_flanks: Option<Off>) -> Verdict {
        self.contradicted = if force_between_flanks.is_some() { self.contradicted + 1 } else { 0 };
        let Some(off) = force_between_flanks.filter(|_| self.contradicted >= CONTRADICTED) else {
            return Verdict::Keep;
        };
        self.contradicted = 0;
        // The gap is narrower than estimated.
        if !self.is_trusted() {
            return self.other_half_gap();
        }
        if off != Off::Far && self.forgives() { Verdict::LoosenHalfGap } else { Verdict::EncoderFails }
    }

    /// Returns true if the error may once more be attributed to the variation around the turn.
    fn forgives(&mut self) -> bool {
        self.sound = 0;
        let forgives = self.forgiven < FORGIVEN;
        self.forgiven = self.forgiven.saturating_add(1);
        forgives
    }

    /// Judges an outlier by its deviation; `was_sure` is true once a half-gap was trusted.
    pub fn outlier(&mut self, off: Off, was_sure: bool) -> Verdict {
        self.outliers += 1;
        if self.outliers >= TOO_MANY {
            self.outliers = 0;
            if was_sure { Verdict::EncoderFails } else { Verdict::RelearnAll }
        } else if self.outliers != FEW || off == Off::Little {
            Verdict::Keep
        } else if off == Off::AsInAnotherPlace && self.is_trusted() && self.forgives() {
            Verdict::LoosenHalfGap
        } else {
            self.other_half_gap()
        }
    }

    /// Counts an accepted rest.
    pub fn fits(&mut self, flank: Option<Flank>) {
        self.outliers = 0;
        self.sound = self.sound.saturating_add(1);
        if self.sound >= FORGOTTEN {
            self.forgiven = 0;
        }
        let [back, drive] = &mut self.trusted;
        let trusted = if flank == Some(Flank::Drive) { &mut *drive } else { &mut *back };
        *trusted = trusted.saturating_add(1);
    }

    /// Discards the half-gap. If the half-gap was not trusted, all other parameters are in doubt too.
    fn other_half_gap(&mut self) -> Verdict {
        let trusted = self.is_trusted();
        self.trusted = [0; 2];
        if trusted { Verdict::RelearnHalfGap } else { Verdict::RelearnAll }
    }

    /// Returns true once the half-gap has been confirmed on both flanks.
    pub fn is_trusted(&self) -> bool {
        let [back, drive] = self.trusted;
        back.min(drive) >= TRUSTED
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Consistency with a trusted half-gap.
    fn trusted() -> Consistency {
        let mut consistency = Consistency::default();
        for _ in 0..TRUSTED {
            consistency.fits(Some(Flank::Drive));
            consistency.fits(Some(Flank::Back));
        }
        assert!(consistency.is_trusted());
        consistency
    }

    /// Verdict on force between the flanks that lasts for `CONTRADICTED` intervals.
    fn lasting_force(consistency: &mut Consistency, off: Off) -> Verdict {
        for _ in 1..CONTRADICTED {
            assert_eq!(consistency.step(Some(off)), Verdict::Keep);
        }
        consistency.step(Some(off))
    }

    /// Verdict on two consecutive outliers.
    fn outliers(consistency: &mut Consistency, off: Off) -> Verdict {
        assert_eq!(consistency.outlier(off, true), Verdict::Keep);
        let verdict = consistency.outlier(off, true);
        consistency.outliers = 0;
        verdict
    }

    #[test]
    fn a_narrower_gap_is_another_place_three_times() {
        let mut consistency = trusted();
        for _ in 0..FORGIVEN {
            assert_eq!(lasting_force(&mut consistency, Off::AsInAnotherPlace), Verdict::LoosenHalfGap);
        }
        assert_eq!(lasting_force(&mut consistency, Off::AsInAnotherPlace), Verdict::EncoderFails);
    }

    #[test]
    fn sound_rests_make_it_forgotten() {
        let mut consistency = trusted();
        for _ in 0..3 * FORGIVEN {
            assert_eq!(lasting_force(&mut consistency, Off::AsInAnotherPlace), Verdict::LoosenHalfGap);
            (0..FORGOTTEN).for_each(|_| consistency.fits(Some(Flank::Drive)));
        }
    }

    #[test]
    fn teeth_do_not_grow_by_half_of_the_gap() {
        assert_eq!(lasting_force(&mut trusted(), Off::Far), Verdict::EncoderFails);
        assert_eq!(lasting_force(&mut Consistency::default(), Off::AsInAnotherPlace), Verdict::RelearnAll);
    }

    #[test]
    fn force_that_comes_and_goes_says_nothing() {
        let mut consistency = trusted();
        for interval in 0..10 * u32::from(CONTRADICTED) {
            let force = (interval % u32::from(CONTRADICTED) != 0).then_some(Off::Far);
            assert_eq!(consistency.step(force), Verdict::Keep);
        }
    }

    #[test]
    fn two_outliers_are_another_place_or_another_half_gap() {
        assert_eq!(outliers(&mut trusted(), Off::Little), Verdict::Keep);
        assert_eq!(outliers(&mut trusted(), Off::AsInAnotherPlace), Verdict::LoosenHalfGap);
        let mut consistency = trusted();
        assert_eq!(outliers(&mut consistency, Off::Far), Verdict::RelearnHalfGap);
        assert!(!consistency.is_trusted());
        assert_eq!(outliers(&mut consistency, Off::Far), Verdict::RelearnAll);
    }

    #[test]
    fn many_outliers_speak_against_the_encoder() {
        let (mut sure, mut unsure) = (Consistency::default(), Consistency::default());
        for _ in 1..TOO_MANY {
            assert_ne!(sure.outlier(Off::Little, true), Verdict::EncoderFails);
            assert_ne!(unsure.outlier(Off::Little, false), Verdict::RelearnAll);
        }
        assert_eq!(sure.outlier(Off::Little, true), Verdict::EncoderFails);
        assert_eq!(unsure.outlier(Off::Little, false), Verdict::RelearnAll);
    }
}
