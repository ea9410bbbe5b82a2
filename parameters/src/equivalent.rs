//! An equivalent gear: what is known of a spur train, a cycloid or a belt whose teeth nobody knows, and how it is written
//! as joint parameters. Preload and hysteresis, as harmonic drives have them, are not in it.

use heapless::String;

use crate::joint::{Bodies, Coherence, Excitation, Geometry, JointParameters};
use crate::mesh::{DampingLaw, DeadZone, Mesh, MeshPhases, StiffnessWave};
use crate::planets::PerPlanet;

/// Planets of an equivalent gear's parameters: one without mass, which stands for whatever is between both shafts.
pub const EQUIVALENT: usize = 1;

/// Lever at the link on which lengths of an equivalent gear are counted, since it has no line of action: 1 um stands for
/// 1 urad at the link [m].
const LEVER: f64 = 1.0;

/// A gear of which ratio, lost motion, stiffness, damping and inertia are known, and no teeth.
///
/// Motor and link turn on a spring with a gap: with the deflection delta = theta_m / ratio - theta_l and half the lost
/// motion b, the torque at the link is max(0, K (delta - b) + C delta') for delta > b, min(0, K (delta + b) + C delta')
/// for delta < -b, and 0 between. Signs are those of [`JointParameters`].
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
    /// Motor turns over link turns as a fraction of whole numbers, above 1.
    pub ratio: [u32; 2],
    /// With the motor held, the link turns so far without resistance [rad].
    pub lost_motion: f64,
    /// Between motor and link, at the link [N m/rad].
    pub stiffness: f64,
    /// Of the motor's side swinging against the link in contact: C = 2 zeta sqrt(K J), J of both sides, referred to the
    /// link, in series [-].
    pub damping_ratio: f64,
    /// Inertia of the gear at its input, without the rotor [kg m^2].
    pub inertia_at_input: f64,
}

impl EquivalentGear {
    /// A joint with this gear: rotor inertia [kg m^2], link inertia [kg m^2], rated torque at the link [N m].
    ///
    /// One planet without mass has the same force in both of its meshes, which are then two springs in series: each takes
    /// half of what motor and link are apart, on the lever of the link.
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
                // No teeth: the ratio's whole numbers, (ring + sun) / sun.
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
            // What the rated torque winds up: deflections in contact are of that size.
            characteristic_length: LEVER * rated_output_torque / self.stiffness,
            rated_output_torque,
        }
    }
}

impl JointParameters {
    /// The equivalent gear that these parameters stand for, if they do.
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
