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
}

/// What is to be done about what was learnt.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Verdict {
    /// Nothing.
    Keep,
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
    /// are not where they were learnt to be.
    pub fn step(&mut self, force_between_flanks: bool) -> Verdict {
        self.contradicted = if force_between_flanks { self.contradicted + 1 } else { 0 };
        if self.contradicted < CONTRADICTED {
            return Verdict::Keep;
        }
        self.contradicted = 0;
        // The gap is narrower than was learnt.
        if self.is_trusted() { Verdict::EncoderFails } else { self.other_half_gap() }
    }

    /// A rest that does not belong to the model, by more than a known half-gap may be wrong or not; whether anything was ever
    /// learnt for sure.
    pub fn outlier(&mut self, large: bool, was_sure: bool) -> Verdict {
        self.outliers += 1;
        if self.outliers >= TOO_MANY {
            self.outliers = 0;
            if was_sure { Verdict::EncoderFails } else { Verdict::RelearnAll }
        } else if self.outliers != FEW || !large {
            Verdict::Keep
        } else {
            self.other_half_gap()
        }
    }

    /// A rest that belongs to the model.
    pub fn fits(&mut self, flank: Option<Flank>) {
        self.outliers = 0;
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
