//! A slow log as samples: output, motor on the output's scale and their difference, in the output's unit; gaps and
//! jitter are kept.

use std::f64::consts::TAU;

use super::options::Options;
use crate::statistics::quantile;
use log_reader::bad_readings;
use log_reader::columns::{Columns, DIFFERENCE, KNOWN, MOTOR, OUTPUT, TIMES};
use log_reader::register::Register;
use report::failure::{Failure, Outcome};
use report::number::{ESTIMATE, TYPED};

/// Least samples of a log with passes.
const SAMPLES_MIN: usize = 96;
/// Time step, in usual steps, from which it is a gap.
pub const GAP_STEPS: f64 = 10.0;
/// Largest motion between samples, as a share of the whole travel.
const JUMP_SHARE: f64 = 0.2;
/// Tolerated slope of output against motor on one scale.
const SLOPE_RANGE: std::ops::RangeInclusive<f64> = 0.9..=1.1;
/// Differences below this share of the range are rounding.
const ROUNDING: f64 = 1e-9;
/// Least correlation of output and motor.
const CORRELATION_MIN: f64 = 0.8;

/// A slow log.
#[derive(Debug, Clone, PartialEq)]
pub struct Samples {
    /// Time since the first sample [s].
    pub time: Vec<f64>,
    /// Output as read.
    pub output: Vec<f64>,
    /// Motor over the gear ratio, on the output's scale.
    pub motor: Vec<f64>,
    /// Output less motor.
    pub difference: Vec<f64>,
    /// Motor torque [N m].
    pub motor_torque: Option<Vec<f64>>,
    /// Torque of the joint on its link [N m].
    pub output_torque: Option<Vec<f64>>,
    /// Unit of the output.
    pub scale: Scale,
    /// Resolution of both encoders together, on the output's scale [units of the output].
    pub resolution: f64,
    /// Changes to the rows of the file, a sentence each.
    pub notes: Vec<String>,
    /// Median time between samples [s].
    pub period: f64,
    /// 5 and 95 % quantile of the time between samples [s].
    pub jitter: [f64; 2],
    /// Number of gaps, and the longest time step [s].
    pub gaps: (usize, f64),
}

/// Unit of the output's column.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scale {
    /// Name of the unit.
    pub unit: &'static str,
    /// Units per turn, if known.
    pub per_turn: Option<f64>,
}

impl Scale {
    /// Degrees per unit.
    pub fn degrees(self) -> Option<f64> {
        self.per_turn.map(|turn| 360.0 / turn)
    }
}

/// A column of angles.
struct Angles {
    values: Vec<f64>,
    /// Radians, or counts of unknown size.
    scale: Scale,
}

impl Samples {
    /// Reads columns of known names.
    pub fn from_columns(columns: &mut Columns, options: &Options) -> Outcome<Self> {
        let motor_names: &[&str] = if columns.column(DIFFERENCE).is_some() { &[DIFFERENCE] } else { &MOTOR };
        columns.remove_incomplete(&[&TIMES, motor_names, &OUTPUT, &["motor_torque_N_m"], &["output_torque_N_m"]])?;
        let stated = [(motor_names, options.motor_units_per_turn), (&OUTPUT, options.output_units_per_turn)];
        for (names, per_turn) in stated {
            let Some(name) = columns.name_of(names).map(str::to_owned) else { continue };
            let counts = names == [DIFFERENCE] || columns.first_of(&names[..1])?.is_some();
            let per_turn = if names == [DIFFERENCE] { options.output_units_per_turn } else { per_turn };
            let turn = if counts { per_turn } else { Some(TAU) };
            let count = columns.column(&name).map_or(0.0, resolution);
            bad_readings::remove_from_column(columns, &name, count, turn)?;
        }
        let time = columns.time_from_start()?;
        if time.len() < SAMPLES_MIN {
            return Err(Failure::new(format!("there are only {} samples, {SAMPLES_MIN} are the least", time.len()))
                .with_help("record several slow sweeps each way"));
        }
        let mut steps: Vec<f64> = time.windows(2).map(|pair| pair[1] - pair[0]).collect();
        if let Some(row) = steps.iter().position(|step| *step < 0.0) {
            return Err(Failure::new(format!("the time falls in {}", columns.place(row + 1)))
                .with_help("samples must be in the order in which they were taken"));
        }
        steps.sort_by(f64::total_cmp);
        let period = quantile(&steps, 0.5);
        if period <= 0.0 {
            return Err(Failure::new("the time does not advance for most of the log").with_help(
                "check the column: time_s, time_ms and time_us are accepted, --column time_s=NAME reads another",
            ));
        }
        let gaps = steps.iter().filter(|step| **step > GAP_STEPS * period).count();
        let longest = steps[steps.len() - 1];
        let output = angles(columns, OUTPUT, options.output_units_per_turn, "output")?
            .ok_or_else(|| columns.missing_encoder("output"))?;
        let Angles { values: mut output, scale } = output;
        let resolutions = [columns.name_of(&OUTPUT), columns.name_of(motor_names)]
            .map(|name| name.and_then(|name| columns.column(name)).map_or(0.0, resolution));
        unwrap(&mut output, scale, OUTPUT[0], columns);
        let (motor, factor) = motor(columns, options, scale, &output)?;
        for (name, values) in [("output", &output), ("motor", &motor)] {
            check_jumps(name, values, &time, period, columns, options)?;
        }
        let difference = output.iter().zip(&motor).map(|(output, motor)| output - motor).collect();
        let samples = Self {
            difference,
            resolution: resolutions[0] + factor.abs() * resolutions[1],
            notes: columns.notes().to_vec(),
            motor_torque: torque(columns, "motor_torque_N_m", options.gear_ratio.unwrap_or(1.0).signum())?,
            output_torque: torque(columns, "output_torque_N_m", 1.0)?,
            scale,
            period,
            jitter: [quantile(&steps, 0.05), quantile(&steps, 0.95)],
            gaps: (gaps, longest),
            time,
            output,
            motor,
        };
        samples.check_scale(options, columns)?;
        Ok(samples)
    }

    /// Travel of the motor between its 1 % and 99 % quantiles [units of the output].
    pub fn travel(&self) -> f64 {
        spread(&self.motor)
    }

    /// Rejects encoders that have different units after gear ratio and stated units.
    fn check_scale(&self, options: &Options, columns: &Columns) -> Outcome<()> {
        let count = self.motor.len() as f64;
        let mean = |values: &[f64]| values.iter().sum::<f64>() / count;
        let [of_motor, of_output] = [mean(&self.motor), mean(&self.output)];
        let (mut square, mut product, mut other) = (0.0, 0.0, 0.0);
        for (motor, output) in self.motor.iter().zip(&self.output) {
            let (motor, output) = (motor - of_motor, output - of_output);
            square += motor * motor;
            product += motor * output;
            other += output * output;
        }
        if square <= 0.0 || other <= 0.0 {
            let still = if square <= 0.0 { "motor" } else { "output" };
            return Err(Failure::new(format!("the {still} does not move in this log"))
                .with_help("record slow sweeps to and fro, with both encoders; check --column"));
        }
        let (slope, correlation) = (product / square, product / (square * other).sqrt());
        if correlation.abs() < CORRELATION_MIN {
            return Err(Failure::new(format!(
                "the output does not follow the motor: their readings correlate by {correlation:.2}"
            ))
            .with_help(match open_options(options, columns, false)[..] {
                [] => "check --column, and that both encoders belong to one joint".to_owned(),
                ref open => format!("check --column; counts that wrap every turn need {}", open.join(" and ")),
            }));
        }
        if SLOPE_RANGE.contains(&slope) {
            return Ok(());
        }
        let message = format!(
            "output and motor are not in one unit: the output moves by {} for each 1 of the motor over its gear ratio",
            ESTIMATE.write(slope)
        );
        if columns.column(DIFFERENCE).is_some() {
            return Err(Failure::new(message).with_help(format!(
                "`{DIFFERENCE}` has another unit than the output, or its motor is not on the output's scale: convert \
                     it"
            )));
        }
        let ratio = ESTIMATE.write(options.gear_ratio.unwrap_or(1.0) / slope);
        Err(Failure::new(message).with_help(match open_options(options, columns, true)[..] {
            [] => format!("one of the options that are stated is wrong: with the units as stated, the gear ratio would have to be {ratio}"),
            ref open => format!(
                "state {}; with the units as they are, the gear ratio would have to be {ratio}",
                open.join(" and ")
            ),
        }))
    }
}

/// Unstated options on the encoders' scale that would have an effect.
fn open_options(options: &Options, columns: &Columns, ratio: bool) -> Vec<&'static str> {
    let is_difference = columns.column(DIFFERENCE).is_some();
    let counts = |names: [&str; 2]| has_column(columns, names[0]);
    [
        ("--gear-ratio", ratio && !is_difference && options.gear_ratio.is_none()),
        ("--output-units-per-turn", counts(OUTPUT) && options.output_units_per_turn.is_none()),
        ("--motor-units-per-turn", !is_difference && counts(MOTOR) && options.motor_units_per_turn.is_none()),
    ]
    .into_iter()
    .filter_map(|(option, open)| open.then_some(option))
    .collect()
}

/// Torque, if logged, positive when it drives the output forwards.
fn torque(columns: &Columns, name: &str, sign: f64) -> Outcome<Option<Vec<f64>>> {
    if !has_column(columns, name) {
        return Ok(None);
    }
    let (_, torque) = columns.named(&[name])?;
    Ok(Some(torque.iter().map(|torque| sign * torque).collect()))
}

/// Returns true if a column exists under any of its names.
fn has_column(columns: &Columns, name: &str) -> bool {
    let others = KNOWN.iter().find(|(known, _)| *known == name).map_or(&[][..], |(_, others)| *others);
    columns.names().any(|own| own == name || others.contains(&own))
}

/// Distance between the 1 % and the 99 % quantile.
pub fn spread(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    quantile(&sorted, 0.99) - quantile(&sorted, 0.01)
}

/// Angles in counts or radians, if either is logged.
fn angles(columns: &Columns, names: [&str; 2], per_turn: Option<f64>, whose: &str) -> Outcome<Option<Angles>> {
    let Some(wanted) = names.into_iter().find(|name| has_column(columns, name)) else { return Ok(None) };
    let (_, values) = columns.named(&[wanted])?;
    if wanted == names[0] {
        return Ok(Some(Angles { values, scale: Scale { unit: "units", per_turn } }));
    }
    if per_turn.is_some() {
        return Err(Failure::new(format!("--{whose}-units-per-turn has no effect on `{wanted}`, which is in radians"))
            .with_help(format!("leave it out, or read the column as {} by --column", names[0])));
    }
    Ok(Some(Angles { values, scale: Scale { unit: "rad", per_turn: Some(TAU) } }))
}

/// Motor on the output's scale, from its own column or from the difference, and the size of the column's unit on this
/// scale.
fn motor(columns: &mut Columns, options: &Options, scale: Scale, output: &[f64]) -> Outcome<(Vec<f64>, f64)> {
    if let Some(mut difference) = columns.finite(DIFFERENCE)? {
        let stated = [("--gear-ratio", options.gear_ratio), ("--motor-units-per-turn", options.motor_units_per_turn)];
        if let Some((option, _)) = stated.iter().find(|(_, value)| value.is_some()) {
            return Err(Failure::new(format!(
                "{option} has no effect: in `{DIFFERENCE}` the motor is already on the output's scale"
            ))
            .with_help("leave the option out, or give the motor's own column"));
        }
        step_over_turns(&mut difference, scale);
        return Ok((output.iter().zip(&difference).map(|(output, difference)| output - difference).collect(), 1.0));
    }
    let motor = angles(columns, MOTOR, options.motor_units_per_turn, "motor")?;
    let Angles { mut values, scale: own } = motor.ok_or_else(|| columns.missing_encoder("motor"))?;
    let ratio = options.gear_ratio.unwrap_or(1.0);
    unwrap(&mut values, own, MOTOR[0], columns);
    let factor = match (scale.per_turn, own.per_turn) {
        (Some(output), Some(motor)) => output / motor,
        // Both encoders count in units of one size.
        _ if scale.unit == own.unit => 1.0,
        _ => {
            let option = if own.per_turn.is_none() { "--motor-units-per-turn" } else { "--output-units-per-turn" };
            return Err(Failure::new("one encoder is in radians, the other in counts of unknown size")
                .with_help(format!("state {option}")));
        }
    };
    values.iter_mut().for_each(|value| *value *= factor / ratio);
    Ok((values, factor / ratio))
}

/// Joins counts that wrap every turn, or in a wider register.
fn unwrap(values: &mut [f64], scale: Scale, name: &str, columns: &mut Columns) {
    let (least, most) =
        values.iter().fold((f64::MAX, f64::MIN), |(least, most), value| (least.min(*value), most.max(*value)));
    if scale.per_turn.is_some_and(|turn| most - least <= turn * (1.0 + 1e-9)) {
        step_over_turns(values, scale);
    } else if let Some(register) = Register::find(values, scale.per_turn) {
        register.join(values, |_| 1.0);
        register.note(name, scale.per_turn).into_iter().for_each(|notes| columns.add_note(notes));
    }
}

/// Resolution of a column: 1 for whole numbers, else the least step between distinct values; zero for a constant
/// column.
pub fn resolution(values: &[f64]) -> f64 {
    if values.iter().all(|value| value.fract() == 0.0) {
        return 1.0;
    }
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let range = sorted.last().zip(sorted.first()).map_or(0.0, |(last, first)| last - first);
    let steps = sorted.windows(2).map(|pair| pair[1] - pair[0]).filter(|step| *step > ROUNDING * range);
    steps.min_by(f64::total_cmp).unwrap_or_default()
}

fn step_over_turns(values: &mut [f64], scale: Scale) {
    let Some(turn) = scale.per_turn else { return };
    let (mut added, mut before) = (0.0, values.first().copied().unwrap_or_default());
    for value in values {
        added -= ((*value - before) / turn).round() * turn;
        before = *value;
        *value += added;
    }
}

fn check_jumps(
    name: &str,
    values: &[f64],
    time: &[f64],
    period: f64,
    columns: &Columns,
    options: &Options,
) -> Outcome<()> {
    let (least, most) =
        values.iter().fold((f64::MAX, f64::MIN), |(least, most), value| (least.min(*value), most.max(*value)));
    let limit = JUMP_SHARE * (most - least);
    let jumps = |row: &usize| {
        (values[row + 1] - values[*row]).abs() > limit.max(f64::MIN_POSITIVE)
            && time[row + 1] - time[*row] <= GAP_STEPS * period
    };
    let Some(row) = (0..values.len() - 1).find(jumps) else { return Ok(()) };
    let by = ESTIMATE.write((values[row + 1] - values[row]).abs());
    Err(Failure::new(format!(
        "the {name} jumps by {by} in {}, of {} in all",
        columns.place(row + 1),
        ESTIMATE.write(most - least)
    ))
    .with_help(format!(
        "a reading was lost, the log is too slow for the motion, or {}",
        jump_causes(name, columns, options)
    )))
}

/// Other causes of a jump, with the option that joins it if unstated.
fn jump_causes(name: &str, columns: &Columns, options: &Options) -> String {
    let of_output = name == "output" || columns.column(DIFFERENCE).is_some();
    let (option, stated, names) = if of_output {
        ("--output-units-per-turn", options.output_units_per_turn, OUTPUT)
    } else {
        ("--motor-units-per-turn", options.motor_units_per_turn, MOTOR)
    };
    match stated {
        Some(turn) => {
            format!("the counts wrap after another number than the {} stated by {option}", TYPED.write(turn))
        }
        None if has_column(columns, names[0]) => format!("the counts wrap every turn: state {option}"),
        None => format!(
            "an angle wraps in another unit than rad: name it {} and state its unit with --unit",
            names[1].trim_end_matches("_rad")
        ),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Counts that wrap every turn are joined, fractions included; continuous counts stay.
    #[test]
    fn unwrap_joins_counts_with_fractions() {
        let scale = Scale { unit: "units", per_turn: Some(100.0) };
        let truth: Vec<f64> = (0..400).map(|step| 7.25 * f64::from(step)).collect();
        let mut read: Vec<f64> = truth.iter().map(|value| value.rem_euclid(100.0)).collect();
        unwrap(&mut read, scale, "", &mut Columns::new("line"));
        assert!(read.iter().zip(&truth).all(|(read, truth)| (read - truth).abs() < 1e-9));
        let mut many_turns: Vec<f64> = truth.clone();
        unwrap(&mut many_turns, scale, "", &mut Columns::new("line"));
        assert_eq!(many_turns, truth);
    }
}
