//! Faults between a virtual joint and its controller: encoders that stand still, slip or scatter, readings that do not come,
//! a motor that gives another torque than it was asked for. What they are to prove, and faults of teeth, are left out.

use crate::numbers::Real;
use crate::numbers::arithmetic::clamp;
use crate::numbers::phase::sine_cosine;
use crate::numbers::random::splitmix64;
use crate::observer::{Reading, Samples};
use crate::virtual_joint::tables::SurroundingsTable;

/// Most faults of a run.
pub const MOST_UPSETS: usize = 8;

/// One fault.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Upset<T: Real> {
    /// First control period in which it acts.
    pub start: u32,
    /// First in which it acts no more.
    pub end: u32,
    /// Begins its random numbers.
    pub seed: u64,
    /// What goes wrong.
    pub kind: Kind<T>,
}

/// Which encoder.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shaft {
    /// The motor's.
    Motor,
    /// The link's.
    Link,
}

/// What goes wrong.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Kind<T: Real> {
    /// Counts stand still.
    Frozen(Shaft),
    /// Counts are off [2^-32 turns].
    Offset(Shaft, i32),
    /// Counts scatter: standard deviation [2^-32 turns].
    Noise(Shaft, u32),
    /// A part of the motion is not counted [2^-32], and stays uncounted afterwards.
    MissingCounts(Shaft, u32),
    /// An error that comes once a turn: amplitude [2^-32 turns].
    Eccentric(Shaft, T),
    /// Readings do not come, so many in 2^32.
    LostFrames(Shaft, u32),
    /// The motor gives so much beyond the command: a ratio of it, and a torque [N m].
    TorqueBias(T, T),
    /// The motor gives no more than this [N m].
    Saturation(T),
}

/// A fault with what it remembers.
#[derive(Debug, Clone, Copy)]
struct Active<T: Real> {
    upset: Upset<T>,
    random: u64,
    /// Angle when the encoder froze, and in the period before.
    held: Option<u32>,
    before: Option<u32>,
    /// Motion that was not counted, in 2^-32 of 2^-32 turns.
    lost: i64,
}

/// The faults of a run; none to begin with.
#[derive(Debug, Clone)]
pub struct Upsets<T: Real> {
    all: [Option<Active<T>>; MOST_UPSETS],
    period: u32,
    /// What the motor was asked for last: a motor that gives something else does not know it.
    asked: T,
    /// Last word of the motor's encoder.
    motor: Option<Reading>,
}

impl<T: Real> Default for Upsets<T> {
    fn default() -> Self {
        Self { all: [None; MOST_UPSETS], period: 0, asked: T::ZERO, motor: None }
    }
}

impl<T: Real> Upsets<T> {
    /// One more fault; `false` if there is no room.
    pub fn add(&mut self, upset: Upset<T>) -> bool {
        let Some(place) = self.all.iter_mut().find(|place| place.is_none()) else { return false };
        *place = Some(Active { upset, random: upset.seed, held: None, before: None, lost: 0 });
        true
    }

    /// What the controller sees of a period's samples; begins the period.
    pub fn sense(&mut self, samples: Samples<T>, table: &SurroundingsTable<T>) -> Samples<T> {
        let Self { all, period, asked, motor } = self;
        if all.iter().all(Option::is_none) {
            return samples;
        }
        let [of_motor, of_link] = &table.encoders;
        let output = samples.output;
        let mut seen =
            [(samples.motor, of_motor.shift, true), (output.unwrap_or_default(), of_link.shift, output.is_some())];
        for active in all.iter_mut().flatten() {
            let on = *period >= active.upset.start && *period < active.upset.end;
            for (shaft, (reading, shift, comes)) in [Shaft::Motor, Shaft::Link].into_iter().zip(&mut seen) {
                // Whole turns are 2^32, so that everything wraps by itself.
                let angle = reading.counts.checked_shl(*shift).unwrap_or(0);
                reading.counts = active.read(shaft, angle, on).checked_shr(*shift).unwrap_or(0);
                *comes &= !active.loses(shaft, on);
            }
        }
        let [(fresh, _, motor_comes), (output, _, output_comes)] = seen;
        if motor_comes || motor.is_none() {
            *motor = Some(fresh);
        }
        let motor = motor.unwrap_or(fresh);
        let limit = table.current.limit;
        Samples { motor, output: output_comes.then_some(output), torque: clamp(*asked, -limit, limit), ..samples }
    }

    /// What the motor makes of a command; ends the period.
    pub fn torque(&mut self, command: T) -> T {
        let period = self.period;
        self.period = period.saturating_add(1);
        self.asked = if command.is_finite() { command } else { T::ZERO };
        let acting =
            self.all.iter().flatten().filter(|active| period >= active.upset.start && period < active.upset.end);
        acting.fold(command, |torque, active| match active.upset.kind {
            Kind::TorqueBias(ratio, offset) => torque + torque * ratio + offset,
            Kind::Saturation(limit) => clamp(torque, -limit, limit),
            _ => torque,
        })
    }
}

impl<T: Real> Active<T> {
    /// What an encoder reads in place of its angle [2^-32 turns].
    fn read(&mut self, shaft: Shaft, angle: u32, on: bool) -> u32 {
        match self.upset.kind {
            Kind::Frozen(of) if of == shaft => {
                self.held = if on { self.held.or(Some(angle)) } else { None };
                self.held.unwrap_or(angle)
            }
            Kind::Offset(of, offset) if of == shaft && on => angle.wrapping_add(offset as u32),
            Kind::Noise(of, deviation) if of == shaft && on => {
                // Twelve even numbers from -1/2 to 1/2 have a variance of one: the quarters of three words, in 2^-16.
                let quarters = |word: u64| (0..4).map(move |place| i64::from((word >> (16 * place)) as i16));
                let sum: i64 = (0..3).flat_map(|_| quarters(splitmix64(&mut self.random))).sum();
                angle.wrapping_add((sum.wrapping_mul(deviation.into()) >> 16) as u32)
            }
            Kind::Eccentric(of, amplitude) if of == shaft && on => {
                angle.wrapping_add((amplitude * sine_cosine::<T>(angle).0).to_i64() as u32)
            }
            Kind::MissingCounts(of, share) if of == shaft => {
                let moved = angle.wrapping_sub(self.before.unwrap_or(angle)) as i32;
                self.before = Some(angle);
                if on {
                    self.lost = self.lost.wrapping_add(i64::from(moved).wrapping_mul(share.into()));
                }
                angle.wrapping_sub((self.lost >> 32) as u32)
            }
            _ => angle,
        }
    }

    /// Whether a reading does not come.
    fn loses(&mut self, shaft: Shaft, on: bool) -> bool {
        match self.upset.kind {
            Kind::LostFrames(of, share) if of == shaft && on => self.even() < share,
            _ => false,
        }
    }

    /// The upper half of a random word.
    fn even(&mut self) -> u32 {
        (splitmix64(&mut self.random) >> 32) as u32
    }
}
