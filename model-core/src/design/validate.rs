//! Whether parameters can be designed for at all: lists of the right length, physical signs, finite numbers. Whether
//! the geometry is coherent is judged where joint files are read.

use crate::error::DesignError;
use crate::joint::{Excitation, JointParameters, MAX_PLANETS, MIN_PLANETS};
use crate::mesh::{MAX_HARMONICS, MESH_KINDS, MeshPhases};

/// Physical quantities in SI stay within these for any joint; what is outside would not fit an f32 table.
const SMALLEST: f64 = 1e-12;
const LARGEST: f64 = 1e12;

fn positive(what: &'static str, given: f64) -> Result<(), DesignError> {
    let good = (SMALLEST..=LARGEST).contains(&given);
    good.then_some(()).ok_or(DesignError::OutOfRange { what, given, must_be: "between 1e-12 and 1e12 (SI units)" })
}

fn not_negative(what: &'static str, given: f64) -> Result<(), DesignError> {
    let good = (0.0..=LARGEST).contains(&given);
    good.then_some(()).ok_or(DesignError::OutOfRange { what, given, must_be: "zero or more, and finite" })
}

fn finite(what: &'static str, given: f64) -> Result<(), DesignError> {
    let good = (-LARGEST..=LARGEST).contains(&given);
    good.then_some(()).ok_or(DesignError::OutOfRange { what, given, must_be: "a finite number" })
}

/// Checks everything that the tables rest on.
pub fn validate(parameters: &JointParameters) -> Result<(), DesignError> {
    let geometry = &parameters.geometry;
    let planets = geometry.planets;
    if !(MIN_PLANETS..=MAX_PLANETS).contains(&planets) {
        return Err(DesignError::PlanetCount { given: planets });
    }
    positive("the sun's base radius", geometry.sun_base_radius)?;
    positive("the planets' base radius", geometry.planet_base_radius)?;
    positive("the carrier radius", geometry.carrier_radius)?;
    let angle = geometry.working_pressure_angle;
    if !(0.0..1.2).contains(&angle) {
        let must_be = "an angle from 0 to 1.2 rad";
        return Err(DesignError::OutOfRange { what: "the working pressure angle", given: angle, must_be });
    }
    let bodies = &parameters.bodies;
    positive("the sun's equivalent mass", bodies.sun_equivalent_mass)?;
    positive("the planets' equivalent mass", bodies.planet_equivalent_mass)?;
    not_negative("the planets' mass", bodies.planet_mass)?;
    positive("the carrier's inertia over radius squared", bodies.carrier_inertia_over_radius_squared)?;
    not_negative("the rotor inertia", parameters.rotor_inertia)?;
    not_negative("the link inertia", parameters.link_inertia)?;
    positive("the characteristic length", parameters.characteristic_length)?;
    if let Some(compliance) = &parameters.compliance {
        positive("the torsional stiffness", compliance.stiffness)?;
        not_negative("the torsional damping ratio", compliance.damping_ratio)?;
        positive("the link inertia behind a compliance", parameters.link_inertia)?;
    }
    match parameters.excitation {
        Excitation::Time { mesh_frequency } => not_negative("the mesh frequency", mesh_frequency)?,
        Excitation::Angle => positive("the ring's number of teeth", geometry.ring_teeth.into())?,
    }
    if let crate::dead_zone::DeadZone::Tanh { sharpness } = parameters.dead_zone {
        positive("the sharpness of the dead zone", sharpness)?;
    }
    for kind in MESH_KINDS {
        let mesh = parameters.mesh(kind);
        positive("a mean mesh stiffness", mesh.mean_stiffness)?;
        not_negative("a mesh damping ratio", mesh.damping_ratio)?;
        let lists =
            [("the list of half-backlashes", &mesh.half_backlash), ("the list of errors", &mesh.transmission_error)];
        let phases = match &mesh.phases {
            MeshPhases::Given { stiffness, error } => [Some(stiffness), Some(error)],
            MeshPhases::FromTeeth { .. } => [None, None],
        };
        let lists = lists.into_iter().chain(phases.into_iter().flatten().map(|list| ("a list of phases", list)));
        for (what, list) in lists {
            if list.len() != planets {
                return Err(DesignError::ListLength { what, given: list.len(), planets });
            }
        }
        for i in 0..planets {
            not_negative("a half-backlash", mesh.half_backlash[i])?;
            finite("a transmission error", mesh.transmission_error[i])?;
            finite("a stiffness phase", parameters.stiffness_phase(kind, i))?;
            finite("an error phase", parameters.error_phase(kind, i))?;
        }
        let order = mesh.stiffness_wave.order();
        if !(1..=MAX_HARMONICS).contains(&order) {
            let given = order as f64;
            return Err(DesignError::OutOfRange { what: "the order of the stiffness wave", given, must_be: "1 to 8" });
        }
        let swing = mesh.stiffness_wave.swing();
        if swing.is_nan() || swing >= 1.0 {
            let what = "the sum of the stiffness ripple's harmonics over the mean";
            return Err(DesignError::OutOfRange { what, given: swing, must_be: "below 1: stiffness stays positive" });
        }
    }
    Ok(())
}
