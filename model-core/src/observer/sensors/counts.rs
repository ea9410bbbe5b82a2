//! From raw counts to whole numbers that are exact over any number of turns and over wrap-around: where each shaft is,
//! and motor less ratio times output. Angles beyond a turn never become floating point here.

use crate::numbers::Real;
use crate::observer::samples::Reading;
use crate::observer::tables::{CountTable, EncoderTable};

/// Readings in a row that are too far away to be believed, after which the encoder is taken to have jumped.
const BELIEVED_AFTER: u8 = 3;

/// Where one shaft is.
#[derive(Debug, Clone, Copy, Default)]
pub struct Counter {
    raw: u32,
    place: u32,
    turns: i32,
    doubted: u8,
    began: bool,
}

/// What a reading came to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Advance {
    /// The first reading ever.
    Began,
    /// Counts since the last one.
    By(i32),
    /// Too far away: not believed, the shaft is taken to have gone on as it went.
    Implausible,
    /// Too far away time after time: the encoder has jumped by this much.
    Jumped(i32),
}

impl Counter {
    #[inline]
    pub fn take<T: Real>(&mut self, table: &EncoderTable<T>, raw: u32) -> Advance {
        // Raw counts outside their range are brought into it.
        let raw = if raw > table.last { raw.checked_rem(table.wraps_at).unwrap_or(raw) } else { raw };
        let by = difference(raw, self.raw, table);
        if !self.began || by.unsigned_abs() > table.fastest {
            return self.take_odd(table, raw, by);
        }
        self.move_to(table, raw, by);
        Advance::By(by)
    }

    /// The first reading, or one that is far away.
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

    /// Goes on by so many counts.
    fn advance<T: Real>(&mut self, table: &EncoderTable<T>, by: i32) {
        let place = self.place.wrapping_add(by as u32);
        // Places before the turn's beginning are huge here.
        if place < table.turn {
            self.place = place;
        } else {
            self.turn(table, by.into());
        }
    }

    /// Goes on by so many counts into another turn.
    #[cold]
    fn turn<T: Real>(&mut self, table: &EncoderTable<T>, by: i64) {
        let turn = i64::from(table.turn);
        let place = i64::from(self.place).wrapping_add(by);
        let turns = whole(place, turn);
        self.place = (place - turns * turn) as u32;
        self.turns = self.turns.wrapping_add(turns as i32);
    }

    /// Place within the turn in 2^-32 turns.
    pub fn phase<T: Real>(&self, table: &EncoderTable<T>) -> u32 {
        (u64::from(self.place).wrapping_mul(table.phase) >> 32) as u32
    }

    /// Place within the turn, in counts.
    pub fn place(&self) -> u32 {
        self.place
    }

    /// Whole turns since the first reading's own turn.
    pub fn turns(&self) -> i32 {
        self.turns
    }
}

/// The quotient of two whole numbers, towards zero; none where there is no part. A division of 64 bits is a library call of
/// 700 bytes: what fits into 32 the hardware divides, and other quotients here have few digits.
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

/// Digit by digit.
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

/// Half of a whole number, towards zero.
fn half(units: i64) -> i64 {
    units.wrapping_add(i64::from(units < 0)) >> 1
}

/// How often a part goes into units, downwards, so that what is left of them is not below zero. No part at all goes into none.
fn whole(units: i64, part: i64) -> i64 {
    let Some(towards_zero) = quotient(units, part) else { return 0 };
    if towards_zero.wrapping_mul(part) > units { towards_zero.wrapping_sub(1) } else { towards_zero }
}

/// What is left of them.
fn rest(units: i64, part: i64) -> i64 {
    units.wrapping_sub(whole(units, part).wrapping_mul(part))
}

/// Counts of the whole ranges of raw counts that come nearest to so many units of the difference, a count being so many.
fn whole_ranges<T: Real>(units: i64, table: &EncoderTable<T>, weight: i64) -> i64 {
    let range = i64::from(table.last).wrapping_add(1);
    let of_range = range.wrapping_mul(weight);
    whole(units.wrapping_add(half(of_range)), of_range).wrapping_mul(range)
}

/// From `before` to `now` the shorter way round; both within their range.
pub fn difference<T: Real>(now: u32, before: u32, table: &EncoderTable<T>) -> i32 {
    let up = now.wrapping_sub(before);
    let up = if now < before { up.wrapping_add(table.wraps_at) } else { up };
    (if up > table.last / 2 { up.wrapping_sub(table.wraps_at) } else { up }) as i32
}

/// Both shafts, and the output as the motor implies it while its encoder is not trusted.
#[derive(Debug, Clone, Copy, Default)]
pub struct Counts {
    pub motor: Counter,
    /// As measured.
    pub output: Counter,
    /// Motor less ratio times output as measured, since the start, in the table's units, wrapping.
    pub difference: i64,
    /// What the difference was at the start, modulo whole turns: where the encoders' zeros are.
    pub start: i64,
    /// The start is a saved one.
    referred: bool,
    /// As implied: an output that follows the motor by whole counts, and what is left of the difference.
    implied: Option<(Counter, i64)>,
    fresh_time: u32,
    motor_time: u32,
    /// The motor encoder is not trusted.
    doubt: Option<Doubt>,
}

/// What is remembered of a motor encoder that is not trusted.
#[derive(Debug, Clone, Copy)]
struct Doubt {
    /// The difference before.
    difference: i64,
    /// Units of the difference by which the motor's counts have gone on since, as far as raw counts tell.
    went: i64,
}

/// What one period's readings came to.
#[derive(Debug, Clone, Copy)]
pub struct Taken {
    pub motor: Advance,
    /// `None` when there was no fresh reading.
    pub output: Option<Advance>,
    /// Ticks since the fresh reading before, by their own times.
    pub apart: u32,
    /// The same of the motor's reading; 0 if it is the one before again.
    pub motor_apart: u32,
    /// By how many counts the output went on that is in use.
    pub turned: i32,
}

impl Counts {
    // A call and what it hands over cost some hundredths of the instructions of a period.
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

    /// The motor went on by units of the difference while one of the encoders is not trusted, the output by counts; by how
    /// many counts the output went on that is in use.
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

    /// From now on the motor encoder is not trusted; `last` is by how many counts it went on in this period, before that
    /// was known.
    pub fn doubt_motor<T: Real>(&mut self, table: &CountTable<T>, last: Advance) {
        if self.doubt.is_none() {
            let by = if let Advance::Jumped(by) = last { i64::from(by).wrapping_mul(table.motor_weight) } else { 0 };
            self.doubt = Some(Doubt { difference: self.difference.wrapping_sub(by), went: by });
        }
    }

    /// Raw counts of a motor encoder that was not trusted leave whole ranges open: of the places that they can mean it takes the
    /// one nearest to where the output says, or, without one, to where the motor was.
    pub fn find_motor<T: Real>(&mut self, table: &CountTable<T>) {
        let Some(Doubt { difference, went }) = self.doubt else { return };
        let beyond = if self.implied.is_some() { went } else { self.difference.wrapping_sub(difference) };
        let back = whole_ranges(beyond, &table.motor, table.motor_weight).wrapping_neg();
        self.motor.turn(&table.motor, back);
        let back = back.wrapping_mul(table.motor_weight);
        self.difference = self.difference.wrapping_add(back);
        self.doubt = Some(Doubt { difference, went: went.wrapping_add(back) });
    }

    /// The motor encoder is trusted again, as it is found; one that has slipped, by so many units of the difference, goes on from
    /// where the motor is.
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

    /// Counts the difference from so many units further on: an encoder has slipped by as much.
    fn count_from<T: Real>(&mut self, table: &CountTable<T>, by: i64) {
        self.start = rest(self.start.wrapping_add(by), table.modulus);
        self.difference = self.difference.wrapping_sub(by);
    }

    /// The output has jumped by so many counts, which gives it up: what the motor implies goes on from where it was. Raw
    /// counts leave whole ranges open; of the places that they can mean it is the one nearest to what is implied. By how many
    /// counts it has gone on to there.
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

    /// Both encoders are there for the first time.
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

    /// Lets the implied output follow the motor; by how many counts it did.
    fn follow<T: Real>(&mut self, table: &CountTable<T>, by: i64) -> i32 {
        let Some((implied, rest)) = &mut self.implied else { return 0 };
        let sum = rest.wrapping_add(by);
        let counts = quotient(sum, table.output_weight).unwrap_or(0);
        *rest = sum.wrapping_sub(counts.wrapping_mul(table.output_weight));
        implied.advance(&table.output, counts as i32);
        counts as i32
    }

    /// Counts the difference from where the encoders' zeros were before, as far as whole turns leave that open.
    pub fn refer_to<T: Real>(&mut self, reference: i64, table: &CountTable<T>) {
        self.referred = true;
        if self.output.began {
            let beyond = rest(self.start.wrapping_sub(reference), table.modulus);
            let beyond = if beyond > half(table.modulus) { beyond - table.modulus } else { beyond };
            self.difference = self.difference.wrapping_add(beyond);
        }
        self.start = reference;
    }

    /// From now on the output is what the motor implies, beginning where it is measured now.
    pub fn imply(&mut self) {
        if self.implied.is_none() {
            self.implied = Some((self.output, self.difference));
        }
    }

    /// From now on the output is what is measured; an encoder that has slipped, by so many units of the difference, goes on
    /// from where the link is.
    pub fn trust<T: Real>(&mut self, table: &CountTable<T>, slipped: i64) {
        self.implied = None;
        let counts = quotient(slipped, table.output_weight).unwrap_or(0);
        if counts != 0 {
            let by = counts.wrapping_mul(table.output_weight);
            self.output.turn(&table.output, counts);
            self.count_from(table, by);
        }
    }

    /// The output that is in use, and its difference.
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
