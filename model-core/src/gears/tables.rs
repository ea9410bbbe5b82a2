//! Everything the fixed step needs, as plain numbers: the single doorway between the offline half (`design`, f64) and
//! the fast half (`model`, f32). Dimensionless (see `scales`) except where a unit stands.

use core::fmt;

use nalgebra::{ArrayStorage, SMatrix};

use crate::numbers::{Real, digest};
pub use parameters::DampingLaw;
use parameters::MAX_HARMONICS;

/// Tables of a joint with `N` planets at one tick rate.
#[derive(Debug, Clone, PartialEq)]
#[repr(C)]
pub struct Tables<T: Real, const N: usize> {
    /// Digest over all numbers below; the board checks it before it runs.
    pub digest: u64,
    /// Fixed steps a second [Hz].
    pub tick_rate: u32,
    /// How a tick is stepped.
    pub scheme: Scheme,
    /// Sub-steps of a tick in which contacts may change.
    pub substeps: u32,
    /// Half a sub-step over the tick.
    pub half_substep_share: T,
    /// A sub-step in dimensionless time, h omega_n / substeps.
    pub substep: T,
    /// 1/N.
    pub planet_share: T,
    /// Force law of the meshes once teeth part.
    pub damping_law: DampingLaw,
    /// Sharpness of eq. 13; zero stands for the sharp dead zone of eq. 12.
    pub sharpness: T,
    /// From SI to dimensionless and back.
    pub units: Units<T>,
    /// The rigid body.
    pub rigid: Rigid<T>,
    /// What a unit force does to each body.
    pub mobility: Mobility<T>,
    /// Mesh phase: its source and rate.
    pub excitation: Excitation<T>,
    /// Stiffness and damping common to the meshes of a kind: sun-planet, ring-planet.
    pub springs: [Spring<T>; 2],
    /// Each mesh: sun-planet of every planet, then ring-planet.
    pub meshes: [[MeshTable<T>; N]; 2],
    /// The joint in the sub-step's own units of time.
    pub stage: Stage<T>,
    /// Exponential flow of the closed joint over one tick (or one sub-step, for [`Scheme::PaperEtd1`]).
    pub flow: Flow<T>,
    /// Verlet sub-steps for light planets.
    pub verlet: VerletTable<T>,
}

/// Position-Verlet (leapfrog) sub-steps, in a unit of time in which a sub-step lasts one.
#[derive(Debug, Clone, PartialEq)]
#[repr(C)]
pub struct VerletTable<T: Real> {
    /// Sub-steps of a tick; zero where planets are not light.
    pub substeps: u32,
    /// Half their number.
    pub half_count: T,
    /// A sub-step in dimensionless time.
    pub substep: T,
    /// Its square.
    pub square: T,
    /// Its inverse.
    pub per_substep: T,
    /// Mobilities.
    pub mobility: Mobility<T>,
    /// Of the wind-up: carrier's and link's together.
    pub wind_up_mobility: T,
    /// What the wind-up's own acceleration adds to its damping force.
    pub wind_up_yield: T,
    /// Damping of the meshes of a kind.
    pub damping: [T; 2],
    /// Half of it: what the mesh's own acceleration adds to its damping force.
    pub half_damped: [T; 2],
    /// What curvature of the path adds to the mean deflection, for a unit of acceleration.
    pub curvature: T,
    /// A mesh is in contact throughout if its overlap in the middle exceeds its speed times (constant - stiffness
    /// times slope): half a sub-step and damping over stiffness, by which a mesh that parts loses contact early.
    pub release: [[T; 2]; 2],
}

/// The joint in units in which a sub-step lasts 1 and an acceleration is counted in sixths: so the weights of a step
/// are whole numbers, and those that are 1 cost nothing.
#[derive(Debug, Clone, PartialEq)]
#[repr(C)]
pub struct Stage<T: Real> {
    /// Sub-steps in a unit of dimensionless time, 1/h.
    pub rate: T,
    /// h^2 / 6: what turns a dimensionless acceleration into one of a stage.
    pub square_sixth: T,
    /// Mobilities times h^2 / 6; damping of the wind-up over h.
    pub mobility: Mobility<T>,
    /// Damping of sun-planet and ring-planet meshes over h.
    pub damping: [T; 2],
}

/// How a tick is stepped. Those for comparisons are no part of a board's image.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u32)]
pub enum Scheme {
    /// Exponential flow while the contact set holds over the tick; otherwise sub-steps with a fixed contact set,
    /// corrected for every crossing.
    Realtime,
    /// The paper's: one constant exponential, everything nonlinear held as a pseudo-force over the sub-step.
    #[cfg(feature = "design")]
    PaperEtd1,
    /// Classical Runge-Kutta on the full forces, for comparison.
    #[cfg(feature = "design")]
    RungeKutta4,
    /// Semi-implicit Euler on the full forces, likewise.
    #[cfg(feature = "design")]
    SemiImplicitEuler,
}

/// From SI to dimensionless and back.
#[derive(Debug, Clone, PartialEq)]
#[repr(C)]
pub struct Units<T: Real> {
    /// Dimensionless acceleration of the sun for each N m of drive torque.
    pub drive: T,
    /// Dimensionless deceleration of the carrier for each N m of load torque (no compliance).
    pub load_on_carrier: T,
    /// Dimensionless deceleration of the link for each N m of load torque (with compliance).
    pub load_on_link: T,
    /// Characteristic length b_c [m].
    pub length: T,
    /// Carrier speed for each 2^-64 turn a tick [rad/s].
    pub carrier_speed: T,
    /// Sun displacement beyond the rigid body's, for each unit of: any planet, gap, wind-up [rad].
    pub motor_offset: [T; 3],
    /// Link displacement beyond the rigid body's, likewise [rad].
    pub link_offset: [T; 3],
}

/// The rigid body: gains from torque to speed change a tick, in 2^-64 turns a tick.
#[derive(Debug, Clone, PartialEq)]
#[repr(C)]
pub struct Rigid<T: Real> {
    /// For each N m of drive torque.
    pub drive: T,
    /// For each N m of load torque.
    pub load: T,
}

/// Acceleration of each body under a unit force (all dimensionless).
#[derive(Debug, Clone, PartialEq)]
#[repr(C)]
pub struct Mobility<T: Real> {
    /// Sun with rotor.
    pub sun: T,
    /// One planet.
    pub planet: T,
    /// Carrier; with the link when there is no compliance.
    pub carrier: T,
    /// Link; zero without compliance.
    pub link: T,
    /// One with compliance, zero without: there the wind-up stays zero.
    pub wind_up: T,
    /// Stiffness between carrier and link.
    pub wind_up_stiffness: T,
    /// Damping between carrier and link.
    pub wind_up_damping: T,
}

/// Mesh phase: its source and rate.
#[derive(Debug, Clone, PartialEq)]
#[repr(C)]
pub struct Excitation<T: Real> {
    /// `time` mode: fraction of a mesh period that a tick adds, in 2^-64; zero in `angle` mode.
    pub phase_step: u64,
    /// `time` mode: mesh periods a tick in 2^-32, whole periods included; zero in `angle` mode.
    pub phase_advance: T,
    /// `angle` mode: ring teeth, mesh periods a carrier turn; zero in `time` mode.
    pub periods_per_turn: u32,
    /// Phase rate in radians a unit of dimensionless time, for each 2^-32 period a tick.
    pub rate: T,
    /// Harmonics of the stiffness wave in use.
    pub harmonics: u32,
}

/// Stiffness and damping of the meshes of one kind.
#[derive(Debug, Clone, PartialEq)]
#[repr(C)]
pub struct Spring<T: Real> {
    /// Mean stiffness.
    pub stiffness: T,
    /// Damping.
    pub damping: T,
}

/// One mesh.
#[derive(Debug, Clone, PartialEq)]
#[repr(C)]
pub struct MeshTable<T: Real> {
    /// Half-backlash b.
    pub half_backlash: T,
    /// Transmission error = sine * sin(phase) + cosine * cos(phase): [sine, cosine].
    pub error: [T; 2],
    /// Stiffness = mean + sum over harmonics of [sine, cosine] likewise.
    pub ripple: [[T; 2]; MAX_HARMONICS],
}

/// Exponential flow over a step: in-phase motion and the planets' deviations from their mean, which decouple.
///
/// In-phase state: mean planet, gap, wind-up, then their rates. Deviation state: deviation, rate. Transitions are
/// stored less the identity, which saves a digit in f32.
#[derive(Debug, Clone, PartialEq)]
#[repr(C)]
pub struct Flow<T: Real> {
    /// Over the whole step.
    pub whole: Transition<T>,
    /// Up to the first node within the step.
    pub early: Transition<T>,
    /// Up to the second node.
    pub late: Transition<T>,
    /// Input integrals up to the first node, of a pseudo-force linear through its value and its rate (a sub-step) at
    /// the start.
    pub early_inputs: [Inputs<T>; 2],
    /// Up to the second node, of a parabola: value and rate at the start, value at the first node.
    pub late_inputs: [Inputs<T>; 3],
    /// Over the whole step, of a cubic: value and rate at the start, values at both nodes.
    pub whole_inputs: [Inputs<T>; 4],
    /// Where the nodes are, as parts of the step.
    pub nodes: [T; 2],
    /// Up to the middle: for light planets, whose whole tick evaluates its pseudo-force there alone.
    pub half: Transition<T>,
    /// Input integrals up to the middle, of a constant pseudo-force.
    pub half_constant: Inputs<T>,
    /// Over the whole step, of a pseudo-force linear through its values at the start and in the middle.
    pub whole_linear: [Inputs<T>; 2],
    /// Pseudo-force constant over the whole step.
    pub whole_constant: Inputs<T>,
    /// The step, in dimensionless time.
    pub step: T,
    /// A mesh counts as safely closed at the start of a whole tick when its overlap exceeds this times its speed.
    pub reach: T,
    /// Mesh periods over the step, in 2^-32, up to which the excitation counts as quadratic in time; zero where no tick is
    /// taken whole.
    pub longest_advance: T,
}

impl<T: Real> Flow<T> {
    /// Whether ticks in which contact holds are taken as a whole.
    #[inline(always)]
    pub fn takes_whole_ticks(&self) -> bool {
        self.longest_advance > T::ZERO
    }
}

/// exp(H h) - I in both subspaces, and the response to torques constant over the step.
#[derive(Debug, Clone, PartialEq)]
#[repr(C)]
pub struct Transition<T: Real> {
    /// In-phase motion.
    pub in_phase: Block<T, 6, 6>,
    /// Deviation of a planet.
    pub deviation: Block<T, 2, 2>,
    /// In-phase response to a unit of sun, carrier and link acceleration.
    pub torques: Block<T, 6, 3>,
}

/// Response to pseudo-forces under one time weight.
#[derive(Debug, Clone, PartialEq)]
#[repr(C)]
pub struct Inputs<T: Real> {
    /// In-phase response to the sums over planets: sun-planet, ring-planet.
    pub in_phase: Block<T, 6, 2>,
    /// Response of a deviation to the deviation of (sun-planet - ring-planet).
    pub deviation: [T; 2],
}

/// A matrix of a table, `R` rows by `C` columns; prints as the Rust expression that makes it.
#[derive(Clone, PartialEq)]
#[repr(transparent)]
pub struct Block<T: Real, const R: usize, const C: usize>(pub SMatrix<T, R, C>);

/// A block from its columns.
pub const fn block<T: Real, const R: usize, const C: usize>(columns: [[T; R]; C]) -> Block<T, R, C> {
    Block(SMatrix::from_array_storage(ArrayStorage(columns)))
}

impl<T: Real, const R: usize, const C: usize> fmt::Debug for Block<T, R, C> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "block({:?})", self.0.data.0)
    }
}

impl<T: Real, const N: usize> Tables<T, N> {
    /// Whether the numbers are those that the digest was taken over.
    pub fn digest_is_good(&self) -> bool {
        self.digest == self.numbers_digest()
    }

    /// Digest over every number but the digest itself.
    pub fn numbers_digest(&self) -> u64 {
        let mut digest = Digest(digest::START);
        digest.whole(N as u64);
        digest.whole(self.tick_rate.into());
        digest.whole(self.scheme as u64);
        digest.whole(self.substeps.into());
        digest.whole(self.damping_law as u64);
        digest.reals(&[self.substep, self.planet_share, self.sharpness, self.half_substep_share]);
        let units = &self.units;
        digest.reals(&[units.drive, units.load_on_carrier, units.load_on_link, units.length, units.carrier_speed]);
        digest.reals(&units.motor_offset);
        digest.reals(&units.link_offset);
        digest.reals(&[self.rigid.drive, self.rigid.load]);
        digest.mobility(&self.mobility);
        digest.reals(&[self.stage.rate, self.stage.square_sixth]);
        digest.mobility(&self.stage.mobility);
        digest.reals(&self.stage.damping);
        digest.whole(self.excitation.phase_step);
        digest.whole(self.excitation.periods_per_turn.into());
        digest.whole(self.excitation.harmonics.into());
        digest.reals(&[self.excitation.phase_advance, self.excitation.rate]);
        for spring in &self.springs {
            digest.reals(&[spring.stiffness, spring.damping]);
        }
        for mesh in self.meshes.iter().flatten() {
            digest.reals(&[mesh.half_backlash]);
            digest.reals(&mesh.error);
            mesh.ripple.iter().for_each(|pair| digest.reals(pair));
        }
        digest.flow(&self.flow);
        digest.verlet(&self.verlet);
        digest.0
    }
}

/// Takes a digest over numbers in the order in which they are given.
struct Digest(u64);

impl Digest {
    fn whole(&mut self, word: u64) {
        self.0 = digest::chain(self.0, word);
    }

    /// Not inlined: it runs once, when a board starts, and is called some dozens of times.
    #[inline(never)]
    fn reals<T: Real>(&mut self, values: &[T]) {
        values.iter().for_each(|value| self.whole(value.bits()));
    }

    fn block<T: Real, const R: usize, const C: usize>(&mut self, block: &Block<T, R, C>) {
        self.reals(block.0.as_slice());
    }

    fn mobility<T: Real>(&mut self, mobility: &Mobility<T>) {
        self.reals(&[mobility.sun, mobility.planet, mobility.carrier, mobility.link]);
        self.reals(&[mobility.wind_up, mobility.wind_up_stiffness, mobility.wind_up_damping]);
    }

    fn verlet<T: Real>(&mut self, verlet: &VerletTable<T>) {
        self.whole(verlet.substeps.into());
        self.mobility(&verlet.mobility);
        self.reals(&[verlet.half_count, verlet.substep, verlet.square, verlet.per_substep]);
        self.reals(&[verlet.wind_up_mobility, verlet.wind_up_yield, verlet.curvature]);
        for values in [&verlet.damping, &verlet.half_damped].into_iter().chain(&verlet.release) {
            self.reals(values);
        }
    }

    fn flow<T: Real>(&mut self, flow: &Flow<T>) {
        for transition in [&flow.whole, &flow.early, &flow.late, &flow.half] {
            self.block(&transition.in_phase);
            self.block(&transition.deviation);
            self.block(&transition.torques);
        }
        let nodes = flow.early_inputs.iter().chain(&flow.late_inputs).chain(&flow.whole_inputs);
        for inputs in nodes.chain(&flow.whole_linear).chain([&flow.whole_constant, &flow.half_constant]) {
            self.block(&inputs.in_phase);
            self.reals(&inputs.deviation);
        }
        self.reals(&flow.nodes);
        self.reals(&[flow.step, flow.reach, flow.longest_advance]);
    }
}
