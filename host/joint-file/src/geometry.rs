//! Reads `[geometry]`: teeth, angles, and radii, either stated or derived from module and teeth. `coherence` checks
//! that they fit together.

use parameters::{Coherence, Geometry};

use crate::section::Section;

const RADII: [&str; 4] = ["sun_base_radius_mm", "planet_base_radius_mm", "carrier_radius_mm", "carrier_base_radius_mm"];

/// Reads the geometry; `None` after a noted problem.
pub(crate) fn read(section: &Section<'_>, coherence: Coherence) -> Option<Geometry> {
    let planets = section.required_whole("planets");
    let sun_teeth = section.required_whole("sun_teeth");
    let planet_teeth = section.required_whole("planet_teeth");
    let ring_teeth = section.required_whole("ring_teeth");
    let working = section.required_number("working_pressure_angle_deg");
    let reference = section.number("reference_pressure_angle_deg").or(working);

    let (sun, planet, carrier) = if section.has("module_mm") {
        for radius in RADII.into_iter().filter(|radius| section.has(radius)) {
            let message = format!("`{radius}` and `module_mm` both set the radii");
            section.notes.error(section.place(radius), message, "keep the module, or all radii and no module");
        }
        let half_module = section.number("module_mm").map(|module| module / 2.0);
        let base = |teeth: Option<u32>| Some(half_module? * f64::from(teeth?) * reference?.cos());
        let (sun, planet) = (base(sun_teeth), base(planet_teeth));
        // Only centre distance at which the pair works at this angle.
        let carrier = || Some((sun? + planet?) / working?.cos());
        (sun, planet, carrier())
    } else {
        if section.has("reference_pressure_angle_deg") {
            let message = "`reference_pressure_angle_deg` has no effect without `module_mm`";
            let help = "leave it out, or give module_mm instead of the radii";
            section.notes.error(section.place("reference_pressure_angle_deg"), message, help);
        }
        let sun = section.required_number("sun_base_radius_mm");
        let planet = section.required_number("planet_base_radius_mm");
        let carrier = match section.one_of(&["carrier_radius_mm", "carrier_base_radius_mm"], true) {
            Some("carrier_base_radius_mm") => {
                let lever = section.number("carrier_base_radius_mm");
                lever.zip(working).map(|(lever, angle)| lever / angle.cos())
            }
            Some(key) => section.number(key),
            None => None,
        };
        (sun, planet, carrier)
    };

    Some(Geometry {
        planets: planets? as usize,
        sun_teeth: sun_teeth?,
        planet_teeth: planet_teeth?,
        ring_teeth: ring_teeth?,
        working_pressure_angle: working?,
        sun_base_radius: sun?,
        planet_base_radius: planet?,
        carrier_radius: carrier?,
        coherence,
    })
}
