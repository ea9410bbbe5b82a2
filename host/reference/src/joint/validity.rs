//! Parameter checks of the reference; each error states cause and remedy. The geometry is not checked for coherence:
//! the equations hold for any radii.

use std::fmt;

use parameters::{DeadZone, EquivalentGear, Excitation, JointParameters, MAX_PLANETS, MIN_PLANETS, Mesh, MeshPhases};

use crate::integrator::IntegrationError;

/// Reason for refusing a joint or stopping its integration.
#[derive(Debug, Clone, PartialEq)]
pub enum ReferenceError {
    /// The tanh dead zone of eq. 13, which only approximates the sharp dead zone of the reference.
    SmoothDeadZone,
    /// Number of planets outside the model's range.
    Planets(usize),
    /// A list that does not have one value per planet.
    ListLength {
        /// Name of the list.
        quantity: &'static str,
        /// Length of the list.
        length: usize,
        /// Number of planets.
        planets: usize,
    },
    /// A quantity is out of range, infinite or NaN.
    OutOfRange {
        /// Name of the quantity.
        quantity: &'static str,
        /// Rejected value.
        value: f64,
        /// Required range.
        must_be: &'static str,
    },
    /// The integration failed.
    Integration(IntegrationError),
}

impl fmt::Display for ReferenceError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::SmoothDeadZone => {
                write!(formatter, "the reference has no tanh dead zone; set the dead zone to sharp to compare with it")
            }
            Self::Planets(planets) => {
                write!(formatter, "{planets} planets; the reference takes {MIN_PLANETS} to {MAX_PLANETS}")
            }
            Self::ListLength { quantity, length, planets } => {
                write!(formatter, "{quantity} has {length} values for {planets} planets; give one for each")
            }
            Self::OutOfRange { quantity, value, must_be } => {
                write!(formatter, "{quantity} is {value}; it must be {must_be}")
            }
            Self::Integration(error) => write!(formatter, "{error}; check the joint's parameters and torques"),
        }
    }
}

impl std::error::Error for ReferenceError {}

impl From<IntegrationError> for ReferenceError {
    fn from(error: IntegrationError) -> Self {
        Self::Integration(error)
    }
}

/// Refuses parameters that would divide by zero, never end, or be misinterpreted.
pub(super) fn check(joint: &JointParameters) -> Result<(), ReferenceError> {
    if joint.dead_zone != DeadZone::Sharp {
        return Err(ReferenceError::SmoothDeadZone);
    }
    if let Some(gear) = joint.equivalent_gear() {
        return check_equivalent(joint, &gear);
    }
    let planets = joint.geometry.planets;
    if !(MIN_PLANETS..=MAX_PLANETS).contains(&planets) {
        return Err(ReferenceError::Planets(planets));
    }
    let geometry = &joint.geometry;
    positive("cosine of the working pressure angle", geometry.working_pressure_angle.cos())?;
    positive("number of ring teeth", f64::from(geometry.ring_teeth))?;
    positive("sun base radius", geometry.sun_base_radius)?;
    positive("carrier radius", geometry.carrier_radius)?;
    positive("sun equivalent mass", joint.bodies.sun_equivalent_mass)?;
    positive("planet equivalent mass", joint.bodies.planet_equivalent_mass)?;
    not_negative("planet mass", joint.bodies.planet_mass)?;
    positive("carrier inertia over radius squared", joint.bodies.carrier_inertia_over_radius_squared)?;
    not_negative("rotor inertia", joint.rotor_inertia)?;
    not_negative("link inertia", joint.link_inertia)?;
    positive("characteristic length", joint.characteristic_length)?;
    if let Some(compliance) = joint.compliance {
        positive("compliance stiffness", compliance.stiffness)?;
        not_negative("compliance damping ratio", compliance.damping_ratio)?;
        positive("link inertia behind a compliance", joint.link_inertia)?;
    }
    if let Excitation::Time { mesh_frequency } = joint.excitation {
        not_negative("mesh frequency", mesh_frequency)?;
    }
    check_mesh(&joint.sun_planet, planets)?;
    check_mesh(&joint.ring_planet, planets)
}

fn check_equivalent(joint: &JointParameters, gear: &EquivalentGear) -> Result<(), ReferenceError> {
    let [over, under] = gear.ratio.map(f64::from);
    must("ratio of an equivalent gear", over / under, over > under && under > 0.0, "above 1")?;
    not_negative("lost motion", gear.lost_motion)?;
    positive("stiffness of an equivalent gear", gear.stiffness)?;
    not_negative("damping ratio of an equivalent gear", gear.damping_ratio)?;
    not_negative("inertia of an equivalent gear", gear.inertia_at_input)?;
    not_negative("rotor inertia", joint.rotor_inertia)?;
    positive("inertia of rotor and equivalent gear", joint.rotor_inertia + gear.inertia_at_input)?;
    positive("link inertia behind an equivalent gear", joint.link_inertia)?;
    positive("characteristic length", joint.characteristic_length)
}

fn check_mesh(mesh: &Mesh, planets: usize) -> Result<(), ReferenceError> {
    positive("mean mesh stiffness", mesh.mean_stiffness)?;
    not_negative("mesh damping ratio", mesh.damping_ratio)?;
    let mut lists = vec![("half-backlash", &mesh.half_backlash), ("transmission error", &mesh.transmission_error)];
    if let MeshPhases::Given { stiffness, error } = &mesh.phases {
        lists.extend([("stiffness phase", stiffness), ("error phase", error)]);
    }
    for (quantity, list) in lists {
        if list.len() != planets {
            return Err(ReferenceError::ListLength { quantity, length: list.len(), planets });
        }
        for value in list {
            must(quantity, *value, value.is_finite(), "finite")?;
        }
    }
    mesh.half_backlash.iter().try_for_each(|value| not_negative("half-backlash", *value))
}

fn positive(quantity: &'static str, value: f64) -> Result<(), ReferenceError> {
    must(quantity, value, value.is_finite() && value > 0.0, "positive and finite")
}

fn not_negative(quantity: &'static str, value: f64) -> Result<(), ReferenceError> {
    must(quantity, value, value.is_finite() && value >= 0.0, "zero or positive, and finite")
}

fn must(quantity: &'static str, value: f64, holds: bool, must_be: &'static str) -> Result<(), ReferenceError> {
    if holds { Ok(()) } else { Err(ReferenceError::OutOfRange { quantity, value, must_be }) }
}
