//! Command line of `joint new`, and the data sheet built from it.

use std::path::PathBuf;

use crate::material::Material;

/// Seeds per assumption: the median of three runs is right even if one run is an outlier.
pub const DEFAULT_SEEDS: u64 = 3;

/// Arguments of `joint new`.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example:
  joint new elbow --ratio 9 --lost-motion-arcmin 15 --stiffness-Nm-per-arcmin 1.8 --rated-torque-Nm 8 \\
      --rotor-inertia-kg-cm2 0.32 --no-load-torque-Nm 0.05 --efficiency 0.94
  joint new wrist --equivalent --ratio 59 --lost-motion-arcmin 3 ...     a cycloid, spur train or belt with unknown teeth

On a terminal it asks for missing figures. The file is elbow.toml; an existing file is never overwritten.
Exit code 2 if no gears of this ratio assemble, or if the joint is impossible.")]
pub struct Arguments {
    /// Name of the joint, or path of its file: NAME.toml
    #[arg(value_name = "NAME")]
    pub name: PathBuf,
    /// Makes an equivalent gear without teeth, for a spur train, a cycloid or a belt of any ratio above 1
    #[arg(long)]
    pub equivalent: bool,
    /// Gear ratio, motor turns per turn of the link
    #[arg(long, value_name = "RATIO", allow_negative_numbers = true)]
    pub ratio: Option<f64>,
    /// Lost motion at the output in minutes of arc
    #[arg(long, value_name = "ARCMIN", allow_negative_numbers = true)]
    pub lost_motion_arcmin: Option<f64>,
    /// Torsional stiffness at the output in N m/arcmin, teeth and shafts together
    #[arg(long = "stiffness-Nm-per-arcmin", value_name = "NM/ARCMIN", allow_negative_numbers = true)]
    pub stiffness: Option<f64>,
    /// Rated torque at the output in N m
    #[arg(long = "rated-torque-Nm", value_name = "NM", allow_negative_numbers = true)]
    pub rated_torque: Option<f64>,
    /// Inertia of the motor's rotor in kg cm^2
    #[arg(long = "rotor-inertia-kg-cm2", value_name = "KG CM2", allow_negative_numbers = true)]
    pub rotor_inertia: Option<f64>,
    /// Torque at the input that turns the unloaded joint, in N m
    #[arg(long = "no-load-torque-Nm", value_name = "NM", allow_negative_numbers = true)]
    pub no_load_torque: Option<f64>,
    /// Efficiency of the gears: 94 % is 0.94
    #[arg(long, value_name = "RATIO", allow_negative_numbers = true)]
    pub efficiency: Option<f64>,
    /// Inertia of the gears at the input in kg cm^2 [default: derived from size and material; for an equivalent gear
    /// half of the rotor's]
    #[arg(long = "gear-inertia-kg-cm2", value_name = "KG CM2", allow_negative_numbers = true)]
    pub gear_inertia: Option<f64>,
    /// Inertia of the link in kg m^2 [default: ten times the rotor's, referred to the link]
    #[arg(long = "link-inertia-kg-m2", value_name = "KG M2", allow_negative_numbers = true)]
    pub link_inertia: Option<f64>,
    /// Torque of the link's weight in N m, with the link level [default: none]
    #[arg(long = "gravity-torque-Nm", value_name = "NM", allow_negative_numbers = true)]
    pub gravity_torque: Option<f64>,
    /// Peak torque of the motor in N m [default: twice the motor torque for the rated torque]
    #[arg(long = "motor-peak-torque-Nm", value_name = "NM", allow_negative_numbers = true)]
    pub motor_peak_torque: Option<f64>,
    /// Outer diameter of the ring in mm; the largest module that fits is used [default: a module by the rated torque]
    #[arg(long, value_name = "MM", allow_negative_numbers = true, conflicts_with = "equivalent")]
    pub outer_diameter_mm: Option<f64>,
    /// Material of the gears [default: steel, assumed]
    #[arg(long, value_enum, conflicts_with = "equivalent")]
    pub material: Option<Material>,
    /// Planets, 3 to 5
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(3..=5), conflicts_with = "equivalent")]
    pub planets: Option<u32>,
    /// Tolerance of the teeth's ratio, in percent
    #[arg(
        long,
        value_name = "PERCENT",
        default_value_t = 1.0,
        allow_negative_numbers = true,
        conflicts_with = "equivalent"
    )]
    pub ratio_tolerance: f64,
    /// Resolution of the motor encoder: 14 bits are 16384 counts a turn [default: 14, assumed]
    #[arg(long, value_name = "BITS", value_parser = clap::value_parser!(u32).range(8..=32))]
    pub motor_bits: Option<u32>,
    /// Resolution of the output encoder [default: 17, assumed]
    #[arg(long, value_name = "BITS", value_parser = clap::value_parser!(u32).range(8..=32))]
    pub output_bits: Option<u32>,
    /// Skips the measurement of wrong assumptions: takes a moment instead of half a minute
    #[arg(long)]
    pub no_measure: bool,
    /// Seeds of noise per assumption; 8 take three times as long and rarely misjudge an assumption by chance
    #[arg(long, value_name = "N", default_value_t = DEFAULT_SEEDS, value_parser = clap::value_parser!(u64).range(1..=100), conflicts_with = "no_measure")]
    pub seeds: u64,
}

/// Complete data sheet, in the units of the options.
#[derive(Debug, Clone, PartialEq)]
#[allow(missing_docs, reason = "as the options")]
pub struct DataSheet {
    pub name: String,
    pub equivalent: bool,
    pub ratio: f64,
    pub lost_motion_arcmin: f64,
    pub stiffness: f64,
    pub rated_torque: f64,
    pub rotor_inertia: f64,
    pub no_load_torque: f64,
    pub efficiency: f64,
    pub gear_inertia: Option<f64>,
    pub link_inertia: Option<f64>,
    pub gravity_torque: Option<f64>,
    pub motor_peak_torque: Option<f64>,
    pub outer_diameter_mm: Option<f64>,
    pub material: Option<Material>,
    pub planets: Option<u32>,
    pub ratio_tolerance: f64,
    pub motor_bits: Option<u32>,
    pub output_bits: Option<u32>,
}

impl DataSheet {
    /// Material of the gears; steel unless stated.
    pub fn material(&self) -> Material {
        self.material.unwrap_or_default()
    }
}
