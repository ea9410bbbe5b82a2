//! The figure that a threshold moves most, relative to its bound.

use report::checks::Bound;
use report::number::TERMINAL;
use scenario::record::AssertionRecord;

use crate::runs::{FILES, Figures, digest_of};

/// Change of one figure.
struct Change {
    text: String,
    /// Size of the change over the bound [-].
    size: f64,
}

/// Cell of the table: the figure that moved most, or that nothing moved.
pub fn cell(base: &Figures, changed: &Figures) -> String {
    if digest_of(base) == digest_of(changed) {
        return "moves nothing".to_owned();
    }
    let mut changes = Vec::new();
    for (name, (base, changed)) in FILES.iter().zip(base.iter().zip(changed)) {
        match (base, changed) {
            (Some(base), Some(changed)) => {
                let pairs = base.assertions.iter().zip(&changed.assertions);
                changes.extend(pairs.filter_map(|(base, changed)| change(name, base, changed)));
            }
            (Some(_), None) => return format!("{name}: refused before the run"),
            (None, _) => {}
        }
    }
    let largest = changes.into_iter().reduce(|a, b| if b.size > a.size { b } else { a });
    largest.map_or_else(|| "moves no figure with a bound".to_owned(), |change| change.text)
}

/// Change of a figure; `None` if the figure is the same.
fn change(file: &str, base: &AssertionRecord, changed: &AssertionRecord) -> Option<Change> {
    let name = format!("{file}: {}", base.name);
    let (sign, bound) = base.bound.sign_and_value()?;
    let (before, after) = match (base.figure, changed.figure) {
        (Some(before), Some(after)) if before == after => return None,
        (Some(before), Some(after)) => (before, after),
        (None, None) => return None,
        (Some(_), None) => return Some(Change { text: format!("{name} cannot be measured"), size: f64::INFINITY }),
        (None, Some(_)) => return Some(Change { text: format!("{name} can be measured"), size: f64::INFINITY }),
    };
    // A count bounded by zero has no scale but itself.
    let scale = if bound == 0.0 { 1.0 } else { bound.abs() };
    let worse = match base.bound {
        Bound::AtMost(_) => after > before,
        Bound::AtLeast(_) => after < before,
        Bound::Exactly(wanted) => (after - wanted).abs() > (before - wanted).abs(),
        Bound::None => return None,
    };
    let size = (after - before).abs() / scale;
    let direction = if worse { "worse" } else { "better" };
    let crossing = match (base.bound.holds(before), base.bound.holds(after)) {
        (true, false) => ", bound broken",
        (false, true) => ", bound kept",
        _ => "",
    };
    let number = |value: f64| TERMINAL.write(value);
    let text = format!(
        "{name} {} to {} ({sign} {}): {direction} by {:.1} % of the bound{crossing}",
        number(before),
        number(after),
        number(bound),
        100.0 * size
    );
    Some(Change { text, size })
}

#[cfg(test)]
mod tests {
    use super::*;
    use report::checks::Verdict;

    fn assertion(bound: Bound, figure: Option<f64>) -> AssertionRecord {
        AssertionRecord {
            name: "rms".into(),
            aggregate: "worst".into(),
            figure,
            unit: String::new(),
            bound,
            verdict: Verdict::Passed,
            seed: None,
            note: String::new(),
        }
    }

    #[test]
    fn change_is_relative_to_the_bound() {
        let of = |bound, before, after| {
            change("t2", &assertion(bound, before), &assertion(bound, after)).map(|change| change.text)
        };
        assert_eq!(of(Bound::AtMost(2.0), Some(1.0), Some(1.0)), None);
        assert_eq!(
            of(Bound::AtMost(2.0), Some(1.0), Some(2.5)).unwrap(),
            "t2: rms 1 to 2.500 (≤ 2): worse by 75.0 % of the bound, bound broken"
        );
        assert!(
            of(Bound::AtLeast(2.0), Some(1.0), Some(2.5))
                .unwrap()
                .ends_with("better by 75.0 % of the bound, bound kept")
        );
        assert!(of(Bound::AtMost(2.0), Some(1.0), None).unwrap().ends_with("cannot be measured"));
    }
}
