//! Whether what teeth at rest show belongs to what was learnt: it is learnt, left out, or the half-gap is doubted, for
//! teeth wear, and in the end everything else too.

use crate::gears::Flank;

/// Normalised innovation that does not belong to the model [standard deviations].
pub const GATE: i32 = 5;

/// Outliers in a row after which the half-gap counts as wrong: one may be a blow.
const FEW: u8 = 2;

/// Outliers in a row after which everything that was learnt counts as wrong.
const TOO_MANY: u8 = 12;

/// Learning intervals with force between the flanks after which the half-gap counts as wrong: three blocks.
const CONTRADICTED: u8 = 24;

/// Times that a trusted half-gap may be put down to another place in the turn before something else is to blame.
const FORGIVEN: u8 = 3;

/// Rests without an outlier after which that is forgotten: a quarter of a second of contact on both flanks.
const FORGOTTEN: u8 = 64;

/// Rests without an outlier on each flank after which a half-gap counts as learnt: a quarter of a second of contact.
const TRUSTED: u8 = 32;

/// What speaks against what was learnt.
#[derive(Debug, Clone, Copy, Default)]
pub struct Consistency {
    /// Intervals in a row with force between the flanks.
    contradicted: u8,
    /// Rests in a row that did not belong to the model.
    outliers: u8,
    /// Rests without an outlier on the back flank and on the drive flank since the half-gap was doubted.
    trusted: [u8; 2],
    /// Times of late that the half-gap was another one in another place.
    forgiven: u8,
    /// Rests without an outlier since.
    sound: u8,
}

/// By how much a rest, or force between the flanks, is off what was learnt.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Off {
    /// By less than a known half-gap may be wrong.
    Little,
    /// By as much as the half-gap of a gear may vary around the turn.
    AsInAnotherPlace,
    /// By more.
    Far,
}

/// What is to be done about what was learnt.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Verdict {
    /// Nothing.
    Keep,
    /// The half-gap may be another one here, as in worn gears: it is known less well.
    LoosenHalfGap,
    /// The half-gap is learnt anew: it is only how sure it is that is forgotten.
    RelearnHalfGap,
    /// Everything is learnt anew.
    RelearnAll,
    /// The gap seems narrower than was seen on both flanks for long, or nothing is as it was: teeth do not grow, nor do shafts
    /// turn against each other. The output encoder fails.
    EncoderFails,
}

impl Consistency {
    /// Once an interval: whether there was force at rest between the flanks, bias and stiction aside, which says that they
    /// are not where they were learnt to be, and by how much not.
    pub fn step(&mut self, force_between_flanks: Option<Off>) -> Verdict {
        self.contradicted = if force_between_flanks.is_some() { self.contradicted + 1 } else { 0 };
        let Some(off) = force_between_flanks.filter(|_| self.contradicted >= CONTRADICTED) else {
            return Verdict::Keep;
        };
        self.contradicted = 0;
        // The gap is narrower than was learnt.
        if !self.is_trusted() {
            return self.other_half_gap();
        }
        if off != Off::Far && self.forgives() { Verdict::LoosenHalfGap } else { Verdict::EncoderFails }
    }

    /// Whether a trusted half-gap may be another one in this place once more.
    fn forgives(&mut self) -> bool {
        self.sound = 0;
        let forgives = self.forgiven < FORGIVEN;
        self.forgiven = self.forgiven.saturating_add(1);
        forgives
    }

    /// A rest that does not belong to the model, and by how much not; whether anything was ever learnt for sure.
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

    /// A rest that belongs to the model.
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

    /// The half-gap is not what was learnt. If it had not been seen on both flanks for long, nothing else is sure either.
    fn other_half_gap(&mut self) -> Verdict {
        let trusted = self.is_trusted();
        self.trusted = [0; 2];
        if trusted { Verdict::RelearnHalfGap } else { Verdict::RelearnAll }
    }

    /// Whether the half-gap has been seen on both flanks for long.
    pub fn is_trusted(&self) -> bool {
        let [back, drive] = self.trusted;
        back.min(drive) >= TRUSTED
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// One whose half-gap was seen on both flanks for long.
    fn trusted() -> Consistency {
        let mut consistency = Consistency::default();
        for _ in 0..TRUSTED {
            consistency.fits(Some(Flank::Drive));
            consistency.fits(Some(Flank::Back));
        }
        assert!(consistency.is_trusted());
        consistency
    }

    /// What force between the flanks comes to that lasts for as long as it takes.
    fn lasting_force(consistency: &mut Consistency, off: Off) -> Verdict {
        for _ in 1..CONTRADICTED {
            assert_eq!(consistency.step(Some(off)), Verdict::Keep);
        }
        consistency.step(Some(off))
    }

    /// What two rests in a row that do not belong to the model come to.
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
