//! A case: joint, initial state, torques, and the error measure. The cases are listed in `catalogue`.

use model_core::gears::{Kinematics, MeshPhasing};
use parameters::{Excitation, JointParameters, MESH_KINDS, MeshKind, MeshPhases};
use reference::joint::{RelativeState, Start};
use reference::scenarios::case_r::{CaseR, TICK_RATE};
use reference::scenarios::{Scenario, TorqueSegment};
use std::f64::consts::TAU;

/// Error measure of a case.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Measure {
    /// Deflections of all meshes: RMS error over the standard deviation.
    Deflections,
    /// Angle of the link: RMS error over the lost motion, for cases whose single meshes rattle chaotically.
    LinkAngle,
}

/// A case.
#[derive(Debug, Clone, PartialEq)]
pub struct Case {
    /// Short name: one word.
    pub key: String,
    /// Title in one line.
    pub title: String,
    /// The joint.
    pub joint: JointParameters,
    /// State at time zero.
    pub start: Start,
    /// Torques, in order.
    pub torques: Vec<TorqueSegment>,
    /// Ticks of `torques` in a second [Hz]: where torques change, a method's rate must be a multiple.
    pub tick_rate: u32,
    /// Length [ticks].
    pub ticks: u64,
    /// Sample rate [Hz].
    pub sample_rate: u32,
    /// Start of the evaluation [s].
    pub counts_from: f64,
    /// First tick of every part whose largest mesh force is compared.
    pub parts: Vec<u64>,
    /// Ticks at which a method is reset to the reference's state: a motion that is chaotic in the long run is evaluated in windows. Only
    /// where the carrier's angle determines the mesh phase.
    pub restarts: Vec<u64>,
    /// Error measure.
    pub measure: Measure,
}

/// State of bodies at rest without displacement: the deflections are the imposed errors, negated.
pub fn at_rest(joint: &JointParameters) -> RelativeState {
    let rate = match joint.excitation {
        Excitation::Time { mesh_frequency } => mesh_frequency,
        Excitation::Angle => 0.0,
    };
    let mut start = RelativeState::centred(joint.geometry.planets);
    for (planet, amplitude) in joint.sun_planet.transmission_error.iter().enumerate() {
        let (sine, cosine) = joint.error_phase(MeshKind::SunPlanet, planet).sin_cos();
        start.sun_planet[planet] = -(amplitude * sine);
        start.sun_planet_rate[planet] = -(amplitude * rate * cosine);
    }
    start
}

impl Case {
    /// Creates the case of a scenario. All deflections are evaluated, from the time `counts_from` [s] on.
    pub fn from_scenario(key: &str, title: &str, scenario: Scenario, sample_rate: u32, counts_from: f64) -> Self {
        Self {
            key: key.into(),
            title: title.into(),
            start: scenario.start,
            torques: scenario.torques,
            joint: scenario.joint,
            tick_rate: scenario.tick_rate,
            ticks: scenario.ticks,
            sample_rate,
            counts_from,
            parts: vec![0],
            restarts: Vec::new(),
            measure: Measure::Deflections,
        }
    }

    /// Motion of a robot joint.
    pub fn from_robot_joint(key: &str, title: &str, case: CaseR) -> Self {
        let mut torques: Vec<TorqueSegment> = Vec::new();
        for (tick, [drive, load]) in case.torques.iter().enumerate() {
            if torques.last().is_none_or(|last| (last.drive_torque, last.load_torque) != (*drive, *load)) {
                torques.push(TorqueSegment { from_tick: tick as u64, drive_torque: *drive, load_torque: *load });
            }
        }
        Self {
            key: key.into(),
            title: title.into(),
            ticks: case.ticks() as u64,
            parts: case.parts.iter().map(|part| part.first as u64).collect(),
            restarts: case.windows.iter().map(|first| *first as u64).filter(|first| *first > 0).collect(),
            joint: case.joint,
            start: Start::Still,
            torques,
            tick_rate: TICK_RATE,
            sample_rate: TICK_RATE,
            counts_from: 0.0,
            measure: Measure::LinkAngle,
        }
    }

    /// Length [s].
    pub fn duration(&self) -> f64 {
        self.ticks as f64 / f64::from(self.tick_rate)
    }

    /// Lost motion at the link [rad].
    pub fn lost_motion(&self) -> f64 {
        let least = |kind: MeshKind| self.joint.mesh(kind).half_backlash.iter().copied().fold(f64::INFINITY, f64::min);
        MESH_KINDS.into_iter().map(least).sum::<f64>() / self.joint.geometry.carrier_base_radius()
    }

    /// Start with the sun displaced by a part of b_c.
    pub fn displaced_start(&self, part: f64) -> Start {
        let by = part * self.joint.characteristic_length;
        let mut start = match &self.start {
            Start::Relative(start) => start.clone(),
            Start::Still => at_rest(&self.joint),
        };
        start.sun_planet.iter_mut().for_each(|planet| *planet += by);
        start.gap += by;
        Start::Relative(start)
    }

    /// Rate of the mesh phase at a carrier speed [rad/s].
    fn phase_rate(&self, carrier_speed: f64) -> f64 {
        match self.joint.excitation {
            Excitation::Time { mesh_frequency } => mesh_frequency,
            Excitation::Angle => f64::from(self.joint.geometry.ring_teeth) * carrier_speed,
        }
    }

    /// Case with all mesh phases advanced by a number of periods. The bodies start where they did.
    pub fn shifted(&self, periods: f64) -> Self {
        let mut shifted = self.clone();
        for mesh in [&mut shifted.joint.sun_planet, &mut shifted.joint.ring_planet] {
            let by = TAU * periods;
            match &mut mesh.phases {
                MeshPhases::Given { stiffness, error } => stiffness.iter_mut().chain(error).for_each(|p| *p += by),
                MeshPhases::FromTeeth { stiffness, error } => {
                    *stiffness += by;
                    *error += by;
                }
            }
        }
        if let Start::Relative(start) = &mut shifted.start {
            let rate = self.phase_rate(start.rigid_speed);
            for planet in 0..self.joint.geometry.planets {
                let amplitude = self.joint.sun_planet.transmission_error[planet];
                let [before, after] =
                    [&self.joint, &shifted.joint].map(|joint| joint.error_phase(MeshKind::SunPlanet, planet).sin_cos());
                start.sun_planet[planet] += amplitude * (before.0 - after.0);
                start.sun_planet_rate[planet] += amplitude * rate * (before.1 - after.1);
            }
        }
        shifted
    }
}
