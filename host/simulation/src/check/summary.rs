//! The result of `joint check` as data: figures in SI with their units in their names, as JSON in the schema
//! `joint-check/2`. They are computed in `derive`.

use serde::Serialize;

use crate::bandwidth::Bandwidth;
use crate::verdicts::Verdicts;

/// Says which fields there are; rises when one changes its meaning or goes.
pub(super) const SCHEMA: &str = "joint-check/2";

/// Everything that `joint check` says of a joint.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct CheckSummary {
    /// `joint-check/2`.
    pub schema: String,
    /// Path or preset.
    pub file: String,
    /// The joint's own name.
    pub name: String,
    /// From the file; may be empty.
    pub description: String,
    /// Ratio, stiffness, damping and inertias of an equivalent gear, in place of all that teeth have.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub equivalent_gear: Option<EquivalentFigures>,
    /// Teeth, radii, ratio; not of an equivalent gear.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub geometry: Option<GeometryFigures>,
    /// Masses along the line of action; not of an equivalent gear.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub equivalent_masses: Option<Masses>,
    /// omega_n and natural frequencies.
    pub frequencies: Frequencies,
    /// Sun-planet, then ring-planet; none of an equivalent gear.
    pub meshes: Vec<MeshFigures>,
    /// `contact` or `paper`.
    pub damping_law: &'static str,
    /// What the output does under load and when it is turned by hand.
    pub output: Output,
    /// How fast its control may be; left out where no compensation can be designed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bandwidth: Option<Bandwidth>,
    /// The fixed step at the wanted rate.
    pub fixed_step: FixedStep,
    /// How many numbers the file states, and how many of them it calls assumed.
    pub numbers: Numbers,
    /// What is odd but can be used.
    pub warnings: Vec<Warning>,
}

/// An equivalent gear with what is on either side of it.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[allow(missing_docs, non_snake_case, reason = "names and units say it")]
pub struct EquivalentFigures {
    pub motor_turns: u32,
    pub link_turns: u32,
    /// The first over the second.
    pub ratio: f64,
    pub stiffness_N_m_per_rad: f64,
    pub damping_ratio: f64,
    /// C = 2 zeta sqrt(K J), J both sides in series at the link.
    pub damping_N_m_s_per_rad: f64,
    /// Of the gear alone, at the motor.
    pub gear_inertia_at_input_kg_m2: f64,
    /// Rotor and gear, at the motor.
    pub motor_inertia_kg_m2: f64,
    /// The same, at the link.
    pub motor_inertia_at_link_kg_m2: f64,
    pub link_inertia_kg_m2: f64,
}

/// Teeth, radii, ratio.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[allow(missing_docs, reason = "names and units say it")]
pub struct GeometryFigures {
    pub planets: usize,
    pub sun_teeth: u32,
    pub planet_teeth: u32,
    pub ring_teeth: u32,
    pub working_pressure_angle_deg: f64,
    pub sun_base_radius_m: f64,
    pub planet_base_radius_m: f64,
    pub carrier_radius_m: f64,
    /// r_c cos(alpha).
    pub carrier_base_radius_m: f64,
    /// 2 r_c cos(alpha) / r_bs.
    pub ratio_by_radii: f64,
    /// 1 + Zr/Zs.
    pub ratio_by_teeth: f64,
}

/// Masses along the line of action, I / r^2.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Masses {
    /// The sun's own.
    pub sun_kg: f64,
    /// With the motor rotor.
    pub sun_with_rotor_kg: f64,
    /// Of one planet.
    pub planet_kg: f64,
    /// M_c: the carrier with its planets.
    pub carrier_with_planets_kg: f64,
    /// The link, over (r_c cos(alpha))^2; 0 without a link.
    pub link_kg: f64,
}

/// omega_n and natural frequencies, undamped, all meshes in contact at mean stiffness.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[allow(non_snake_case, reason = "Hz is written Hz")]
pub struct Frequencies {
    /// Eq. 18.
    pub omega_n_rad_per_s: f64,
    /// omega_n / 2 pi.
    pub omega_n_Hz: f64,
    /// Gears alone, as the paper has them; the rigid body's zero left out. None of an equivalent gear.
    pub gears_alone_Hz: Vec<f64>,
    /// With rotor, link and compliance; the rigid body's zero left out.
    pub whole_joint_Hz: Vec<f64>,
}

/// One family of meshes. Lists hold one value for each planet.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[allow(non_snake_case, reason = "N is written N")]
pub struct MeshFigures {
    /// `sun_planet` or `ring_planet`.
    pub kind: &'static str,
    /// b.
    pub half_backlash_m: Vec<f64>,
    /// Phase of the stiffness ripple, in mesh periods from 0 to 1.
    pub stiffness_phase_periods: Vec<f64>,
    /// Phase of the transmission error, likewise.
    pub error_phase_periods: Vec<f64>,
    /// K_m.
    pub mean_stiffness_N_per_m: f64,
    /// C of eqs 9 and 10.
    pub damping_N_s_per_m: f64,
    /// How far the teeth give under the rated torque, beyond b.
    pub deflection_at_rated_torque_m: f64,
}

/// Seen from the link.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[allow(non_snake_case, reason = "N is written N")]
pub struct Output {
    /// From the file.
    pub rated_torque_N_m: f64,
    /// At the sun, in balance with the rated torque by the ratio of radii.
    pub balancing_drive_torque_N_m: f64,
    /// Force of one mesh at rated torque, shared alike; not of an equivalent gear.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mesh_force_N: Option<f64>,
    /// Span of the gap coordinate u_s - 2 u_c while every mesh is free: 4 b. Of an equivalent gear, which has no line of
    /// action, on a lever of 1 m at the link.
    pub gap_m: f64,
    /// With the sun held, the link turns this far without resistance.
    pub lost_motion_rad: f64,
    /// The same in minutes of arc.
    pub lost_motion_arcmin: f64,
    /// With the link held, the sun turns this far.
    pub lost_motion_at_sun_rad: f64,
    /// Wind-up of the teeth at rated torque, beyond the lost motion.
    pub wind_up_of_teeth_rad: f64,
    /// Wind-up between carrier and link at rated torque.
    pub wind_up_of_compliance_rad: f64,
    /// Both together.
    pub wind_up_rad: f64,
    /// Both together in minutes of arc.
    pub wind_up_arcmin: f64,
    /// The efficiency is below 0.5: torque at the link alone does not turn the motor, as with a worm.
    pub self_locking: bool,
}

/// The fixed step at the wanted rate.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[allow(non_snake_case, reason = "Hz is written Hz")]
pub struct FixedStep {
    /// Board that it is made for.
    pub board: String,
    /// Asked for.
    pub rate_Hz: u32,
    /// Below it no step is stable.
    pub lowest_rate_Hz: u32,
    /// 1 / lowest rate.
    pub longest_step_s: f64,
    /// From it on the usual number of sub-steps resolves the fastest mode and the mesh frequency.
    pub recommended_rate_Hz: u32,
    /// 1 / recommended rate.
    pub recommended_step_s: f64,
    /// Method of the sub-steps of a tick in which contacts change: `corrected` or `leapfrog`.
    pub method: &'static str,
    /// How many of them.
    pub substeps: u32,
    /// Phase of the fastest mode in one of them.
    pub fastest_mode_phase_rad: f64,
    /// Flash that the f32 tables take.
    pub table_bytes: usize,
    /// The board's digest of them, in hexadecimal.
    pub digest: String,
    /// Errors and verdicts on that board in the role `plant`, where they were asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub verdicts: Option<Verdicts>,
}

/// The sources of the file's numbers.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Numbers {
    /// Numbers in the file.
    pub stated: usize,
    /// Those whose comment begins with "assumed".
    pub assumed: usize,
    /// Those without a comment.
    pub without_source: usize,
}

/// What is odd but can be used.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Warning {
    /// Line of the file, from 1.
    pub line: usize,
    /// What is odd.
    pub message: String,
    /// How to mend it.
    pub help: String,
}
