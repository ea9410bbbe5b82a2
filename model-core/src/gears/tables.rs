//! Tables of the fixed step: the only interface between the offline half (`design`, f64) and the real-time half (`model`,
//! f32). Quantities without a unit are dimensionless (see `scales`).

use core::fmt;

use nalgebra::{ArrayStorage, SMatrix};

use crate::numbers::{Real, digest};
pub use parameters::DampingLaw;
use parameters::MAX_HARMONICS;

/// Tables of a joint with `N` planets at one tick rate.
#[derive(Debug, Clone, PartialEq)]
#[repr(C)]
pub struct Tables<T: Real, const N: usize> {
    /// Digest over all other fields; the board checks the digest before the model runs.
    pub digest: u64,
    /// Ticks per second [Hz].
    pub tick_rate: u32,
    /// Integration method of a tick.
    pub scheme: Scheme,
    /// Number of sub-steps in a tick in which contacts may change.
    pub substeps: u32,
    /// Half a sub-step as a fraction of the tick.
    pub half_substep_share: T,
    /// Length h of a sub-step: dimensionless tick length over `substeps`.
    pub substep: T,
    /// 1/N.
    pub planet_share: T,
    /// Damping law: `contact` (no force in the gap) or `paper` (damping also in the gap).
    pub damping_law: DampingLaw,
    /// Sharpness of the tanh dead zone (eq. 13); zero selects the sharp dead zone (eq. 12).
    pub sharpness: T,
    /// Factors between SI and dimensionless quantities.
    pub units: UnitTable<T>,
    /// Gains of the rigid body.
    pub rigid: Rigid<T>,
    /// Acceleration of each body under a unit force.
    pub mobility: Mobility<T>,
    /// Mesh phase: its source and rate.
    pub excitation: Excitation<T>,
    /// Stiffness and damping common to the meshes of a kind: sun-planet, ring-planet.
    pub springs: [Spring<T>; 2],
    /// Parameters of each mesh: sun-planet of every planet, then ring-planet.
    pub meshes: [[MeshTable<T>; N]; 2],
    /// Joint in units in which a sub-step lasts 1.
    pub stage: StageTable<T>,
    /// Exponential flow of the joint with all meshes closed, over one tick (one sub-step for `Scheme::PaperEtd1`).
    pub flow: FlowTable<T>,
    /// Verlet sub-steps for light planets.
    pub verlet: VerletTable<T>,
}

/// Position-Verlet (leapfrog) sub-steps (S11), (S12), in units in which a sub-step lasts 1.
#[derive(Debug, Clone, PartialEq)]
#[repr(C)]
pub struct VerletTable<T: Real> {
    /// Number of sub-steps in a tick; zero if Verlet sub-steps are not used.
    pub substeps: u32,
    /// Half the number of sub-steps.
    pub half_count: T,
    /// Length h of a sub-step in dimensionless time.
    pub substep: T,
    /// h^2.
    pub square: T,
    /// 1/h.
    pub per_substep: T,
    /// Mobilities.
    pub mobility: Mobility<T>,
    /// Mobility of the wind-up: sum of the mobilities of carrier and link.
    pub wind_up_mobility: T,
    /// Change of the wind-up's damping force per unit of wind-up acceleration.
    pub wind_up_yield: T,
    /// Damping of the meshes of a kind.
    pub damping: [T; 2],
    /// Half of `damping`: change of a mesh's damping force per unit of the mesh's own acceleration.
    pub half_damped: [T; 2],
    /// Change of the mean deflection by the curvature of the path, per unit of acceleration.
    pub curvature: T,
    /// [constant, slope] of each kind: a mesh stays in contact over the sub-step if its overlap in the middle exceeds its
    /// speed times (constant - slope * stiffness). The bracket is half a sub-step plus damping over stiffness, by which a
    /// parting mesh loses contact early.
    pub release: [[T; 2]; 2],
}

/// Joint in units in which a sub-step lasts 1 and accelerations are counted in sixths: most weights of the step (S9)
/// become whole numbers, and a weight of 1 costs no instruction.
#[derive(Debug, Clone, PartialEq)]
#[repr(C)]
pub struct StageTable<T: Real> {
    /// Sub-steps per unit of dimensionless time, 1/h.
    pub rate: T,
    /// h^2 / 6: converts a dimensionless acceleration to stage units.
    pub square_sixth: T,
    /// Mobilities times h^2 / 6; damping of the wind-up over h.
    pub mobility: Mobility<T>,
    /// Damping of sun-planet and ring-planet meshes over h.
    pub damping: [T; 2],
}

/// Integration method of a tick. Methods for comparison are not part of a board's image.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u32)]
pub enum Scheme {
    /// Exponential flow while the contact set holds over the tick; otherwise sub-steps with a fixed contact set, corrected
    /// for every crossing, or Verlet sub-steps. With a tanh dead zone: Runge-Kutta.
    Realtime,
    /// Method of the paper: one constant exponential; all nonlinear forces are a pseudo-force held over the sub-step.
    #[cfg(feature = "design")]
    PaperEtd1,
    /// Classical Runge-Kutta on the full forces, for comparison.
    #[cfg(feature = "design")]
    RungeKutta4,
    /// Semi-implicit Euler on the full forces, for comparison.
    #[cfg(feature = "design")]
    SemiImplicitEuler,
}

/// Factors between SI and dimensionless quantities.
#[derive(Debug, Clone, PartialEq)]
#[repr(C)]
pub struct UnitTable<T: Real> {
    /// Dimensionless acceleration of the sun per N m of drive torque.
    pub drive: T,
    /// Dimensionless deceleration of the carrier per N m of load torque (without compliance).
    pub load_on_carrier: T,
    /// Dimensionless deceleration of the link per N m of load torque (with compliance).
    pub load_on_link: T,
    /// Characteristic length b_c [m].
    pub length: T,
    /// Carrier speed per 2^-64 turn a tick [rad/s].
    pub carrier_speed: T,
    /// Coefficients of the motor angle relative to the rigid-body motion [rad], per unit of one planet's coordinate, of
    /// the gap and of the wind-up.
    pub motor_offset: [T; 3],
    /// Coefficients of the link angle relative to the rigid-body motion [rad], per unit of one planet's coordinate, of
    /// the gap and of the wind-up.
    pub link_offset: [T; 3],
}

/// Gains of the rigid-body motion: change of the carrier speed [2^-64 turns a tick] per tick and N m.
#[derive(Debug, Clone, PartialEq)]
#[repr(C)]
pub struct Rigid<T: Real> {
    /// Gain of the drive torque.
    pub drive: T,
    /// Gain of the load torque, which decelerates.
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
    /// Carrier, together with the link in a joint without compliance.
    pub carrier: T,
    /// Link; zero without compliance.
    pub link: T,
    /// 1 with compliance; 0 without compliance, where the wind-up stays zero.
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
    /// `time` mode: mesh periods per tick in 2^-32, whole periods included; zero in `angle` mode.
    pub phase_advance: T,
    /// `angle` mode: mesh periods per carrier turn, which is the number of ring teeth; zero in `time` mode.
    pub periods_per_turn: u32,
    /// Phase rate [rad per unit of dimensionless time] per 2^-32 period a tick.
    pub rate: T,
    /// Number of harmonics of the stiffness wave.
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

/// Parameters of one mesh.
#[derive(Debug, Clone, PartialEq)]
#[repr(C)]
pub struct MeshTable<T: Real> {
    /// Half-backlash b.
    pub half_backlash: T,
    /// Coefficients [sine, cosine] of the transmission error sine * sin(phase) + cosine * cos(phase) (S3).
    pub error: [T; 2],
    /// Coefficients [sine, cosine] of each harmonic of the stiffness about its mean (S3).
    pub ripple: [[T; 2]; MAX_HARMONICS],
}

/// Exponential flow (S7), (S8) over a step, for the in-phase motion and the planets' deviations from their mean, which are
/// decoupled.
///
/// In-phase state: mean planet, gap, wind-up, then their rates. Deviation state: deviation, rate. Transitions are
/// stored minus the identity, which saves a digit in f32.
#[derive(Debug, Clone, PartialEq)]
#[repr(C)]
pub struct FlowTable<T: Real> {
    /// Transition over the whole step.
    pub whole: TransitionTable<T>,
    /// Transition up to the first node within the step.
    pub early: TransitionTable<T>,
    /// Transition up to the second node.
    pub late: TransitionTable<T>,
    /// Input integrals up to the first node, of a pseudo-force linear in time: its value and its rate (per sub-step) at the
    /// start.
    pub early_inputs: [Inputs<T>; 2],
    /// Input integrals up to the second node, of a parabola: value and rate at the start, value at the first node.
    pub late_inputs: [Inputs<T>; 3],
    /// Input integrals over the whole step, of a cubic: value and rate at the start, values at both nodes.
    pub whole_inputs: [Inputs<T>; 4],
    /// Times of the nodes as fractions of the step.
    pub nodes: [T; 2],
    /// Transition up to the middle of the step, where light planets evaluate the pseudo-force.
    pub half: TransitionTable<T>,
    /// Input integrals up to the middle, of a constant pseudo-force.
    pub half_constant: Inputs<T>,
    /// Input integrals over the whole step, of a pseudo-force linear through its values at the start and in the middle.
    pub whole_linear: [Inputs<T>; 2],
    /// Input integrals over the whole step, of a constant pseudo-force.
    pub whole_constant: Inputs<T>,
    /// Length of the step in dimensionless time.
    pub step: T,
    /// Time by which the speed of a mesh is multiplied; if its overlap exceeds the product, the mesh is safely closed at the
    /// start of an exponential tick.
    pub reach: T,
    /// Limit of the mesh phase's advance per step for an exponential tick, in 2^-32 periods: below it the excitation is
    /// nearly quadratic in time. Zero disables exponential ticks.
    pub longest_advance: T,
}

impl<T: Real> FlowTable<T> {
    /// Returns true if ticks in which contacts hold are exponential ticks.
    #[inline(always)]
    pub fn takes_whole_ticks(&self) -> bool {
        self.longest_advance > T::ZERO
    }
}

/// exp(H t) - I for in-phase motion and deviations, and the response to constant torques.
#[derive(Debug, Clone, PartialEq)]
#[repr(C)]
pub struct TransitionTable<T: Real> {
    /// In-phase motion.
    pub in_phase: Block<T, 6, 6>,
    /// Deviation of a planet from the mean planet.
    pub deviation: Block<T, 2, 2>,
    /// In-phase response to a unit of sun, carrier and link acceleration.
    pub torques: Block<T, 6, 3>,
}

/// Response to pseudo-forces with one weight function of time.
#[derive(Debug, Clone, PartialEq)]
#[repr(C)]
pub struct Inputs<T: Real> {
    /// In-phase response to the sums over planets: sun-planet, ring-planet.
    pub in_phase: Block<T, 6, 2>,
    /// Response of a deviation to the deviation of (sun-planet - ring-planet).
    pub deviation: [T; 2],
}

/// Matrix of a table, `R` rows by `C` columns; its `Debug` form is the Rust expression that constructs it.
#[derive(Clone, PartialEq)]
#[repr(transparent)]
pub struct Block<T: Real, const R: usize, const C: usize>(pub SMatrix<T, R, C>);

/// Creates a block from its columns.
pub const fn block<T: Real, const R: usize, const C: usize>(columns: [[T; R]; C]) -> Block<T, R, C> {
    Block(SMatrix::from_array_storage(ArrayStorage(columns)))
}

impl<T: Real, const R: usize, const C: usize> fmt::Debug for Block<T, R, C> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "block({:?})", self.0.data.0)
    }
}

impl<T: Real, const N: usize> Tables<T, N> {
    /// Returns true if the stored digest matches the numbers.
    pub fn digest_is_good(&self) -> bool {
        self.digest == self.numbers_digest()
    }

    /// Computes the digest over every number except the stored digest.
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

/// Running digest over numbers; the order of the numbers matters.
struct Digest(u64);

impl Digest {
    fn whole(&mut self, word: u64) {
        self.0 = digest::chain(self.0, word);
    }

    /// Adds real numbers. Not inlined, to save flash: called some dozens of times, once after the start of a board.
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

    fn flow<T: Real>(&mut self, flow: &FlowTable<T>) {
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
