//! One axis of a grid: a key of the joint file and its values, as text, so that 0.1 stays 0.1 in every file.

use report::failure::{Failure, Outcome};
use report::number::TYPED;

/// Largest number of values on one axis; more are likely a typing error.
pub const MAX_AXIS_VALUES: f64 = 1e6;
/// Rounding by which the last value may miss the end, over a step [-].
const END_ROUNDING: f64 = 1e-9;
/// Largest number of decimal places that are kept exact.
const MAX_DECIMALS: usize = 12;

/// One axis.
#[derive(Debug, Clone, PartialEq)]
pub struct Axis {
    /// Full path of the key.
    pub key: String,
    /// Text after the equals sign, as typed.
    pub spec: String,
    /// Values in order.
    pub values: Vec<String>,
}

impl Axis {
    /// Parses `key=from:to:step` or `key=value,value,...`; a short key needs the joint file's text.
    pub fn parse(vary: &str, joint: Option<&str>) -> Outcome<Self> {
        let refused = |message: String| Failure::new(message).with_help(AXIS_HELP);
        let Some((key, spec)) = vary.split_once('=') else {
            return Err(refused(format!("`{vary}` has no `=`")));
        };
        let full = joint.map_or_else(|| joint_file::full_key(key), |text| joint_file::full_key_in(text, key));
        let key = full
            .map_err(|refused| Failure::new(format!("--vary {vary}: {}", refused.message)).with_help(refused.help))?;
        let spec = spec.trim().to_owned();
        let parts: Vec<&str> = spec.split(':').map(str::trim).collect();
        let values = match parts[..] {
            [from, to, step] => steps(vary, [from, to, step])?,
            [list] => {
                let values: Vec<String> = list.split(',').map(|value| value.trim().to_owned()).collect();
                if values.iter().any(String::is_empty) {
                    return Err(refused(format!("--vary {vary}: a value is missing")));
                }
                values
            }
            _ => return Err(refused(format!("--vary {vary}: `{spec}` is neither from:to:step nor a list"))),
        };
        Ok(Self { key, spec, values })
    }

    /// Axis as typed, with the full key.
    pub fn text(&self) -> String {
        format!("{}={}", self.key, self.spec)
    }

    /// Step with which the axis has at most the given number of values; `None` for a list.
    pub fn coarser_step(&self, values: f64) -> Option<String> {
        let mut parts = self.spec.split(':').map(|part| part.trim().parse::<f64>());
        let (Some(Ok(from)), Some(Ok(to))) = (parts.next(), parts.next()) else { return None };
        coarser_step(from, to, values)
    }
}

const AXIS_HELP: &str =
    "write key=from:to:step, such as mesh.half_backlash_um=0:150:0.5, or key=value,value,value for single values";

/// Step with two digits that covers a range with at most the given number of values.
fn coarser_step(from: f64, to: f64, values: f64) -> Option<String> {
    let least = (to - from) / (values - 1.0).max(1.0);
    let digit = 10f64.powf(least.abs().log10().floor() - 1.0);
    let step = (least / digit).abs().ceil() * digit * least.signum();
    step.is_finite().then(|| format!("{step:.3e}").parse::<f64>().map_or_else(|_| step.to_string(), |s| s.to_string()))
}

/// Values from one number to another; the end is included if the steps reach it.
fn steps(vary: &str, texts: [&str; 3]) -> Outcome<Vec<String>> {
    let mut numbers = [0.0; 3];
    for ((number, text), what) in numbers.iter_mut().zip(texts).zip(["from", "to", "step"]) {
        *number = match text.parse::<f64>() {
            Ok(value) if value.is_finite() => value,
            Ok(value) => {
                return Err(Failure::new(format!("--vary {vary}: {what} is {value}")).with_help("give finite numbers"));
            }
            Err(_) => {
                let message = format!("--vary {vary}: {what} is `{text}`, not a number");
                return Err(Failure::new(message).with_help(AXIS_HELP));
            }
        };
    }
    let [from, to, step] = numbers;
    if step == 0.0 {
        let message = format!("--vary {vary}: a step of 0 never arrives, so the grid has no end");
        return Err(Failure::new(message).with_help("give a step that is not 0, or a list of single values"));
    }
    let way = (to - from) / step;
    if way < -END_ROUNDING {
        let message = format!("--vary {vary}: steps of {step} lead from {from} away from {to}: the axis has no value");
        return Err(Failure::new(message).with_help(format!("change the sign of the step: {from}:{to}:{}", -step)));
    }
    // Long ways lose their last digits in the division.
    let count = (way * (1.0 + f64::EPSILON * 4.0) + END_ROUNDING).floor() + 1.0;
    if count > MAX_AXIS_VALUES {
        let message =
            format!("--vary {vary}: {} values on one axis, at most {MAX_AXIS_VALUES} can be swept", TYPED.write(count));
        let help = coarser_step(from, to, 1000.0)
            .map_or_else(|| AXIS_HELP.to_owned(), |step| format!("a step of {step} gives about a thousand"));
        return Err(Failure::new(message).with_help(help));
    }
    let decimals = texts.iter().map(|text| decimals(text)).collect::<Option<Vec<_>>>();
    let decimals = decimals.and_then(|all| all.into_iter().max());
    let value = |index: usize| {
        let value = from + index as f64 * step;
        decimals.map_or_else(|| value.to_string(), |decimals| format!("{value:.decimals$}"))
    };
    Ok((0..count as usize).map(value).collect())
}

/// Decimal places of a number as typed; `None` with an exponent or with too many places.
fn decimals(text: &str) -> Option<usize> {
    let places = text.split_once('.').map_or(0, |(_, places)| places.len());
    (!text.contains(['e', 'E']) && places <= MAX_DECIMALS).then_some(places)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn values(spec: &str) -> Vec<String> {
        Axis::parse(&format!("mesh.half_backlash_um={spec}"), None).expect("a good axis").values
    }

    fn refused(spec: &str) -> Failure {
        Axis::parse(&format!("mesh.half_backlash_um={spec}"), None).expect_err("a bad axis")
    }

    #[test]
    fn values_are_written_as_decimals() {
        assert_eq!(values("0:0.5:0.1"), ["0.0", "0.1", "0.2", "0.3", "0.4", "0.5"]);
        assert_eq!(values("0:150:0.5").len(), 301);
        assert_eq!(values("10:0:-5"), ["10", "5", "0"]);
        assert_eq!(values("1:2:0.4"), ["1.0", "1.4", "1.8"]);
        assert_eq!(values("7:7:1"), ["7"]);
        assert_eq!(values("1e1:3e1:1e1"), ["10", "20", "30"]);
        assert_eq!(values("5, 10,20"), ["5", "10", "20"]);
    }

    #[test]
    fn short_key_becomes_full_key() {
        let axis = Axis::parse("sun_planet.half_backlash_um=1:2:1", None).expect("a good axis");
        assert_eq!(axis.text(), "mesh.sun_planet.half_backlash_um=1:2:1");
    }

    #[test]
    fn empty_grids_are_rejected() {
        for (spec, word) in [
            ("0:10:-1", "away"),
            ("10:0:1", "away"),
            ("0:10:0", "never arrives"),
            ("NaN:10:1", "NaN"),
            ("0:inf:1", "inf"),
            ("0:10:NaN", "NaN"),
            ("0:ten:1", "`ten`"),
            ("0:10", "neither"),
            ("", "missing"),
            ("1,,2", "missing"),
        ] {
            let failure = refused(spec);
            assert!(failure.message().contains(word), "{spec}: {failure}");
            assert!(failure.help().is_some(), "{spec}: {failure}");
        }
    }

    /// The error of an axis with too many values names their number and a step that is accepted.
    #[test]
    fn oversized_axis_error_gives_a_valid_step() {
        let failure = refused("0:1000:0.000000001");
        assert!(failure.message().contains("1000000000001 values"), "{failure}");
        assert!(
            failure.help().is_some_and(|help| help.contains("a step of 1.1 ") || help.contains("a step of 1.01")),
            "{failure}"
        );
    }

    #[test]
    fn unknown_key_error_suggests_nearest() {
        let failure = Axis::parse("mesh.half_backlsh_um=1:2:1", None).expect_err("unknown");
        assert!(failure.help().is_some_and(|help| help.contains("mesh.half_backlash_um")), "{failure}");
    }
}
