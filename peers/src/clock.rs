//! The mesh phase from step to step: prescribed in time, or made by the rigid carrier's angle. Whole numbers, so that
//! it neither drifts nor loses digits; the rigid motion under constant torques is exact.

use model_core::real::Real;
use model_core::realtime::phase::sine_cosine;

use crate::instant::Rotor;
use crate::plant::Plant;

/// Phase, and the rigid body where it makes the phase.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Clock<T> {
    /// Mesh phase [2^-64 periods] if prescribed, else rigid carrier angle [2^-64 turns].
    place: u64,
    /// Rigid carrier speed [2^-64 turns a step].
    speed: i64,
    /// Its change a step under the present torques.
    change: i64,
    /// Whether the carrier's angle makes the phase.
    angle: bool,
    rotor: Rotor<T>,
}

/// Phase in the middle and at the end of a step.
pub struct Ahead<T> {
    /// In the middle.
    pub middle: Rotor<T>,
    /// At the end.
    pub end: Rotor<T>,
}

impl<T: Real> Clock<T> {
    /// At phase and angle zero, the rigid carrier at a speed in 2^-64 turns a step.
    pub fn new<const N: usize>(plant: &Plant<T, N>, speed: i64) -> Self {
        let mut clock = Self {
            place: 0,
            speed,
            change: 0,
            angle: plant.phase.periods_per_turn != 0,
            rotor: Rotor { sine: T::ZERO, cosine: T::ONE, rate: plant.phase.rate },
        };
        if clock.angle {
            clock.rotor.rate = rate(plant, speed);
        }
        clock
    }

    /// Phase now.
    pub fn now(&self) -> &Rotor<T> {
        &self.rotor
    }

    /// Angle of the rigid carrier [2^-64 turns], where it makes the phase.
    pub fn carrier(&self) -> Option<u64> {
        self.angle.then_some(self.place)
    }

    /// Takes torques [N m].
    pub fn set_torques<const N: usize>(&mut self, plant: &Plant<T, N>, drive: T, load: T) {
        self.change = (plant.gains.rigid[0] * drive - plant.gains.rigid[1] * load).to_i64();
    }

    /// Goes on by a step; `MIDDLE` says whether the middle is wanted, else it is the end again.
    #[inline(always)]
    pub fn advance<const MIDDLE: bool, const N: usize>(&mut self, plant: &Plant<T, N>) -> Ahead<T> {
        let phase = &plant.phase;
        let start = self.rotor;
        if !self.angle {
            self.place = self.place.wrapping_add(phase.step);
            let (sine, cosine) = sine_cosine((self.place >> 32) as u32);
            self.rotor = Rotor { sine, cosine, rate: phase.rate };
            if !MIDDLE {
                return Ahead { middle: self.rotor, end: self.rotor };
            }
            let [half_sine, half_cosine] = phase.half_turn;
            let middle = Rotor {
                sine: start.sine * half_cosine + start.cosine * half_sine,
                cosine: start.cosine * half_cosine - start.sine * half_sine,
                rate: phase.rate,
            };
            return Ahead { middle, end: self.rotor };
        }
        let at = |place: u64| sine_cosine((place.wrapping_mul(phase.periods_per_turn.into()) >> 32) as u32);
        let half = (self.speed >> 1).wrapping_add(self.change >> 3);
        let mid_place = self.place.wrapping_add(half as u64);
        let way = self.speed.wrapping_add(self.change >> 1);
        self.place = self.place.wrapping_add(way as u64);
        self.speed = self.speed.wrapping_add(self.change);
        let (sine, cosine) = at(self.place);
        self.rotor = Rotor { sine, cosine, rate: rate(plant, self.speed) };
        if !MIDDLE {
            return Ahead { middle: self.rotor, end: self.rotor };
        }
        let (sine, cosine) = at(mid_place);
        let middle = Rotor { sine, cosine, rate: T::HALF * (start.rate + self.rotor.rate) };
        Ahead { middle, end: self.rotor }
    }
}

/// Phase rate at a rigid speed.
#[inline(always)]
fn rate<T: Real, const N: usize>(plant: &Plant<T, N>, speed: i64) -> T {
    // A step goes far less than half a turn, so that the upper half of the speed fits.
    plant.phase.rate * T::from_i32((speed >> 32) as i32)
}
