//! Record of a study, as described in `docs/reference/paper-study.md` and, for machines, `docs/reference/paper-study.schema.json`.
//! Quantities without a unit in their key are dimensionless: lengths over b_c, times over 1/omega_n.

use serde::Serialize;

pub use crate::numerics::attractor::Class;
use report::checks::Check;

/// Version of the JSON form; raised when a key changes its meaning or is removed.
pub const SCHEMA_VERSION: u32 = 1;

/// A whole study.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct StudyRecord {
    /// [`SCHEMA_VERSION`] of the writer.
    pub schema_version: u32,
    /// Joint, command, sources and host of the study.
    pub identity: Identity,
    /// Joints of the study: two readings of one joint for the paper's own, else one.
    pub readings: Vec<Reading>,
    /// Fig. 3.
    pub stiffness: StiffnessFigure,
    /// Figs 4 and 5.
    pub dead_zone: DeadZoneFigure,
    /// Results of the checks.
    pub checks: Vec<Check>,
}

/// Joint, command, sources and host of the study.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Identity {
    /// Name of the joint; of the first reading where there are two.
    pub joint: String,
    /// Command line that repeats exactly this study.
    pub replay: String,
    /// Commit of the sources, if they were under git; with ` (changed)` if they were modified.
    pub git_commit: Option<String>,
    /// Operating system and processor.
    pub host: String,
    /// Version of the host command.
    pub host_version: String,
    /// Start of the study, ISO 8601.
    pub date: String,
}

/// One joint under one load and one mesh frequency.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Reading {
    /// Name of the joint.
    pub joint: String,
    /// Joint file as named by the user, or the preset.
    pub joint_file: String,
    /// Description in the joint file.
    pub description: String,
    /// Damping law: `paper` or `contact`.
    pub damping_law: String,
    /// Dimensionless mesh frequency Omega = omega / omega_n.
    pub omega: f64,
    /// Natural frequency omega_n of eq. 18.
    pub omega_n_rad_per_s: f64,
    /// Characteristic length b_c.
    pub characteristic_length_m: f64,
    /// Torque on the sun.
    #[serde(rename = "drive_torque_Nm")]
    pub drive_torque_nm: f64,
    /// Torque that brakes the link and balances the drive torque.
    #[serde(rename = "load_torque_Nm")]
    pub load_torque_nm: f64,
    /// Equivalent mass M_c below eq. 19.
    pub carrier_equivalent_mass_kg: f64,
    /// Attractors of Figs 5-8, one for each requested half-backlash.
    pub attractors: Vec<AttractorRecord>,
    /// Bifurcation diagrams, one for each start.
    pub sweeps: Vec<Sweep>,
}

/// One attractor.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct AttractorRecord {
    /// Half-backlash b.
    pub half_backlash_m: f64,
    /// Class of the attractor.
    #[serde(flatten)]
    pub class: Class,
    /// Points (X_sp, X_sc, X_sp', X_sc') at tau = 2 pi k / Omega: one cycle, or some hundreds of an attractor without a period.
    pub poincare_points: Vec<[f64; 4]>,
    /// Number of examined points.
    pub points_looked_at: usize,
    /// Number of points that differ by more than 0.01.
    pub distinct_points: usize,
    /// Largest Lyapunov exponent by a tangent vector.
    pub exponent_by_tangent_vector: f64,
    /// Largest Lyapunov exponent by two trajectories.
    pub exponent_by_two_trajectories: f64,
    /// Largest exponent of disturbances that drive planets apart; null unless all planets mesh in phase.
    pub exponent_between_planets: Option<f64>,
    /// RMS of the content that is neither mean nor at the mesh frequency, over RMS at the mesh frequency.
    pub non_fundamental_ratio: f64,
    /// Peak to peak of X_sp.
    pub peak_to_peak: f64,
    /// Shares of time over all meshes: drive side, separated, back side.
    pub contact_percent: [f64; 3],
    /// Mesh periods before the measurement.
    pub settled_after_periods: u32,
    /// Largest distance from the independent integrator, started from the same point, at its next Poincare points; null if this integrator
    /// rejects the joint.
    pub reference_distance: Option<f64>,
    /// X_sp and its rate over some periods.
    pub history: History,
    /// Amplitudes of X_sp.
    pub spectrum: SpectrumRecord,
}

/// X_sp over time.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct History {
    /// Time in mesh periods.
    pub periods: Vec<f64>,
    /// X_sp.
    pub x_sp: Vec<f64>,
    /// X_sp'.
    pub x_sp_rate: Vec<f64>,
}

/// Amplitudes by frequency.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct SpectrumRecord {
    /// Frequency over the mesh frequency.
    pub over_mesh_frequency: Vec<f64>,
    /// Amplitude.
    pub amplitude: Vec<f64>,
}

/// A bifurcation diagram.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Sweep {
    /// `rest` (X = X' = 0 at each b), `up` or `down` (from the last state at the b before).
    pub start: String,
    /// Points in rising order of b.
    pub points: Vec<SweepPoint>,
    /// Ranges of one class.
    pub windows: Vec<ClassWindow>,
}

/// One half-backlash of a sweep.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct SweepPoint {
    /// Half-backlash b.
    pub half_backlash_m: f64,
    /// Class of the attractor.
    #[serde(flatten)]
    pub class: Class,
    /// Largest Lyapunov exponent by a tangent vector.
    pub exponent: f64,
    /// X_sp at the Poincare points: one cycle, or all examined points.
    pub x_sp: Vec<f64>,
}

/// Neighbouring points of one class.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct ClassWindow {
    /// First half-backlash of the range.
    pub from_m: f64,
    /// Last half-backlash of the range.
    pub to_m: f64,
    /// Class of the range.
    #[serde(flatten)]
    pub class: Class,
}

/// Fig. 3: stiffness over one mesh period, over its mean.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct StiffnessFigure {
    /// Contact ratio of the sun-planet pair.
    pub contact_ratio: f64,
    /// Source of the contact ratio.
    pub contact_ratio_source: String,
    /// (K_max - K_min) / (2 K_m) of the rectangular wave.
    pub rectangular_ratio: f64,
    /// K_a / K_m of eq. 7, the first harmonic of the rectangular wave.
    pub first_harmonic_ratio: f64,
    /// Phase in periods.
    pub phase: Vec<f64>,
    /// Rectangular wave.
    pub rectangular: Vec<f64>,
    /// First harmonic, eq. 7.
    pub first_harmonic: Vec<f64>,
    /// Fourier series up to harmonic 8.
    pub eight_harmonics: Vec<f64>,
}

/// Figs 4 and 5: dead zone of half-width `half_backlash`.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct DeadZoneFigure {
    /// Half-backlash b over b_c.
    pub half_backlash: f64,
    /// Deflection x over b_c.
    pub deflection: Vec<f64>,
    /// Sharp dead zone, eq. 12.
    pub sharp: Vec<f64>,
    /// Eq. 13, corrected, at some sharpnesses.
    pub smoothed: Vec<Smoothed>,
    /// Eq. 13 as printed, at the sharpness of 1000 recommended by the paper.
    pub printed: Vec<f64>,
    /// Largest distance from eq. 12 by sharpness.
    pub errors: Vec<DeadZoneError>,
}

/// Eq. 13 at one sharpness.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Smoothed {
    /// Sharpness sigma.
    pub sharpness: f64,
    /// Force f(x, b).
    pub force: Vec<f64>,
}

/// Largest distance of eq. 13 from eq. 12.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct DeadZoneError {
    /// Sharpness sigma.
    pub sharpness: f64,
    /// Largest error of eq. 13, corrected.
    pub corrected: f64,
    /// Largest error of eq. 13 as printed.
    pub printed: f64,
}
