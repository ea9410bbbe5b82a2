//! Command line of `joint identify --quasi-static`.

/// Options that have no meaning for slow logs. An option that needs `--quasi-static` names them, too: clap takes an option
/// without what it needs if that conflicts with another one.
const NOT_SLOW: [&str; 11] = [
    "joint",
    "set",
    "motor_bits",
    "output_bits",
    "torque_error",
    "inertia_error",
    "simulate",
    "seed",
    "with_output_torque",
    "output_locked",
    "output_only",
];

/// Options of the quasi-static mode.
#[derive(Debug, Clone, Default, clap::Args)]
#[command(next_help_heading = "Slow logs")]
pub struct Options {
    /// Reads a log of slow sweeps, without a joint file: lost motion, hysteresis, error map, friction
    #[arg(long, conflicts_with_all = NOT_SLOW)]
    pub quasi_static: bool,
    /// Seconds of the log with the output loaded one way, such as 0..60; given a second time for the other way
    #[arg(long = "half", value_name = "FROM..TO", requires = "quasi_static", conflicts_with_all = NOT_SLOW, value_parser = stretch)]
    pub halves: Vec<(f64, f64)>,
    /// Units of the output's column in a turn of the output
    #[arg(long, value_name = "N", requires = "quasi_static", conflicts_with_all = NOT_SLOW, value_parser = positive)]
    pub output_units_per_turn: Option<f64>,
    /// Units of the motor's column in a turn of the motor
    #[arg(long, value_name = "N", requires = "quasi_static", conflicts_with_all = NOT_SLOW, value_parser = positive)]
    pub motor_units_per_turn: Option<f64>,
    /// Turns of the motor per turn of the output, negative if they count in opposite directions [default: 1]
    #[arg(long, value_name = "R", requires = "quasi_static", conflicts_with_all = NOT_SLOW, allow_hyphen_values = true, value_parser = ratio)]
    pub gear_ratio: Option<f64>,
}

fn stretch(text: &str) -> Result<(f64, f64), String> {
    let ends = text.split_once("..").and_then(|(from, to)| Some((from.parse().ok()?, to.parse().ok()?)));
    match ends {
        Some((from, to)) if from < to && f64::abs(from) < 1e9 && f64::abs(to) < 1e9 => Ok((from, to)),
        Some(_) => Err("the first time must be less than the second".to_owned()),
        None => Err("write seconds as FROM..TO, as in 0..60".to_owned()),
    }
}

fn positive(text: &str) -> Result<f64, String> {
    let value: f64 = text.parse().map_err(|_| "write a number".to_owned())?;
    if (1e-6..=1e15).contains(&value) { Ok(value) } else { Err("must be from 1e-6 to 1e15".to_owned()) }
}

fn ratio(text: &str) -> Result<f64, String> {
    let value: f64 = text.parse().map_err(|_| "write a number".to_owned())?;
    if (1e-6..=1e6).contains(&value.abs()) {
        Ok(value)
    } else {
        Err("must be from 1e-6 to 1e6, or from -1e6 to -1e-6".to_owned())
    }
}
