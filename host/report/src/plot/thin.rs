//! Thinning of long series that keeps every extreme: first, least, greatest and last value in each column of the
//! picture. Values that are not finite interrupt the line.

/// Sections of finite points, thinned to at most four points in each column of the range.
pub fn thin(points: &[(f64, f64)], range: (f64, f64), columns: usize) -> Vec<Vec<(f64, f64)>> {
    let width = (range.1 - range.0) / columns.max(1) as f64;
    let column = |x: f64| ((x - range.0) / width).floor();
    points
        .split(|(x, y)| !x.is_finite() || !y.is_finite())
        .filter(|stretch| !stretch.is_empty())
        .map(|stretch| {
            let same_column = |a: &(f64, f64), b: &(f64, f64)| column(a.0) == column(b.0);
            stretch.chunk_by(same_column).flat_map(extremes).collect()
        })
        .collect()
}

/// First, least, greatest and last point in order, without repetition.
fn extremes(points: &[(f64, f64)]) -> Vec<(f64, f64)> {
    if points.len() <= 4 {
        return points.to_vec();
    }
    let by_value = |a: &&usize, b: &&usize| points[**a].1.total_cmp(&points[**b].1);
    let indices: Vec<usize> = (0..points.len()).collect();
    let mut kept = vec![0, points.len() - 1];
    kept.extend(indices.iter().min_by(by_value));
    kept.extend(indices.iter().max_by(by_value));
    kept.sort_unstable();
    kept.dedup();
    kept.into_iter().map(|index| points[index]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn single_spike_survives() {
        let mut points: Vec<(f64, f64)> = (0..100_000).map(|i| (f64::from(i), f64::from(i % 7))).collect();
        points[54_321].1 = 99.0;
        points[54_322].1 = -99.0;
        let thinned = thin(&points, (0.0, 100_000.0), 500);
        assert_eq!(thinned.len(), 1);
        assert!(thinned[0].len() <= 4 * 501, "{}", thinned[0].len());
        assert!(thinned[0].contains(&(54_321.0, 99.0)));
        assert!(thinned[0].contains(&(54_322.0, -99.0)));
        assert!(thinned[0].windows(2).all(|pair| pair[0].0 <= pair[1].0), "order is kept");
    }

    #[test]
    fn non_finite_value_breaks_line() {
        let points = [(0.0, 1.0), (1.0, f64::NAN), (2.0, 3.0), (3.0, f64::INFINITY), (4.0, 5.0)];
        assert_eq!(thin(&points, (0.0, 4.0), 100), [vec![(0.0, 1.0)], vec![(2.0, 3.0)], vec![(4.0, 5.0)]]);
    }

    #[test]
    fn empty_line_stays_empty() {
        assert!(thin(&[], (0.0, 1.0), 100).is_empty());
        assert!(thin(&[(0.0, f64::NAN)], (0.0, 1.0), 100).is_empty());
    }
}
