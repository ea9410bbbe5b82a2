//! All keys of a joint file: section, unit, bound, and a hint for a wrong value. The page docs/reference/joint-file.md
//! lists every key in its tables.

use crate::bound::{Bound, Unit};
use crate::table::{self, Keys};
use crate::wording::listed;

/// Type of a key's value.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Kind {
    /// A string.
    Text,
    /// One of these words.
    Choice(&'static [&'static str]),
    /// A whole number with both ends allowed.
    Whole(u32, u32),
    /// A number.
    Number(Unit, Bound),
    /// A number for all planets, or a list with a number per planet.
    PerPlanet(Unit, Bound),
    /// A table of its own.
    Section,
}

/// One key; `[mesh.sun_planet]` has the keys of `[mesh]`.
pub(crate) type Key = table::Key<Kind>;

impl Keys for Kind {
    const FILE: &'static str = "a joint file";
    const ALL: &'static [Key] = KEYS;

    fn stray(section: &str, word: &str) -> String {
        if Self::find("encoder", word).is_some() {
            return "it belongs in [drive_train.motor_encoder] or [drive_train.output_encoder]".to_owned();
        }
        let known: Vec<&str> = Self::of(section).map(|key| key.name).collect();
        Self::belongs(word).unwrap_or_else(|| format!("known here: {}", listed(&known)))
    }
}

const fn key(section: &'static str, name: &'static str, kind: Kind, hint: &'static str) -> Key {
    Key { section, name, kind, hint }
}

const fn section(parent: &'static str, name: &'static str, hint: &'static str) -> Key {
    key(parent, name, Kind::Section, hint)
}

use Bound::{Between, FromToBelow, Inside, ZeroOr};
use Kind::{Choice, Number, PerPlanet, Text, Whole};
use Unit::{Arcmin, Degrees, Micro, Milli, PerArcmin, Si, SquareCentimetres};

/// Bounds of plausible values: the board computes in f32.
const MASS: Bound = Between(1e-6, 1e6);
const INERTIA: Bound = Between(1e-12, 1e6);
const TORQUE: Bound = Between(1e-6, 1e9);
const ZERO_OR_MORE: Bound = Between(0.0, 1e6);
const RADIUS: Kind = Number(Milli, Between(0.5, 5000.0));
const RADIUS_HINT: &str = "base radius in mm (40 mm is 40, not 0.04); or give `module_mm` and leave all radii out";
const MASS_HINT: &str = "equivalent mass I / r^2 in kg along the line of action: \"Inertia\" in the paper's Table 1";
const INERTIA_HINT: &str = "moment of inertia in kg m^2 about the gear's own axis";
const ANGLE: Kind = Number(Degrees, Between(5.0, 45.0));
const TEETH: Kind = Whole(5, 1000);
const PHASE: Kind = PerPlanet(Si, Between(-6.3, 6.3));
const PHASE_HINT: &str = "phase in rad, within a turn: a single number is for planet 0, and the teeth give the other phases; a list has a number for each planet";
const TURNS_HINT: &str =
    "whole turns of motor and link after which both are back at their start: 29 and 3 for a ratio of 29/3";
const FRICTION_HINT: &str = "dry friction in N m; 0 for none";
const PRESLIDING_HINT: &str = "displacement in mrad at which dry friction is reached; 0 sticks at once";
const DRIFT_HINT: &str = "change a second over the value at time 0: 30 % in 60 s are 0.005";

/// All keys, in the order of the documentation.
pub(crate) const KEYS: &[Key] = &[
    key("", "name", Text, "name of up to 32 letters, digits, spaces and -_.+(): name = \"Q1\""),
    key("", "description", Text, "description for reports"),
    key(
        "",
        "coherence",
        Choice(&["required", "warn"]),
        "\"warn\" accepts gears that do not fit together, with a warning",
    ),
    key(
        "",
        "rated_output_torque_N_m",
        Number(Si, TORQUE),
        "rated torque at the link; profiles and reports scale with it",
    ),
    key("", "characteristic_length_um", Number(Micro, Between(1e-3, 1e4)), "b_c of eq. 16; default 10"),
    section(
        "",
        "geometry",
        "teeth, angles and radii: planets, sun_teeth, planet_teeth, ring_teeth, ...; or [equivalent_gear] in place of teeth",
    ),
    section("", "bodies", "masses: sun_equivalent_mass_kg, planet_equivalent_mass_kg, planet_mass_kg, ..."),
    section("", "compliance", "stiffness_N_m_per_rad and damping_ratio; leave it out to join carrier and link rigidly"),
    section(
        "",
        "equivalent_gear",
        "replaces all sections on teeth: ratio, lost_motion_arcmin, total_stiffness_N_m_per_arcmin, damping_ratio",
    ),
    section(
        "",
        "mesh",
        "the gear meshes: mean_stiffness_N_per_m, stiffness_ratio, damping_ratio, half_backlash_um, ...",
    ),
    section("", "contact", "damping_law and dead_zone"),
    section("", "excitation", "mode and, in mode \"time\", the mesh frequency"),
    section("", "profile", "torques that the built-in motion profile scales with"),
    section("", "drive_train", "friction, cogging, current loop and encoders around the joint"),
    // Equivalent gear
    key(
        "equivalent_gear",
        "ratio",
        Number(Si, Inside(1.0, 1e5)),
        "motor turns over link turns as a decimal number, for example 50 or 12.5; for 29/3 write motor_turns = 29 and link_turns = 3",
    ),
    key("equivalent_gear", "motor_turns", Whole(1, 100_000), TURNS_HINT),
    key("equivalent_gear", "link_turns", Whole(1, 100_000), TURNS_HINT),
    key(
        "equivalent_gear",
        "lost_motion_arcmin",
        Number(Arcmin, ZeroOr(0.01, 600.0)),
        "lost motion or backlash at the output in arcmin, flank to flank, from the data sheet",
    ),
    key(
        "equivalent_gear",
        "lost_motion_mrad",
        Number(Milli, ZeroOr(0.003, 175.0)),
        "lost motion at the output in mrad, flank to flank: 1 arcmin is 0.291 mrad",
    ),
    key(
        "equivalent_gear",
        "total_stiffness_N_m_per_arcmin",
        Number(PerArcmin, Between(1e-4, 1e6)),
        "torsional stiffness at the output in N m/arcmin, all parts together, from the data sheet",
    ),
    key(
        "equivalent_gear",
        "stiffness_N_m_per_rad",
        Number(Si, Between(1.0, 1e9)),
        "torsional stiffness at the output in N m/rad, all parts together: 3 N m/arcmin are 10.3e3 N m/rad",
    ),
    key(
        "equivalent_gear",
        "damping_ratio",
        Number(Si, FromToBelow(0.0, 1.0)),
        "damping ratio of motor side against link while a flank is in contact; 5 % is 0.05",
    ),
    // Geometry
    key("geometry", "planets", Whole(3, 5), "number of equally spaced planets: 3, 4 or 5"),
    key("geometry", "sun_teeth", TEETH, "teeth of the sun"),
    key("geometry", "planet_teeth", TEETH, "teeth of one planet"),
    key("geometry", "ring_teeth", TEETH, "teeth of the fixed ring: sun_teeth + 2 planet_teeth"),
    key("geometry", "working_pressure_angle_deg", ANGLE, "working pressure angle in degrees, commonly 20; not in rad"),
    key(
        "geometry",
        "reference_pressure_angle_deg",
        ANGLE,
        "reference pressure angle in degrees, used with `module_mm`; default: the working angle",
    ),
    key("geometry", "module_mm", Number(Milli, Between(0.05, 50.0)), "module in mm; module and teeth give all radii"),
    key("geometry", "sun_base_radius_mm", RADIUS, RADIUS_HINT),
    key("geometry", "planet_base_radius_mm", RADIUS, RADIUS_HINT),
    key(
        "geometry",
        "carrier_radius_mm",
        RADIUS,
        "r_c, distance from the joint's axis to a planet's axis in mm; not r_c cos(alpha)",
    ),
    key(
        "geometry",
        "carrier_base_radius_mm",
        RADIUS,
        "r_c cos(alpha), lever of the carrier on the line of action in mm",
    ),
    // Bodies
    key("bodies", "sun_equivalent_mass_kg", Number(Si, MASS), MASS_HINT),
    key("bodies", "sun_inertia_kg_m2", Number(Si, INERTIA), INERTIA_HINT),
    key("bodies", "planet_equivalent_mass_kg", Number(Si, MASS), MASS_HINT),
    key("bodies", "planet_inertia_kg_m2", Number(Si, INERTIA), INERTIA_HINT),
    key(
        "bodies",
        "planet_mass_kg",
        Number(Si, ZERO_OR_MORE),
        "mass of one planet in kg, which orbits with the carrier",
    ),
    key(
        "bodies",
        "carrier_inertia_over_radius_squared_kg",
        Number(Si, MASS),
        "I_c / r_c^2 in kg without planets and link, as in the paper's Table 1",
    ),
    key(
        "bodies",
        "carrier_equivalent_mass_kg",
        Number(Si, MASS),
        "I_c / (r_c cos(alpha))^2 in kg, without planets and link",
    ),
    key(
        "bodies",
        "carrier_inertia_kg_m2",
        Number(Si, INERTIA),
        "I_c in kg m^2 about the joint's axis, without planets and link",
    ),
    key(
        "bodies",
        "gear_inertia_at_input_kg_cm2",
        Number(SquareCentimetres, Between(1e-9, 1e10)),
        "moment of inertia of the gearbox at its input in kg cm^2, from the data sheet; replaces all masses but rotor and link",
    ),
    key(
        "bodies",
        "rotor_inertia_kg_m2",
        Number(Si, ZERO_OR_MORE),
        "inertia of the motor rotor on the sun shaft in kg m^2; default 0",
    ),
    key(
        "bodies",
        "link_inertia_kg_m2",
        Number(Si, ZERO_OR_MORE),
        "inertia of the link on the carrier in kg m^2; default 0",
    ),
    // Compliance
    key(
        "compliance",
        "stiffness_N_m_per_rad",
        Number(Si, Between(1.0, 1e9)),
        "torsional stiffness between carrier and link in N m/rad: 3 N m/arcmin are 10.3e3 N m/rad",
    ),
    key(
        "compliance",
        "total_stiffness_N_m_per_arcmin",
        Number(PerArcmin, Between(1e-4, 1e6)),
        "torsional stiffness at the output in N m/arcmin, teeth and shafts together, from the data sheet",
    ),
    key(
        "compliance",
        "damping_ratio",
        Number(Si, FromToBelow(0.0, 1.0)),
        "damping ratio of the carrier-link oscillator; 2 % is 0.02",
    ),
    // Meshes
    section("mesh", "sun_planet", "values of the sun-planet meshes that differ from [mesh]"),
    section("mesh", "ring_planet", "values of the ring-planet meshes that differ from [mesh]"),
    key(
        "mesh",
        "mean_stiffness_N_per_m",
        Number(Si, Between(1e4, 1e12)),
        "mean mesh stiffness K_m in N/m, about 1e8 for steel teeth; 100 N/um are 1e8 N/m",
    ),
    key(
        "mesh",
        "stiffness_wave",
        Choice(&["harmonic", "rectangular"]),
        "waveform of the mesh stiffness: \"harmonic\" (eq. 7) or \"rectangular\" (Fig. 3)",
    ),
    key(
        "mesh",
        "stiffness_ratio",
        Number(Si, FromToBelow(0.0, 1.0)),
        "K_a / K_m: half the stiffness range over its mean; 10 % is 0.1",
    ),
    key(
        "mesh",
        "contact_ratio",
        Number(Si, Inside(1.0, 2.0)),
        "contact ratio of the pair, for the rectangular wave; 1.6 is common",
    ),
    key("mesh", "order", Whole(1, 8), "highest Fourier harmonic kept of the rectangular wave"),
    key(
        "mesh",
        "damping_ratio",
        Number(Si, FromToBelow(0.0, 1.0)),
        "damping ratio zeta of eqs 8-10, commonly 0.03 to 0.1; 5 % is 0.05",
    ),
    key(
        "mesh",
        "half_backlash_um",
        PerPlanet(Micro, ZeroOr(0.5, 1000.0)),
        "half-backlash b in um; a mesh is free over 2b: 0.06 mm are 60 um, 6e-5 m are 60 um",
    ),
    key(
        "mesh",
        "backlash_um",
        PerPlanet(Micro, ZeroOr(1.0, 2000.0)),
        "backlash 2b along the line of action in um: 0.12 mm are 120 um",
    ),
    key(
        "mesh",
        "lost_motion_arcmin",
        Number(Arcmin, ZeroOr(0.01, 600.0)),
        "lost motion at the output in arcmin over all meshes, from the data sheet: 2b / (r_c cos(alpha)); in [mesh] only",
    ),
    key(
        "mesh",
        "transmission_error_um",
        PerPlanet(Micro, Between(0.0, 1000.0)),
        "amplitude E of eq. 11 in um (half of peak to peak); 0 for none",
    ),
    key("mesh", "stiffness_phase_rad", PHASE, PHASE_HINT),
    key("mesh", "error_phase_rad", PHASE, PHASE_HINT),
    // Contact
    key(
        "contact",
        "damping_law",
        Choice(&["contact", "paper"]),
        "\"contact\": teeth only push; \"paper\": C d' acts in the gap too",
    ),
    key("contact", "dead_zone", Choice(&["sharp", "tanh"]), "law of the gap: \"sharp\" (eq. 12) or \"tanh\" (eq. 13)"),
    key(
        "contact",
        "sharpness",
        Number(Si, Between(0.1, 1e6)),
        "sigma of eq. 13, per unit of the dimensionless deflection",
    ),
    // Excitation
    key(
        "excitation",
        "mode",
        Choice(&["angle", "time"]),
        "\"angle\": the mesh phase follows the joint; \"time\": it runs at a stated frequency",
    ),
    key("excitation", "mesh_frequency_rad_per_s", Number(Si, Between(1e-3, 1e9)), "mesh frequency omega in rad/s"),
    key("excitation", "mesh_frequency_Hz", Number(Si, Between(1e-3, 1e8)), "mesh frequency omega / 2 pi in Hz"),
    key(
        "excitation",
        "mesh_frequency_over_omega_n",
        Number(Si, Between(1e-6, 1e3)),
        "mesh frequency Omega = omega / omega_n, with omega_n of eq. 18",
    ),
    // Profile
    key(
        "profile",
        "drive_torque_N_m",
        Number(Si, TORQUE),
        "rated motor torque; default: the torque that balances the rated output torque, at most the motor's limit",
    ),
    key(
        "profile",
        "motor_torque_limit_N_m",
        Number(Si, TORQUE),
        "torque limit of the motor; default: twice the drive torque",
    ),
    // Drive train
    key("drive_train", "motor_coulomb_friction_N_m", Number(Si, ZERO_OR_MORE), FRICTION_HINT),
    key(
        "drive_train",
        "no_load_torque_N_m",
        Number(Si, ZERO_OR_MORE),
        "torque at the input that turns the joint without a load, all dry friction together, from the data sheet",
    ),
    key(
        "drive_train",
        "motor_viscous_friction_N_m_s_per_rad",
        Number(Si, ZERO_OR_MORE),
        "viscous friction in N m s/rad of motor speed",
    ),
    key("drive_train", "cogging_torque_N_m", Number(Si, ZERO_OR_MORE), "amplitude of the cogging torque"),
    key(
        "drive_train",
        "cogging_periods_per_turn",
        Whole(1, 10_000),
        "cogging periods in a turn: least common multiple of slots and poles",
    ),
    key("drive_train", "load_coulomb_friction_N_m", Number(Si, ZERO_OR_MORE), FRICTION_HINT),
    key(
        "drive_train",
        "load_stribeck_rise_ratio",
        Number(Si, Between(0.0, 10.0)),
        "excess of friction at rest over friction in motion; 20 % is 0.2",
    ),
    key(
        "drive_train",
        "load_stribeck_speed_rad_per_s",
        Number(Si, Between(1e-6, 1e3)),
        "speed at which the excess of friction at rest has decayed",
    ),
    key(
        "drive_train",
        "load_viscous_friction_N_m_s_per_rad",
        Number(Si, ZERO_OR_MORE),
        "viscous friction in N m s/rad of link speed",
    ),
    key(
        "drive_train",
        "efficiency",
        Number(Si, Between(0.1, 1.0)),
        "efficiency of the gears, load-dependent losses only; 97 % is 0.97; below 0.5 the load cannot turn the motor",
    ),
    key(
        "drive_train",
        "gravity_torque_N_m",
        Number(Si, Between(-1e6, 1e6)),
        "amplitude of the torque of the link's weight, which acts times sin(link angle)",
    ),
    key(
        "drive_train",
        "motor_speed_limit_rad_per_s",
        Number(Si, Between(1.0, 1e5)),
        "top speed of the motor; faster counts are treated as a fault of the motor encoder",
    ),
    key("drive_train", "current_lag_ms", Number(Milli, Between(0.0, 100.0)), "time constant of the current loop in ms"),
    key(
        "drive_train",
        "torque_noise_ratio",
        Number(Si, Between(0.0, 1.0)),
        "RMS torque noise over the torque; 1.5 % is 0.015",
    ),
    key(
        "drive_train",
        "torque_constant_error_ratio",
        Number(Si, Between(-0.5, 0.5)),
        "true over nominal torque constant, less 1; 3 % is 0.03",
    ),
    key(
        "drive_train",
        "control_rate_Hz",
        Number(Si, Between(1.0, 1e6)),
        "rate of the controller around the joint in Hz",
    ),
    key(
        "drive_train",
        "control_delay_periods",
        Number(Si, Between(0.0, 100.0)),
        "delay from measurement to torque, in control periods",
    ),
    key(
        "drive_train",
        "payload_inertia_share",
        Number(Si, FromToBelow(0.0, 1.0)),
        "share of the link's inertia that hangs on a spring; 40 % is 0.4",
    ),
    key(
        "drive_train",
        "payload_frequency_Hz",
        Number(Si, Between(0.1, 1000.0)),
        "undamped frequency of the sprung inertia while the link is held",
    ),
    key(
        "drive_train",
        "payload_damping_ratio",
        Number(Si, FromToBelow(0.0, 1.0)),
        "damping ratio of the sprung inertia while the link is held",
    ),
    key(
        "drive_train",
        "payload_step_time_s",
        Number(Si, Between(0.0, 1e5)),
        "time at which the link's inertia changes",
    ),
    key(
        "drive_train",
        "payload_step_ratio",
        Number(Si, Between(0.01, 100.0)),
        "link inertia and weight after the change, over their values before: 3 has gripped, 0.33 has released",
    ),
    key("drive_train", "motor_presliding_mrad", Number(Milli, ZeroOr(1e-3, 1000.0)), PRESLIDING_HINT),
    key("drive_train", "load_presliding_mrad", Number(Milli, ZeroOr(1e-3, 1000.0)), PRESLIDING_HINT),
    key(
        "drive_train",
        "hysteresis_stiffness_share",
        Number(Si, FromToBelow(0.0, 1.0)),
        "share of the stiffness between carrier and link that slips; 20 % is 0.2",
    ),
    key(
        "drive_train",
        "hysteresis_torque_N_m",
        Number(Si, TORQUE),
        "torque at the link at which the slipping share slips",
    ),
    key(
        "drive_train",
        "width_once_per_link_turn_ratio",
        Number(Si, FromToBelow(0.0, 1.0)),
        "variation of the half-backlash once a turn of the link: amplitude over half-backlash; 30 % is 0.3",
    ),
    key(
        "drive_train",
        "width_once_per_motor_turn_ratio",
        Number(Si, FromToBelow(0.0, 1.0)),
        "variation of the half-backlash once a turn of the motor: amplitude over half-backlash; both variations together stay below 1",
    ),
    key("drive_train", "friction_drift_ratio_per_s", Number(Si, Between(-0.1, 0.1)), DRIFT_HINT),
    key("drive_train", "width_drift_ratio_per_s", Number(Si, Between(-0.1, 0.1)), DRIFT_HINT),
    key(
        "drive_train",
        "torque_ripple_ratio",
        Number(Si, FromToBelow(0.0, 1.0)),
        "amplitude of the torque ripple over the torque; 2 % is 0.02",
    ),
    key(
        "drive_train",
        "torque_ripple_periods_per_turn",
        Whole(1, 10_000),
        "ripple periods in a turn: six times the pole pairs for a motor with sinusoidal currents",
    ),
    key(
        "drive_train",
        "torque_resolution_ratio",
        Number(Si, Between(0.0, 0.5)),
        "step of the torque command over the motor's limit; 12 bits with sign are 0.0005",
    ),
    key(
        "drive_train",
        "torque_saturation_ratio",
        Number(Si, FromToBelow(0.0, 1.0)),
        "torque lost at the motor's limit, over the limit; 10 % is 0.1",
    ),
    key(
        "drive_train",
        "control_jitter_ratio",
        Number(Si, Between(0.0, 0.5)),
        "longest delay of a control period's start over the period; 5 % is 0.05",
    ),
    section(
        "drive_train",
        "motor_encoder",
        "bits or counts_per_turn, once_per_turn_error_deg, twice_per_turn_error_deg, skew_us",
    ),
    section(
        "drive_train",
        "output_encoder",
        "bits or counts_per_turn, once_per_turn_error_deg, twice_per_turn_error_deg, skew_us",
    ),
    key("encoder", "bits", Whole(8, 32), "resolution: 14 bits are 16384 counts in a turn"),
    key(
        "encoder",
        "counts_per_turn",
        Whole(12, 16_777_216),
        "counts in a turn that are no power of two, in place of bits: 1000 lines read at every edge are 4000",
    ),
    key(
        "encoder",
        "once_per_turn_error_deg",
        Number(Degrees, Between(0.0, 10.0)),
        "amplitude in degrees of the error that comes once a turn",
    ),
    key(
        "encoder",
        "twice_per_turn_error_deg",
        Number(Degrees, Between(0.0, 10.0)),
        "amplitude in degrees of the error that comes twice a turn",
    ),
    key("encoder", "skew_us", Number(Micro, Between(0.0, 1e5)), "delay of the reading in us"),
    key(
        "encoder",
        "age_jitter_us",
        Number(Micro, Between(0.0, 1e5)),
        "additional age of a reading in us, from 0 to this value, which its time stamp does not show",
    ),
    key(
        "encoder",
        "noise_counts",
        Number(Si, Between(0.0, 1e6)),
        "standard deviation of the noise in counts, before rounding",
    ),
    key(
        "encoder",
        "subdivisional_error_deg",
        Number(Degrees, Between(0.0, 10.0)),
        "amplitude in degrees of the error that comes once a period of the scale",
    ),
    key(
        "encoder",
        "subdivisional_second_error_deg",
        Number(Degrees, Between(0.0, 10.0)),
        "amplitude in degrees of the error that comes twice a period of the scale",
    ),
    key("encoder", "subdivisional_periods_per_turn", Whole(1, 65_536), "periods of the scale in a turn"),
    key(
        "encoder",
        "missing_frames_share",
        Number(Si, Between(0.0, 1.0)),
        "share of the control periods without a reading; 1 % is 0.01",
    ),
];

/// Returns true for the name of a section.
pub(crate) fn is_section(name: &str) -> bool {
    KEYS.iter().any(|key| matches!(key.kind, Kind::Section) && key.name == name)
}

#[cfg(test)]
mod tests {
    use super::{KEYS, Kind};

    #[test]
    fn keys_are_documented_with_bounds() {
        let document = include_str!("../../../docs/reference/joint-file.md");
        for key in KEYS {
            let value = match key.kind {
                Kind::Text => "text".to_owned(),
                Kind::Choice(words) => {
                    words.iter().map(|word| format!("`\"{word}\"`")).collect::<Vec<_>>().join(" or ")
                }
                Kind::Whole(low, high) => format!("between {low} and {high}"),
                Kind::Number(_, bound) => bound.text(),
                Kind::PerPlanet(_, bound) => format!("{}; number or list", bound.text()),
                Kind::Section => continue,
            };
            let name = format!("| `{}` |", key.name);
            let documented = document.lines().any(|line| line.starts_with(&name) && line.contains(&value));
            assert!(documented, "no row `{name}` with `{value}`");
        }
    }

    #[test]
    fn sections_are_documented() {
        let document = include_str!("../../../docs/reference/joint-file.md");
        for key in KEYS.iter().filter(|key| matches!(key.kind, Kind::Section)) {
            let path =
                if key.section.is_empty() { key.name.to_owned() } else { format!("{}.{}", key.section, key.name) };
            assert!(document.contains(&format!("`[{path}]`")), "{path}");
        }
    }
}
