//! Result of `joint check` as data: figures in SI with their units in their names, as JSON in the schema
//! `joint-check/2`. `derive` computes the figures.

use serde::Serialize;

use crate::bandwidth::Bandwidth;
use crate::verdicts::Verdicts;

/// Name and version of the schema; the version rises when a field changes its meaning or is removed.
pub(super) const SCHEMA: &str = "joint-check/2";

/// Result of `joint check` for a joint.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct CheckSummary {
    /// `joint-check/2`.
    pub schema: String,
    /// Path or preset of the joint file.
    pub file: String,
    /// Name of the joint.
    pub name: String,
    /// Description in the file; may be empty.
    pub description: String,
    /// Ratio, stiffness, damping and inertias of an equivalent gear, which has no teeth.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub equivalent_gear: Option<EquivalentFigures>,
    /// Teeth, radii, ratio; absent for an equivalent gear.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub geometry: Option<GeometryFigures>,
    /// Masses along the line of action; absent for an equivalent gear.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub equivalent_masses: Option<Masses>,
    /// Natural frequencies and omega_n.
    pub frequencies: Frequencies,
    /// Sun-planet, then ring-planet meshes; empty for an equivalent gear.
    pub meshes: Vec<MeshFigures>,
    /// `contact` or `paper`.
    pub damping_law: &'static str,
    /// Behaviour of the output under load and when turned by hand.
    pub output: Output,
    /// Bandwidth of the control; absent if no compensation can be designed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bandwidth: Option<Bandwidth>,
    /// Fixed step at the requested rate.
    pub fixed_step: FixedStep,
    /// Numbers stated in the file, and numbers marked as assumed.
    pub numbers: Numbers,
    /// Warnings of the joint file.
    pub warnings: Vec<Warning>,
}

/// An equivalent gear with the inertias on both sides.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[allow(missing_docs, non_snake_case, reason = "names and units say it")]
pub struct EquivalentFigures {
    pub motor_turns: u32,
    pub link_turns: u32,
    /// Motor turns over link turns.
    pub ratio: f64,
    pub stiffness_N_m_per_rad: f64,
    pub damping_ratio: f64,
    /// C = 2 zeta sqrt(K J), with J both sides in series at the link.
    pub damping_N_m_s_per_rad: f64,
    /// Inertia of the gear alone, at the motor.
    pub gear_inertia_at_input_kg_m2: f64,
    /// Inertia of rotor and gear, at the motor.
    pub motor_inertia_kg_m2: f64,
    /// Inertia of rotor and gear, at the link.
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
    /// Sun.
    pub sun_kg: f64,
    /// Sun with the motor rotor.
    pub sun_with_rotor_kg: f64,
    /// One planet.
    pub planet_kg: f64,
    /// Carrier with its planets, M_c.
    pub carrier_with_planets_kg: f64,
    /// Link, over (r_c cos(alpha))^2; 0 without a link.
    pub link_kg: f64,
}

/// Undamped natural frequencies and omega_n, with all meshes in contact at mean stiffness.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[allow(non_snake_case, reason = "Hz is written Hz")]
pub struct Frequencies {
    /// Eq. 18.
    pub omega_n_rad_per_s: f64,
    /// omega_n / 2 pi.
    pub omega_n_Hz: f64,
    /// Gears alone, as in the paper, without the rigid body's zero. Empty for an equivalent gear.
    pub gears_alone_Hz: Vec<f64>,
    /// Whole joint with rotor, link and compliance, without the rigid body's zero.
    pub whole_joint_Hz: Vec<f64>,
}

/// One family of meshes. Lists hold one value for each planet.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[allow(non_snake_case, reason = "N is written N")]
pub struct MeshFigures {
    /// `sun_planet` or `ring_planet`.
    pub kind: &'static str,
    /// Half-backlash b.
    pub half_backlash_m: Vec<f64>,
    /// Phase of the stiffness ripple, in mesh periods from 0 to 1.
    pub stiffness_phase_periods: Vec<f64>,
    /// Phase of the transmission error, in mesh periods from 0 to 1.
    pub error_phase_periods: Vec<f64>,
    /// Mean stiffness K_m.
    pub mean_stiffness_N_per_m: f64,
    /// Damping coefficient C of eqs 9 and 10.
    pub damping_N_s_per_m: f64,
    /// Deflection of the teeth under the rated torque, beyond b.
    pub deflection_at_rated_torque_m: f64,
}

/// Behaviour at the link.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[allow(non_snake_case, reason = "N is written N")]
pub struct Output {
    /// Rated torque, from the file.
    pub rated_torque_N_m: f64,
    /// Torque at the sun that balances the rated torque, by the ratio of radii.
    pub balancing_drive_torque_N_m: f64,
    /// Force of one mesh at rated torque, with equal sharing; absent for an equivalent gear.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mesh_force_N: Option<f64>,
    /// Range of the gap coordinate u_s - 2 u_c while every mesh is free: 4 b. An equivalent gear has no line of action;
    /// its gap is stated on a lever of 1 m at the link.
    pub gap_m: f64,
    /// Free rotation of the link with the sun held.
    pub lost_motion_rad: f64,
    /// Free rotation of the link with the sun held, in minutes of arc.
    pub lost_motion_arcmin: f64,
    /// Free rotation of the sun with the link held.
    pub lost_motion_at_sun_rad: f64,
    /// Wind-up of the teeth at rated torque, beyond the lost motion.
    pub wind_up_of_teeth_rad: f64,
    /// Wind-up between carrier and link at rated torque.
    pub wind_up_of_compliance_rad: f64,
    /// Total wind-up at rated torque.
    pub wind_up_rad: f64,
    /// Total wind-up at rated torque, in minutes of arc.
    pub wind_up_arcmin: f64,
    /// True for an efficiency below 0.5: torque at the link alone does not turn the motor, as in a worm gear.
    pub self_locking: bool,
}

/// The fixed step at the requested rate.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[allow(non_snake_case, reason = "Hz is written Hz")]
pub struct FixedStep {
    /// Board of the step.
    pub board: String,
    /// Requested rate.
    pub rate_Hz: u32,
    /// Lowest rate with a stable step.
    pub lowest_rate_Hz: u32,
    /// 1 / lowest rate.
    pub longest_step_s: f64,
    /// Rate from which the default number of sub-steps resolves the fastest mode and the mesh frequency.
    pub recommended_rate_Hz: u32,
    /// 1 / recommended rate.
    pub recommended_step_s: f64,
    /// Method of the sub-steps of a tick in which contacts change: `corrected` or `leapfrog`.
    pub method: &'static str,
    /// Number of sub-steps.
    pub substeps: u32,
    /// Phase of the fastest mode in a sub-step.
    pub fastest_mode_phase_rad: f64,
    /// Flash of the f32 tables.
    pub table_bytes: usize,
    /// Digest of the tables on the board, in hexadecimal.
    pub digest: String,
    /// Errors and verdicts on the board in the role `plant`, if requested.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub verdicts: Option<Verdicts>,
}

/// Sources of the file's numbers.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Numbers {
    /// Numbers in the file.
    pub stated: usize,
    /// Numbers whose comment begins with "assumed".
    pub assumed: usize,
    /// Numbers without a comment.
    pub without_source: usize,
}

/// A warning of the joint file.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Warning {
    /// Line of the file, from 1.
    pub line: usize,
    /// Cause of the warning.
    pub message: String,
    /// Remedy.
    pub help: String,
}
