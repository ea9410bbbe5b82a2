//! Integer counts of both shafts, exact over any number of turns and over wrap-around, and their difference (O1): motor
//! less ratio times output. D = `difference`, n_m C_o q = motor counts times `motor_weight`, n_o C_m p = output counts
//! times `output_weight`, both without common divisors. Angles beyond a turn never become floating point here.

use crate::numbers::Real;
use crate::observer::samples::Reading;
use crate::observer::tables::{CountTable, EncoderTable};

/// Consecutive readings rejected as too far away; the next such reading counts as a jump of the encoder.
const BELIEVED_AFTER: u8 = 3;

/// Position of one shaft.
#[derive(Debug, Clone, Copy, Default)]
pub struct Counter {
    raw: u32,
    place: u32,
    turns: i32,
    doubted: u8,
    began: bool,
}

/// Result of a reading.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Advance {
    /// First reading.
    Began,
    /// Counts since the last accepted reading.
    By(i32),
    /// Too far away: rejected, the motion is extrapolated.
    Implausible,
    /// Too far away repeatedly: the encoder has jumped by these counts.
    Jumped(i32),
}

impl Counter {
    #[inline]
    pub fn take<T: Real>(&mut self, table: &EncoderTable<T>, raw: u32) -> Advance {
        // Bring raw counts outside their range into it.
        let raw = if raw > table.last { raw.checked_rem(table.wraps_at).unwrap_or(raw) } else { raw };
        let by = difference(raw, self.raw, table);
        if !self.began || by.unsigned_abs() > table.fastest {
            return self.take_odd(table, raw, by);
        }
        self.move_to(table, raw, by);
        Advance::By(by)
    }

    /// Handles the first reading or a distant reading.
    #[cold]
    fn take_odd<T: Real>(&mut self, table: &EncoderTable<T>, raw: u32, by: i32) -> Advance {
        if !self.began {
            self.began = true;
            self.raw = raw;
            self.place = raw.checked_rem(table.turn).unwrap_or(0);
            return Advance::Began;
        }
        let within = by.unsigned_abs() <= table.fastest.saturating_mul(u32::from(self.doubted) + 1);
        if !within && self.doubted < BELIEVED_AFTER {
            self.doubted += 1;
            return Advance::Implausible;
        }
        self.move_to(table, raw, by);
        if within { Advance::By(by) } else { Advance::Jumped(by) }
    }

    fn move_to<T: Real>(&mut self, table: &EncoderTable<T>, raw: u32, by: i32) {
        self.raw = raw;
        self.doubted = 0;
        self.advance(table, by);
    }

    /// Advances by counts.
    fn advance<T: Real>(&mut self, table: &EncoderTable<T>, by: i32) {
        let place = self.place.wrapping_add(by as u32);
        // A position before the start of the turn wraps to a huge value.
        if place < table.turn {
            self.place = place;
        } else {
            self.turn(table, by.into());
        }
    }

    /// Advances by counts into another turn.
    #[cold]
    fn turn<T: Real>(&mut self, table: &EncoderTable<T>, by: i64) {
        let turn = i64::from(table.turn);
        let place = i64::from(self.place).wrapping_add(by);
        let turns = whole(place, turn);
        self.place = (place - turns * turn) as u32;
        self.turns = self.turns.wrapping_add(turns as i32);
    }

    /// Position within the turn [2^-32 turns].
    pub fn phase<T: Real>(&self, table: &EncoderTable<T>) -> u32 {
        (u64::from(self.place).wrapping_mul(table.phase) >> 32) as u32
    }

    /// Position within the turn [counts].
    pub fn place(&self) -> u32 {
        self.place
    }

    /// Whole turns since the turn of the first reading.
    pub fn turns(&self) -> i32 {
        self.turns
    }
}

/// Quotient rounded towards zero; `None` for a divisor of zero. A 64-bit division is a library call of 700 bytes:
/// operands that fit 32 bits are divided in hardware, other quotients have few digits here.
#[inline(never)]
fn quotient(units: i64, part: i64) -> Option<i64> {
    let (left, size) = (units.unsigned_abs(), part.unsigned_abs());
    let quotient = match (u32::try_from(left), u32::try_from(size)) {
        (Ok(left), Ok(size)) => left.checked_div(size)?.into(),
        _ => quotient_of_large(left, size)?,
    };
    let quotient = quotient as i64;
    Some(if (units < 0) == (part < 0) { quotient } else { quotient.wrapping_neg() })
}

/// Long division, one binary digit per step.
#[cold]
fn quotient_of_large(mut left: u64, size: u64) -> Option<u64> {
    if size == 0 {
        return None;
    }
    let digits = size.leading_zeros().saturating_sub(left.leading_zeros());
    let (mut shifted, mut quotient) = (size << digits, 0);
    for _ in 0..=digits {
        quotient <<= 1;
        if left >= shifted {
            left -= shifted;
            quotient |= 1;
        }
        shifted >>= 1;
    }
    Some(quotient)
}

/// Half of an integer, rounded towards zero.
fn half(units: i64) -> i64 {
    units.wrapping_add(i64::from(units < 0)) >> 1
}

/// Quotient rounded down, so that the remainder is not negative; zero for a divisor of zero.
fn whole(units: i64, part: i64) -> i64 {
    let Some(towards_zero) = quotient(units, part) else { return 0 };
    if towards_zero.wrapping_mul(part) > units { towards_zero.wrapping_sub(1) } else { towards_zero }
}

/// Remainder of the division rounded down.
fn rest(units: i64, part: i64) -> i64 {
    units.wrapping_sub(whole(units, part).wrapping_mul(part))
}

/// Multiple of the raw range, in counts, nearest to `units` of the difference; `weight` is the units per count.
fn whole_ranges<T: Real>(units: i64, table: &EncoderTable<T>, weight: i64) -> i64 {
    let range = i64::from(table.last).wrapping_add(1);
    let of_range = range.wrapping_mul(weight);
    whole(units.wrapping_add(half(of_range)), of_range).wrapping_mul(range)
}

/// Counts from `before` to `now` the shorter way round; both lie within their range.
pub fn difference<T: Real>(now: u32, before: u32, table: &EncoderTable<T>) -> i32 {
    let up = now.wrapping_sub(before);
    let up = if now < before { up.wrapping_add(table.wraps_at) } else { up };
    (if up > table.last / 2 { up.wrapping_sub(table.wraps_at) } else { up }) as i32
}

/// Positions of both shafts, and the output implied by the motor while the output encoder is excluded.
#[derive(Debug, Clone, Copy, Default)]
pub struct Counts {
    pub motor: Counter,
    /// Measured output.
    pub output: Counter,
    /// Difference D since the start, as measured, in the table's units, wrapping.
    pub difference: i64,
    /// Difference at the start, modulo whole turns: position of the encoders' zeros.
    pub start: i64,
    /// The start was restored from memory.
    referred: bool,
    /// Implied output, which follows the motor by whole counts, and the remaining difference.
    implied: Option<(Counter, i64)>,
    fresh_time: u32,
    motor_time: u32,
    /// State while the motor encoder is excluded.
    doubt: Option<Doubt>,
}

/// Memory of an excluded motor encoder.
#[derive(Debug, Clone, Copy)]
struct Doubt {
    /// Difference before the exclusion.
    difference: i64,
    /// Travel of the motor counts since then, as far as raw counts show [units of the difference].
    went: i64,
}

/// Result of the readings of one period.
#[derive(Debug, Clone, Copy)]
pub struct Taken {
    pub motor: Advance,
    /// `None` without a fresh reading.
    pub output: Option<Advance>,
    /// Time from the previous fresh output reading, by time stamps [ticks].
    pub apart: u32,
    /// Time from the previous motor reading; 0 for a repeated reading [ticks].
    pub motor_apart: u32,
    /// Travel of the output in use, measured or implied [counts].
    pub turned: i32,
}

impl Counts {
    // Inlined: the call with its arguments would cost some hundredths of the instructions of a period.
    #[inline(always)]
    pub fn take<T: Real>(&mut self, table: &CountTable<T>, motor: Reading, output: Option<Reading>) -> Taken {
        let begins = !self.output.began;
        let motor_apart = motor.time.wrapping_sub(core::mem::replace(&mut self.motor_time, motor.time));
        let motor = self.motor.take(&table.motor, motor.counts);
        let by = if let Advance::By(by) | Advance::Jumped(by) = motor {
            i64::from(by).wrapping_mul(table.motor_weight)
        } else {
            0
        };
        let fresh = output.filter(|reading| table.has_output && (begins || reading.time != self.fresh_time));
        let apart = fresh.map_or(0, |reading| reading.time.wrapping_sub(self.fresh_time));
        let output = fresh.map(|reading| {
            self.fresh_time = reading.time;
            self.output.take(&table.output, reading.counts)
        });
        let turned = match output {
            Some(Advance::By(by)) => by,
            Some(Advance::Jumped(by)) => self.jump(table, by),
            _ => 0,
        };
        self.difference =
            self.difference.wrapping_add(by).wrapping_sub(i64::from(turned).wrapping_mul(table.output_weight));
        if begins && self.output.began {
            self.begin(table);
        }
        let turned =
            if self.implied.is_some() || self.doubt.is_some() { self.go_on(table, motor, by, turned) } else { turned };
        Taken { motor, output, apart, motor_apart, turned }
    }

    /// Advances an implied output, and the travel of an excluded motor encoder. `by` is the motor's travel in units of
    /// the difference, `turned` the measured output's in counts. Returns the travel of the output in use [counts].
    #[cold]
    fn go_on<T: Real>(&mut self, table: &CountTable<T>, motor: Advance, by: i64, turned: i32) -> i32 {
        if let Some(doubt) = &mut self.doubt {
            doubt.went = doubt.went.wrapping_add(by);
        }
        let followed = self.doubt.is_none() && matches!(motor, Advance::By(_));
        match self.implied {
            Some(_) if followed => self.follow(table, by),
            Some(_) => 0,
            None => turned,
        }
    }

    /// Excludes the motor encoder; `last` is its advance in this period, which preceded the exclusion.
    pub fn doubt_motor<T: Real>(&mut self, table: &CountTable<T>, last: Advance) {
        if self.doubt.is_none() {
            let by = if let Advance::Jumped(by) = last { i64::from(by).wrapping_mul(table.motor_weight) } else { 0 };
            self.doubt = Some(Doubt { difference: self.difference.wrapping_sub(by), went: by });
        }
    }

    /// Resolves the ambiguity of whole raw ranges of an excluded motor encoder: chooses the position nearest to the
    /// position implied by the output or, without an output encoder, to the motor's last position.
    pub fn find_motor<T: Real>(&mut self, table: &CountTable<T>) {
        let Some(Doubt { difference, went }) = self.doubt else { return };
        let beyond = if self.implied.is_some() { went } else { self.difference.wrapping_sub(difference) };
        let back = whole_ranges(beyond, &table.motor, table.motor_weight).wrapping_neg();
        self.motor.turn(&table.motor, back);
        let back = back.wrapping_mul(table.motor_weight);
        self.difference = self.difference.wrapping_add(back);
        self.doubt = Some(Doubt { difference, went: went.wrapping_add(back) });
    }

    /// Readmits the motor encoder at its found position. An encoder that slipped by `slipped` units of the difference
    /// continues from the motor's position.
    pub fn trust_motor<T: Real>(&mut self, table: &CountTable<T>, slipped: i64) {
        let Some(Doubt { went, .. }) = self.doubt.take() else { return };
        let counts = quotient(slipped, table.motor_weight).unwrap_or(0);
        if counts != 0 {
            let by = counts.wrapping_mul(table.motor_weight);
            self.motor.turn(&table.motor, counts.wrapping_neg());
            self.count_from(table, by);
        }
        if self.implied.is_some() {
            self.follow(table, went);
        }
    }

    /// Shifts the origin of the difference by the units of an encoder slip.
    fn count_from<T: Real>(&mut self, table: &CountTable<T>, by: i64) {
        self.start = rest(self.start.wrapping_add(by), table.modulus);
        self.difference = self.difference.wrapping_sub(by);
    }

    /// Handles a jump of the output, which excludes its encoder: the implied output continues from the last position.
    /// Among the positions that whole raw ranges leave open, the measured output takes the position nearest to the
    /// implied output. Returns the travel of the measured output [counts].
    #[cold]
    fn jump<T: Real>(&mut self, table: &CountTable<T>, by: i32) -> i32 {
        self.output.advance(&table.output, by.wrapping_neg());
        let (_, implied) = *self.implied.get_or_insert((self.output, self.difference));
        let beyond =
            i64::from(by).wrapping_mul(table.output_weight).wrapping_sub(self.difference).wrapping_add(implied);
        let went = i64::from(by).wrapping_sub(whole_ranges(beyond, &table.output, table.output_weight)) as i32;
        self.output.advance(&table.output, went);
        went
    }

    /// Sets the start when both encoders have given a first reading.
    #[cold]
    fn begin<T: Real>(&mut self, table: &CountTable<T>) {
        let absolute = i64::from(self.motor.place)
            .wrapping_mul(table.motor_weight)
            .wrapping_sub(i64::from(self.output.place).wrapping_mul(table.output_weight));
        let reference = core::mem::replace(&mut self.start, rest(absolute, table.modulus));
        self.difference = 0;
        if self.referred {
            self.refer_to(reference, table);
        }
    }

    /// Advances the implied output with the motor and returns its travel [counts].
    fn follow<T: Real>(&mut self, table: &CountTable<T>, by: i64) -> i32 {
        let Some((implied, rest)) = &mut self.implied else { return 0 };
        let sum = rest.wrapping_add(by);
        let counts = quotient(sum, table.output_weight).unwrap_or(0);
        *rest = sum.wrapping_sub(counts.wrapping_mul(table.output_weight));
        implied.advance(&table.output, counts as i32);
        counts as i32
    }

    /// Refers the difference to saved zeros of the encoders, as far as whole turns leave the zeros open.
    pub fn refer_to<T: Real>(&mut self, reference: i64, table: &CountTable<T>) {
        self.referred = true;
        if self.output.began {
            let beyond = rest(self.start.wrapping_sub(reference), table.modulus);
            let beyond = if beyond > half(table.modulus) { beyond - table.modulus } else { beyond };
            self.difference = self.difference.wrapping_add(beyond);
        }
        self.start = reference;
    }

    /// Replaces the output by the output implied by the motor, starting at the measured position.
    pub fn imply(&mut self) {
        if self.implied.is_none() {
            self.implied = Some((self.output, self.difference));
        }
    }

    /// Returns to the measured output. An encoder that slipped by `slipped` units of the difference continues from the
    /// link's position.
    pub fn trust<T: Real>(&mut self, table: &CountTable<T>, slipped: i64) {
        self.implied = None;
        let counts = quotient(slipped, table.output_weight).unwrap_or(0);
        if counts != 0 {
            let by = counts.wrapping_mul(table.output_weight);
            self.output.turn(&table.output, counts);
            self.count_from(table, by);
        }
    }

    /// Returns the output in use and its difference.
    pub fn used(&self) -> (&Counter, i64) {
        match &self.implied {
            Some((implied, rest)) => (implied, *rest),
            None => (&self.output, self.difference),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{half, quotient};
    use crate::numbers::random::splitmix64;

    #[test]
    fn quotients_are_the_language_s() {
        let mut state = 3;
        let mut any = || (splitmix64(&mut state) as i64) >> (splitmix64(&mut state) % 64);
        let ends = [0, 1, -1, i64::from(u32::MAX), 1 << 32, i64::MAX, i64::MIN + 1];
        let random = (0..200_000).map(|_| (any(), any()));
        for (units, part) in ends.into_iter().flat_map(|one| ends.map(|other| (one, other))).chain(random) {
            assert_eq!(quotient(units, part), units.checked_div(part), "{units} by {part}");
            assert_eq!(half(units), units / 2, "half of {units}");
        }
    }
}
