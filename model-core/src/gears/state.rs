//! What the step carries from tick to tick: the dimensionless relative motion, the rigid body in whole numbers, and
//! the mesh phase. Nothing here is derived from something else that is also here.

use core::array;

use crate::gears::equivalent::Point;
use crate::gears::excitation::{PhaseHarmonics, Phasor, mesh_phase_advance};
use crate::gears::tables::{Rigid, Tables};
use crate::numbers::Real;
use crate::numbers::digest::{self, chain};

/// Relative coordinates, or their rates or accelerations, in units of b_c.
///
/// They are the paper's X (eqs 16, 17) with the imposed errors left out: X_spi = planets[i] - e_spi / b_c. Moving the
/// errors from the coordinates to the meshes removes their second derivative from the equations.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Relative<T, const N: usize> {
    /// u_s - u_pi - u_c of every planet.
    pub planets: [T; N],
    /// u_s - 2 u_c.
    pub gap: T,
    /// u_c - u_l; stays zero without compliance.
    pub wind_up: T,
}

impl<T: Real, const N: usize> Relative<T, N> {
    /// All zero.
    pub const ZERO: Self = Self { planets: [T::ZERO; N], gap: T::ZERO, wind_up: T::ZERO };

    /// self + scale * other.
    #[inline]
    pub fn plus(&self, scale: T, other: &Self) -> Self {
        Self {
            planets: array::from_fn(|i| self.planets[i] + scale * other.planets[i]),
            gap: self.gap + scale * other.gap,
            wind_up: self.wind_up + scale * other.wind_up,
        }
    }

    /// Whether its canonical form is known to be itself. The wind-up is zero in joints without compliance.
    #[inline(always)]
    fn is_ordinary(&self) -> bool {
        self.gap.is_ordinary()
            && (self.wind_up.is_ordinary() || self.wind_up.bits() == 0)
            && self.planets.iter().all(|planet| planet.is_ordinary())
    }

    /// The canonical form of every number, which no floating-point mode changes: none so small that it may be flushed to
    /// zero, and one NaN for all that is not finite.
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

/// Position and rate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Motion<T, const N: usize> {
    /// Relative coordinates.
    pub position: Relative<T, N>,
    /// Their rates.
    pub rate: Relative<T, N>,
}

/// Position and rate where a state keeps them: what moves a motion in place.
#[derive(Debug)]
pub struct MotionInPlace<'a, T, const N: usize> {
    /// Relative coordinates.
    pub position: &'a mut Relative<T, N>,
    /// Their rates.
    pub rate: &'a mut Relative<T, N>,
}

/// The decoupled rigid motion, as carrier angle. Whole numbers: it neither drifts nor loses digits over any number of
/// turns, and wraps exactly.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct RigidBody {
    /// Whole turns of the carrier.
    pub turns: i32,
    /// The rest, in 2^-64 turns.
    pub fraction: u64,
    /// Speed in 2^-64 turns a tick.
    pub speed: i64,
}

impl RigidBody {
    /// At rest at angle zero.
    pub const REST: Self = Self { turns: 0, fraction: 0, speed: 0 };

    /// One tick under constant torques (exact: x += v + a/2, v += a); returns its travel, in 2^-64 turns.
    #[inline]
    pub fn advance<T: Real>(&mut self, table: &Rigid<T>, drive: T, load: T) -> i64 {
        let change = (table.drive * drive - table.load * load).to_i64();
        let travel = self.speed.saturating_add(change >> 1);
        self.speed = self.speed.saturating_add(change);
        let (fraction, carried) = self.fraction.overflowing_add(travel as u64);
        self.fraction = fraction;
        // Adding a negative travel as a whole number of 2^64 carries unless a turn is left behind.
        self.turns = match (travel < 0, carried) {
            (false, true) => self.turns.wrapping_add(1),
            (true, false) => self.turns.wrapping_sub(1),
            _ => self.turns,
        };
        travel
    }
}

/// The whole state.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct State<T, const N: usize> {
    /// Relative coordinates.
    pub position: Relative<T, N>,
    /// Their rates, in b_c omega_n.
    pub rate: Relative<T, N>,
    /// Rigid motion.
    pub rigid: RigidBody,
    /// Mesh phase of the `time` mode in 2^-64 periods; unused in `angle` mode.
    pub phase: u64,
}

impl<T: Real, const N: usize> State<T, N> {
    /// At rest, undeformed, at angle and phase zero.
    pub const REST: Self = Self { position: Relative::ZERO, rate: Relative::ZERO, rigid: RigidBody::REST, phase: 0 };

    /// A state with given mesh deflections and rates (eqs 16 and 17: sun-planet deflections, and the gap u_s - 2 u_c),
    /// in units of b_c and b_c omega_n, and a carrier speed [rad/s], at angle and phase zero. For tests and scenarios;
    /// the imposed errors are added here.
    pub fn from_deflections(
        tables: &Tables<T, N>,
        deflections: &Relative<T, N>,
        rates: &Relative<T, N>,
        carrier_speed: T,
    ) -> Self {
        let speed = carrier_speed.over(tables.units.carrier_speed).to_i64();
        Self::with_rigid_body(tables, deflections, rates, RigidBody { speed, ..RigidBody::REST })
    }

    /// The same with the rigid body at any angle.
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

    /// Moves an equivalent gear's gap: its planet without mass is in the middle. Canonical as every state is.
    #[inline]
    pub(super) fn set_gap(&mut self, gap: Point<T>) {
        let (position, rate) = (gap.position.canonical(), gap.rate.canonical());
        (self.position.gap, self.rate.gap) = (position, rate);
        (self.position.planets, self.rate.planets) = ([T::HALF * position; N], [T::HALF * rate; N]);
    }

    /// Position and rate apart from the rest.
    #[inline(always)]
    pub(super) fn motion(&mut self) -> MotionInPlace<'_, T, N> {
        MotionInPlace { position: &mut self.position, rate: &mut self.rate }
    }

    /// Brings every number into its canonical form, so that the next tick does not depend on the floating-point mode.
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

    /// Neither infinite nor NaN anywhere.
    pub fn is_finite(&self) -> bool {
        self.position.is_finite() && self.rate.is_finite()
    }

    /// Digest of every bit of the state.
    pub fn digest(&self) -> u64 {
        let motion = self.rate.digest(self.position.digest(digest::START));
        let RigidBody { turns, fraction, speed } = self.rigid;
        [turns as u64, fraction, speed as u64, self.phase].into_iter().fold(motion, chain)
    }
}
