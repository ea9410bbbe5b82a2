//! Mesh phase from step to step: prescribed in time, or derived from the rigid carrier's angle. Integers, so that it neither drifts nor
//! loses digits; the rigid motion under constant torques is exact.

use model_core::numbers::Real;
use model_core::numbers::phase::sine_cosine;

use crate::instant::Rotor;
use crate::plant::Plant;

/// Mesh phase, and the rigid body where its angle determines the phase.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Clock<T> {
    /// Mesh phase [2^-64 periods] if prescribed, else rigid carrier angle [2^-64 turns].
    place: u64,
    /// Rigid carrier speed [2^-64 turns a step].
    speed: i64,
    /// Change of the speed per step under the present torques.
    change: i64,
    /// True if the carrier's angle determines the phase.
    angle: bool,
    rotor: Rotor<T>,
    /// Steps since the rotor was last computed from the phase.
    since: u32,
}

/// Steps by which a prescribed phase is rotated before it is recomputed: rounding is still below a millionth.
const RECOMPUTE_STEPS: u32 = 8;

/// Mesh phase in the middle and at the end of a step.
pub struct StepPhases<T> {
    /// In the middle.
    pub middle: Rotor<T>,
    /// At the end.
    pub end: Rotor<T>,
}

impl<T: Real> Clock<T> {
    /// Clock at phase zero; where the rigid carrier determines the phase, at its angle [2^-64 turns] and speed [2^-64 turns a step].
    pub fn new<const N: usize>(plant: &Plant<T, N>, place: u64, speed: i64) -> Self {
        let mut clock = Self {
            place: 0,
            speed,
            change: 0,
            angle: plant.phase.periods_per_turn != 0,
            rotor: Rotor { sine: T::ZERO, cosine: T::ONE, rate: plant.phase.rate },
            since: 0,
        };
        if clock.angle {
            clock.place = place;
            clock.rotor = rotor_at(plant, place, speed);
        }
        clock
    }

    /// Present phase.
    pub fn now(&self) -> &Rotor<T> {
        &self.rotor
    }

    /// Angle of the rigid carrier [2^-64 turns], if it determines the phase.
    pub fn carrier(&self) -> Option<u64> {
        self.angle.then_some(self.place)
    }

    /// Sets the torques [N m].
    pub fn set_torques<const N: usize>(&mut self, plant: &Plant<T, N>, drive: T, load: T) {
        self.change = (plant.gains.rigid[0] * drive - plant.gains.rigid[1] * load).to_i64();
    }

    /// Advances by a step. Without `MIDDLE` the middle of the result is meaningless.
    #[inline(always)]
    pub fn advance<const MIDDLE: bool, const N: usize>(&mut self, plant: &Plant<T, N>) -> StepPhases<T> {
        let phase = &plant.phase;
        let start = self.rotor;
        if !self.angle {
            self.place = self.place.wrapping_add(phase.step);
            let middle = if MIDDLE { rotated(&start, phase.half_turn) } else { start };
            self.since += 1;
            if self.since < RECOMPUTE_STEPS {
                self.rotor = rotated(&start, phase.turn);
            } else {
                self.since = 0;
                let (sine, cosine) = sine_cosine((self.place >> 32) as u32);
                self.rotor = Rotor { sine, cosine, rate: phase.rate };
            }
            return StepPhases { middle, end: self.rotor };
        }
        let half = (self.speed >> 1).wrapping_add(self.change >> 3);
        let mid_place = self.place.wrapping_add(half as u64);
        let way = self.speed.wrapping_add(self.change >> 1);
        self.place = self.place.wrapping_add(way as u64);
        self.speed = self.speed.wrapping_add(self.change);
        self.rotor = rotor_at(plant, self.place, self.speed);
        if !MIDDLE {
            return StepPhases { middle: self.rotor, end: self.rotor };
        }
        let (sine, cosine) = at(plant, mid_place);
        let middle = Rotor { sine, cosine, rate: T::HALF * (start.rate + self.rotor.rate) };
        StepPhases { middle, end: self.rotor }
    }
}

/// Rotor advanced by an angle given by its sine and cosine.
#[inline(always)]
fn rotated<T: Real>(rotor: &Rotor<T>, [sine, cosine]: [T; 2]) -> Rotor<T> {
    Rotor {
        sine: rotor.sine * cosine + rotor.cosine * sine,
        cosine: rotor.cosine * cosine - rotor.sine * sine,
        rate: rotor.rate,
    }
}

/// Sine and cosine of the phase at an angle of the rigid carrier.
#[inline(always)]
fn at<T: Real, const N: usize>(plant: &Plant<T, N>, place: u64) -> (T, T) {
    sine_cosine((place.wrapping_mul(plant.phase.periods_per_turn.into()) >> 32) as u32)
}

/// Rotor at an angle and a speed of the rigid carrier.
#[inline(always)]
fn rotor_at<T: Real, const N: usize>(plant: &Plant<T, N>, place: u64, speed: i64) -> Rotor<T> {
    let (sine, cosine) = at(plant, place);
    Rotor { sine, cosine, rate: rate(plant, speed) }
}

/// Phase rate at a rigid speed.
#[inline(always)]
fn rate<T: Real, const N: usize>(plant: &Plant<T, N>, speed: i64) -> T {
    // A step covers far less than half a turn, so the upper half of the speed suffices.
    plant.phase.rate * T::from_i32((speed >> 32) as i32)
}
