//! Parameters of a planetary joint in SI: all quantities of He, Jia, Chen and Sun (2015), plus the motor rotor, the link
//! and the compliance between carrier and link of a real joint. The fixed step reads tables, not these parameters.

use heapless::String;

use crate::mesh::{DampingLaw, DeadZone, Mesh, MeshKind};

/// Planetary joint with a fixed ring, driven sun and loaded carrier (2K-H); or a joint with an
/// [equivalent gear](crate::EquivalentGear), represented by one planet without mass.
///
/// Sign convention: a positive sun angle turns the carrier the same way; positive drive torque accelerates the sun,
/// positive load torque brakes the link. A positive deflection of either mesh carries drive torque towards the load.
///
/// Example: a joint from numbers; usually a joint file is read:
///
/// ```
/// use heapless::String;
/// use parameters::*;
///
/// let each = |value: f64| PerPlanet::from_slice(&[value; 3]).unwrap();
/// let mesh = || Mesh {
///     mean_stiffness: 1e8,
///     stiffness_wave: StiffnessWave::Harmonic { stiffness_ratio: 0.15 },
///     damping_ratio: 0.05,
///     half_backlash: each(40e-6),
///     transmission_error: each(3e-6),
///     phases: MeshPhases::FromTeeth { stiffness: 0.0, error: 0.0 },
/// };
/// let mut joint = JointParameters {
///     name: String::try_from("by hand").unwrap(),
///     geometry: Geometry {
///         planets: 3,
///         sun_teeth: 15,
///         planet_teeth: 30,
///         ring_teeth: 75,
///         working_pressure_angle: 20_f64.to_radians(),
///         sun_base_radius: 7.048e-3,
///         planet_base_radius: 14.095e-3,
///         carrier_radius: 22.5e-3,
///         coherence: Coherence::Required,
///     },
///     bodies: Bodies {
///         sun_equivalent_mass: 0.02,
///         planet_equivalent_mass: 0.03,
///         planet_mass: 0.05,
///         carrier_inertia_over_radius_squared: 0.13,
///     },
///     rotor_inertia: 2.5e-4,
///     link_inertia: 0.15,
///     compliance: None,
///     sun_planet: mesh(),
///     ring_planet: mesh(),
///     damping_law: DampingLaw::Contact,
///     dead_zone: DeadZone::Sharp,
///     excitation: Excitation::Angle,
///     characteristic_length: 10e-6,
///     rated_output_torque: 12.0,
/// };
/// assert_eq!(joint.validate(), Ok(()));
/// joint.ring_planet.half_backlash[1] = -40e-6;
/// let refused = joint.validate().unwrap_err();
/// assert!(refused.to_string().contains("half-backlash"), "{refused}");
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct JointParameters {
    /// Short name, for reports and the board's identity.
    pub name: String<32>,
    /// Teeth, radii and angles.
    pub geometry: Geometry,
    /// Masses of gears and carrier.
    pub bodies: Bodies,
    /// Inertia of the motor rotor and all other rigid parts on the sun shaft, without the sun [kg m^2].
    pub rotor_inertia: f64,
    /// Inertia of the link on the carrier [kg m^2].
    pub link_inertia: f64,
    /// Torsional compliance between carrier and link; `None` joins them rigidly.
    pub compliance: Option<Compliance>,
    /// Sun-planet meshes (external).
    pub sun_planet: Mesh,
    /// Ring-planet meshes (internal).
    pub ring_planet: Mesh,
    /// Damping law of the meshes in contact and in the gap.
    pub damping_law: DampingLaw,
    /// Sharp (eq. 12) or smoothed (eq. 13) dead zone.
    pub dead_zone: DeadZone,
    /// Source of the mesh phase.
    pub excitation: Excitation,
    /// Characteristic length b_c that makes deflections dimensionless (eq. 16) [m].
    pub characteristic_length: f64,
    /// Rated torque at the link [N m]; scales profiles and reports, does not enter the dynamics.
    pub rated_output_torque: f64,
}

/// Teeth and radii. Only radii enter the equations of motion; teeth give mesh phases and the exact ratio.
#[derive(Debug, Clone, PartialEq)]
pub struct Geometry {
    /// Number of planets n; 1 for an equivalent gear.
    pub planets: usize,
    /// Teeth of the sun.
    pub sun_teeth: u32,
    /// Teeth of each planet.
    pub planet_teeth: u32,
    /// Teeth of the fixed ring.
    pub ring_teeth: u32,
    /// Working pressure angle, alpha [rad].
    pub working_pressure_angle: f64,
    /// Base radius of the sun, r_bs [m].
    pub sun_base_radius: f64,
    /// Base radius of a planet, r_bp [m].
    pub planet_base_radius: f64,
    /// Carrier radius r_c: from the joint's axis to a planet's axis [m]. Never r_c cos(alpha).
    pub carrier_radius: f64,
    /// Treatment of radii and teeth that do not fit together; Table 1 of the paper needs `Warned`.
    pub coherence: Coherence,
}

/// Treatment of an incoherent geometry.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Coherence {
    /// Incoherent geometry is an error.
    Required,
    /// Incoherent geometry gives a warning and is used as written.
    Warned,
}

/// Masses. Equivalent masses are I / r_b^2, referred to the line of action.
#[derive(Debug, Clone, PartialEq)]
pub struct Bodies {
    /// Sun: I_s / r_bs^2, without the rotor [kg].
    pub sun_equivalent_mass: f64,
    /// Planet: I_p / r_bp^2 [kg].
    pub planet_equivalent_mass: f64,
    /// Mass of one planet, carried round by the carrier [kg].
    pub planet_mass: f64,
    /// Carrier alone: I_c / r_c^2, without planets and link [kg].
    pub carrier_inertia_over_radius_squared: f64,
}

/// Torsion spring and damper between carrier and link.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Compliance {
    /// Torsional stiffness [N m/rad].
    pub stiffness: f64,
    /// Damping ratio of the link swinging against everything geared to the carrier, C = 2 zeta sqrt(K M_1 M_2 /
    /// (M_1 + M_2)) with M_1 = 4 M_s + n M_p + M_c (rotor included) and M_2 the link's equivalent mass [-].
    pub damping_ratio: f64,
}

/// Source of the mesh phase of stiffness ripple and transmission error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Excitation {
    /// Prescribed phase omega t, as in the paper.
    Time {
        /// Mesh frequency omega [rad/s].
        mesh_frequency: f64,
    },
    /// Phase equal to ring teeth times the rigid-body carrier angle; runs backwards with the joint.
    Angle,
}

impl JointParameters {
    /// Returns the meshes of one kind.
    pub fn mesh(&self, kind: MeshKind) -> &Mesh {
        match kind {
            MeshKind::SunPlanet => &self.sun_planet,
            MeshKind::RingPlanet => &self.ring_planet,
        }
    }
}
