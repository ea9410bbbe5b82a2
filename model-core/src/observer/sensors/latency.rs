//! How old the motor's readings are, by their own time stamps: whether each is of this period, a late one, or the same
//! as before because a new one was lost.

/// Control periods without a new reading over which the motor is taken to go on as it went: the force that acts
/// meanwhile is a guess, and after two periods a landing could have gone by unseen.
const EXTRAPOLATED: u32 = 2;

/// By how many late periods may outnumber those on time before the line counts as late for good: one lost frame or two
/// must not stop learning.
const LATE_FOR_GOOD: u8 = 4;

/// Control periods in which readings must be on time again until that is over: the motor side's estimates of what was
/// late have faded by then.
const RECOVERED_AFTER: u8 = 32;

/// Ages are counted in this many parts of a control period.
const PARTS: u32 = 16;

/// Parts of a control period by which the same reading, given again, is older than before: a whole period less what the
/// clock of a sampling line may jitter.
const GIVEN_AGAIN: u32 = 12;

/// How fresh the motor's reading is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Freshness {
    /// Taken in this period.
    Fresh,
    /// The same as before: one or two were lost. The motor goes on as it went.
    Lost,
    /// The same as before for longer: the force since is a guess, so estimates that depend on it are not valid, and
    /// nothing is learnt from them.
    LostForLong,
    /// A new one, older than a period: likewise.
    Late,
    /// None, or one that is too old to be used.
    Unusable,
}

/// Age of the motor's readings over time.
#[derive(Debug, Clone, Copy, Default)]
pub struct Latency {
    /// Age of the last reading, in [`PARTS`] of a period.
    age: u8,
    /// By how many late periods outnumber those on time; beyond [`LATE_FOR_GOOD`], periods on time until that is over.
    late: u8,
}

impl Latency {
    /// Takes a reading's age, `None` for one that is too old, and the length of a period; both in ticks.
    #[inline]
    pub fn step(&mut self, age: Option<u32>, period: u32) -> Freshness {
        match age {
            Some(age) if age < period => {
                self.age = 0;
                self.late = self.late.saturating_sub(1);
                Freshness::Fresh
            }
            _ => self.step_late(age, period),
        }
    }

    #[cold]
    fn step_late(&mut self, age: Option<u32>, period: u32) -> Freshness {
        let parts =
            age.and_then(|age| age.saturating_mul(PARTS).checked_div(period)).map_or(u8::MAX, |parts| parts as u8);
        let before = u32::from(core::mem::replace(&mut self.age, parts));
        let again = u32::from(parts) >= before + GIVEN_AGAIN;
        let freshness = match age {
            Some(age) if again && age < period.saturating_mul(EXTRAPOLATED).saturating_add(period / 2) => {
                Freshness::Lost
            }
            Some(_) if again => Freshness::LostForLong,
            Some(_) => Freshness::Late,
            None => Freshness::Unusable,
        };
        self.late = match freshness {
            Freshness::Fresh | Freshness::Lost => self.late.saturating_sub(1),
            Freshness::LostForLong | Freshness::Late if self.late < LATE_FOR_GOOD => self.late + 1,
            _ => LATE_FOR_GOOD + RECOVERED_AFTER,
        };
        freshness
    }

    /// Whether the line has been late for long.
    pub fn is_late_for_good(&self) -> bool {
        self.late > LATE_FOR_GOOD
    }
}
