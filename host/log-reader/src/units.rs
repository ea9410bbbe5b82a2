//! Units of a log's columns, as stated on the command line; units are never guessed. A column with a unit in its name
//! needs no statement; a bare name such as `motor_angle` needs `--unit motor_angle=turns`.

use std::f64::consts::{PI, TAU};

use super::columns::Columns;
use report::failure::{Failure, Outcome};

/// Quantity: bare name, canonical column, and units with their factors to SI.
struct Quantity {
    name: &'static str,
    column: &'static str,
    units: &'static [(&'static str, f64)],
    /// Power of the gear ratio that converts a quantity from the output to the motor; `None` for quantities without
    /// one.
    over_gears: Option<i32>,
}

const TIMES: &[(&str, f64)] = &[("s", 1.0), ("ms", 1e-3), ("us", 1e-6), ("ns", 1e-9)];
const ANGLES: &[(&str, f64)] =
    &[("rad", 1.0), ("mrad", 1e-3), ("deg", PI / 180.0), ("arcmin", PI / 10_800.0), ("turns", TAU)];
/// Standard acceleration of free fall, inch of 25.4 mm.
const TORQUES: &[(&str, f64)] = &[
    ("N_m", 1.0),
    ("mN_m", 1e-3),
    ("N_cm", 1e-2),
    ("kgf_cm", 0.098_066_5),
    ("ozf_in", 0.007_061_551_8),
    ("lbf_in", 0.112_984_83),
];

const QUANTITIES: [Quantity; 5] = [
    Quantity { name: "time", column: "time_s", units: TIMES, over_gears: None },
    Quantity { name: "motor_angle", column: "motor_angle_rad", units: ANGLES, over_gears: Some(1) },
    Quantity { name: "output_angle", column: "output_angle_rad", units: ANGLES, over_gears: None },
    Quantity { name: "motor_torque", column: "motor_torque_N_m", units: TORQUES, over_gears: Some(-1) },
    Quantity { name: "output_torque", column: "output_torque_N_m", units: TORQUES, over_gears: None },
];

/// Suffix of a motor's quantity measured at the output.
const AT_OUTPUT: &str = "@output";

/// Unit of a column.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Unit {
    /// Index of the quantity.
    quantity: usize,
    /// Factor to SI.
    factor: f64,
    /// True for a motor's quantity measured at the output.
    at_output: bool,
}

impl Unit {
    /// Bare name of the quantity.
    pub fn name(self) -> &'static str {
        QUANTITIES[self.quantity].name
    }
}

/// Quantity of a column by the beginning of its name; counts are an angle.
pub fn quantity_of(column: &str) -> &str {
    let name = column.strip_suffix("_counts").map(|encoder| match encoder {
        "motor" => "motor_angle",
        _ => "output_angle",
    });
    name.or_else(|| bare_names().find(|name| column.starts_with(name))).unwrap_or(column)
}

/// Bare names of columns, which need a stated unit.
pub fn bare_names() -> impl Iterator<Item = &'static str> {
    QUANTITIES.iter().map(|quantity| quantity.name)
}

/// Parses a value of `--unit`, such as `motor_angle=turns`, `motor_torque=0.06*N_m` or `motor_angle=turns@output`.
pub fn parse(text: &str) -> Result<Unit, String> {
    let names: Vec<&str> = bare_names().collect();
    let (name, unit) = text.split_once('=').ok_or("write QUANTITY=UNIT, as in motor_angle=turns")?;
    let Some(place) = names.iter().position(|known| *known == name) else {
        return Err(format!("`{name}` is not one of {}", names.join(", ")));
    };
    let quantity = &QUANTITIES[place];
    let (unit, at_output) = match (unit.strip_suffix(AT_OUTPUT), quantity.over_gears) {
        (Some(unit), Some(_)) => (unit, true),
        (Some(_), None) => return Err(format!("{AT_OUTPUT} is for the motor's quantities")),
        (None, _) => (unit, false),
    };
    let (times, unit) = match unit.split_once('*') {
        None => (1.0, unit),
        Some((times, unit)) => (times.parse().map_err(|_| format!("`{times}` is not a number: write 0.06*N_m"))?, unit),
    };
    let known: Vec<&str> = quantity.units.iter().map(|(name, _)| *name).collect();
    let Some((_, factor)) = quantity.units.iter().find(|(name, _)| *name == unit) else {
        let current = if unit == "A" { "; for a current write its constant in N m/A: 0.06*N_m" } else { "" };
        return Err(format!("`{unit}` is not one of {}{current}", known.join(", ")));
    };
    if !f64::is_normal(times) {
        return Err("the number before the * must be finite and not zero".to_owned());
    }
    Ok(Unit { quantity: place, factor: times * factor, at_output })
}

/// Converts columns with bare names to canonical columns in SI; `ratio` is motor over output.
pub fn convert(mut columns: Columns, units: &[Unit], ratio: f64) -> Outcome<Columns> {
    for (place, Quantity { name, column, over_gears, .. }) in QUANTITIES.iter().enumerate() {
        let mut stated_units = units.iter().filter(|unit| unit.quantity == place);
        let has = |wanted: &str| columns.names().any(|name| name == wanted);
        match (stated_units.next(), has(name)) {
            (None, false) => {}
            (None, true) if has(column) => {}
            (None, true) => {
                return Err(Failure::new(format!("the unit of the column `{name}` is not stated"))
                    .with_help(format!("state it, such as --unit {name}={}", QUANTITIES[place].units[0].0)));
            }
            (Some(_), false) => {
                let help = if has(column) {
                    format!("`{column}` states its unit: if it is another unit, add --column {name}={column}")
                } else {
                    format!("add --column {name}=NAME for its column")
                };
                return Err(Failure::new(format!("--unit {name}: there is no column `{name}`")).with_help(help));
            }
            (Some(unit), true) => {
                if stated_units.next().is_some() {
                    return Err(Failure::new(format!("--unit {name} is given twice")).with_help("give it once"));
                }
                let gears = if unit.at_output { ratio.powi(over_gears.unwrap_or_default()) } else { 1.0 };
                columns.scale(name, column, unit.factor * gears);
            }
        }
    }
    Ok(columns)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn columns() -> Columns {
        let mut columns = Columns::new("line");
        assert!(columns.push(1, &[("motor_angle".to_owned(), 2.0), ("motor_torque".to_owned(), 3.0)]));
        columns
    }

    /// A stated unit converts a column to SI.
    #[test]
    fn stated_unit_converts_to_si() {
        let units = ["motor_angle=turns@output", "motor_torque=0.06*N_m"].map(|text| parse(text).expect("a unit"));
        let columns = convert(columns(), &units, 6.0).expect("both are there");
        assert_eq!(columns.finite("motor_angle_rad").expect("a number"), Some(vec![12.0 * TAU]));
        assert_eq!(columns.finite("motor_torque_N_m").expect("a number"), Some(vec![0.06 * 3.0]));
    }

    /// A missing unit, an unused unit and a malformed one are rejected.
    #[test]
    fn missing_or_unused_unit_is_rejected() {
        let torque = parse("motor_torque=N_cm").expect("a unit");
        let refused = convert(columns(), &[torque], 6.0).expect_err("no unit of the angle");
        assert_eq!(refused.message(), "the unit of the column `motor_angle` is not stated");
        let turns = parse("output_angle=turns").expect("a unit");
        let both = [torque, parse("motor_angle=deg").expect("a unit"), turns];
        let refused = convert(columns(), &both, 6.0).expect_err("no output");
        assert_eq!(refused.message(), "--unit output_angle: there is no column `output_angle`");
        for (text, why) in [
            ("motor_angle", "QUANTITY=UNIT"),
            ("speed=rad", "one of time, motor_angle"),
            ("motor_torque=A", "0.06*N_m"),
            ("output_angle=turns@output", "motor's"),
            ("motor_angle=x*rad", "not a number"),
            ("motor_angle=0*rad", "not zero"),
            ("motor_angle=grad", "one of rad, mrad, deg, arcmin, turns"),
        ] {
            let refused = parse(text).expect_err(text);
            assert!(refused.contains(why), "{text}: {refused}");
        }
    }
}
