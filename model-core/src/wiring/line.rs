//! Recursive straight-line fits `y = slope x + step s + constant` by least squares, for two `y` and all their weighted
//! sums.

use super::thresholds::JUDGE;
use crate::numbers::Real;

/// Moments of the points (x, s, y1, y2) about their means.
#[derive(Debug, Clone, Copy, Default)]
pub struct Line<T: Real> {
    points: u16,
    mean: [T; 4],
    /// Covariances xx, xs, ss.
    moment: [T; 3],
    /// Covariances of x and s with y1 and y2.
    cross_moment: [[T; 2]; 2],
    /// Covariances y1 y1, y1 y2, y2 y2.
    response_moment: [T; 3],
}

/// Fitted line.
#[derive(Debug, Clone, Copy, Default)]
pub struct Fit<T: Real> {
    pub slope: T,
    /// Change of y per unit of s.
    pub step: T,
    /// Standard deviation of the slope.
    pub deviation: T,
    /// Standard deviation of the step.
    pub step_deviation: T,
}

impl<T: Real> Fit<T> {
    /// Sign of the slope; 0 for a slope that noise explains.
    pub fn sign(&self) -> i32 {
        match self.slope.abs() > T::FOUR * self.deviation {
            true if self.slope > T::ZERO => 1,
            true => -1,
            false => 0,
        }
    }
}

impl<T: Real> Line<T> {
    /// Adds a point.
    pub fn add(&mut self, x: T, s: T, y: [T; 2]) {
        self.points = self.points.saturating_add(1).min(JUDGE.fading_points);
        let weight = T::ONE / T::from_i32(self.points.into());
        let [mean_x, mean_s, mean_1, mean_2] = self.mean;
        let [y_1, y_2] = y;
        let (dx, ds, d1, d2) = (x - mean_x, s - mean_s, y_1 - mean_1, y_2 - mean_2);
        self.mean = [mean_x + weight * dx, mean_s + weight * ds, mean_1 + weight * d1, mean_2 + weight * d2];
        let kept_share = T::ONE - weight;
        let fold = |moment: &mut T, product: T| *moment = kept_share * (*moment + weight * product);
        let [with_x, with_s] = &mut self.cross_moment;
        let moments = self.moment.iter_mut().chain(with_x).chain(with_s).chain(&mut self.response_moment);
        let products = [dx * dx, dx * ds, ds * ds, dx * d1, dx * d2, ds * d1, ds * d2, d1 * d1, d1 * d2, d2 * d2];
        moments.zip(products).for_each(|(moment, product)| fold(moment, product));
    }

    /// Line of `y = weights . (y1, y2)`, if the points determine a line.
    pub fn fit(&self, weights: [T; 2]) -> Option<Fit<T>> {
        let [xx, xs, ss] = self.moment;
        let negligible = T::TWENTIETH * T::TWENTIETH;
        // A constant x varies by its rounding.
        let rounding = negligible * self.mean[0];
        if self.points < JUDGE.min_points || xx <= rounding * rounding {
            return None;
        }
        let [w1, w2] = weights;
        let [xy, sy] = self.cross_moment.map(|[with_1, with_2]| w1 * with_1 + w2 * with_2);
        let [of_1, of_both, of_2] = self.response_moment;
        let yy = w1 * w1 * of_1 + T::TWO * w1 * w2 * of_both + w2 * w2 * of_2;
        // Points of one direction, or with x proportional to the direction, do not determine the step.
        let remaining_spread = if ss > negligible { xx - (xs * xs) / ss } else { T::ZERO };
        let (slope, step, spread) = if remaining_spread > negligible * xx {
            let slope = (xy - (xs * sy) / ss) / remaining_spread;
            (slope, (sy - slope * xs) / ss, remaining_spread)
        } else {
            (xy / xx, T::ZERO, xx)
        };
        let residual = (yy - slope * xy - step * sy).abs();
        // Only half of the points count: neighbouring points share a block and its error.
        let count = T::HALF * T::from_i32(self.points.into());
        let deviation = (residual / (count * spread)).square_root();
        let step_deviation = if ss > negligible { (residual / (count * ss)).square_root() } else { T::ZERO };
        Some(Fit { slope, step, deviation, step_deviation })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Line through `points` points of y1 = 2 x + 3 s and y2 = -x.
    fn line(points: u16) -> Line<f32> {
        let mut line = Line::default();
        for point in 0..points {
            let (x, s) = (f32::from(point) - 10.0, if point % 2 == 0 { 1.0 } else { -1.0 });
            line.add(x, s, [2.0 * x + 3.0 * s, -x]);
        }
        line
    }

    #[test]
    fn slope_and_step_are_fitted() {
        let fit = line(40).fit([1.0, 0.0]).expect("enough points");
        assert!((fit.slope - 2.0).abs() < 1e-3 && (fit.step - 3.0).abs() < 1e-2, "{fit:?}");
        let fit = line(40).fit([0.0, 2.0]).expect("enough points");
        assert!((fit.slope + 2.0).abs() < 1e-3 && fit.sign() == -1, "{fit:?}");
    }

    #[test]
    fn few_points_give_no_line() {
        assert!(line(JUDGE.min_points - 1).fit([1.0, 0.0]).is_none());
        assert!(line(JUDGE.min_points).fit([1.0, 0.0]).is_some());
    }

    #[test]
    fn constant_x_gives_no_line() {
        let mut line = Line::<f32>::default();
        (0..40).for_each(|point| line.add(5.0, 1.0, [point as f32, 0.0]));
        assert!(line.fit([1.0, 0.0]).is_none());
    }

    #[test]
    fn sign_needs_four_deviations() {
        let fit = Fit { slope: 4.1_f32, step: 0.0, deviation: 1.0, step_deviation: 0.0 };
        assert_eq!((fit.sign(), Fit { slope: -4.1, ..fit }.sign()), (1, -1));
        assert_eq!((Fit { slope: 3.9, ..fit }.sign(), Fit { slope: f32::NAN, ..fit }.sign()), (0, 0));
    }
}
