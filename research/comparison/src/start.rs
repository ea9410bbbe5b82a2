//! Start of a case in the forms of the core and of the baselines. The reference uses it directly.

use std::array;
use std::f64::consts::TAU;

use baselines::motion::Coordinates;
use baselines::peer;
use model_core::gears::{Relative, RigidBody, Scales, State, Tables};
use model_core::numbers::Real;
use parameters::JointParameters;
use reference::joint::Start;

use crate::case::at_rest;
use crate::trajectory::Restart;

/// One turn, 2^64.
const TURN: f64 = 18_446_744_073_709_551_616.0;

/// Sun-planet deflections (errors subtracted), gap and wind-up [m], their rates [m/s], and the rigid carrier.
pub struct InitialState<const N: usize> {
    /// Coordinates.
    pub position: Coordinates<f64, N>,
    /// Rates.
    pub rate: Coordinates<f64, N>,
    /// Angle of the rigid carrier [turns].
    pub turns: f64,
    /// Speed of the rigid carrier [rad/s].
    pub speed: f64,
}

impl<const N: usize> InitialState<N> {
    /// State of a joint at a start.
    pub fn new(joint: &JointParameters, start: &Start) -> Self {
        match start {
            Start::Relative(given) => Self {
                position: Coordinates {
                    planets: array::from_fn(|i| given.sun_planet[i]),
                    gap: given.gap,
                    wind_up: given.wind_up,
                },
                rate: Coordinates {
                    planets: array::from_fn(|i| given.sun_planet_rate[i]),
                    gap: given.gap_rate,
                    wind_up: given.wind_up_rate,
                },
                turns: 0.0,
                speed: given.rigid_speed,
            },
            Start::Still => Self::new(joint, &Start::Relative(at_rest(joint))),
        }
    }

    /// State at a restart.
    pub fn at_restart(joint: &JointParameters, restart: &Restart) -> Self {
        Self { turns: restart.turns, ..Self::new(joint, &Start::Relative(restart.state.clone())) }
    }

    /// States at the start of a case and at each of its restarts.
    pub fn all(joint: &JointParameters, start: &Start, restarts: &[Restart]) -> Vec<Self> {
        std::iter::once(Self::new(joint, start)).chain(restarts.iter().map(|at| Self::at_restart(joint, at))).collect()
    }

    /// Fraction of the rigid carrier's turns [2^-64 turns].
    fn place(&self) -> u64 {
        ((self.turns - self.turns.floor()) * TURN) as u64
    }

    /// State for the core.
    pub fn state<T: Real>(&self, joint: &JointParameters, tables: &Tables<T, N>) -> State<T, N> {
        let scales = Scales::new(joint);
        let over = |values: &Coordinates<f64, N>, unit: f64| Relative {
            planets: values.planets.map(|value| T::from_f64(value / unit)),
            gap: T::from_f64(values.gap / unit),
            wind_up: T::from_f64(values.wind_up / unit),
        };
        let position = over(&self.position, scales.length);
        let rate = over(&self.rate, scales.length * scales.frequency);
        let rigid = RigidBody {
            turns: self.turns.floor() as i32,
            fraction: self.place(),
            speed: (self.speed / (TAU * f64::from(tables.tick_rate)) * TURN) as i64,
        };
        State::with_rigid_body(tables, &position, &rate, rigid)
    }

    /// Start for a baseline of `rate` steps a second.
    pub fn peer<T: Real>(&self, joint: &JointParameters, rate: f64) -> peer::Start<T, N> {
        peer::Start::new(joint, rate, &self.position, &self.rate, (self.place(), self.speed))
    }

    /// State for the two-mass model, dimensionless: motor against link along the output's line of action, half the gap plus the wind-up,
    /// and its rate.
    pub fn two_mass(&self, joint: &JointParameters) -> (f64, f64) {
        let scales = Scales::new(joint);
        let apart = |values: &Coordinates<f64, N>| 0.5 * values.gap + values.wind_up;
        (apart(&self.position) / scales.length, apart(&self.rate) / (scales.length * scales.frequency))
    }
}
