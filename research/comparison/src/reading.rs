//! Readings of a motion, computed in f64 from coordinates, rates and phase, by one formula for every method, so that no method benefits
//! from its own outputs.

use baselines::forces::{Always, ForceLaw, PushOnly, Smooth, SmoothPush, Spring};
use baselines::instant::{Instant, Rotor};
use baselines::motion::{Coordinates, PeerState};
use baselines::plant::{Law, Plant};
use model_core::gears::design::dynamics::MovingMasses;
use model_core::gears::{Kinematics, Scales};
use parameters::JointParameters;

/// A motion at one moment.
#[derive(Debug, Clone, PartialEq)]
pub struct Reading {
    /// Deflections of all meshes over b_c; empty for a model without meshes.
    pub deflections: Vec<f64>,
    /// Link angle: total in mode `angle`, else relative to the rigid body [rad].
    pub link_angle: f64,
    /// Largest force in any mesh [N].
    pub mesh_force: f64,
}

/// Readings of motions of a joint.
pub struct ReadingModel<const N: usize> {
    plant: Plant<f64, N>,
    /// Rigid coordinate along the line of action per planet, gap and wind-up, negated: the carrier is at zero.
    rigid: [f64; 3],
    length: f64,
    lever: f64,
    force: f64,
}

impl<const N: usize> ReadingModel<N> {
    /// Readings for a joint.
    pub fn new(joint: &JointParameters) -> Self {
        let masses = MovingMasses::new(joint);
        let all = masses.rigid(N);
        let scales = Scales::new(joint);
        let link = masses.link.unwrap_or(0.0);
        Self {
            plant: Plant::new(joint, scales.frequency),
            // u_s = gap, u_p = gap - planet, u_l = -wind-up where u_c = 0; the sun's share counts twice.
            rigid: [-masses.planet / all, (2.0 * masses.sun + N as f64 * masses.planet) / all, -link / all],
            length: scales.length,
            lever: joint.geometry.carrier_base_radius(),
            force: scales.force(),
        }
    }

    /// Reads a dimensionless motion, given the mesh phase with its rate and the rigid carrier's angle [rad].
    pub fn read(&self, motion: &PeerState<f64, N>, phase: &Rotor<f64>, carrier: f64) -> Reading {
        let now = Instant::at(&self.plant, phase);
        let PeerState { position, rate } = motion;
        let mut deflections = Vec::with_capacity(2 * N);
        let mut mesh_force = 0.0_f64;
        for kind in 0..2 {
            for i in 0..N {
                let of = |values: &Coordinates<f64, N>| match kind {
                    0 => values.planets[i],
                    _ => values.gap - values.planets[i],
                };
                let deflection = of(position) - now.error[kind][i];
                deflections.push(deflection);
                mesh_force = mesh_force.max(self.mesh_force(&now, kind, i, deflection, of(rate)).abs());
            }
        }
        let [planet, gap, wind_up] = self.rigid;
        let rigid = planet * position.planets.iter().sum::<f64>() + gap * position.gap + wind_up * position.wind_up;
        let link_angle = carrier + (-position.wind_up - rigid) * self.length / self.lever;
        Reading { deflections, link_angle, mesh_force: mesh_force * self.force }
    }

    fn mesh_force(&self, now: &Instant<f64, N>, kind: usize, i: usize, deflection: f64, rate: f64) -> f64 {
        let spring = Spring {
            stiffness: now.stiffness[kind][i],
            damping: self.plant.damping[kind],
            half_backlash: self.plant.meshes[kind][i].half_backlash,
            sharpness: self.plant.sharpness,
        };
        let rate = rate - now.error_rate[kind][i];
        match self.plant.law {
            Law::Always => Always::force(&spring, deflection, rate),
            Law::Push => PushOnly::force(&spring, deflection, rate),
            Law::Smooth => Smooth::force(&spring, deflection, rate),
            Law::SmoothPush => SmoothPush::force(&spring, deflection, rate),
        }
    }
}
