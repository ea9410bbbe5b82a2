//! A joint run by a scheme, one fixed step at a time, in the units of the plant.

use core::array;

use model_core::numbers::Real;

use crate::clock::{Clock, StepPhases};
use crate::forces::{Always, ForceLaw, Push, PushOnly, Smooth, SmoothPush};
use crate::instant::{Instant, PerMesh};
use crate::motion::{Coordinates, PeerState};
use crate::plant::{Law, Plant};
use crate::scheme::{Phases, Scheme};

/// Joint and scheme.
#[derive(Debug, Clone)]
pub struct Peer<'a, T: Real, const N: usize, S> {
    plant: &'a Plant<T, N>,
    scheme: S,
    push: Push<T>,
    clock: Clock<T>,
    motion: PeerState<T, N>,
}

/// Initial state.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Start<T: Real, const N: usize> {
    /// Sun-planet deflections d (errors subtracted), gap and wind-up.
    pub position: Coordinates<T, N>,
    /// Rates of the coordinates.
    pub rate: Coordinates<T, N>,
    /// Angle of the rigid carrier [2^-64 turns].
    pub rigid_place: u64,
    /// Speed of the rigid carrier [2^-64 turns a step].
    pub rigid_speed: i64,
}

impl<'a, T: Real, const N: usize, S: Scheme<T, N>> Peer<'a, T, N, S> {
    /// Joint at a start, without torques.
    pub fn new(plant: &'a Plant<T, N>, start: &Start<T, N>) -> Self {
        let clock = Clock::new(plant, start.rigid_place, start.rigid_speed);
        let instant = Instant::at(plant, clock.now());
        let mut motion = PeerState { position: start.position, rate: start.rate };
        for i in 0..N {
            motion.position.planets[i] += instant.error[0][i];
            motion.rate.planets[i] += instant.error_rate[0][i];
        }
        let push = Push { sun: T::ZERO, carrier: T::ZERO, link: T::ZERO };
        Self { plant, scheme: S::begin(plant, clock.now()), push, clock, motion }
    }

    /// Sets the torques [N m].
    pub fn set_torques(&mut self, drive: T, load: T) {
        let gains = &self.plant.gains;
        self.push = Push { sun: gains.sun * drive, carrier: -(gains.carrier * load), link: -(gains.link * load) };
        self.clock.set_torques(self.plant, drive, load);
        self.scheme.set_torques(self.plant, &self.push);
    }

    /// Advances by one step.
    pub fn step(&mut self) {
        match (self.plant.compliant, self.plant.law) {
            (false, Law::Always) => self.step_under::<Always, false>(),
            (false, Law::Push) => self.step_under::<PushOnly, false>(),
            (false, Law::Smooth) => self.step_under::<Smooth, false>(),
            (false, Law::SmoothPush) => self.step_under::<SmoothPush, false>(),
            (true, Law::Always) => self.step_under::<Always, true>(),
            (true, Law::Push) => self.step_under::<PushOnly, true>(),
            (true, Law::Smooth) => self.step_under::<Smooth, true>(),
            (true, Law::SmoothPush) => self.step_under::<SmoothPush, true>(),
        }
    }

    #[inline(always)]
    fn step_under<L: ForceLaw<T>, const COMPLIANT: bool>(&mut self) {
        let start = *self.clock.now();
        let StepPhases { middle, end } = match S::MIDDLE {
            true => self.clock.advance::<true, N>(self.plant),
            false => self.clock.advance::<false, N>(self.plant),
        };
        let phases = Phases { start: &start, middle: &middle, end: &end };
        self.scheme.advance::<L, COMPLIANT>(self.plant, &self.push, &phases, &mut self.motion);
    }

    /// Present motion.
    pub fn motion(&self) -> &PeerState<T, N> {
        &self.motion
    }

    /// Phase and, where it determines the phase, the rigid carrier.
    pub fn clock(&self) -> &Clock<T> {
        &self.clock
    }

    /// Present mesh deflections: sun-planet of every planet, then ring-planet.
    pub fn deflections(&self) -> PerMesh<T, N> {
        let position = &self.motion.position;
        let error = Instant::at(self.plant, self.clock.now()).error;
        let sun = array::from_fn(|i| position.planets[i] - error[0][i]);
        let ring = array::from_fn(|i| position.gap - position.planets[i] - error[1][i]);
        [sun, ring]
    }
}
