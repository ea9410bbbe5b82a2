//! Reads `[contact]`, `[excitation]` and `[profile]`: the contact law of teeth, the source of the mesh phase, and the
//! torques that scale a motion profile.

use parameters::{DampingLaw, DeadZone, Excitation};

use crate::section::Section;

/// Torques for motion profiles.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Profile {
    /// Rated motor torque: balances the rated output torque, at most the motor's limit [N m].
    pub drive_torque: f64,
    /// Largest motor torque in either direction [N m].
    pub motor_torque_limit: f64,
}

/// Contact law of `[contact]`, with defaults without the section.
pub(crate) fn read_contact(section: Option<&Section<'_>>) -> Option<(DampingLaw, DeadZone)> {
    let Some(section) = section else { return Some((DampingLaw::Contact, DeadZone::Sharp)) };
    let law = if section.has("damping_law") { section.choice("damping_law") } else { Some("contact") };
    let zone = if section.has("dead_zone") { section.choice("dead_zone") } else { Some("sharp") };
    let zone = match zone? {
        "tanh" => DeadZone::Tanh { sharpness: section.required_number("sharpness")? },
        _ => {
            if section.has("sharpness") {
                let message = "`sharpness` belongs to the tanh dead zone, and this one is sharp";
                section.notes.error(section.place("sharpness"), message, "write dead_zone = \"tanh\"");
            }
            DeadZone::Sharp
        }
    };
    Some((if law? == "paper" { DampingLaw::Paper } else { DampingLaw::Contact }, zone))
}

/// Source of the mesh phase, from `[excitation]`; the joint's own angle without the section. A frequency may be stated
/// in units of `omega_n` (eq. 18), which is unknown while the rest of the file is wrong.
pub(crate) fn read_excitation(section: Option<&Section<'_>>, omega_n: Option<f64>) -> Option<Excitation> {
    const FREQUENCIES: [&str; 3] = ["mesh_frequency_rad_per_s", "mesh_frequency_Hz", "mesh_frequency_over_omega_n"];
    let Some(section) = section else { return Some(Excitation::Angle) };
    let mode = if section.has("mode") { section.choice("mode")? } else { "angle" };
    if mode == "time" {
        let key = section.one_of(&FREQUENCIES, true)?;
        let value = section.number(key)?;
        let mesh_frequency = match key {
            "mesh_frequency_Hz" => core::f64::consts::TAU * value,
            "mesh_frequency_over_omega_n" => value * omega_n?,
            _ => value,
        };
        return Some(Excitation::Time { mesh_frequency });
    }
    for key in FREQUENCIES.into_iter().filter(|key| section.has(key)) {
        let message =
            format!("`{key}` belongs to mode \"time\"; in mode \"angle\" the frequency follows from the motion");
        section.notes.error(section.place(key), message, "leave it out, or write mode = \"time\"");
    }
    Some(Excitation::Angle)
}

/// Torques of `[profile]`. An unstated drive torque balances the rated output torque, limited by a stated motor limit:
/// gearheads are often rated above the motor in front of them.
pub(crate) fn read_profile(
    section: Option<&Section<'_>>,
    ratio: Option<f64>,
    rated_output_torque: Option<f64>,
) -> Option<Profile> {
    let stated = |key| section.filter(|section| section.has(key)).map(|section| section.number(key));
    let balancing = ratio.zip(rated_output_torque).map(|(ratio, torque)| torque / ratio);
    let stated_limit = stated("motor_torque_limit_N_m");
    let drive_torque = match (stated("drive_torque_N_m"), stated_limit) {
        (Some(torque), _) => torque,
        (None, Some(limit)) => balancing.zip(limit).map(|(torque, limit)| torque.min(limit)),
        (None, None) => balancing,
    };
    let limit = match stated_limit {
        Some(limit) => limit,
        None => drive_torque.map(|torque| 2.0 * torque),
    };
    let profile = Profile { drive_torque: drive_torque?, motor_torque_limit: limit? };
    if profile.motor_torque_limit < profile.drive_torque
        && let Some(section) = section
    {
        let message = format!(
            "`motor_torque_limit_N_m` is below the drive torque of {:.4} N m that the joint is rated for",
            profile.drive_torque
        );
        let help = "raise the limit, or lower `drive_torque_N_m` or `rated_output_torque_N_m`";
        section.notes.error(section.place("motor_torque_limit_N_m"), message, help);
    }
    Some(profile)
}
