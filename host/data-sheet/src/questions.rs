//! Questions for figures missing on the command line; without a terminal the missing options are named. Answers and
//! options have the same bounds.

use std::io::{self, BufRead, IsTerminal};

use report::command_line::quoted;
use report::failure::{Failure, Outcome};
use report::output;

use crate::arguments::{Arguments, DEFAULT_SEEDS, DataSheet};

/// Figure of the sheet.
struct Figure {
    option: &'static str,
    question: &'static str,
    least: f64,
    most: f64,
}

const fn figure(option: &'static str, question: &'static str, least: f64, most: f64) -> Figure {
    Figure { option, question, least, most }
}

/// Figures that every sheet needs, in order of the questions.
const REQUIRED_FIGURES: [Figure; 7] = [
    figure("--ratio", "gear ratio, motor turns for one turn of the link, such as 9", 2.2, 14.0),
    figure("--lost-motion-arcmin", "lost motion at the output in arcmin, such as 15", 0.0, 600.0),
    figure("--stiffness-Nm-per-arcmin", "torsional stiffness at the output in N m/arcmin, such as 1.8", 1e-4, 1e6),
    figure("--rated-torque-Nm", "rated torque at the output in N m, such as 8", 1e-3, 1e6),
    figure("--rotor-inertia-kg-cm2", "inertia of the motor's rotor in kg cm^2, such as 0.32", 1e-6, 1e6),
    figure(
        "--no-load-torque-Nm",
        "torque at the input that turns the joint without a load, in N m, such as 0.05",
        0.0,
        1e6,
    ),
    figure("--efficiency", "efficiency of the gears, such as 0.94", 0.1, 1.0),
];

/// Ratio of an equivalent gear, not bounded by teeth.
const EQUIVALENT_RATIO: Figure =
    figure("--ratio", "gear ratio, motor turns for one turn of the link, such as 59", 1.000_001, 99_999.0);

/// Kinds of gears, as typed by the user.
const GEAR_KINDS: [&str; 2] = ["planetary", "equivalent"];

/// Optional figures.
const OPTIONAL_FIGURES: [Figure; 6] = [
    figure("--gear-inertia-kg-cm2", "", 1e-9, 1e10),
    figure("--link-inertia-kg-m2", "", 1e-9, 1e6),
    figure("--gravity-torque-Nm", "", -1e6, 1e6),
    figure("--motor-peak-torque-Nm", "", 1e-6, 1e6),
    figure("--outer-diameter-mm", "", 2.0, 5000.0),
    figure("--ratio-tolerance", "", 0.0, 20.0),
];

/// Completes the sheet; asks for missing figures on a terminal if `may_ask` allows it.
pub fn complete(arguments: &Arguments, may_ask: bool) -> Outcome<DataSheet> {
    let stem = match arguments.name.extension() {
        Some(extension) if extension == "toml" => arguments.name.file_stem(),
        _ => arguments.name.file_name(),
    };
    let name = stem.map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default();
    check_name(&name)?;
    let given = [
        arguments.ratio,
        arguments.lost_motion_arcmin,
        arguments.stiffness,
        arguments.rated_torque,
        arguments.rotor_inertia,
        arguments.no_load_torque,
        arguments.efficiency,
    ];
    let optional = [
        arguments.gear_inertia,
        arguments.link_inertia,
        arguments.gravity_torque,
        arguments.motor_peak_torque,
        arguments.outer_diameter_mm,
        Some(arguments.ratio_tolerance),
    ];
    let stdin = io::stdin();
    let asks = may_ask && stdin.is_terminal();
    // If the ratio is asked for too, the teeth may be unknown as well.
    let asked = arguments.ratio.is_none() && !arguments.states_teeth() && asks;
    let equivalent = arguments.equivalent || (asked && ask_kind(&mut stdin.lock())? == GEAR_KINDS[1]);
    let mut needed = REQUIRED_FIGURES;
    if equivalent {
        needed[0] = EQUIVALENT_RATIO;
    }
    for (figure, value) in needed.iter().zip(given).chain(OPTIONAL_FIGURES.iter().zip(optional)) {
        if let Some(value) = value {
            figure.check(value).map_err(|why| {
                let other_gears =
                    figure.option == REQUIRED_FIGURES[0].option && !equivalent && EQUIVALENT_RATIO.check(value).is_ok();
                let help = if other_gears { arguments.equivalent_gear_help() } else { HELP.to_owned() };
                Failure::new(format!("{}: {why}", figure.option)).with_help(help)
            })?;
        }
    }
    let missing: Vec<&str> =
        needed.iter().zip(given).filter(|(_, value)| value.is_none()).map(|(figure, _)| figure.option).collect();
    if !missing.is_empty() && !asks {
        return Err(Failure::new(format!("{name}: the data sheet lacks {}", missing.join(", "))).with_help(
            if may_ask {
                "give each with its figure; a terminal session asks for them"
            } else {
                "give each with its figure"
            },
        ));
    }
    let mut figures = [0.0; REQUIRED_FIGURES.len()];
    for ((figure, value), place) in needed.iter().zip(given).zip(&mut figures) {
        *place = match value {
            Some(value) => value,
            None => figure.ask(&mut stdin.lock())?,
        };
    }
    let [ratio, lost_motion_arcmin, stiffness, rated_torque, rotor_inertia, no_load_torque, efficiency] = figures;
    Ok(DataSheet {
        name,
        equivalent,
        ratio,
        lost_motion_arcmin,
        stiffness,
        rated_torque,
        rotor_inertia,
        no_load_torque,
        efficiency,
        gear_inertia: arguments.gear_inertia,
        link_inertia: arguments.link_inertia,
        gravity_torque: arguments.gravity_torque,
        motor_peak_torque: arguments.motor_peak_torque,
        outer_diameter_mm: arguments.outer_diameter_mm,
        material: arguments.material,
        planets: arguments.planets,
        ratio_tolerance: arguments.ratio_tolerance,
        motor_bits: arguments.motor_bits,
        output_bits: arguments.output_bits,
    })
}

const HELP: &str = "`joint new --help` explains each option and its unit";

/// Asks for the kind of gears until the answer is valid.
fn ask_kind(answers: &mut impl BufRead) -> Outcome<&'static str> {
    loop {
        output::remark(
            "planetary (a stage whose teeth are found) or equivalent (gears without teeth, such as a spur train, \
                 a cycloid or a belt):",
        );
        let mut line = String::new();
        let read = answers.read_line(&mut line).unwrap_or_default();
        if read == 0 {
            return Err(Failure::new("no answer for the kind of gears").with_help("give --equivalent, or --ratio"));
        }
        let answer = line.trim();
        match GEAR_KINDS.into_iter().find(|kind| !answer.is_empty() && kind.starts_with(answer)) {
            Some(kind) => return Ok(kind),
            None => output::remark(&format!("`{answer}` is neither planetary nor equivalent; try again")),
        }
    }
}

impl Arguments {
    /// Help for gears that are not a single planetary stage: the same command for an equivalent gear.
    pub(crate) fn equivalent_gear_help(&self) -> String {
        let mut command = format!("joint new {} --equivalent", quoted(&self.name.display().to_string()));
        let numbers = [
            ("ratio", self.ratio),
            ("lost-motion-arcmin", self.lost_motion_arcmin),
            ("stiffness-Nm-per-arcmin", self.stiffness),
            ("rated-torque-Nm", self.rated_torque),
            ("rotor-inertia-kg-cm2", self.rotor_inertia),
            ("no-load-torque-Nm", self.no_load_torque),
            ("efficiency", self.efficiency),
            ("gear-inertia-kg-cm2", self.gear_inertia),
            ("link-inertia-kg-m2", self.link_inertia),
            ("gravity-torque-Nm", self.gravity_torque),
            ("motor-peak-torque-Nm", self.motor_peak_torque),
            ("motor-bits", self.motor_bits.map(f64::from)),
            ("output-bits", self.output_bits.map(f64::from)),
        ];
        for (option, value) in numbers {
            command += &value.map_or_else(String::new, |value| format!(" --{option} {value}"));
        }
        if self.no_measure {
            command += " --no-measure";
        } else if self.seeds != DEFAULT_SEEDS {
            command += &format!(" --seeds {}", self.seeds);
        }
        format!("for several stages, other kinds of gears or unknown teeth use an equivalent gear: {command}")
    }

    /// Returns true if an option that only gears with teeth have was given.
    fn states_teeth(&self) -> bool {
        self.equivalent || self.planets.is_some() || self.material.is_some() || self.outer_diameter_mm.is_some()
    }
}

/// Checks a name by the rules of the joint file.
fn check_name(name: &str) -> Outcome<()> {
    let plain = |letter: char| letter.is_ascii_alphanumeric() || " -_.+()".contains(letter);
    match !name.trim().is_empty() && name.len() <= 32 && name.chars().all(plain) {
        true => Ok(()),
        false => Err(Failure::new(format!("a joint cannot be called `{name}`"))
            .with_help("at most 32 letters, digits, spaces and -_.+(), such as elbow")),
    }
}

impl Figure {
    fn check(&self, value: f64) -> Result<(), String> {
        let Self { least, most, .. } = *self;
        match least <= value && value <= most {
            true => Ok(()),
            false => Err(format!("{value} is not between {least} and {most}")),
        }
    }

    /// Asks until the answer is valid.
    fn ask(&self, answers: &mut impl BufRead) -> Outcome<f64> {
        loop {
            output::remark(&format!("{}:", self.question));
            let mut line = String::new();
            let ended = |why: &str| Failure::new(format!("no answer for {}{why}", self.option)).with_help(HELP);
            let read = answers.read_line(&mut line).map_err(|error| ended(&format!(": {error}")))?;
            if read == 0 {
                return Err(ended(""));
            }
            let answer = line.trim();
            let value = answer.parse::<f64>().map_err(|_| format!("`{answer}` is not a number"));
            match value.and_then(|value| self.check(value).map(|()| value)) {
                Ok(value) => return Ok(value),
                Err(why) => output::remark(&format!("{why}; try again")),
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use std::io::Cursor;

    use super::*;

    /// An invalid answer is asked for again, until the input ends.
    #[test]
    fn invalid_answer_is_asked_again() {
        let mut answers = Cursor::new("nine\n-9\nNaN\n9\n");
        assert_eq!(REQUIRED_FIGURES[0].ask(&mut answers).expect("an answer"), 9.0);
        let failure = REQUIRED_FIGURES[0].ask(&mut answers).expect_err("no more answers");
        assert!(failure.message().contains("--ratio"), "{failure}");
    }
}
