//! A steppable model, and one run of it under changing torques and restarts, identical on host and board.

use model_core::gears::{Model, State, Torques};
use model_core::numbers::{Real, digest};

use crate::peer::{Peer, Start};
use crate::plant::Plant;
use crate::scheme::Scheme;
use crate::two_mass::{TwoMass, TwoMassPeer};

/// Model that moves in steps.
pub trait SteppedModel<T> {
    /// Resets the model to start number `count`; does nothing if there is none.
    fn restart(&mut self, count: usize);
    /// Sets the torques [N m].
    fn set_torques(&mut self, drive: T, load: T);
    /// Advances by one step.
    fn step(&mut self);
    /// Digest over the state.
    fn digest(&self) -> u64;
}

/// The core, with the scheme of its tables.
pub struct Core<'a, T: Real, const N: usize> {
    /// The model.
    pub model: Model<'a, T, N>,
    starts: &'a [State<T, N>],
    torques: Torques<T>,
}

/// Joint with a scheme.
pub struct GearedJoint<'a, T: Real, const N: usize, S> {
    /// The joint.
    pub peer: Peer<'a, T, N, S>,
    plant: &'a Plant<T, N>,
    starts: &'a [Start<T, N>],
}

/// Two-mass gap model.
pub struct GapModel<'a, T: Real> {
    /// The model.
    pub peer: TwoMassPeer<'a, T>,
    model: &'a TwoMass<T>,
    starts: &'a [[T; 2]],
}

impl<'a, T: Real, const N: usize> Core<'a, T, N> {
    /// Core at the first of its starts.
    pub fn new(model: Model<'a, T, N>, starts: &'a [State<T, N>]) -> Self {
        let mut core = Self { model, starts, torques: Torques { drive: T::ZERO, load: T::ZERO } };
        core.restart(0);
        core
    }
}

impl<'a, T: Real, const N: usize, S: Scheme<T, N>> GearedJoint<'a, T, N, S> {
    /// Joint at the first of its starts; `None` without starts.
    pub fn new(plant: &'a Plant<T, N>, starts: &'a [Start<T, N>]) -> Option<Self> {
        Some(Self { peer: Peer::new(plant, starts.first()?), plant, starts })
    }
}

impl<'a, T: Real> GapModel<'a, T> {
    /// Model at the first of its starts: displacements and their rates.
    pub fn new(model: &'a TwoMass<T>, starts: &'a [[T; 2]]) -> Self {
        let mut gap = Self { peer: TwoMassPeer::new(model, T::ZERO, T::ZERO), model, starts };
        gap.restart(0);
        gap
    }
}

impl<T: Real, const N: usize> SteppedModel<T> for Core<'_, T, N> {
    fn restart(&mut self, count: usize) {
        if let Some(start) = self.starts.get(count) {
            self.model.set_state(*start);
        }
    }

    fn set_torques(&mut self, drive: T, load: T) {
        self.torques = Torques { drive, load };
    }

    #[inline(always)]
    fn step(&mut self) {
        self.model.step(self.torques);
    }

    fn digest(&self) -> u64 {
        self.model.state_digest()
    }
}

impl<T: Real, const N: usize, S: Scheme<T, N>> SteppedModel<T> for GearedJoint<'_, T, N, S> {
    fn restart(&mut self, count: usize) {
        if let Some(start) = self.starts.get(count) {
            self.peer = Peer::new(self.plant, start);
        }
    }

    fn set_torques(&mut self, drive: T, load: T) {
        self.peer.set_torques(drive, load);
    }

    #[inline(always)]
    fn step(&mut self) {
        self.peer.step();
    }

    fn digest(&self) -> u64 {
        self.peer.motion().digest()
    }
}

impl<T: Real> SteppedModel<T> for GapModel<'_, T> {
    fn restart(&mut self, count: usize) {
        if let Some([place, rate]) = self.starts.get(count) {
            self.peer = TwoMassPeer::new(self.model, *place, *rate);
        }
    }

    fn set_torques(&mut self, drive: T, load: T) {
        self.peer.set_torques(drive, load);
    }

    #[inline(always)]
    fn step(&mut self) {
        self.peer.step();
    }

    fn digest(&self) -> u64 {
        digest::chain(digest::START, self.peer.link_offset().bits())
    }
}

/// Number of steps, restarts and torque changes (drive, load), each before a step and in order.
pub struct StepSchedule<R, C> {
    /// Number of steps.
    pub steps: u64,
    /// Steps before which the model restarts.
    pub restarts: R,
    /// Steps before which the torques change, and the torques.
    pub changes: C,
}

/// Runs a model through a schedule. `look` is called before each step and after the last, before any change there; `step` takes a step. The
/// digest is over the last state, and the last before every restart.
pub fn follow<T: Real, M: SteppedModel<T>>(
    moving: &mut M,
    schedule: StepSchedule<impl Iterator<Item = u64>, impl Iterator<Item = (u64, T, T)>>,
    mut look: impl FnMut(&M),
    mut step: impl FnMut(&mut M),
) -> u64 {
    let (mut restarts, mut changes) = (schedule.restarts.zip(1..).peekable(), schedule.changes.peekable());
    let mut torques = (T::ZERO, T::ZERO);
    let mut digest = digest::START;
    for now in 0..=schedule.steps {
        look(moving);
        while let Some((_, count)) = restarts.next_if(|restart| restart.0 <= now) {
            digest = digest::chain(digest, moving.digest());
            moving.restart(count);
            moving.set_torques(torques.0, torques.1);
        }
        while let Some((_, drive, load)) = changes.next_if(|change| change.0 <= now) {
            moving.set_torques(drive, load);
            torques = (drive, load);
        }
        if now < schedule.steps {
            step(moving);
        }
    }
    digest::chain(digest, moving.digest())
}
