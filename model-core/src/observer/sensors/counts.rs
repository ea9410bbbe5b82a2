//! Integer counts of both shafts, exact over any number of turns and over wrap-around, and their difference, motor less
//! ratio times output. Angles beyond a turn never become floating point here.
//!
//! ```text
//! (O1)  D = n_m C_o q - n_o C_m p,   unit 1/(C_m C_o q) motor turn
//! ```
//!
//! Symbols: D = `difference`, n_m = counts of `motor`, n_o = counts of `output`, C_o q = `motor_weight`, C_m p =
//! `output_weight`, both weights without common divisors.

use super::thresholds::COUNTS;
use crate::numbers::Real;
use crate::numbers::integers::{floor_div, floor_mod, half, quotient};
use crate::numbers::state_words::state_words;
use crate::observer::samples::Reading;
use crate::observer::tables::{CountTable, EncoderTable};

/// Position of one shaft.
#[derive(Debug, Clone, Copy, Default)]
pub struct Counter {
    raw: u32,
    place: u32,
    turns: i32,
    rejected: u8,
    began: bool,
}
state_words! { struct Counter { raw, place, turns, rejected, began } }

/// Result of a reading.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CountChange {
    /// First reading.
    First,
    /// Counts since the last accepted reading.
    By(i32),
    /// Too far away: rejected, the motion is extrapolated.
    Implausible,
    /// Too far away repeatedly: the encoder has jumped by these counts.
    Jumped(i32),
}

impl Counter {
    #[inline]
    pub fn read<T: Real>(&mut self, table: &EncoderTable<T>, raw: u32) -> CountChange {
        // Bring raw counts outside their range into it.
        let raw = if raw > table.last { raw.checked_rem(table.wraps_at).unwrap_or(raw) } else { raw };
        let by = shortest_difference(raw, self.raw, table);
        if !self.began || by.unsigned_abs() > table.fastest {
            return self.read_distant(table, raw, by);
        }
        self.accept(table, raw, by);
        CountChange::By(by)
    }

    /// Handles the first reading or a distant reading.
    #[cold]
    fn read_distant<T: Real>(&mut self, table: &EncoderTable<T>, raw: u32, by: i32) -> CountChange {
        if !self.began {
            self.began = true;
            self.raw = raw;
            self.place = raw.checked_rem(table.turn).unwrap_or(0);
            return CountChange::First;
        }
        let within = by.unsigned_abs() <= table.fastest.saturating_mul(u32::from(self.rejected) + 1);
        if !within && self.rejected < COUNTS.rejections_before_jump {
            self.rejected += 1;
            return CountChange::Implausible;
        }
        self.accept(table, raw, by);
        if within { CountChange::By(by) } else { CountChange::Jumped(by) }
    }

    fn accept<T: Real>(&mut self, table: &EncoderTable<T>, raw: u32, by: i32) {
        self.raw = raw;
        self.rejected = 0;
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
        let turns = floor_div(place, turn);
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

/// Multiple of the raw range, in counts, nearest to `units` of the difference; `weight` is the units per count.
fn nearest_range_multiple<T: Real>(units: i64, table: &EncoderTable<T>, weight: i64) -> i64 {
    let range = i64::from(table.last).wrapping_add(1);
    let of_range = range.wrapping_mul(weight);
    floor_div(units.wrapping_add(half(of_range)), of_range).wrapping_mul(range)
}

/// Counts from `before` to `now` the shorter way round; both lie within their range.
pub fn shortest_difference<T: Real>(now: u32, before: u32, table: &EncoderTable<T>) -> i32 {
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
    has_reference: bool,
    /// Implied output, which follows the motor by whole counts, and the remaining difference.
    implied: Option<(Counter, i64)>,
    output_time: u32,
    motor_time: u32,
    /// State while the motor encoder is excluded.
    suspicion: Option<Suspicion>,
}
state_words! {
    struct Counts {
        motor, output, difference, start, has_reference, implied, output_time, motor_time, suspicion,
    }
}

/// Memory of an excluded motor encoder.
#[derive(Debug, Clone, Copy)]
struct Suspicion {
    /// Difference before the exclusion.
    difference: i64,
    /// Travel of the motor counts since then, as far as raw counts show [units of the difference].
    travel: i64,
}
state_words! { struct Suspicion { difference, travel } }

/// Result of the readings of one period.
#[derive(Debug, Clone, Copy)]
pub struct CountReadings {
    pub motor: CountChange,
    /// `None` without a fresh reading.
    pub output: Option<CountChange>,
    /// Time from the previous fresh output reading, by time stamps [ticks].
    pub output_interval: u32,
    /// Time from the previous motor reading; 0 for a repeated reading [ticks].
    pub motor_interval: u32,
    /// Travel of the output in use, measured or implied [counts].
    pub output_travel: i32,
}

impl Counts {
    // Inlined: the call with its arguments would cost some hundredths of the instructions of a period.
    #[inline(always)]
    pub fn read_counts<T: Real>(
        &mut self,
        table: &CountTable<T>,
        motor: Reading,
        output: Option<Reading>,
    ) -> CountReadings {
        let begins = !self.output.began;
        let motor_interval = motor.time.wrapping_sub(core::mem::replace(&mut self.motor_time, motor.time));
        let motor = self.motor.read(&table.motor, motor.counts);
        let by = if let CountChange::By(by) | CountChange::Jumped(by) = motor {
            i64::from(by).wrapping_mul(table.motor_weight)
        } else {
            0
        };
        let fresh = output.filter(|reading| table.has_output && (begins || reading.time != self.output_time));
        let output_interval = fresh.map_or(0, |reading| reading.time.wrapping_sub(self.output_time));
        let output = fresh.map(|reading| {
            self.output_time = reading.time;
            self.output.read(&table.output, reading.counts)
        });
        let output_travel = match output {
            Some(CountChange::By(by)) => by,
            Some(CountChange::Jumped(by)) => self.follow_output_jump(table, by),
            _ => 0,
        };
        self.difference =
            self.difference.wrapping_add(by).wrapping_sub(i64::from(output_travel).wrapping_mul(table.output_weight));
        if begins && self.output.began {
            self.set_start(table);
        }
        let output_travel = if self.implied.is_some() || self.suspicion.is_some() {
            self.advance_output_in_use(table, motor, by, output_travel)
        } else {
            output_travel
        };
        CountReadings { motor, output, output_interval, motor_interval, output_travel }
    }

    /// Advances an implied output, and the travel of an excluded motor encoder. `by` is the motor's travel in units of
    /// the difference, `output_travel` the measured output's in counts. Returns the travel of the output in use
    /// [counts].
    #[cold]
    fn advance_output_in_use<T: Real>(
        &mut self,
        table: &CountTable<T>,
        motor: CountChange,
        by: i64,
        output_travel: i32,
    ) -> i32 {
        if let Some(suspicion) = &mut self.suspicion {
            suspicion.travel = suspicion.travel.wrapping_add(by);
        }
        let is_followed = self.suspicion.is_none() && matches!(motor, CountChange::By(_));
        match self.implied {
            Some(_) if is_followed => self.advance_implied(table, by),
            Some(_) => 0,
            None => output_travel,
        }
    }

    /// Excludes the motor encoder; `last` is its advance in this period, which preceded the exclusion.
    pub fn suspend_motor<T: Real>(&mut self, table: &CountTable<T>, last: CountChange) {
        if self.suspicion.is_none() {
            let by =
                if let CountChange::Jumped(by) = last { i64::from(by).wrapping_mul(table.motor_weight) } else { 0 };
            self.suspicion = Some(Suspicion { difference: self.difference.wrapping_sub(by), travel: by });
        }
    }

    /// Resolves the ambiguity of whole raw ranges of an excluded motor encoder: chooses the position nearest to the
    /// position implied by the output or, without an output encoder, to the motor's last position.
    pub fn resolve_motor_position<T: Real>(&mut self, table: &CountTable<T>) {
        let Some(Suspicion { difference, travel }) = self.suspicion else { return };
        let offset = if self.implied.is_some() { travel } else { self.difference.wrapping_sub(difference) };
        let correction = nearest_range_multiple(offset, &table.motor, table.motor_weight).wrapping_neg();
        self.motor.turn(&table.motor, correction);
        let correction = correction.wrapping_mul(table.motor_weight);
        self.difference = self.difference.wrapping_add(correction);
        self.suspicion = Some(Suspicion { difference, travel: travel.wrapping_add(correction) });
    }

    /// Readmits the motor encoder at its found position. An encoder that slipped by `slipped` units of the difference
    /// continues from the motor's position.
    pub fn readmit_motor<T: Real>(&mut self, table: &CountTable<T>, slipped: i64) {
        let Some(Suspicion { travel, .. }) = self.suspicion.take() else { return };
        let counts = quotient(slipped, table.motor_weight).unwrap_or(0);
        if counts != 0 {
            let by = counts.wrapping_mul(table.motor_weight);
            self.motor.turn(&table.motor, counts.wrapping_neg());
            self.shift_origin(table, by);
        }
        if self.implied.is_some() {
            self.advance_implied(table, travel);
        }
    }

    /// Shifts the origin of the difference by the units of an encoder slip.
    fn shift_origin<T: Real>(&mut self, table: &CountTable<T>, by: i64) {
        self.start = floor_mod(self.start.wrapping_add(by), table.modulus);
        self.difference = self.difference.wrapping_sub(by);
    }

    /// Handles a jump of the output, which excludes its encoder: the implied output continues from the last position.
    /// Among the positions that whole raw ranges leave open, the measured output takes the position nearest to the
    /// implied output. Returns the travel of the measured output [counts].
    #[cold]
    fn follow_output_jump<T: Real>(&mut self, table: &CountTable<T>, by: i32) -> i32 {
        self.output.advance(&table.output, by.wrapping_neg());
        let (_, implied) = *self.implied.get_or_insert((self.output, self.difference));
        let offset =
            i64::from(by).wrapping_mul(table.output_weight).wrapping_sub(self.difference).wrapping_add(implied);
        let travel =
            i64::from(by).wrapping_sub(nearest_range_multiple(offset, &table.output, table.output_weight)) as i32;
        self.output.advance(&table.output, travel);
        travel
    }

    /// Sets the start when both encoders have given a first reading.
    #[cold]
    fn set_start<T: Real>(&mut self, table: &CountTable<T>) {
        let absolute = i64::from(self.motor.place)
            .wrapping_mul(table.motor_weight)
            .wrapping_sub(i64::from(self.output.place).wrapping_mul(table.output_weight));
        let reference = core::mem::replace(&mut self.start, floor_mod(absolute, table.modulus));
        self.difference = 0;
        if self.has_reference {
            self.set_reference(reference, table);
        }
    }

    /// Advances the implied output with the motor and returns its travel [counts].
    fn advance_implied<T: Real>(&mut self, table: &CountTable<T>, by: i64) -> i32 {
        let Some((implied, remainder)) = &mut self.implied else { return 0 };
        let sum = remainder.wrapping_add(by);
        let counts = quotient(sum, table.output_weight).unwrap_or(0);
        *remainder = sum.wrapping_sub(counts.wrapping_mul(table.output_weight));
        implied.advance(&table.output, counts as i32);
        counts as i32
    }

    /// Refers the difference to saved zeros of the encoders, as far as whole turns leave the zeros open.
    pub fn set_reference<T: Real>(&mut self, reference: i64, table: &CountTable<T>) {
        self.has_reference = true;
        if self.output.began {
            let offset = floor_mod(self.start.wrapping_sub(reference), table.modulus);
            let offset = if offset > half(table.modulus) { offset - table.modulus } else { offset };
            self.difference = self.difference.wrapping_add(offset);
        }
        self.start = reference;
    }

    /// Replaces the output by the output implied by the motor, starting at the measured position.
    pub fn imply_output(&mut self) {
        if self.implied.is_none() {
            self.implied = Some((self.output, self.difference));
        }
    }

    /// Returns to the measured output. An encoder that slipped by `slipped` units of the difference continues from the
    /// link's position.
    pub fn readmit_output<T: Real>(&mut self, table: &CountTable<T>, slipped: i64) {
        self.implied = None;
        let counts = quotient(slipped, table.output_weight).unwrap_or(0);
        if counts != 0 {
            let by = counts.wrapping_mul(table.output_weight);
            self.output.turn(&table.output, counts);
            self.shift_origin(table, by);
        }
    }

    /// Returns the output in use and its difference.
    pub fn output_in_use(&self) -> (&Counter, i64) {
        match &self.implied {
            Some((implied, remainder)) => (implied, *remainder),
            None => (&self.output, self.difference),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Encoder of 1000 counts per turn that moves by at most 100 counts per period.
    fn encoder() -> EncoderTable<f32> {
        EncoderTable {
            turn: 1000,
            wraps_at: 1000,
            last: 999,
            phase: u64::MAX / 1000,
            fastest: 100,
            angle: 6.283e-3,
            fraction: 1e-3,
            turns: 0.159,
        }
    }

    fn began(raw: u32) -> (Counter, EncoderTable<f32>) {
        let (mut counter, table) = (Counter::default(), encoder());
        assert_eq!(counter.read(&table, raw), CountChange::First);
        (counter, table)
    }

    #[test]
    fn shortest_difference_wraps_either_way() {
        let table = encoder();
        assert_eq!(shortest_difference(10, 990, &table), 20);
        assert_eq!(shortest_difference(990, 10, &table), -20);
        assert_eq!(shortest_difference(499, 0, &table), 499);
        let wide = EncoderTable { wraps_at: 0, last: u32::MAX, ..table };
        assert_eq!(shortest_difference(5, u32::MAX, &wide), 6);
    }

    #[test]
    fn travel_at_limit_is_accepted() {
        let (mut counter, table) = began(0);
        assert_eq!(counter.read(&table, table.fastest), CountChange::By(100));
        assert_eq!(counter.read(&table, 0), CountChange::By(-100));
        assert_eq!(counter.read(&table, table.fastest + 1), CountChange::Implausible);
        assert_eq!(counter.place(), 0);
    }

    #[test]
    fn distant_reading_repeated_is_jump() {
        let (mut counter, table) = began(0);
        for _ in 0..COUNTS.rejections_before_jump {
            assert_eq!(counter.read(&table, 450), CountChange::Implausible);
        }
        assert_eq!(counter.read(&table, 450), CountChange::Jumped(450));
        assert_eq!(counter.place(), 450);
    }

    #[test]
    fn reading_after_rejection_may_be_farther() {
        let (mut counter, table) = began(0);
        assert_eq!(counter.read(&table, 300), CountChange::Implausible);
        assert_eq!(counter.read(&table, 2 * table.fastest), CountChange::By(200));
    }

    #[test]
    fn position_counts_turns_either_way() {
        let (mut counter, table) = began(950);
        counter.read(&table, 20);
        assert_eq!((counter.turns(), counter.place()), (1, 20));
        counter.read(&table, 980);
        assert_eq!((counter.turns(), counter.place()), (0, 980));
    }

    #[test]
    fn raw_count_out_of_range_is_reduced() {
        let (mut counter, table) = began(10);
        assert_eq!(counter.read(&table, 1015), CountChange::By(5));
        assert_eq!(counter.read(&EncoderTable { wraps_at: 0, ..table }, 1020), CountChange::Implausible);
    }

    #[test]
    fn range_multiple_is_nearest() {
        let table = encoder();
        assert_eq!(nearest_range_multiple(2 * 1499, &table, 2), 1000);
        assert_eq!(nearest_range_multiple(2 * 1500, &table, 2), 2000);
        assert_eq!(nearest_range_multiple(-2 * 600, &table, 2), -1000);
    }
}
