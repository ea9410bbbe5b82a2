//! A joint at one instant in SI, for any scheme: read from the core's state or from the reference. Forces of a core
//! state are computed here in f64 by eq. 5 and the joint's damping law.

use std::f64::consts::TAU;

use heapless::Vec;
use model_core::gears::tables::MeshTable;
use model_core::gears::{Kinematics, Model, Scales, Tables, dead_zone};
use model_core::numbers::Real;
use model_core::numbers::phase::sine_cosine;
use parameters::{ContactState, DampingLaw, Excitation, JointParameters, MAX_PLANETS};
use reference::joint::{Observation, Work};

/// A joint at one instant.
#[derive(Debug, Clone, PartialEq)]
pub struct Snapshot {
    /// Finished ticks.
    pub tick: u32,
    /// Time [s].
    pub time: f64,
    /// Torque on the sun shaft in the following tick [N m].
    pub drive: f64,
    /// Torque that brakes the link in the following tick [N m].
    pub load: f64,
    /// Rigid-body carrier angle [rad].
    pub carrier_angle: f64,
    /// Rigid-body carrier speed [rad/s].
    pub carrier_speed: f64,
    /// Motor angle minus ratio times rigid carrier angle [rad].
    pub motor_offset: f64,
    /// Link angle minus rigid carrier angle [rad].
    pub link_offset: f64,
    /// Gap coordinate u_s - 2 u_c [m].
    pub gap: f64,
    /// Rate of the gap coordinate [m/s].
    pub gap_rate: f64,
    /// Carrier minus link along the line of action [m].
    pub wind_up: f64,
    /// Rate of the wind-up [m/s].
    pub wind_up_rate: f64,
    /// Mesh phase, unwrapped [mesh periods].
    pub mesh_periods: f64,
    /// Sun-planet meshes of every planet, then ring-planet meshes.
    pub teeth: Vec<MeshSnapshot, { 2 * MAX_PLANETS }>,
    /// Energies, if the scheme computes them itself.
    pub energy: Option<Energy>,
}

/// One mesh at one instant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeshSnapshot {
    /// Deflection d [m].
    pub deflection: f64,
    /// Deflection rate d' [m/s].
    pub rate: f64,
    /// Mesh force along the line of action [N].
    pub force: f64,
    /// Touching flank, by geometry.
    pub contact: ContactState,
}

/// Stored energy and the work since the start.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Energy {
    /// Kinetic and elastic energy [J].
    pub stored: f64,
    /// Work by its origin.
    pub work: Work,
}

impl Snapshot {
    /// Motor angle [rad].
    pub fn motor_angle(&self, joint: &JointParameters) -> f64 {
        joint.geometry.ratio_by_radii() * self.carrier_angle + self.motor_offset
    }

    /// Link angle [rad].
    pub fn link_angle(&self) -> f64 {
        self.carrier_angle + self.link_offset
    }

    /// Motor angle over the ratio, minus the link angle [rad].
    pub fn twist(&self, joint: &JointParameters) -> f64 {
        self.motor_offset / joint.geometry.ratio_by_radii() - self.link_offset
    }

    /// Snapshot of the reference.
    pub fn from_reference(tick: u32, joint: &JointParameters, observation: &Observation) -> Self {
        let kinds = [0, 1];
        let teeth = kinds.into_iter().flat_map(|kind| {
            (0..joint.geometry.planets).map(move |planet| MeshSnapshot {
                deflection: observation.deflections[kind][planet],
                rate: observation.deflection_rates[kind][planet],
                force: observation.mesh_forces[kind][planet],
                contact: observation.contacts[kind][planet],
            })
        });
        let mesh_periods = match joint.excitation {
            Excitation::Time { mesh_frequency } => mesh_frequency * observation.time / TAU,
            Excitation::Angle => observation.rigid_turns * f64::from(joint.geometry.ring_teeth),
        };
        Self {
            tick,
            time: observation.time,
            drive: 0.0,
            load: 0.0,
            carrier_angle: TAU * observation.rigid_turns,
            carrier_speed: observation.rigid_speed,
            motor_offset: observation.motor_offset,
            link_offset: observation.link_offset,
            gap: observation.gap,
            gap_rate: observation.gap_rate,
            wind_up: observation.wind_up,
            wind_up_rate: observation.wind_up_rate,
            mesh_periods,
            teeth: teeth.collect(),
            energy: Some(Energy {
                stored: observation.kinetic_energy + observation.elastic_energy,
                work: observation.work,
            }),
        }
    }
}

/// Reads snapshots from a core model; holds the data that are constant over a run.
pub struct Reader<'a, T: Real, const N: usize> {
    joint: &'a JointParameters,
    tables: &'a Tables<T, N>,
    scales: Scales,
}

impl<'a, T: Real, const N: usize> Reader<'a, T, N> {
    /// Reader for models with these tables.
    pub fn new(joint: &'a JointParameters, tables: &'a Tables<T, N>) -> Self {
        Self { joint, tables, scales: Scales::new(joint) }
    }

    /// Snapshot after a number of ticks.
    pub fn read(&self, tick: u32, model: &Model<'_, T, N>) -> Snapshot {
        let state = model.state();
        let outputs = model.outputs();
        let excitation = &self.tables.excitation;
        let time = f64::from(tick) / f64::from(self.tables.tick_rate);
        let turns = f64::from(state.rigid.turns) + state.rigid.fraction as f64 * (-64f64).exp2();
        let (phase, way, mesh_periods) = match self.joint.excitation {
            Excitation::Time { mesh_frequency } => {
                (state.phase, excitation.phase_advance.to_f64(), mesh_frequency * time / TAU)
            }
            Excitation::Angle => {
                let periods = excitation.periods_per_turn;
                let way = state.rigid.speed as f64 * (-32f64).exp2() * f64::from(periods);
                (state.rigid.fraction.wrapping_mul(periods.into()), way, turns * f64::from(periods))
            }
        };
        let instant = Instant {
            rotor: sine_cosine((phase >> 32) as u32),
            phase_rate: excitation.rate.to_f64() * way,
            harmonics: excitation.harmonics as usize,
        };
        let (gap, gap_rate) = (state.position.gap.to_f64(), state.rate.gap.to_f64());
        let speed = self.scales.length * self.scales.frequency;
        let teeth = [0, 1].into_iter().flat_map(|kind| {
            let instant = &instant;
            (0..N).map(move |planet| {
                let own = (state.position.planets[planet].to_f64(), state.rate.planets[planet].to_f64());
                let (position, rate) = if kind == 0 { own } else { (gap - own.0, gap_rate - own.1) };
                self.teeth(kind, &self.tables.meshes[kind][planet], instant, position, rate)
            })
        });
        Snapshot {
            tick,
            time,
            drive: 0.0,
            load: 0.0,
            carrier_angle: TAU * turns,
            carrier_speed: state.rigid.speed as f64 * (-64f64).exp2() * TAU * f64::from(self.tables.tick_rate),
            motor_offset: outputs.motor_offset.to_f64(),
            link_offset: outputs.link_offset.to_f64(),
            gap: self.scales.length * gap,
            gap_rate: speed * gap_rate,
            wind_up: self.scales.length * state.position.wind_up.to_f64(),
            wind_up_rate: speed * state.rate.wind_up.to_f64(),
            mesh_periods,
            teeth: teeth.collect(),
            energy: None,
        }
    }

    /// Mesh force by eq. 5 with the joint's damping law, dimensionless except in the result.
    fn teeth(&self, kind: usize, mesh: &MeshTable<T>, instant: &Instant, position: f64, rate: f64) -> MeshSnapshot {
        let (error, error_rate) = instant.error(mesh);
        let (deflection, rate) = (position - error, rate - error_rate);
        let half_backlash = mesh.half_backlash.to_f64();
        let stiffness = self.tables.springs[kind].stiffness.to_f64() + instant.ripple(mesh);
        let damping_force = self.tables.springs[kind].damping.to_f64() * rate;
        let contact = if deflection >= half_backlash {
            ContactState::DriveSide
        } else if deflection <= -half_backlash {
            ContactState::BackSide
        } else {
            ContactState::Separated
        };
        let sharpness = self.tables.sharpness.to_f64();
        let force = if sharpness > 0.0 {
            stiffness * dead_zone::smoothed(deflection, half_backlash, sharpness) + damping_force
        } else {
            let line = stiffness * dead_zone::sharp(deflection, half_backlash) + damping_force;
            match (self.tables.damping_law, contact) {
                (DampingLaw::Paper, _) => line,
                (DampingLaw::Contact, ContactState::DriveSide) => line.max(0.0),
                (DampingLaw::Contact, ContactState::BackSide) => line.min(0.0),
                (DampingLaw::Contact, ContactState::Separated) => 0.0,
            }
        };
        MeshSnapshot {
            deflection: self.scales.length * deflection,
            rate: self.scales.length * self.scales.frequency * rate,
            force: self.scales.force() * force,
            contact,
        }
    }
}

/// Excitation at one instant.
struct Instant {
    /// Sine and cosine of the mesh phase.
    rotor: (f64, f64),
    /// Rate of the mesh phase [rad] per unit of dimensionless time.
    phase_rate: f64,
    harmonics: usize,
}

impl Instant {
    /// Transmission error e and its rate e' (eq. 11).
    fn error<T: Real>(&self, mesh: &MeshTable<T>) -> (f64, f64) {
        let (sine, cosine) = self.rotor;
        let [by_sine, by_cosine] = mesh.error.map(Real::to_f64);
        (by_sine * sine + by_cosine * cosine, self.phase_rate * (by_sine * cosine - by_cosine * sine))
    }

    /// Stiffness minus its mean (eq. 7, or the harmonics of Fig. 3).
    fn ripple<T: Real>(&self, mesh: &MeshTable<T>) -> f64 {
        let (sine, cosine) = self.rotor;
        let (mut sum, mut multiple) = (0.0, self.rotor);
        for [by_sine, by_cosine] in mesh.ripple.iter().take(self.harmonics) {
            sum += by_sine.to_f64() * multiple.0 + by_cosine.to_f64() * multiple.1;
            multiple = (multiple.0 * cosine + multiple.1 * sine, multiple.1 * cosine - multiple.0 * sine);
        }
        sum
    }
}
