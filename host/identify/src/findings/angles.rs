//! Findings of the encoders: errors once and twice a turn, and the age of the output's reading.

use super::finding::{Finding, finding};
use super::quantisation;
use crate::estimate::Estimate;
use crate::log::Log;
use crate::prior::PriorModel;
use crate::twist;
use crate::twist::Twist;

/// An error by angle counts as found if the log narrows it to this share of its prior width.
const NARROWED_SHARE: f64 = 0.1;
/// Time over which a speed is taken [s].
const SPEED_WINDOW: f64 = 0.01;
/// Radius that contains two parts in 95 of 100 cases, over the reach that contains one.
const TWO_PART_RADIUS: f64 = 1.25;
/// Unknown share of the motor's viscous friction.
const VISCOUS_UNKNOWN_SHARE: f64 = 0.3;
/// Degrees per radian.
const DEGREES: f64 = 180.0 / std::f64::consts::PI;

/// Name of an encoder's error of this order and its key in the joint file.
pub(crate) fn names(encoder: &str, word: &str) -> (String, String) {
    let key = format!("drive_train.{encoder}_encoder.{word}_per_turn_error_deg");
    (format!("{encoder} encoder: error {word} a turn"), key)
}

/// Errors once and twice a turn of either encoder.
pub(super) fn encoder_errors(twist: &Twist, prior: &PriorModel) -> Vec<Finding> {
    let solution = &twist.solution;
    let mut findings = Vec::new();
    let encoders = [("motor", twist::MOTOR_MAP, prior.motor_turn), ("output", twist::OUTPUT_MAP, prior.output_turn)];
    for (encoder, first, turn) in encoders {
        for (order, word) in [(0, "once"), (1, "twice")] {
            let [sine, cosine] = [first + 2 * order, first + 2 * order + 1];
            let (along, across) = (solution.values[sine], solution.values[cosine]);
            let amplitude = along.hypot(across);
            let [by_sine, by_cosine] = [along / amplitude, across / amplitude];
            let estimate = Estimate::of_function(solution, amplitude, &[(sine, by_sine), (cosine, by_cosine)]);
            let estimate = estimate.widened_by(quantisation::angle(turn));
            // The amplitude of two noisy parts is never zero; it may be zero unless it exceeds the interval of both.
            let both = Estimate { half: TWO_PART_RADIUS * estimate.half, ..estimate };
            let estimate = if amplitude < both.half { both } else { estimate };
            let narrow = [sine, cosine].iter().all(|part| {
                solution.half(&[(*part, 1.0)]) < solution.coverage_factor * NARROWED_SHARE * twist::prior_width(first)
            });
            let phase = across.atan2(along) * DEGREES;
            let reach = (estimate.half / amplitude).min(std::f64::consts::PI) * DEGREES;
            let (name, key) = names(encoder, word);
            let why = format!("the {encoder} must make a whole turn and more under torque");
            let note = match amplitude > estimate.half {
                true => format!("phase at count zero {phase:.1} deg, +- {reach:.1}"),
                false => "may well be zero".to_owned(),
            };
            findings.push(
                finding(&name, "deg", &key, estimate.scaled(DEGREES))
                    .only_if(narrow, &why)
                    .not_negative()
                    .with_note(note),
            );
        }
    }
    findings
}

/// Age of the output's reading. Angle errors mimicked by counts and teeth look like an age, more so for a slow output.
pub(super) fn skew(log: &Log, twist: &Twist, prior: &PriorModel, rates: f64) -> Finding {
    let speed = rms_speed(log).max(f64::MIN_POSITIVE);
    let skew = Estimate::of_unknown(&twist.solution, twist::SKEW).widened_by(quantisation::twist(prior) / speed);
    // Viscous friction of the motor bends the joint like an age.
    let mimicked = prior.compliance * prior.ratio().powi(2) * prior.surroundings.motor_friction.viscous;
    let skew = skew.widened_by(VISCOUS_UNKNOWN_SHARE * mimicked + rates * skew.value);
    let why = "the joint must turn at different speeds";
    let narrow = skew.half < 2.0 * NARROWED_SHARE * twist::prior_width(twist::SKEW);
    finding("output encoder: age of a reading", "us", "drive_train.output_encoder.skew_us", skew.scaled(1e6))
        .only_if(narrow, why)
}

/// Root mean square of the output's speed [rad/s].
fn rms_speed(log: &Log) -> f64 {
    let samples = ((SPEED_WINDOW / log.period) as usize).max(1);
    let places: Vec<f64> = log.output.iter().copied().step_by(samples).collect();
    let squares: f64 = places.windows(2).map(|pair| (pair[1] - pair[0]).powi(2)).sum();
    (squares / places.len().max(1) as f64).sqrt() / (samples as f64 * log.period)
}
