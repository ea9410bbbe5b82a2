//! Joint file line by line: each value with its origin.

use joint_file::DERIVED;
use report::provenance;

use crate::arguments::DataSheet;
use crate::sizes::{Gears, PRESSURE_ANGLE_DEG, Sizes, rounded};
use crate::swing::Swing;

/// Origin of a value.
#[derive(Debug, Clone, PartialEq)]
pub enum Origin {
    /// Figure of the sheet.
    Sheet(String),
    /// Derived from other values.
    Derived(String),
    /// Assumed.
    Assumed(String),
}

/// One line of the file.
#[derive(Debug, Clone, PartialEq)]
pub struct Line {
    /// Section of the file.
    pub section: &'static str,
    /// Key.
    pub key: &'static str,
    /// Value, as typed.
    pub value: String,
    /// Origin of the value.
    pub origin: Origin,
    /// Relative change of the standard test for a value wrong by half [-], or the reason for a missing one; `None`
    /// until measured.
    pub moved: Option<Result<f64, String>>,
}

/// Number as a person would write it; TOML needs a point or an exponent in it.
fn number(value: f64) -> String {
    match value.abs() {
        size if size != 0.0 && !(1e-3..1e6).contains(&size) => format!("{value:e}"),
        _ => format!("{value:?}"),
    }
}

/// Returns true for whole numbers: turns, teeth, bits.
fn is_whole(line: &Line) -> bool {
    !line.value.contains(['.', 'e', '"'])
}

impl Line {
    /// Value as a number, if it is one.
    pub fn number(&self) -> Option<f64> {
        self.value.parse().ok()
    }

    /// Both wrong values to be tried, as typed: 0.5 and 1.5 times the value, or one bit less and more.
    pub fn wrong_values(&self) -> Option<[String; 2]> {
        let value = self.number()?;
        Some(match self.key {
            "bits" => [value - 1.0, value + 1.0].map(|bits| bits.to_string()),
            _ if is_whole(self) => [0.5, 1.5].map(|factor| (factor * value).round().to_string()),
            _ => [0.5, 1.5].map(|factor| number(factor * value)),
        })
    }

    fn remark(&self) -> String {
        match (&self.origin, &self.moved) {
            (Origin::Sheet(what), _) => format!("data sheet: {what}"),
            (Origin::Derived(from), _) => format!("{DERIVED} {from}"),
            (Origin::Assumed(why), None) => format!("assumed: {why}"),
            (Origin::Assumed(why), Some(Ok(moved))) => {
                let wrong = if self.key == "bits" { "+-1 bit" } else { "+-50 %" };
                format!("assumed: {why}; {wrong} moves the standard test by {}", percent(*moved))
            }
            (Origin::Assumed(why), Some(Err(unknown))) => format!("assumed: {why}; {unknown}"),
        }
    }
}

/// Keys of the file with the options that set them.
const OPTIONS: [(&str, &str); 16] = [
    ("rated_output_torque_N_m", "--rated-torque-Nm"),
    ("lost_motion_arcmin", "--lost-motion-arcmin"),
    ("total_stiffness_N_m_per_arcmin", "--stiffness-Nm-per-arcmin"),
    ("gear_inertia_at_input_kg_cm2", "--gear-inertia-kg-cm2"),
    ("rotor_inertia_kg_m2", "--rotor-inertia-kg-cm2"),
    ("link_inertia_kg_m2", "--link-inertia-kg-m2"),
    ("motor_torque_limit_N_m", "--motor-peak-torque-Nm"),
    ("no_load_torque_N_m", "--no-load-torque-Nm"),
    ("motor_coulomb_friction_N_m", "--no-load-torque-Nm"),
    ("load_coulomb_friction_N_m", "--no-load-torque-Nm"),
    ("efficiency", "--efficiency"),
    ("gravity_torque_N_m", "--gravity-torque-Nm"),
    ("module_mm", "--outer-diameter-mm"),
    ("ratio", "--ratio"),
    ("planets", "--planets"),
    ("bits", "--motor-bits or --output-bits"),
];

/// Options of the keys named in a message, as the end of a sentence.
pub fn options_in(message: &str) -> String {
    let named = OPTIONS.iter().filter(|(key, _)| message.contains(&format!("`{key}`")));
    named.map(|(key, option)| format!("; `{key}` is {option}")).collect()
}

/// Share as percent, with two digits.
pub fn percent(share: f64) -> String {
    let percent = 100.0 * share;
    match percent {
        _ if percent < 0.1 => "less than 0.1 %".to_owned(),
        _ if percent < 10.0 => format!("{percent:.1} %"),
        _ => format!("{percent:.0} %"),
    }
}

/// Lines in order; a line without a section continues the section before it.
#[derive(Default)]
struct Lines(Vec<Line>);

impl Lines {
    fn add(&mut self, place: Option<&'static str>, key: &'static str, value: String, origin: Origin) {
        let section = place.or(self.0.last().map(|line| line.section)).unwrap_or_default();
        let moved =
            (key == "planets").then(|| Err("it is not varied, since teeth and masses follow from it".to_owned()));
        self.0.push(Line { section, key, value, origin, moved });
    }
}

fn data(what: &str) -> Origin {
    Origin::Sheet(what.to_owned())
}

fn derived(from: String) -> Origin {
    Origin::Derived(from)
}

fn assumed(why: &str) -> Origin {
    Origin::Assumed(why.to_owned())
}

fn round(value: f64) -> String {
    number(rounded(value))
}

/// All lines, in order of the file.
pub fn lines(sheet: &DataSheet, gears: &Gears) -> Vec<Line> {
    let mut lines = Lines::default();
    let ratio = gears.ratio(sheet);
    lines.add(Some(""), "name", format!("\"{}\"", sheet.name), data("as it was called"));
    let kind = match gears {
        Gears::Planetary(sizes) => {
            format!("{} planets of {}, ratio {ratio:.4}", sizes.teeth.planets, sheet.material().word())
        }
        Gears::Equivalent => format!("equivalent gear, ratio {ratio}"),
    };
    let description = format!("\"{kind}, lost motion {} arcmin\"", sheet.lost_motion_arcmin);
    lines.add(None, "description", description, derived("the lines below".into()));
    lines.add(None, "rated_output_torque_N_m", number(sheet.rated_torque), data("rated torque at the output"));
    match gears {
        Gears::Planetary(sizes) => {
            teeth(&mut lines, sheet, sizes);
            motor_and_link(&mut lines, sheet, gears);
            compliance_and_meshes(&mut lines, sheet, sizes);
        }
        Gears::Equivalent => {
            equivalent_gear(&mut lines, sheet);
            motor_and_link(&mut lines, sheet, gears);
        }
    }
    surroundings(&mut lines, sheet, ratio);
    lines.0
}

/// Equivalent gear and its inertia.
fn equivalent_gear(lines: &mut Lines, sheet: &DataSheet) {
    lines.add(Some("equivalent_gear"), "ratio", number(sheet.ratio), data("gear ratio"));
    lines.add(None, "lost_motion_arcmin", number(sheet.lost_motion_arcmin), data("lost motion at the output"));
    let stiffness = data("torsional stiffness at the output");
    lines.add(None, "total_stiffness_N_m_per_arcmin", number(sheet.stiffness), stiffness);
    lines.add(None, "damping_ratio", number(0.05), assumed("0.03 to 0.1 is usual of gears under oil or grease"));
    let (inertia, origin) = match sheet.gear_inertia {
        Some(inertia) => (number(inertia), data("moment of inertia of the gearbox at its input")),
        None => (round(1e4 * Gears::Equivalent.inertia_at_input(sheet)), assumed("half of the rotor's")),
    };
    lines.add(Some("bodies"), "gear_inertia_at_input_kg_cm2", inertia, origin);
}

/// Teeth and their masses.
fn teeth(lines: &mut Lines, sheet: &DataSheet, sizes: &Sizes) {
    let teeth = &sizes.teeth;
    let ratio = teeth.ratio();
    let material = sheet.material().word();
    let planets = match sheet.planets {
        Some(_) => data("number of planets"),
        None => assumed("common practice"),
    };
    lines.add(Some("geometry"), "planets", teeth.planets.to_string(), planets);
    let off = 100.0 * (ratio / sheet.ratio - 1.0);
    let undercut = teeth.undercut().map_or(String::new(), |said| format!("; {said}"));
    let of_ratio = format!(
        "the sheet's ratio {}: 1 + {}/{} = {ratio:.4}, {off:+.2} %{undercut}",
        sheet.ratio, teeth.ring, teeth.sun
    );
    lines.add(None, "sun_teeth", teeth.sun.to_string(), derived(of_ratio));
    lines.add(
        None,
        "planet_teeth",
        teeth.planet.to_string(),
        derived(format!("({} - {}) / 2: coaxial", teeth.ring, teeth.sun)),
    );
    let assembles = format!(
        "({0} + {1}) / {2} = {3}: assembles",
        teeth.sun,
        teeth.ring,
        teeth.planets,
        (teeth.sun + teeth.ring) / teeth.planets
    );
    lines.add(None, "ring_teeth", teeth.ring.to_string(), derived(assembles));
    lines.add(None, "module_mm", number(sizes.module_mm), derived(sizes.module_from.clone()));
    lines.add(
        None,
        "working_pressure_angle_deg",
        number(PRESSURE_ANGLE_DEG),
        assumed("ISO 53 basic rack, no profile shift"),
    );

    let disc = |what: &str, wide: f64| derived(format!("size and material: {what} of {material}, {wide:.2} mm thick"));
    let bodies = &sizes.bodies;
    match sheet.gear_inertia {
        Some(inertia) => lines.add(
            Some("bodies"),
            "gear_inertia_at_input_kg_cm2",
            number(inertia),
            data("moment of inertia of the gearbox at its input"),
        ),
        None => {
            let solid = "a solid disc of the pitch diameter";
            lines.add(
                Some("bodies"),
                "sun_equivalent_mass_kg",
                round(bodies.sun_equivalent_mass),
                disc(solid, sizes.width_mm),
            );
            lines.add(
                None,
                "planet_equivalent_mass_kg",
                round(bodies.planet_equivalent_mass),
                disc(solid, sizes.width_mm),
            );
            lines.add(None, "planet_mass_kg", round(bodies.planet_mass), disc(solid, sizes.width_mm));
            let carrier = "a disc of the radius of the planets' axes";
            let over = bodies.carrier_inertia_over_radius_squared;
            lines.add(None, "carrier_inertia_over_radius_squared_kg", round(over), disc(carrier, sizes.carrier_mm));
        }
    }
}

/// Inertias of rotor and link.
fn motor_and_link(lines: &mut Lines, sheet: &DataSheet, gears: &Gears) {
    let rotor = format!("inertia of the rotor, {} kg cm^2", sheet.rotor_inertia);
    lines.add(None, "rotor_inertia_kg_m2", number(sheet.rotor_inertia / 1e4), Origin::Sheet(rotor));
    match sheet.link_inertia {
        Some(inertia) => lines.add(None, "link_inertia_kg_m2", number(inertia), data("inertia of the link")),
        None => {
            let (link, why) = Swing::new(sheet, gears).assumed_link();
            lines.add(None, "link_inertia_kg_m2", round(link), assumed(why));
        }
    }
}

/// Compliance behind the teeth, and the teeth.
fn compliance_and_meshes(lines: &mut Lines, sheet: &DataSheet, sizes: &Sizes) {
    let material = sheet.material().word();
    let total = format!(
        "torsional stiffness at the output; the teeth take {:.1} % of its compliance",
        100.0 * sizes.teeth_share
    );
    lines.add(Some("compliance"), "total_stiffness_N_m_per_arcmin", number(sheet.stiffness), Origin::Sheet(total));
    lines.add(None, "damping_ratio", number(0.02), assumed("bolted steel joints"));

    let stiffness = format!(
        "face width and material: {:.2} mm of {material}, {:.3e} N/m for a metre",
        sizes.width_mm,
        sheet.material().stiffness_per_width()
    );
    lines.add(Some("mesh"), "mean_stiffness_N_per_m", number(sizes.mean_stiffness), derived(stiffness));
    lines.add(None, "stiffness_ratio", number(0.15), assumed("spur gears of contact ratio 1.6"));
    lines.add(None, "damping_ratio", number(0.05), assumed("0.03 to 0.1 is usual of gear meshes"));
    lines.add(None, "lost_motion_arcmin", number(sheet.lost_motion_arcmin), data("lost motion at the output"));
    let error = rounded(3.0 * sizes.module_mm.sqrt());
    lines.add(None, "transmission_error_um", number(error), assumed("amplitude, quality 6 of ISO 1328 for this size"));
}

/// Drive train around the gears.
fn surroundings(lines: &mut Lines, sheet: &DataSheet, ratio: f64) {
    let balancing = sheet.rated_torque / ratio;
    let (rated, drive) = (sheet.rated_torque, sheet.motor_peak_torque.map_or(balancing, |peak| peak.min(balancing)));
    if let Some(peak) = sheet.motor_peak_torque {
        lines.add(Some("profile"), "motor_torque_limit_N_m", number(peak), data("peak torque of the motor"));
    }

    lines.add(
        Some("drive_train"),
        "no_load_torque_N_m",
        number(sheet.no_load_torque),
        data("torque at the input without a load"),
    );
    let load = 0.5 * sheet.no_load_torque * ratio * sheet.efficiency;
    lines.add(None, "load_coulomb_friction_N_m", round(load), assumed("half of the no-load torque, through the gears"));
    lines.add(None, "load_stribeck_rise_ratio", number(0.2), assumed("seals and grease"));
    lines.add(None, "load_stribeck_speed_rad_per_s", number(0.05), assumed("seals and grease"));
    lines.add(
        None,
        "load_viscous_friction_N_m_s_per_rad",
        round(8e-3 * rated),
        assumed("0.8 % of the rated torque at 1 rad/s"),
    );
    lines.add(
        None,
        "motor_viscous_friction_N_m_s_per_rad",
        round(1e-4 * drive),
        assumed("1 % of the drive torque at 100 rad/s"),
    );
    lines.add(None, "cogging_torque_N_m", round(0.01 * drive), assumed("1 % of the drive torque"));
    lines.add(None, "cogging_periods_per_turn", "84".into(), assumed("twice for each of 42 magnets"));
    lines.add(None, "efficiency", number(sheet.efficiency), data("efficiency of the gears"));
    if let Some(gravity) = sheet.gravity_torque {
        lines.add(None, "gravity_torque_N_m", number(gravity), data("torque of the link's weight"));
    }
    lines.add(None, "current_lag_ms", number(0.2), assumed("current loop of 800 Hz bandwidth"));
    lines.add(None, "torque_noise_ratio", number(0.015), assumed("usual current sensing"));
    lines.add(None, "torque_constant_error_ratio", number(0.03), assumed("spread of magnets and winding temperature"));
    lines.add(None, "control_rate_Hz", number(10e3), assumed("one control step every 100 us"));
    lines.add(None, "control_delay_periods", number(1.0), assumed("one period from measuring to acting"));

    let bits = |stated: Option<u32>, usual: u32, kind: &str| match stated {
        Some(bits) => (bits.to_string(), data("resolution")),
        None => (usual.to_string(), assumed(kind)),
    };
    let (motor, origin) = bits(sheet.motor_bits, 14, "magnetic encoder on the shaft's end");
    lines.add(Some("drive_train.motor_encoder"), "bits", motor, origin);
    lines.add(None, "once_per_turn_error_deg", number(0.1), assumed("eccentric magnet"));
    lines.add(None, "twice_per_turn_error_deg", number(0.1), assumed("tilted magnet"));
    let (output, origin) = bits(sheet.output_bits, 17, "ring encoder");
    lines.add(Some("drive_train.output_encoder"), "bits", output, origin);
    lines.add(None, "once_per_turn_error_deg", number(0.02), assumed("eccentric ring"));
    lines.add(None, "skew_us", number(50.0), assumed("serial read-out"));
}

/// Results of the standard test.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Figures {
    /// Result for the file [mrad].
    pub of_file: f64,
    /// Relative change of the result by a thousandth of the link's inertia [-].
    pub chance: f64,
    /// Seeds of the median.
    pub seeds: u64,
}

/// Text of the file, with the results of the standard test once they are known.
pub fn text(sheet: &DataSheet, gears: &Gears, lines: &[Line], figures: Option<&Figures>) -> String {
    let kind = match gears {
        Gears::Planetary(_) => format!(
            "ratio {} (met within {} %), gears of {}{}",
            sheet.ratio,
            sheet.ratio_tolerance,
            match sheet.material {
                Some(material) => material.word().to_owned(),
                None => format!("{}, which is assumed", sheet.material().word()),
            },
            sheet.outer_diameter_mm.map_or(String::new(), |mm| format!(", outer diameter {mm} mm")),
        ),
        Gears::Equivalent => format!("an equivalent gear of ratio {}, without preload or hysteresis", sheet.ratio),
    };
    let mut text = format!(
        "# {}, made by joint new {} from its data sheet: {kind}.\n\
         # Behind every value stands \"data sheet\", \"derived from\" what, or \"assumed\".\n",
        sheet.name,
        provenance::VERSION,
    );
    if let Some(Figures { of_file, chance, seeds }) = figures {
        text += &format!(
            "#\n\
             # The standard test is motion T2 of `joint hil`: the link swings by 0.5 rad at 1 Hz, reversed by its inertia, under\n\
             # observer and compensation with preview, on the core's own plant. Its figure is the link against the wanted position,\n\
             # root mean square from 2 s to 6 s, the median over the noise of seeds 1 to {seeds}: {of_file:.4} mrad for this file. Behind an\n\
             # assumed value stands how far that figure moves when the joint has 0.5 and 1.5 times the value, the larger of both,\n\
             # and its controllers still believe this file: the median over the seeds. The rate and the bits of encoders are known\n\
             # to the controllers, and one bit fewer or more is tried. Chance moves the figure too: a thousandth more or less of\n\
             # the link's inertia by up to {}. Not much more than that says nothing.\n",
            percent(*chance)
        );
    }
    if let Some(undercut) = gears.undercut() {
        text += &format!("# {undercut}.\n");
    }
    text.push('\n');
    let mut section = "";
    for line in lines {
        if line.section != section {
            text += &format!("\n[{}]\n", line.section);
            section = line.section;
        }
        text += &format!("{} = {} # {}\n", line.key, line.value, line.remark());
    }
    text
}
