//! Classes expected of the attractors (`--expect 1,1,3,chaos`), and the error for an attractor of another class.

use super::pictures::micrometres;
use super::record::AttractorRecord;
use crate::numerics::attractor::Class;
use report::failure::{Failure, Outcome};

/// Reads one expectation for each half-backlash.
pub fn list(text: &str, count: usize) -> Outcome<Vec<Class>> {
    let failed = |what: String| {
        let help = "write a period or the word chaos for each half-backlash, such as --expect 1,1,3,chaos";
        Failure::new(format!("--expect {text}: {what}")).with_help(help)
    };
    let one = |part: &str| match (part.trim(), part.trim().parse::<usize>()) {
        ("chaos", _) => Ok(Class::Chaotic),
        (_, Ok(period)) if period > 0 => Ok(Class::Periodic(period)),
        (other, _) => Err(failed(format!("`{other}` is neither a period nor `chaos`"))),
    };
    let expected: Vec<Class> = text.split(',').map(one).collect::<Outcome<_>>()?;
    if expected.len() != count {
        return Err(failed(format!("{} classes for {count} half-backlashes", expected.len())));
    }
    Ok(expected)
}

/// Fails at the first attractor of a joint that differs from the expectation.
pub fn judge(joint: &str, expected: &[Class], attractors: &[AttractorRecord]) -> Outcome<()> {
    let Some((asked, found)) = expected.iter().zip(attractors).find(|(asked, found)| **asked != found.class) else {
        return Ok(());
    };
    let message = format!(
        "{joint}: at b = {} um {asked} was asked for, and the motion from rest settles on {} \
         (largest Lyapunov exponent {:+.4} per tau)",
        micrometres(found.half_backlash_m),
        found.class,
        found.exponent_by_tangent_vector
    );
    let help =
        "the bifurcation diagram shows which half-backlashes have which class; the report is written all the same";
    Err(Failure::new(message).with_help(help))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The list must have one class for each half-backlash.
    #[test]
    fn expectations_match_half_backlashes() {
        let read = list("1,1,3,chaos", 4).expect("four classes");
        assert_eq!(read, [Class::Periodic(1), Class::Periodic(1), Class::Periodic(3), Class::Chaotic]);
        for (text, count) in [("1,1,3,chaos", 3), ("0", 1), ("order", 1), ("", 1), ("-1", 1)] {
            assert!(list(text, count).expect_err(text).help().is_some());
        }
    }
}
