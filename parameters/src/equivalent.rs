//! Equivalent gear: a spur train, cycloid or belt with unknown teeth, described by its data sheet, and its conversion to
//! joint parameters. Preload and hysteresis, as in harmonic drives, are not modelled.
//!
//! Equations: (E1), (E2), (E3), (E4) in docs/theory/equivalent-gear.md.

use heapless::String;

use crate::joint::{Bodies, Coherence, Excitation, Geometry, JointParameters};
use crate::mesh::{DampingLaw, DeadZone, Mesh, MeshPhases, StiffnessWave};
use crate::planets::PerPlanet;

/// Number of planets in the parameters of an equivalent gear: one massless planet represents the transmission.
pub const EQUIVALENT: usize = 1;

/// Lever at the link that converts angles to lengths, because an equivalent gear has no line of action: 1 um represents
/// 1 urad at the link [m].
const LEVER: f64 = 1.0;

/// Gear described by ratio, lost motion, stiffness, damping and inertia, without teeth.
///
/// Motor and link turn on a spring with a gap: with the deflection delta = theta_m / ratio - theta_l and half the lost
/// motion b, the torque at the link is max(0, K (delta - b) + C delta') for delta > b, min(0, K (delta + b) + C delta')
/// for delta < -b, and 0 between. Signs as in [`JointParameters`].
///
/// ```
/// use heapless::String;
/// use parameters::EquivalentGear;
///
/// let gear = EquivalentGear {
///     ratio: [99, 2],
///     lost_motion: 0.5e-3,
///     stiffness: 60e3,
///     damping_ratio: 0.05,
///     inertia_at_input: 2e-5,
/// };
/// let joint = gear.joint(String::try_from("by hand").unwrap(), 1e-4, 0.5, 100.0);
/// assert_eq!(joint.validate(), Ok(()));
/// let again = joint.equivalent_gear().unwrap();
/// assert_eq!(again.ratio, [99, 2]);
/// assert!((again.stiffness / 60e3 - 1.0).abs() < 1e-12 && (again.lost_motion / 0.5e-3 - 1.0).abs() < 1e-12);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EquivalentGear {
    /// Motor turns over link turns as a fraction of integers, greater than 1.
    pub ratio: [u32; 2],
    /// Lost motion: travel of the link from flank to flank with the motor held [rad].
    pub lost_motion: f64,
    /// Torsional stiffness K between motor and link, at the link [N m/rad].
    pub stiffness: f64,
    /// Damping ratio zeta of motor side against link in contact: C = 2 zeta sqrt(K J), with J the reduced inertia
    /// J_1 J_2 / (J_1 + J_2) of both sides at the link [-].
    pub damping_ratio: f64,
    /// Inertia of the gear at its input, without the rotor [kg m^2].
    pub inertia_at_input: f64,
}

impl EquivalentGear {
    /// Converts to a joint with a rotor inertia [kg m^2], link inertia [kg m^2] and rated torque at the link [N m].
    ///
    /// A massless planet has equal forces in both meshes. The meshes are two springs in series; each deflects by half the
    /// distance between motor and link on the lever of the link.
    pub fn joint(
        &self,
        name: String<32>,
        rotor_inertia: f64,
        link_inertia: f64,
        rated_output_torque: f64,
    ) -> JointParameters {
        let [over, under] = self.ratio;
        let sun_base_radius = 2.0 * LEVER * f64::from(under) / f64::from(over);
        let one = |value: f64| PerPlanet::from_iter([value]);
        let mesh = Mesh {
            mean_stiffness: self.stiffness / (2.0 * LEVER * LEVER),
            stiffness_wave: StiffnessWave::Harmonic { stiffness_ratio: 0.0 },
            damping_ratio: self.damping_ratio,
            half_backlash: one(0.5 * self.lost_motion * LEVER),
            transmission_error: one(0.0),
            phases: MeshPhases::FromTeeth { stiffness: 0.0, error: 0.0 },
        };
        JointParameters {
            name,
            geometry: Geometry {
                planets: EQUIVALENT,
                // Tooth counts that give the ratio, (ring + sun) / sun.
                sun_teeth: under,
                planet_teeth: 0,
                ring_teeth: over.saturating_sub(under),
                working_pressure_angle: 0.0,
                sun_base_radius,
                planet_base_radius: 0.0,
                carrier_radius: LEVER,
                coherence: Coherence::Required,
            },
            bodies: Bodies {
                sun_equivalent_mass: self.inertia_at_input / (sun_base_radius * sun_base_radius),
                planet_equivalent_mass: 0.0,
                planet_mass: 0.0,
                carrier_inertia_over_radius_squared: 0.0,
            },
            rotor_inertia,
            link_inertia,
            compliance: None,
            sun_planet: mesh.clone(),
            ring_planet: mesh,
            damping_law: DampingLaw::Contact,
            dead_zone: DeadZone::Sharp,
            excitation: Excitation::Angle,
            // Wind-up at rated torque: the order of magnitude of deflections in contact.
            characteristic_length: LEVER * rated_output_torque / self.stiffness,
            rated_output_torque,
        }
    }
}

impl JointParameters {
    /// Returns the equivalent gear represented by the parameters; `None` for a planetary gear.
    pub fn equivalent_gear(&self) -> Option<EquivalentGear> {
        let (geometry, mesh) = (&self.geometry, &self.sun_planet);
        (geometry.planets == EQUIVALENT).then(|| EquivalentGear {
            ratio: [geometry.ring_teeth.saturating_add(geometry.sun_teeth), geometry.sun_teeth],
            lost_motion: 2.0 * mesh.half_backlash.first().copied().unwrap_or(0.0) / geometry.carrier_radius,
            stiffness: 2.0 * mesh.mean_stiffness * geometry.carrier_radius * geometry.carrier_radius,
            damping_ratio: mesh.damping_ratio,
            inertia_at_input: self.bodies.sun_equivalent_mass * geometry.sun_base_radius * geometry.sun_base_radius,
        })
    }
}
