//! State of the joint between ticks: dimensionless relative motion (S1), the rigid body in integers (S5), and the mesh
//! phase. The state has no redundant parts.
//!
//! Equations: (E6) in docs/theory/equivalent-gear.md.
//! Equations: (P9) in docs/theory/paper.md.

use core::array;

use crate::gears::equivalent::GapMotion;
use crate::gears::excitation::{PhaseHarmonics, Phasor, mesh_phase_advance};
use crate::gears::tables::{Rigid, Tables};
use crate::numbers::Real;
use crate::numbers::digest::{self, chain};
use crate::numbers::state_words::state_words;

/// Relative coordinates (S1), or their rates or accelerations, in units of b_c.
///
/// The paper's X (eqs 16, 17) includes the imposed errors: X_spi = planets[i] - e_spi / b_c. Moving the errors from the
/// coordinates to the meshes removes the errors' second derivative from the equations.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Relative<T, const N: usize> {
    /// u_s - u_pi - u_c of every planet.
    pub planets: [T; N],
    /// u_s - 2 u_c.
    pub gap: T,
    /// u_c - u_l; stays zero without compliance.
    pub wind_up: T,
}

state_words! { struct Relative<T, P> { planets, gap, wind_up } }

impl<T: Real, const N: usize> Relative<T, N> {
    /// Zero coordinates.
    pub const ZERO: Self = Self { planets: [T::ZERO; N], gap: T::ZERO, wind_up: T::ZERO };

    /// Returns `self + scale * other`.
    #[inline]
    pub fn plus(&self, scale: T, other: &Self) -> Self {
        Self {
            planets: array::from_fn(|i| self.planets[i] + scale * other.planets[i]),
            gap: self.gap + scale * other.gap,
            wind_up: self.wind_up + scale * other.wind_up,
        }
    }

    /// Returns true if every number is certainly in canonical form. A wind-up of zero (no compliance) passes.
    #[inline(always)]
    fn is_ordinary(&self) -> bool {
        self.gap.is_ordinary()
            && (self.wind_up.is_ordinary() || self.wind_up.bits() == 0)
            && self.planets.iter().all(|planet| planet.is_ordinary())
    }

    /// Brings every number into canonical form: values below `LEAST` become zero and non-finite values one NaN, so that no
    /// floating-point mode changes the result.
    #[inline]
    fn canonical(&self) -> Self {
        Self { planets: self.planets.map(T::canonical), gap: self.gap.canonical(), wind_up: self.wind_up.canonical() }
    }

    fn is_finite(&self) -> bool {
        self.planets.iter().all(|value| value.is_finite()) && self.gap.is_finite() && self.wind_up.is_finite()
    }

    fn digest(&self, running: u64) -> u64 {
        let planets = self.planets.iter().fold(running, |digest, value| chain(digest, value.bits()));
        chain(chain(planets, self.gap.bits()), self.wind_up.bits())
    }
}

/// Relative motion: position and rate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Motion<T, const N: usize> {
    /// Relative coordinates.
    pub position: Relative<T, N>,
    /// Rates of the relative coordinates.
    pub rate: Relative<T, N>,
}

/// Mutable references to position and rate within a state, to advance the motion in place.
#[derive(Debug)]
pub struct MotionInPlace<'a, T, const N: usize> {
    /// Relative coordinates.
    pub position: &'a mut Relative<T, N>,
    /// Rates of the relative coordinates.
    pub rate: &'a mut Relative<T, N>,
}

/// Decoupled rigid motion as carrier angle (S5). Integers keep the angle free of drift over any number of turns, and the
/// angle wraps exactly.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct RigidBody {
    /// Whole turns of the carrier.
    pub turns: i32,
    /// Fraction of a turn, in 2^-64 turns.
    pub fraction: u64,
    /// Speed in 2^-64 turns a tick.
    pub speed: i64,
}

state_words! { struct RigidBody { turns, fraction, speed } }

impl RigidBody {
    /// Rigid body at rest at angle zero.
    pub const REST: Self = Self { turns: 0, fraction: 0, speed: 0 };

    /// Advances by one tick under constant torques, exactly (S5); returns the travel in 2^-64 turns.
    #[inline]
    pub fn advance<T: Real>(&mut self, table: &Rigid<T>, drive: T, load: T) -> i64 {
        let change = (table.drive * drive - table.load * load).to_i64();
        let travel = self.speed.saturating_add(change >> 1);
        self.speed = self.speed.saturating_add(change);
        let (fraction, carried) = self.fraction.overflowing_add(travel as u64);
        self.fraction = fraction;
        // A negative travel is added modulo 2^64: the sum carries unless the angle falls below the current turn.
        self.turns = match (travel < 0, carried) {
            (false, true) => self.turns.wrapping_add(1),
            (true, false) => self.turns.wrapping_sub(1),
            _ => self.turns,
        };
        travel
    }
}

/// State of the joint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct State<T, const N: usize> {
    /// Relative coordinates.
    pub position: Relative<T, N>,
    /// Rates of the relative coordinates, in b_c omega_n.
    pub rate: Relative<T, N>,
    /// Rigid motion.
    pub rigid: RigidBody,
    /// Mesh phase of the `time` mode in 2^-64 periods; unused in `angle` mode.
    pub phase: u64,
}

state_words! { struct State<T, P> { position, rate, rigid, phase } }

impl<T: Real, const N: usize> State<T, N> {
    /// State at rest, undeformed, at angle and phase zero.
    pub const REST: Self = Self { position: Relative::ZERO, rate: Relative::ZERO, rigid: RigidBody::REST, phase: 0 };

    /// Creates a state from sun-planet deflections, gap u_s - 2 u_c and wind-up, their rates (in units of b_c and b_c omega_n)
    /// and a carrier speed [rad/s], at angle and phase zero. Adds the imposed errors. For tests and scenarios.
    pub fn from_deflections(
        tables: &Tables<T, N>,
        deflections: &Relative<T, N>,
        rates: &Relative<T, N>,
        carrier_speed: T,
    ) -> Self {
        let speed = (carrier_speed / tables.units.carrier_speed).to_i64();
        Self::with_rigid_body(tables, deflections, rates, RigidBody { speed, ..RigidBody::REST })
    }

    /// Creates a state from deflections and rates (see [`Self::from_deflections`]) with a given rigid body.
    pub fn with_rigid_body(
        tables: &Tables<T, N>,
        deflections: &Relative<T, N>,
        rates: &Relative<T, N>,
        rigid: RigidBody,
    ) -> Self {
        let mut state = Self { position: *deflections, rate: *rates, rigid, phase: 0 };
        let excitation = &tables.excitation;
        let phase = rigid.fraction.wrapping_mul(excitation.periods_per_turn.into());
        let phase_rate = excitation.rate * mesh_phase_advance(excitation, rigid.speed);
        let harmonics_now = PhaseHarmonics::<T, 0>::new(Phasor::at((phase >> 32) as u32), phase_rate, 1);
        for (i, mesh) in tables.meshes[0].iter().enumerate() {
            let imposed = mesh.at(&harmonics_now, T::ZERO, 1);
            state.position.planets[i] += imposed.error;
            state.rate.planets[i] += imposed.error_rate;
        }
        state
    }

    /// Sets the gap of an equivalent gear, in canonical form; the massless planet moves by half the gap.
    #[inline]
    pub(super) fn set_gap(&mut self, gap: GapMotion<T>) {
        let (position, rate) = (gap.position.canonical(), gap.rate.canonical());
        (self.position.gap, self.rate.gap) = (position, rate);
        (self.position.planets, self.rate.planets) = ([T::HALF * position; N], [T::HALF * rate; N]);
    }

    /// Borrows position and rate.
    #[inline(always)]
    pub(super) fn motion(&mut self) -> MotionInPlace<'_, T, N> {
        MotionInPlace { position: &mut self.position, rate: &mut self.rate }
    }

    /// Brings every number into canonical form, so that the next tick does not depend on the floating-point mode.
    #[inline(always)]
    pub(super) fn canonicalise(&mut self) {
        if !(self.position.is_ordinary() && self.rate.is_ordinary()) {
            self.canonicalise_each();
        }
    }

    #[inline(never)]
    fn canonicalise_each(&mut self) {
        (self.position, self.rate) = (self.position.canonical(), self.rate.canonical());
    }

    /// Returns true if no coordinate or rate is infinite or NaN.
    pub fn is_finite(&self) -> bool {
        self.position.is_finite() && self.rate.is_finite()
    }

    /// Returns a digest over every bit of the state.
    pub fn digest(&self) -> u64 {
        let motion = self.rate.digest(self.position.digest(digest::START));
        let RigidBody { turns, fraction, speed } = self.rigid;
        [turns as u64, fraction, speed as u64, self.phase].into_iter().fold(motion, chain)
    }
}
