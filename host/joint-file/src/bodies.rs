//! Reads `[bodies]` and `[compliance]`. Both readings of the paper's Table 1 are accepted, I / r^2 in kg and I in kg
//! m^2.

use parameters::{Bodies, Compliance, Geometry};

use crate::section::Section;

/// Masses of the gears, rotor inertia and link inertia.
pub(crate) struct Masses {
    pub bodies: Bodies,
    pub rotor_inertia: f64,
    pub link_inertia: f64,
}

/// The masses, or `None` once what is wrong has been noted. Inertias need the geometry's radii.
pub(crate) fn read(section: &Section<'_>, geometry: Option<&Geometry>) -> Option<Masses> {
    let sun = equivalent_mass(
        section,
        ["sun_equivalent_mass_kg", "sun_inertia_kg_m2"],
        geometry.map(|geometry| geometry.sun_base_radius),
    );
    let planet = equivalent_mass(
        section,
        ["planet_equivalent_mass_kg", "planet_inertia_kg_m2"],
        geometry.map(|geometry| geometry.planet_base_radius),
    );
    let planet_mass = section.required_number("planet_mass_kg");
    let carrier = carrier_mass(section, geometry);
    let rotor_inertia = optional(section, "rotor_inertia_kg_m2", 0.0);
    let link_inertia = optional(section, "link_inertia_kg_m2", 0.0);
    Some(Masses {
        bodies: Bodies {
            sun_equivalent_mass: sun?,
            planet_equivalent_mass: planet?,
            planet_mass: planet_mass?,
            carrier_inertia_over_radius_squared: carrier?,
        },
        rotor_inertia: rotor_inertia?,
        link_inertia: link_inertia?,
    })
}

/// The torsion spring between carrier and link.
pub(crate) fn read_compliance(section: &Section<'_>) -> Option<Compliance> {
    let stiffness = section.required_number("stiffness_N_m_per_rad");
    let damping_ratio = section.required_number("damping_ratio");
    Some(Compliance { stiffness: stiffness?, damping_ratio: damping_ratio? })
}

/// I / r^2, stated as such (first key) or by I (second key).
fn equivalent_mass(section: &Section<'_>, keys: [&'static str; 2], radius: Option<f64>) -> Option<f64> {
    let key = section.one_of(&keys, true)?;
    let value = section.number(key)?;
    if key == keys[0] { Some(value) } else { radius.map(|radius| value / (radius * radius)) }
}

/// I_c / r_c^2 in any of its three forms.
fn carrier_mass(section: &Section<'_>, geometry: Option<&Geometry>) -> Option<f64> {
    const STATED: &str = "carrier_inertia_over_radius_squared_kg";
    const ON_LINE_OF_ACTION: &str = "carrier_equivalent_mass_kg";
    const INERTIA: &str = "carrier_inertia_kg_m2";
    let key = section.one_of(&[STATED, ON_LINE_OF_ACTION, INERTIA], true)?;
    let value = section.number(key)?;
    match key {
        STATED => Some(value),
        ON_LINE_OF_ACTION => geometry.map(|geometry| value * geometry.working_pressure_angle.cos().powi(2)),
        _ => geometry.map(|geometry| value / geometry.carrier_radius.powi(2)),
    }
}

/// A key with a default; `None` only if it is there and wrong.
fn optional(section: &Section<'_>, key: &str, default: f64) -> Option<f64> {
    if section.has(key) { section.number(key) } else { Some(default) }
}
