//! What a log shows of the encoders: errors that come once and twice a turn, and the age of the output's reading.

use super::feigned;
use super::finding::{Finding, finding};
use crate::estimate::Estimate;
use crate::log::Log;
use crate::prior::PriorModel;
use crate::twist;
use crate::twist::Twist;

/// An error by angle counts as found if the log narrows it to this share of what is expected anyway.
const NARROWED: f64 = 0.1;
/// Time over which a speed is taken [s].
const SPAN: f64 = 0.01;
/// Radius within which two parts lie in 95 of 100 cases, over the reach within which one does.
const OF_BOTH: f64 = 1.25;
/// Part of the motor's viscous friction that is not known.
const VISCOUS: f64 = 0.3;
/// Degrees in a radian.
const DEGREES: f64 = 180.0 / std::f64::consts::PI;

/// What an encoder's error that comes so often a turn is called, and its key in a joint file.
pub(crate) fn names(encoder: &str, word: &str) -> (String, String) {
    let key = format!("drive_train.{encoder}_encoder.{word}_per_turn_error_deg");
    (format!("{encoder} encoder: error {word} a turn"), key)
}

/// Errors that come once and twice a turn of either encoder.
pub(super) fn maps(twist: &Twist, prior: &PriorModel) -> Vec<Finding> {
    let solution = &twist.solution;
    let mut findings = Vec::new();
    let encoders = [("motor", twist::MOTOR_MAP, prior.motor_turn), ("output", twist::OUTPUT_MAP, prior.output_turn)];
    for (encoder, first, turn) in encoders {
        for (order, word) in [(0, "once"), (1, "twice")] {
            let [sine, cosine] = [first + 2 * order, first + 2 * order + 1];
            let (along, across) = (solution.values[sine], solution.values[cosine]);
            let amplitude = along.hypot(across);
            let [by_sine, by_cosine] = [along / amplitude, across / amplitude];
            let estimate = Estimate::from(solution, amplitude, &[(sine, by_sine), (cosine, by_cosine)]);
            let estimate = estimate.wider_by(feigned::angle(turn));
            // An amplitude of two parts that scatter is never zero: one that does not stand out of both may well be.
            let both = Estimate { half: OF_BOTH * estimate.half, ..estimate };
            let estimate = if amplitude < both.half { both } else { estimate };
            let narrow = [sine, cosine]
                .iter()
                .all(|part| solution.half(&[(*part, 1.0)]) < solution.reach * NARROWED * twist::width(first));
            let phase = across.atan2(along) * DEGREES;
            let reach = (estimate.half / amplitude).min(std::f64::consts::PI) * DEGREES;
            let (name, key) = names(encoder, word);
            let why = format!("the {encoder} must make a whole turn and more under torque");
            let note = match amplitude > estimate.half {
                true => format!("phase at count zero {phase:.1} deg, +- {reach:.1}"),
                false => "may well be zero".to_owned(),
            };
            findings.push(
                finding(&name, "deg", &key, estimate.times(DEGREES)).if_so(narrow, &why).not_negative().noted(note),
            );
        }
    }
    findings
}

/// How old the output's reading is. What counts and teeth feign of an angle looks like an age the more, the slower the output
/// turns.
pub(super) fn skew(log: &Log, twist: &Twist, prior: &PriorModel, rates: f64) -> Finding {
    let speed = usual_speed(log).max(f64::MIN_POSITIVE);
    let skew = Estimate::of(&twist.solution, twist::SKEW).wider_by(feigned::twist(prior) / speed);
    // By the motor's viscous friction the joint is bent as by an age.
    let feigned = prior.compliance * prior.ratio().powi(2) * prior.surroundings.motor_friction.viscous;
    let skew = skew.wider_by(VISCOUS * feigned + rates * skew.value);
    let why = "the joint must turn at different speeds";
    let narrow = skew.half < 2.0 * NARROWED * twist::width(twist::SKEW);
    finding("output encoder: age of a reading", "us", "drive_train.output_encoder.skew_us", skew.times(1e6))
        .if_so(narrow, why)
}

/// Speed of the output, root mean square [rad/s].
fn usual_speed(log: &Log) -> f64 {
    let samples = ((SPAN / log.period) as usize).max(1);
    let places: Vec<f64> = log.output.iter().copied().step_by(samples).collect();
    let squares: f64 = places.windows(2).map(|pair| (pair[1] - pair[0]).powi(2)).sum();
    (squares / places.len().max(1) as f64).sqrt() / (samples as f64 * log.period)
}
