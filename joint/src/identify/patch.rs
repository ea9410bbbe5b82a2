//! The joint file with what was found in place of what it said. What was not found stays as it is.

use super::findings::Finding;
use super::table::number;
use crate::check::{self, Loaded};
use crate::failure::{Failure, Outcome};

/// The changed text; it can be read again.
pub fn patch(loaded: &Loaded, findings: &[Finding], log: &str) -> Outcome<String> {
    let log: String = log.chars().filter(|letter| !letter.is_control()).collect();
    let mut text = loaded.text.clone();
    for finding in findings {
        let (Some(key), Some(value), Some([low, high])) = (&finding.key, finding.value, finding.interval) else {
            continue;
        };
        let remark = format!("identified from {log}: {} to {} (95 %)", number(low), number(high));
        text = joints::change_noting(&text, key, &format!("{value:.6e}"), &remark)
            .map_err(|refused| Failure::new(format!("{key}: {}", refused.message)).with_help(refused.help))?;
    }
    check::read_changed(format!("{} with what was found", loaded.name), text.clone(), &[])?;
    Ok(text)
}
