//! What a planetary joint is, in SI units: every quantity of He, Jia, Chen and Sun (2015), plus the motor rotor, the
//! link and the compliance between carrier and link that a real joint has. Files, units in key names and messages
//! with source spans are left to the `joints` crate; nothing here is read by the fixed step.

use heapless::{String, Vec};

use crate::dead_zone::DeadZone;
use crate::mesh::{DampingLaw, Mesh, MeshKind};

/// The largest number of planets that the model is made for.
pub const MAX_PLANETS: usize = 5;

/// The smallest number of planets that the model is made for.
pub const MIN_PLANETS: usize = 3;

/// One value for each planet.
pub type PerPlanet = Vec<f64, MAX_PLANETS>;

/// A planetary joint with a fixed ring: sun driven, carrier loaded (2K-H).
///
/// Sign convention: a positive sun angle turns the carrier the same way; positive drive torque accelerates the sun,
/// positive load torque brakes the link. A positive deflection of either mesh carries drive torque towards the load.
#[derive(Debug, Clone, PartialEq)]
pub struct JointParameters {
    /// A short name, for reports and for the board's hello.
    pub name: String<32>,
    /// Teeth, radii and angles.
    pub geometry: Geometry,
    /// Masses of gears and carrier.
    pub bodies: Bodies,
    /// Inertia of everything rigidly on the sun shaft besides the sun: the motor rotor [kg m^2].
    pub rotor_inertia: f64,
    /// Inertia of the link that the carrier turns [kg m^2].
    pub link_inertia: f64,
    /// Torsional compliance between carrier and link; `None` joins them rigidly.
    pub compliance: Option<Compliance>,
    /// The sun-planet meshes (external).
    pub sun_planet: Mesh,
    /// The ring-planet meshes (internal).
    pub ring_planet: Mesh,
    /// How the mesh damping acts once teeth part.
    pub damping_law: DampingLaw,
    /// Sharp (eq. 12) or smoothed (eq. 13) dead zone.
    pub dead_zone: DeadZone,
    /// What drives the mesh phase.
    pub excitation: Excitation,
    /// Characteristic length b_c that makes deflections dimensionless (eq. 16) [m].
    pub characteristic_length: f64,
    /// Rated torque at the link [N m]; scales profiles and reports, does not enter the dynamics.
    pub rated_output_torque: f64,
}

/// Teeth and radii. Only radii enter the equations of motion; teeth give mesh phases and the exact ratio.
#[derive(Debug, Clone, PartialEq)]
pub struct Geometry {
    /// Number of planets n.
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
    /// Radii that do not fit together are an error for a new joint; the paper's own Table 1 is kept with a warning.
    pub coherence: Coherence,
}

/// What an incoherent geometry means.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Coherence {
    /// Incoherent geometry is an error.
    Required,
    /// Incoherent geometry is reported and used as printed.
    Warned,
}

/// Masses. Equivalent masses are I / r_b^2, felt along the line of action.
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

/// What drives the mesh phase of stiffness ripple and transmission error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Excitation {
    /// Phase is omega t, prescribed, as in the paper. Mesh frequency omega [rad/s].
    Time {
        /// omega [rad/s].
        mesh_frequency: f64,
    },
    /// Phase is ring teeth times the rigid-body carrier angle; it runs backwards when the joint does.
    Angle,
}

impl Geometry {
    /// r_c cos(alpha), the carrier's lever on either line of action [m].
    pub fn carrier_base_radius(&self) -> f64 {
        self.carrier_radius * libm::cos(self.working_pressure_angle)
    }

    /// Ratio of sun to carrier angle by radii, 2 r_c cos(alpha) / r_bs (the rigid solution of eq. 4) [-].
    pub fn ratio_by_radii(&self) -> f64 {
        2.0 * self.carrier_base_radius() / self.sun_base_radius
    }

    /// Ratio of sun to carrier angle by teeth, 1 + Zr/Zs [-].
    pub fn ratio_by_teeth(&self) -> f64 {
        1.0 + f64::from(self.ring_teeth) / f64::from(self.sun_teeth)
    }
}

impl JointParameters {
    /// The meshes of one kind.
    pub fn mesh(&self, kind: MeshKind) -> &Mesh {
        match kind {
            MeshKind::SunPlanet => &self.sun_planet,
            MeshKind::RingPlanet => &self.ring_planet,
        }
    }

    /// Carrier equivalent mass M_c = (I_c/r_c^2 + n m_p) / cos^2(alpha), without the link (below eq. 19) [kg].
    pub fn carrier_equivalent_mass(&self) -> f64 {
        let cosine = libm::cos(self.geometry.working_pressure_angle);
        let planets = self.geometry.planets as f64;
        (self.bodies.carrier_inertia_over_radius_squared + planets * self.bodies.planet_mass) / (cosine * cosine)
    }

    /// Rotor inertia felt along the sun's line of action, J / r_bs^2 [kg].
    pub fn rotor_equivalent_mass(&self) -> f64 {
        self.rotor_inertia / (self.geometry.sun_base_radius * self.geometry.sun_base_radius)
    }

    /// Link inertia felt along the carrier's line of action, J / (r_c cos(alpha))^2 [kg].
    pub fn link_equivalent_mass(&self) -> f64 {
        let lever = self.geometry.carrier_base_radius();
        self.link_inertia / (lever * lever)
    }

    /// Damping coefficient of one mesh (eq. 9 for sun-planet, eq. 10 for ring-planet), from the gears' own masses
    /// without rotor and link [N s/m].
    pub fn damping_coefficient(&self, kind: MeshKind) -> f64 {
        let mesh = self.mesh(kind);
        let planet = self.bodies.planet_equivalent_mass;
        let mass = match kind {
            MeshKind::SunPlanet => {
                let sun = self.bodies.sun_equivalent_mass;
                sun * planet / (sun + planet)
            }
            // Eq. 10 is eq. 9 with an infinitely heavy ring.
            MeshKind::RingPlanet => planet,
        };
        2.0 * mesh.damping_ratio * libm::sqrt(mesh.mean_stiffness * mass)
    }

    /// Load torque that keeps the rigid body from accelerating under `drive_torque` [N m].
    pub fn balanced_load_torque(&self, drive_torque: f64) -> f64 {
        drive_torque * self.geometry.ratio_by_radii()
    }
}
