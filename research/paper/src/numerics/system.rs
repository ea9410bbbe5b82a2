//! Joint under constant torques and a prescribed mesh frequency, in the dimensionless relative coordinates of eqs 15-19: masses, springs
//! and excitation as plain numbers. The tanh dead zone and the phase mode `angle` are rejected, since they have no Poincare section.

use std::f64::consts::TAU;
use std::fmt;

use model_core::gears::design::dynamics::MovingMasses;
use model_core::gears::{Kinematics, Mechanics, MeshPhasing, Scales, StiffnessSeries};
use parameters::{DampingLaw, DeadZone, Excitation, JointParameters, MAX_PLANETS, MESH_KINDS};

/// Largest number of meshes: sun-planet of every planet, then ring-planet.
pub(super) const MAX_MESHES: usize = 2 * MAX_PLANETS;

/// Largest number of coordinates: one a planet, the gap, the wind-up.
pub(super) const MAX_COORDINATES: usize = MAX_PLANETS + 2;

/// Reason why a joint cannot be studied.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StudyError {
    /// The dead zone is smoothed.
    SmoothDeadZone,
    /// The mesh phase follows the joint, so that no frequency is prescribed.
    NoFrequency,
    /// The prescribed frequency is zero.
    Standstill,
    /// One mesh period takes more steps than any motion of gears needs.
    TooStiff,
    /// The state became infinite or NaN.
    NotFinite,
}

impl fmt::Display for StudyError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(match self {
            Self::SmoothDeadZone => "the dead zone is smoothed by tanh; the study needs the sharp one",
            Self::NoFrequency => "the mesh phase follows the joint's angle; the study needs a stated mesh frequency",
            Self::Standstill => "the mesh frequency is zero; the study samples once per mesh period",
            Self::TooStiff => "one mesh period takes more than a million steps",
            Self::NotFinite => "the motion grows without bound",
        })
    }
}

impl std::error::Error for StudyError {}

/// One harmonic of a mesh's stiffness, K/K_m = .. + sine sin(m phase) + cosine cos(m phase), its own phase included.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Harmonic {
    pub sine: f64,
    pub cosine: f64,
}

/// Constants of one mesh.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct MeshConstants {
    pub mean_stiffness: f64,
    /// Harmonics 1, 2 .. of the stiffness.
    pub harmonics: Vec<Harmonic>,
    pub damping: f64,
    pub half_backlash: f64,
    /// Error e = sine sin(phase) + cosine cos(phase).
    pub error: Harmonic,
}

/// Joint ready to be studied. Lengths are over b_c, times over 1/omega_n, forces over K_m b_c.
#[derive(Debug, Clone, PartialEq)]
pub struct System {
    pub(super) planets: usize,
    /// Dimensionless accelerations of sun, one planet, carrier and link by a unit force.
    pub(super) mobilities: [f64; 4],
    /// Stiffness and damping between carrier and link, if compliant.
    pub(super) compliance: Option<(f64, f64)>,
    pub(super) drive_force: f64,
    pub(super) load_force: f64,
    pub(super) law: DampingLaw,
    pub(super) meshes: Vec<MeshConstants>,
    /// Dimensionless mesh frequency Omega = omega / omega_n.
    pub(super) omega: f64,
}

impl System {
    /// Joint under constant torques on sun and link [N m].
    pub fn new(joint: &JointParameters, drive_torque: f64, load_torque: f64) -> Result<Self, StudyError> {
        let Excitation::Time { mesh_frequency } = joint.excitation else { return Err(StudyError::NoFrequency) };
        if joint.dead_zone != DeadZone::Sharp {
            return Err(StudyError::SmoothDeadZone);
        }
        let scales = Scales::new(joint);
        let omega = mesh_frequency / scales.frequency;
        if !(omega > 0.0 && omega.is_finite()) {
            return Err(StudyError::Standstill);
        }
        let masses = MovingMasses::new(joint);
        let mobility = |mass: f64| scales.mobility(mass);
        let geometry = &joint.geometry;
        let lever = geometry.carrier_base_radius();
        let compliance = joint.compliance.zip(masses.link).map(|(compliance, link)| {
            let stiffness = compliance.stiffness / (lever * lever);
            let geared = masses.rigid(geometry.planets) - link;
            let damping = 2.0 * compliance.damping_ratio * (stiffness * geared * link / (geared + link)).sqrt();
            (stiffness / scales.stiffness, scales.damping(damping))
        });
        let meshes = MESH_KINDS
            .into_iter()
            .flat_map(|kind| (0..geometry.planets).map(move |planet| (kind, planet)))
            .map(|(kind, planet)| {
                let mesh = joint.mesh(kind);
                let shift = joint.stiffness_phase(kind, planet);
                let harmonics = (1..=mesh.stiffness_wave.order()).map(|order| {
                    let (sine, cosine) = mesh.stiffness_wave.coefficients(order);
                    // a sin(m (phase + shift)) + b cos(m (phase + shift)), written in sine and cosine of m phase.
                    let (turned_sine, turned_cosine) = (order as f64 * shift).sin_cos();
                    Harmonic {
                        sine: sine * turned_cosine - cosine * turned_sine,
                        cosine: sine * turned_sine + cosine * turned_cosine,
                    }
                });
                let (sine, cosine) = joint.error_phase(kind, planet).sin_cos();
                let error = mesh.transmission_error[planet] / scales.length;
                MeshConstants {
                    mean_stiffness: mesh.mean_stiffness / scales.stiffness,
                    harmonics: harmonics.collect(),
                    damping: scales.damping(joint.damping_coefficient(kind)),
                    half_backlash: mesh.half_backlash[planet] / scales.length,
                    error: Harmonic { sine: error * cosine, cosine: error * sine },
                }
            })
            .collect();
        Ok(Self {
            planets: geometry.planets,
            mobilities: [
                mobility(masses.sun),
                mobility(masses.planet),
                mobility(masses.carrier),
                masses.link.map_or(0.0, mobility),
            ],
            compliance,
            drive_force: drive_torque / geometry.sun_base_radius / scales.force(),
            load_force: load_torque / lever / scales.force(),
            law: joint.damping_law,
            meshes,
            omega,
        })
    }

    /// Number of planets.
    pub fn planets(&self) -> usize {
        self.planets
    }

    /// Number of relative coordinates: planets, gap and, with a compliance, wind-up.
    pub fn coordinates(&self) -> usize {
        self.planets + 1 + usize::from(self.compliance.is_some())
    }

    /// Dimensionless mesh frequency Omega = omega / omega_n.
    pub fn omega(&self) -> f64 {
        self.omega
    }

    /// One mesh period in dimensionless time, 2 pi / Omega.
    pub fn period(&self) -> f64 {
        TAU / self.omega
    }

    /// Transmission error of a mesh over b_c and its rate, at a time since the beginning of a period.
    pub fn transmission_error(&self, mesh: usize, time: f64) -> (f64, f64) {
        let Harmonic { sine, cosine } = self.meshes[mesh].error;
        let (s, c) = (self.omega * time).sin_cos();
        (sine * s + cosine * c, self.omega * (sine * c - cosine * s))
    }

    /// Returns true if all planets are identical, in phase and otherwise.
    pub fn in_phase(&self) -> bool {
        self.meshes.chunks(self.planets).all(|family| family.iter().all(|mesh| *mesh == family[0]))
    }

    /// Number of meshes: sun-planet of every planet, then ring-planet.
    pub fn meshes(&self) -> usize {
        self.meshes.len()
    }
}
