//! The joint file with identified values. Keys without an identified value stay unchanged.

use super::findings::Finding;
use super::prior::PriorModel;
use joint_file::named::{self, Loaded};
use report::failure::{Failure, Outcome};
use report::number::ESTIMATE;

/// Keys that may be negative.
const SIGNED: [&str; 1] = ["drive_train.torque_constant_error_ratio"];

/// Returns the changed text, which the reader accepts. A value whose interval contains zero is not added to a file
/// without its key.
pub fn patch(loaded: &Loaded, prior: &PriorModel, findings: &[Finding], log: &str) -> Outcome<String> {
    let log: String = log.chars().filter(|letter| !letter.is_control()).collect();
    let mut text = loaded.text.clone();
    for finding in findings {
        let (Some(key), Some(value), Some([low, high])) = (&finding.key, finding.value, finding.interval) else {
            continue;
        };
        let stated = joint_file::value(&loaded.text, key).ok().flatten().is_some();
        if !stated && low <= 0.0 && high >= 0.0 {
            continue;
        }
        let value = if SIGNED.contains(&key.as_str()) { value } else { value.max(0.0) };
        let remark = format!("identified from {log}: {} to {} (95 %)", ESTIMATE.write(low), ESTIMATE.write(high));
        for (encoder, turn) in [("motor", prior.motor_turn), ("output", prior.output_turn)] {
            // The section of an encoder missing in the file begins with its resolution.
            let section = format!("drive_train.{encoder}_encoder.");
            let [bits, counts] = ["bits", "counts_per_turn"].map(|name| format!("{section}{name}"));
            let is_missing = |key: &str| matches!(joint_file::value(&text, key), Ok(None));
            if key.starts_with(&section) && is_missing(&bits) && is_missing(&counts) {
                let (key, value) = if turn.is_power_of_two() { (bits, turn.ilog2().into()) } else { (counts, turn) };
                text = set(&text, &key, &value.to_string(), &format!("as stated for {log}"))?;
            }
        }
        text = set(&text, key, &format!("{value:.6e}"), &remark)?;
    }
    named::read_changed(format!("{} with the identified values", loaded.name), text.clone(), &[])?;
    Ok(text)
}

fn set(text: &str, key: &str, value: &str, remark: &str) -> Outcome<String> {
    joint_file::change_with_remark(text, key, value, remark)
        .map_err(|refused| Failure::new(format!("{key}: {}", refused.message)).with_help(refused.help))
}
