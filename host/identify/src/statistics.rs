//! Means, quantiles, range and Student's quantile.

/// Quantile of sorted values, interpolated between neighbours; NaN for an empty slice.
pub fn quantile(sorted: &[f64], share: f64) -> f64 {
    let Some(last) = sorted.len().checked_sub(1) else { return f64::NAN };
    let place = share * last as f64;
    let below = place.floor() as usize;
    let above = (below + 1).min(last);
    sorted[below] + (place - below as f64) * (sorted[above] - sorted[below])
}

/// Quantile of values in any order.
pub fn quantile_of(values: &[f64], share: f64) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    quantile(&sorted, share)
}

/// Arithmetic mean.
pub fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// Returns the largest value less the least one.
pub fn range_of(values: &[f64]) -> f64 {
    let (least, most) = values.iter().fold((f64::MAX, f64::MIN), |(a, b), &value| (a.min(value), b.max(value)));
    most - least
}

/// Root mean square.
pub fn rms(values: &[f64]) -> f64 {
    (values.iter().map(|value| value * value).sum::<f64>() / values.len() as f64).sqrt()
}

/// Student's 97.5 % quantile: tables for one to three degrees of freedom, interpolated linearly in the inverse; for
/// more degrees of freedom, the first terms of its expansion (Abramowitz and Stegun, 26.7.5).
pub fn student(freedom: f64) -> f64 {
    const QUANTILE_TABLE: [f64; 3] = [12.706, 4.303, 3.182];
    const NORMAL: f64 = 1.959_964;
    let inverse = 1.0 / freedom.max(1.0);
    match freedom {
        f if f < 2.0 => QUANTILE_TABLE[1] + (QUANTILE_TABLE[0] - QUANTILE_TABLE[1]) * (inverse - 0.5) / 0.5,
        f if f < 3.0 => QUANTILE_TABLE[2] + (QUANTILE_TABLE[1] - QUANTILE_TABLE[2]) * (inverse - 1.0 / 3.0) * 6.0,
        _ => {
            let z = NORMAL;
            let square = z * z;
            z + z * (square + 1.0) / 4.0 * inverse
                + z * (5.0 * square * square + 16.0 * square + 3.0) / 96.0 * inverse.powi(2)
                + z * (3.0 * square.powi(3) + 19.0 * square * square + 17.0 * square - 15.0) / 384.0 * inverse.powi(3)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Student's quantile agrees with published tables within 1 %.
    #[test]
    fn student_quantile_matches_tables() {
        for (freedom, quantile) in
            [(1.0, 12.706), (2.0, 4.303), (3.0, 3.182), (4.0, 2.776), (10.0, 2.228), (1e9, 1.960)]
        {
            assert!((student(freedom) / quantile - 1.0).abs() < 0.01, "{freedom}: {}", student(freedom));
        }
        assert!(student(1.5) > student(2.5) && student(2.5) > student(3.5));
    }

    /// A quantile is interpolated between neighbouring values.
    #[test]
    fn quantile_interpolates_neighbours() {
        assert_eq!(quantile(&[1.0, 2.0, 4.0], 0.75), 3.0);
        assert!(quantile(&[], 0.5).is_nan());
        assert_eq!(quantile_of(&[3.0, 1.0, 2.0], 0.5), 2.0);
    }
}
