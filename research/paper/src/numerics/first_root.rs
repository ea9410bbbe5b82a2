//! First time at which a polynomial becomes negative.

/// Number of intervals that are examined one by one. Within one interval a guard has at most one extremum: a step is at most about one
/// radian of the fastest motion.
const PARTS: usize = 4;

/// Start values below this are zero: the guard's own event has just been passed.
const ZERO: f64 = 1e-10;

/// First `s` in [0, length] at which `coefficients` (lowest first) turns negative, if any.
pub(super) fn first_fall(coefficients: &[f64], length: f64) -> Option<f64> {
    let start = coefficients[0];
    if start.abs() < ZERO {
        // Dividing by the root at the start avoids finding it again.
        let rest = &coefficients[1..];
        return if rest[0] < 0.0 { Some(0.0) } else { search(rest, length) };
    }
    if start < 0.0 {
        return Some(0.0);
    }
    let farthest = coefficients[1..].iter().rev().fold(0.0, |sum, c| (sum + c.abs()) * length);
    if farthest < start { None } else { search(coefficients, length) }
}

/// First time at which a polynomial with a start value of zero or above turns negative, if any.
fn search(coefficients: &[f64], length: f64) -> Option<f64> {
    let (mut left, mut left_slope) = (0.0, slope(coefficients, 0.0));
    for part in 1..=PARTS {
        let right = length * part as f64 / PARTS as f64;
        if value(coefficients, right) < 0.0 {
            return Some(root(coefficients, left, right));
        }
        let right_slope = slope(coefficients, right);
        if left_slope < 0.0 && right_slope > 0.0 {
            let lowest = minimum(coefficients, left, right);
            if value(coefficients, lowest) < 0.0 {
                return Some(root(coefficients, left, lowest));
            }
        }
        (left, left_slope) = (right, right_slope);
    }
    None
}

/// Newton's method kept inside its bracket: not negative at `left`, negative at `right`.
fn root(coefficients: &[f64], mut left: f64, mut right: f64) -> f64 {
    let mut at = 0.5 * (left + right);
    for round in 0..60 {
        let here = value(coefficients, at);
        if here < 0.0 {
            right = at;
        } else {
            left = at;
        }
        let newton = at - here / slope(coefficients, at);
        // At a graze Newton's method can converge slowly from one side: every fourth iteration halves the bracket.
        let inside = newton > left && newton < right && round % 4 != 3;
        let next = if inside { newton } else { 0.5 * (left + right) };
        if (next - at).abs() <= 1e-15 * right {
            return next;
        }
        at = next;
    }
    at
}

/// Zero of the slope between a falling and a rising end.
fn minimum(coefficients: &[f64], mut left: f64, mut right: f64) -> f64 {
    for _ in 0..40 {
        let middle = 0.5 * (left + right);
        if slope(coefficients, middle) < 0.0 {
            left = middle;
        } else {
            right = middle;
        }
    }
    0.5 * (left + right)
}

fn value(coefficients: &[f64], at: f64) -> f64 {
    coefficients.iter().rev().fold(0.0, |sum, c| sum * at + c)
}

fn slope(coefficients: &[f64], at: f64) -> f64 {
    coefficients.iter().enumerate().skip(1).rev().fold(0.0, |sum, (power, c)| sum * at + power as f64 * c)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The first of two falls is found.
    #[test]
    fn first_of_two_falls_is_found() {
        // -(s - 0.2)(s - 0.5)(s - 0.9) falls at 0.2 and at 0.9.
        let found = first_fall(&[0.09, -0.73, 1.6, -1.0], 1.0).expect("it falls");
        assert!((found - 0.2).abs() < 1e-14, "{found}");
    }

    /// A dip between two positive ends is found.
    #[test]
    fn dip_between_positive_ends_is_found() {
        // (s - 0.4)(s - 0.41) is negative over a hundredth of the interval.
        let found = first_fall(&[0.164, -0.81, 1.0], 1.0).expect("it falls");
        assert!((found - 0.4).abs() < 1e-13, "{found}");
    }

    /// A root at the start is not found again.
    #[test]
    fn root_at_the_start_is_not_repeated() {
        assert_eq!(first_fall(&[0.0, 1.0, 1.0], 1.0), None);
        assert_eq!(first_fall(&[-1e-16, 1.0], 1.0), None);
        let found = first_fall(&[1e-16, 1.0, -2.0], 1.0).expect("it falls after half a unit");
        assert!((found - 0.5).abs() < 1e-14, "{found}");
    }

    /// A polynomial that falls at the start falls at zero.
    #[test]
    fn immediate_fall_is_at_zero() {
        assert_eq!(first_fall(&[1e-17, -1.0, 5.0], 1.0), Some(0.0));
    }

    /// A graze from above is not a fall.
    #[test]
    fn graze_from_above_is_no_fall() {
        assert_eq!(first_fall(&[0.25 + 1e-9, -1.0, 1.0], 1.0), None);
    }
}
