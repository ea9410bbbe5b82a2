//! Findings as lines for the terminal. Pictures are the page's.

use std::fmt::Write as _;

use super::findings::Finding;

/// Findings with their intervals beside what the joint file said.
pub fn render(findings: &[Finding], stated: impl Fn(&Finding) -> Option<String>) -> String {
    let wide = findings.iter().map(|finding| finding.name.len()).max().unwrap_or_default();
    let mut text = format!("{:wide$}  {:>12}  {:^27}  {:10}  joint file\n", "", "found", "95 % interval", "unit");
    for finding in findings {
        let name = &finding.name;
        // Writing to a string cannot fail.
        let _ = match (finding.value, finding.interval) {
            (Some(value), Some([low, high])) => {
                let interval = format!("{} .. {}", number(low), number(high));
                let stated = stated(finding).unwrap_or_else(|| "-".to_owned());
                let note = if finding.note.is_empty() { String::new() } else { format!("  ({})", finding.note) };
                writeln!(
                    text,
                    "{name:wide$}  {:>12}  {interval:^27}  {:10}  {stated}{note}",
                    number(value),
                    finding.unit
                )
            }
            _ => writeln!(text, "{name:wide$}  {}", finding.note),
        };
    }
    text
}

/// What a joint file says for a finding, as this table writes numbers.
pub fn stated(text: &str, finding: &Finding) -> Option<String> {
    let value = joint_file::value(text, finding.key.as_deref()?).ok()??;
    Some(value.replace('_', "").parse().map_or_else(|_| value.to_owned(), number))
}

/// Four digits, in whichever form is short.
pub fn number(value: f64) -> String {
    let size = value.abs();
    if size == 0.0 {
        "0".to_owned()
    } else if (1e-3..1e5).contains(&size) {
        let digits = (3 - size.log10().floor() as i32).clamp(0, 6) as usize;
        format!("{value:.digits$}")
    } else {
        format!("{value:.3e}")
    }
}
