//! Initial states of a joint, resolved into absolute coordinates. Torques are not part of a start.

use parameters::{MAX_PLANETS, PerPlanet};

use super::equations::JointEquations;
use super::observation::Observation;
use crate::integrator::{Entries, MAX_ENTRIES};

/// Initial state of a joint. The rigid-body carrier angle is zero in each.
#[derive(Debug, Clone, PartialEq)]
pub enum Start {
    /// All bodies at rest at angle zero: deflections are the negated transmission errors.
    Still,
    /// State in the relative coordinates of eqs 16 and 17.
    Relative(RelativeState),
}

/// Relative coordinates in SI: sun-planet deflections, gap coordinate and wind-up, with their rates.
#[derive(Debug, Clone, PartialEq)]
pub struct RelativeState {
    /// X_sp b_c: sun-planet deflection, less the transmission error, one per planet [m].
    pub sun_planet: PerPlanet,
    /// [m/s].
    pub sun_planet_rate: PerPlanet,
    /// X_sc b_c: gap coordinate u_s - 2 u_c [m].
    pub gap: f64,
    /// [m/s].
    pub gap_rate: f64,
    /// Wind-up u_c - u_l; unused without compliance [m].
    pub wind_up: f64,
    /// [m/s].
    pub wind_up_rate: f64,
    /// Speed of the rigid-body carrier [rad/s].
    pub rigid_speed: f64,
}

impl RelativeState {
    /// X = X' = 0: every tooth in the middle of its gap, up to the transmission errors, and the joint at rest.
    pub fn centred(planets: usize) -> Self {
        let zeros: PerPlanet = (0..planets.min(MAX_PLANETS)).map(|_| 0.0).collect();
        Self {
            sun_planet: zeros.clone(),
            sun_planet_rate: zeros,
            gap: 0.0,
            gap_rate: 0.0,
            wind_up: 0.0,
            wind_up_rate: 0.0,
            rigid_speed: 0.0,
        }
    }

    /// Relative coordinates of an observation, without the rigid-body angle.
    pub fn of(observation: &Observation) -> Self {
        Self {
            sun_planet: observation.deflections[0].clone(),
            sun_planet_rate: observation.deflection_rates[0].clone(),
            gap: observation.gap,
            gap_rate: observation.gap_rate,
            wind_up: observation.wind_up,
            wind_up_rate: observation.wind_up_rate,
            rigid_speed: observation.rigid_speed,
        }
    }
}

/// Returns the state at time zero.
pub(super) fn resolve(start: &Start, equations: &JointEquations) -> Entries {
    let mut state = [0.0; MAX_ENTRIES];
    let Start::Relative(relative) = start else {
        return state;
    };
    let bodies = equations.bodies();
    // The errors' rates need the phase rate, which in mode `angle` depends on the rigid body only.
    for body in 0..bodies {
        state[bodies + body] = JointEquations::rigid_share(body) * relative.rigid_speed * equations.carrier_lever;
    }
    let phase = equations.phase(0.0, &state);
    let mut positions = [0.0; MAX_PLANETS + 3];
    let mut speeds = [0.0; MAX_PLANETS + 3];
    // The carrier is at zero here; the rigid part is corrected afterwards.
    positions[0] = relative.gap;
    speeds[0] = relative.gap_rate;
    for planet in 0..if equations.equivalent { 0 } else { equations.planets } {
        let [error, error_rate, _] = equations.meshes[0][planet].transmission_error(phase);
        positions[1 + planet] = relative.gap - error - relative.sun_planet[planet];
        speeds[1 + planet] = relative.gap_rate - error_rate - relative.sun_planet_rate[planet];
    }
    if equations.compliance.is_some() {
        positions[equations.link()] = -relative.wind_up;
        speeds[equations.link()] = -relative.wind_up_rate;
    }
    let (shift, drift) = (equations.rigid(&positions), equations.rigid(&speeds));
    for body in 0..bodies {
        let share = JointEquations::rigid_share(body);
        state[body] = positions[body] - share * shift;
        state[bodies + body] += speeds[body] - share * drift;
    }
    state
}
