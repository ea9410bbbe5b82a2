//! Checks that the gears fit together: coaxial, assembling, one centre distance, one ratio, and room between the
//! planets. The file's key `coherence` makes a misfit an error or a warning.

use model_core::gears::Kinematics;
use parameters::{Coherence, Geometry};

use crate::notes::Notes;
use crate::problem::Severity;

/// Relative difference from which two lengths or ratios differ.
const MISFIT_TOLERANCE: f64 = 1e-4;

/// Relative difference within which a carrier radius is taken for r_c cos(alpha).
const LEVER_TOLERANCE: f64 = 1e-3;

/// Notes every misfit.
pub(crate) fn check(geometry: &Geometry, notes: &Notes<'_>) {
    let severity = match geometry.coherence {
        Coherence::Required => Severity::Error,
        Coherence::Warned => Severity::Warning,
    };
    let note = |keys: &[&str], message: String, help: String| {
        notes.problem(notes.first_place(keys), message, help, severity);
    };
    let (sun, planet, ring) = (geometry.sun_teeth, geometry.planet_teeth, geometry.ring_teeth);

    let coaxial = sun + 2 * planet;
    if ring != coaxial {
        let message =
            format!("not coaxial: the ring has {ring} teeth, sun and planets need {sun} + 2 x {planet} = {coaxial}");
        note(&["geometry.ring_teeth"], message, format!("ring_teeth = {coaxial}"));
    }

    let planets = geometry.planets as u32;
    if (sun + ring) % planets != 0 {
        let message =
            format!("{planets} equally spaced planets do not assemble: ({sun} + {ring}) / {planets} is not whole");
        let help = match (3..=5).filter(|count| (sun + ring) % count == 0).collect::<Vec<_>>()[..] {
            [] => "choose teeth of sun and ring whose sum can be divided by the number of planets".to_owned(),
            [count, ..] => format!("these teeth take {count} planets, or choose others"),
        };
        note(&["geometry.planets"], message, help);
    }

    let lever = geometry.carrier_base_radius();
    let base_radii = geometry.sun_base_radius + geometry.planet_base_radius;
    if differ(lever, base_radii, MISFIT_TOLERANCE) {
        let keys = ["geometry.carrier_radius_mm", "geometry.carrier_base_radius_mm"];
        let wanted = 1e3 * base_radii / geometry.working_pressure_angle.cos();
        let (have, need) = (1e3 * lever, 1e3 * base_radii);
        if differ(geometry.carrier_radius, base_radii, LEVER_TOLERANCE) {
            let message =
                format!("r_c cos(alpha) = {have:.4} mm, but the base radii of sun and planet sum to {need:.4} mm");
            note(&keys, message, format!("at this working pressure angle r_c is {wanted:.4} mm"));
        } else {
            let message = format!("this carrier radius is r_c cos(alpha) = {need:.4} mm: cos(alpha) would count twice");
            let help = format!("write carrier_base_radius_mm for it, or carrier_radius_mm = {wanted:.4}");
            note(&keys, message, help);
        }
    }

    let (by_radii, by_teeth) = (2.0 * base_radii / geometry.sun_base_radius, geometry.ratio_by_teeth());
    if differ(by_radii, by_teeth, MISFIT_TOLERANCE) {
        let keys = ["geometry.planet_base_radius_mm", "geometry.sun_base_radius_mm", "geometry.ring_teeth"];
        let message = format!("the ratio is {by_radii:.5} by base radii and {by_teeth:.5} by teeth");
        let help = "r_bp / r_bs must be planet_teeth / sun_teeth, and ring_teeth = sun_teeth + 2 planet_teeth";
        note(&keys, message, help.to_owned());
    }

    room_between_planets(geometry, notes);
}

/// Planets whose pitch circles meet can never be mounted; tips that meet may have been cut.
fn room_between_planets(geometry: &Geometry, notes: &Notes<'_>) {
    let pitch_radius = geometry.planet_base_radius / geometry.working_pressure_angle.cos();
    let tip_radius = pitch_radius * (1.0 + 2.0 / f64::from(geometry.planet_teeth));
    let spacing = 2.0 * geometry.carrier_radius * (core::f64::consts::PI / geometry.planets as f64).sin();
    let place = notes.first_place(&["geometry.planets"]);
    let millimetres = |length: f64| 1e3 * length;
    if spacing <= 2.0 * pitch_radius {
        let message = format!(
            "neighbouring planets collide: their axes are {:.3} mm apart, their pitch diameter is {:.3} mm",
            millimetres(spacing),
            millimetres(2.0 * pitch_radius)
        );
        notes.error(place, message, "fewer planets, or a larger sun with smaller planets");
    } else if spacing <= 2.0 * tip_radius {
        let message = format!(
            "neighbouring planets touch at the tips: axes {:.3} mm apart, tip diameter {:.3} mm at full tooth height",
            millimetres(spacing),
            millimetres(2.0 * tip_radius)
        );
        notes.problem(place, message, "fewer planets, smaller planets, or stub teeth", Severity::Warning);
    }
}

fn differ(one: f64, other: f64, relative: f64) -> bool {
    (one - other).abs() > relative * other.abs()
}
