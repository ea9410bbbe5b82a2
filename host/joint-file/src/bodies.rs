//! Reads `[bodies]` and `[compliance]`. Both readings of the paper's Table 1 are accepted: I / r^2 in kg and I in kg
//! m^2.

use parameters::{Bodies, Compliance, Geometry, Mesh};

use crate::section::Section;
use crate::sheet;

/// Masses of the gears, rotor inertia and link inertia.
pub(crate) struct Masses {
    pub bodies: Bodies,
    pub rotor_inertia: f64,
    pub link_inertia: f64,
}

/// Reads the masses; `None` after a noted problem. Inertias need the geometry's radii.
pub(crate) fn read(section: &Section<'_>, geometry: Option<&Geometry>) -> Option<Masses> {
    let rotor_inertia = optional(section, "rotor_inertia_kg_m2", 0.0);
    let link_inertia = optional(section, "link_inertia_kg_m2", 0.0);
    let bodies =
        if section.has(COMBINED_KEY) { read_at_input(section, geometry) } else { read_each(section, geometry) };
    Some(Masses { bodies: bodies?, rotor_inertia: rotor_inertia?, link_inertia: link_inertia? })
}

/// Key of a data sheet's inertia of gears and carrier together; ...
pub(crate) const COMBINED_KEY: &str = "gear_inertia_at_input_kg_cm2";

/// ... it replaces these keys.
pub(crate) const SEPARATE_KEYS: [&str; 8] = [
    "sun_equivalent_mass_kg",
    "sun_inertia_kg_m2",
    "planet_equivalent_mass_kg",
    "planet_inertia_kg_m2",
    "planet_mass_kg",
    "carrier_inertia_over_radius_squared_kg",
    "carrier_equivalent_mass_kg",
    "carrier_inertia_kg_m2",
];

/// Gears and carrier from their inertia at the input, shared as by discs of one thickness.
fn read_at_input(section: &Section<'_>, geometry: Option<&Geometry>) -> Option<Bodies> {
    for key in SEPARATE_KEYS.into_iter().filter(|key| section.has(key)) {
        let message = format!("`{key}` and `{COMBINED_KEY}` both state the inertia of gears and carrier");
        let help = format!("keep `{COMBINED_KEY}`, or the masses of sun, planets and carrier");
        section.notes.error(section.place(key), message, help);
    }
    let inertia = section.number(COMBINED_KEY)?;
    geometry.map(|geometry| sheet::bodies(inertia, geometry))
}

/// Gears and carrier from their own keys.
fn read_each(section: &Section<'_>, geometry: Option<&Geometry>) -> Option<Bodies> {
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
    Some(Bodies {
        sun_equivalent_mass: sun?,
        planet_equivalent_mass: planet?,
        planet_mass: planet_mass?,
        carrier_inertia_over_radius_squared: carrier?,
    })
}

/// Reads the torsion spring between carrier and link. A data sheet's stiffness at the output includes the teeth, whose
/// compliance is subtracted.
pub(crate) fn read_compliance(
    section: &Section<'_>,
    geometry: Option<&Geometry>,
    meshes: Option<&[Mesh; 2]>,
) -> Option<Compliance> {
    const BEHIND: &str = "stiffness_N_m_per_rad";
    const TOTAL: &str = "total_stiffness_N_m_per_arcmin";
    let damping_ratio = section.required_number("damping_ratio");
    let stiffness = if section.has(TOTAL) {
        section.one_of(&[BEHIND, TOTAL], true)?;
        let total = section.number(TOTAL)?;
        let teeth = sheet::teeth_compliance(geometry?, meshes?.each_ref().map(|mesh| mesh.mean_stiffness));
        let left = sheet::shaft_stiffness(total, teeth);
        if left.is_none() {
            let of_teeth = sheet::ARCMIN / teeth;
            let stated = total * sheet::ARCMIN;
            let message = format!("`{TOTAL}` is {stated:.4}, but the teeth alone give {of_teeth:.4} N m/arcmin");
            let help = "teeth and shafts in series are softer than the teeth: raise `mean_stiffness_N_per_m` of [mesh], or \
                        leave [compliance] out";
            section.notes.error(section.place(TOTAL), message, help);
        }
        left
    } else {
        section.required_number(BEHIND)
    };
    Some(Compliance { stiffness: stiffness?, damping_ratio: damping_ratio? })
}

/// I / r^2, stated directly (first key) or as I (second key).
fn equivalent_mass(section: &Section<'_>, keys: [&'static str; 2], radius: Option<f64>) -> Option<f64> {
    let key = section.one_of(&keys, true)?;
    let value = section.number(key)?;
    if key == keys[0] { Some(value) } else { radius.map(|radius| value / (radius * radius)) }
}

/// I_c / r_c^2 from any of its three keys.
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

/// Value of a key with a default; `None` only for a wrong value.
fn optional(section: &Section<'_>, key: &str, default: f64) -> Option<f64> {
    if section.has(key) { section.number(key) } else { Some(default) }
}
