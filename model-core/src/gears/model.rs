//! Fixed step of the joint: advances the motion by one tick under given torques, in bounded time, without allocation or
//! panic. [`Torques`] and [`Outputs`] are in SI; all other quantities are dimensionless.

use core::array;

use crate::gears::contact::{AppliedAcceleration, contact, mesh_coordinates};
use crate::gears::equivalent::{self, GapMotion};
use crate::gears::excitation::{MAX_OVERTONES, MeshPhase, PerMesh, Phasor, mesh_excitations, mesh_phase_advance};
#[cfg(feature = "design")]
use crate::gears::paper;
use crate::gears::state::{Motion, State};
use crate::gears::tables::{Scheme, Tables};
use crate::gears::warm_start::WarmStart;
use crate::gears::{full_forces, light};
use crate::numbers::Real;
use parameters::{ContactState, EQUIVALENT};

/// Torques on the joint, constant over a tick.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Torques<T> {
    /// Motor torque on the sun shaft [N m].
    pub drive: T,
    /// Load torque that brakes the link, or the carrier in a joint without compliance [N m].
    pub load: T,
}

/// Motion of the joint in SI.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Outputs<T, const N: usize> {
    /// Whole turns of the rigid-body carrier angle.
    pub carrier_turns: i32,
    /// Remaining fraction of the carrier angle, in 2^-32 turns.
    pub carrier_fraction: u32,
    /// Rate of the rigid-body carrier angle [rad/s].
    pub carrier_speed: T,
    /// Motor angle minus ratio times rigid-body carrier angle [rad].
    pub motor_offset: T,
    /// Link angle minus rigid-body carrier angle [rad].
    pub link_offset: T,
    /// Gap coordinate u_s - 2 u_c along the line of action [m].
    pub gap: T,
    /// Wind-up between carrier and link along the line of action [m].
    pub wind_up: T,
    /// Mesh deflections [m]: sun-planet of every planet, then ring-planet.
    pub deflections: PerMesh<T, N>,
    /// Contact states in the order of `deflections`.
    pub contacts: PerMesh<ContactState, N>,
}

/// Gear model: tables and the state advanced with them.
///
/// Example: a motor torque of 1 N m accelerates the joint for 10 ms at 20,000 ticks per second; then a load torque
/// balances the motor, and the speed stays constant:
///
/// ```
/// use model_core::gears::{Kinematics, Mechanics, Model, Tables, Torques, design::design};
/// use parameters::ContactState;
///
/// let q1 = joint_file::read(joint_file::preset("q1").unwrap()).unwrap();
/// let tables: Tables<f32, 3> = design(&q1.parameters, 20_000)?;
/// let mut model = Model::new(&tables);
/// for _ in 0..200 {
///     model.step(Torques { drive: 1.0, load: 0.0 });
/// }
/// let motion = model.outputs();
/// assert!(motion.carrier_speed > 0.0 && motion.gap > 0.0, "the motor leads the link");
/// let before = motion.carrier_speed;
/// // The load takes 6 N m at the link, which is what the motor brings there.
/// let ratio = q1.parameters.geometry.ratio_by_teeth() as f32;
/// for _ in 0..200 {
///     model.step(Torques { drive: 1.0, load: ratio });
/// }
/// assert!((model.outputs().carrier_speed / before - 1.0).abs() < 1e-5);
/// # Ok::<(), model_core::gears::design::DesignError>(())
/// ```
#[derive(Debug, Clone)]
pub struct Model<'a, T: Real, const N: usize> {
    tables: &'a Tables<T, N>,
    state: State<T, N>,
    warm_start: WarmStart<T, N>,
}

impl<'a, T: Real, const N: usize> Model<'a, T, N> {
    /// Creates a joint at rest, undeformed, at angle and mesh phase zero.
    pub const fn new(tables: &'a Tables<T, N>) -> Self {
        Self { tables, state: State::REST, warm_start: WarmStart::EMPTY }
    }

    /// Returns the joint to rest, undeformed, at angle and mesh phase zero.
    pub fn reset(&mut self) {
        self.set_state(State::REST);
    }

    /// Returns the state.
    pub fn state(&self) -> &State<T, N> {
        &self.state
    }

    /// Replaces the state; the next tick starts without laws and accelerations of an earlier tick.
    pub fn set_state(&mut self, state: State<T, N>) {
        self.state = state;
        self.warm_start.invalidate();
    }

    /// Returns a digest over every bit of the state.
    pub fn state_digest(&self) -> u64 {
        self.state.digest()
    }

    /// Returns true if no coordinate or rate is infinite or NaN.
    pub fn is_finite(&self) -> bool {
        self.state.is_finite()
    }

    /// Advances the joint by one tick. Each method has its own stack frame, so unused methods cost a joint no stack.
    pub fn step(&mut self, torques: Torques<T>) {
        let tables = self.tables;
        let units = &tables.units;
        let applied = AppliedAcceleration {
            sun: units.drive * torques.drive,
            carrier: -(units.load_on_carrier * torques.load),
            link: -(units.load_on_link * torques.load),
        };
        // `N` is known at compile time: the image of an equivalent gear contains no code below this block.
        if N == EQUIVALENT {
            self.state.rigid.advance(&tables.rigid, torques.drive, torques.load);
            let start = GapMotion { position: self.state.position.gap, rate: self.state.rate.gap };
            let acceleration = applied.sun - T::TWO * applied.carrier;
            self.state.set_gap(equivalent::tick(tables, acceleration, start));
            return;
        }
        let start = self.phase();
        let travel = self.state.rigid.advance(&tables.rigid, torques.drive, torques.load);
        let advance = mesh_phase_advance(&tables.excitation, travel);
        let phase = MeshPhase { start, advance, rate: tables.excitation.rate * advance };
        self.state.phase = self.state.phase.wrapping_add(tables.excitation.phase_step);

        let Self { state, warm_start, .. } = self;
        match tables.scheme {
            Scheme::Realtime if tables.sharpness == T::ZERO => {
                if tables.verlet.substeps > 0 {
                    light::tick(tables, &applied, &phase, state.motion());
                } else if tables.excitation.harmonics > 1 {
                    warm_start.tick::<MAX_OVERTONES>(tables, &applied, &phase, state.motion());
                } else {
                    warm_start.tick::<0>(tables, &applied, &phase, state.motion());
                }
            }
            scheme => {
                let before = Motion { position: state.position, rate: state.rate };
                let after = match scheme {
                    #[cfg(feature = "design")]
                    Scheme::PaperEtd1 => paper::step(tables, &applied, &phase, &before),
                    #[cfg(feature = "design")]
                    Scheme::SemiImplicitEuler => full_forces::semi_implicit_euler(tables, &applied, &phase, &before),
                    // The tanh dead zone under `Realtime`, and `RungeKutta4`.
                    _ => full_forces::runge_kutta(tables, &applied, &phase, &before),
                };
                (state.position, state.rate) = (after.position, after.rate);
            }
        }
        state.canonicalise();
    }

    /// Returns the motion at the end of the last tick, in SI.
    pub fn outputs(&self) -> Outputs<T, N> {
        let State { position, rigid, .. } = &self.state;
        let units = &self.tables.units;
        let planets = position.planets.iter().fold(T::ZERO, |sum, planet| sum + *planet);
        let offset = |gains: &[T; 3]| gains[0] * planets + gains[1] * position.gap + gains[2] * position.wind_up;
        let errors = mesh_excitations::<T, N, 0>(self.tables, Phasor::at(self.phase()), T::ZERO).error;
        let meshes = mesh_coordinates(position);
        let deflections: PerMesh<T, N> = array::from_fn(|kind| array::from_fn(|i| meshes[kind][i] - errors[kind][i]));
        Outputs {
            carrier_turns: rigid.turns,
            carrier_fraction: (rigid.fraction >> 32) as u32,
            carrier_speed: units.carrier_speed * T::from_i64(rigid.speed),
            motor_offset: offset(&units.motor_offset),
            link_offset: offset(&units.link_offset),
            gap: units.length * position.gap,
            wind_up: units.length * position.wind_up,
            deflections: deflections.map(|family| family.map(|value| units.length * value)),
            contacts: array::from_fn(|kind| {
                array::from_fn(|i| contact(deflections[kind][i], self.tables.meshes[kind][i].half_backlash))
            }),
        }
    }

    /// Returns the mesh phase in 2^-32 periods.
    fn phase(&self) -> u32 {
        let periods = self.tables.excitation.periods_per_turn;
        let phase =
            if periods == 0 { self.state.phase } else { self.state.rigid.fraction.wrapping_mul(periods.into()) };
        (phase >> 32) as u32
    }
}
