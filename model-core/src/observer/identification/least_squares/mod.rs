//! Recursive least squares for all parameters that contact shows: half-gap, offset, compliance, skew, transmission
//! error and, with `P` = [`MAPPED`](super::regressors::MAPPED), the error maps.
//!
//! ```text
//! (O12) v = d - h^T x,   var(v) = 1 + h^T P h,   x += P h v/var(v),   P -= P h h^T P/var(v)
//! ```
//!
//! Symbols: x = `values`, h = `regressors` (O11), v = `Innovation::value`, var(v) = `Innovation::variance`, both in
//! standard deviations of one deflection's noise; U^T h = `projected`. P = U D U^T (Bierman) is kept as `factors`, in
//! units of the initial standard deviations, so that P stays positive in single precision.

#[cfg(test)]
mod tests;

use super::thresholds::LEAST_SQUARES;
use core::array;

use super::regressors::{COMPLIANCE, HALF_GAP, MAP_PARAMETERS, OFFSET, PLAIN, Regressors, SKEW, TRANSMISSION_ERROR};
use crate::numbers::Real;
use crate::numbers::arithmetic::clamp;
use crate::numbers::state_words::state_words;
use crate::observer::tables::{LearnerTable, ObserverTables};

/// Parameters with their covariance.
#[derive(Debug, Clone, Copy)]
pub struct LeastSquares<T: Real, const P: usize> {
    /// U above the diagonal, D on the diagonal; the entries of a column are contiguous.
    factors: [[T; P]; P],
    /// Parameters [SI].
    pub values: [T; P],
}
state_words! { struct LeastSquares<T, P> { factors, values } }

/// Innovation of a deflection, in standard deviations of one deflection's noise.
#[derive(Debug, Clone, Copy)]
pub struct Innovation<T: Real, const P: usize> {
    /// Regressors in the factors' coordinates, U^T h.
    projected: [T; P],
    /// Measured less predicted deflection.
    pub value: T,
    /// Variance of `value`.
    pub variance: T,
}
state_words! { struct Innovation<T, P> { projected, value, variance } }

impl<T: Real, const P: usize> Innovation<T, P> {
    /// Returns true if the normalised innovation is within `deviations` standard deviations.
    pub fn is_within(&self, deviations: i32) -> bool {
        self.value * self.value < T::from_i32(deviations * deviations) * self.variance
    }
}

impl<T: Real, const P: usize> LeastSquares<T, P> {
    /// Least squares without their table. A constant: the compiler clears the destination instead of copying from the stack.
    pub const UNINITIALIZED: Self = Self { factors: [[T::ZERO; P]; P], values: [T::ZERO; P] };

    /// Resets parameters and covariance to the design.
    pub fn reset(&mut self, table: &LearnerTable<T>) {
        for (parameter, value) in self.values.iter_mut().enumerate() {
            *value = table.mean.get(parameter).copied().unwrap_or(T::ZERO);
        }
        self.reset_covariance();
    }

    /// Value of a parameter [SI].
    pub fn value(&self, parameter: usize) -> T {
        self.values.get(parameter).copied().unwrap_or(T::ZERO)
    }

    /// Deflection predicted from regressors [m].
    pub fn deflection(&self, regressors: &Regressors<T, P>) -> T {
        self.values.iter().zip(regressors).fold(T::ZERO, |sum, (value, regressor)| sum + *value * *regressor)
    }

    /// Variance of the predicted deflection by the parameters [m^2].
    pub fn variance(&self, table: &LearnerTable<T>, regressors: &Regressors<T, P>) -> T {
        let scaled = Self::scaled(table, regressors, T::ONE);
        let mut sum = T::ZERO;
        for j in 0..P {
            let (f, d) = self.column(&scaled, j);
            sum += d * f * f;
        }
        sum
    }

    /// Variance of a parameter [SI].
    pub fn variance_of(&self, table: &LearnerTable<T>, parameter: usize) -> T {
        let deviation = table.deviation.get(parameter).copied().unwrap_or(T::ZERO);
        self.relative_variance(parameter) * deviation * deviation
    }

    /// Variance of a parameter over its initial variance [-].
    pub fn relative_variance(&self, parameter: usize) -> T {
        let mut sum = T::ZERO;
        for j in parameter..P {
            let Some(column) = self.factors.get(j) else { break };
            let d = column.get(j).copied().unwrap_or(T::ZERO);
            let u = if j == parameter { T::ONE } else { column.get(parameter).copied().unwrap_or(T::ZERO) };
            sum += d * u * u;
        }
        sum
    }

    /// Standard deviation of the transmission error, and its reduction since the start [m].
    pub fn error_deviation(&self, table: &LearnerTable<T>) -> (T, T) {
        let [sine, cosine] =
            [TRANSMISSION_ERROR, TRANSMISSION_ERROR + 1].map(|parameter| self.variance_of(table, parameter));
        let before = [TRANSMISSION_ERROR, TRANSMISSION_ERROR + 1]
            .map(|parameter| table.deviation.get(parameter).copied().unwrap_or(T::ZERO));
        let before = (before[0] * before[0] + before[1] * before[1]).square_root();
        let now = (sine + cosine).square_root();
        (now, if now < before { before - now } else { T::ZERO })
    }

    /// Saved numbers: parameters, then each column of the factors down to its diagonal.
    pub fn saved_numbers(&self) -> impl Iterator<Item = T> {
        let columns = self.factors.iter().enumerate().flat_map(|(index, column)| column.iter().take(index + 1));
        self.values.iter().chain(columns).copied()
    }

    /// Restores the saved numbers.
    pub fn restore_numbers(&mut self, next: &mut impl FnMut() -> T) {
        self.values.iter_mut().for_each(|value| *value = next());
        for (index, column) in self.factors.iter_mut().enumerate() {
            column.iter_mut().take(index + 1).for_each(|factor| *factor = next());
        }
    }

    /// Returns true if a joint of this design can have the restored numbers: parameters within their limits, an offset
    /// within the ambiguity of whole turns, and a covariance no larger than the initial one.
    pub fn is_in_range(&self, tables: &ObserverTables<T>) -> bool {
        let table = &tables.learner;
        let turns = T::from_i64(tables.counts.modulus) * tables.counts.length;
        let parameters = self.values.iter().zip(&table.mean).zip(&table.deviation).enumerate();
        let values = parameters.map(|(index, ((value, mean), deviation))| {
            let max_distance =
                if index == OFFSET { turns } else { T::from_i32(LEAST_SQUARES.max_deviation) * *deviation };
            (*value - *mean).abs() <= max_distance
        });
        let factors = self.factors.iter().enumerate().map(|(index, column)| {
            let (above, rest) = column.split_at_checked(index).unwrap_or_default();
            let on = rest.first().copied().unwrap_or(T::ZERO);
            on >= T::ZERO
                && on <= T::ONE
                && above.iter().all(|factor| factor.abs() <= T::from_i32(LEAST_SQUARES.max_factor))
        });
        self.value(HALF_GAP) >= T::ZERO && values.chain(factors).all(|possible| possible)
    }

    /// Resets the variances of all parameters that depend on the encoders' zeros. Half-gap, compliance and skew keep
    /// the variances that they have with all other parameters unknown.
    #[cold]
    pub fn reset_position_variances(&mut self) {
        let kept = [HALF_GAP, COMPLIANCE, SKEW].map(|parameter| (parameter, self.relative_variance(parameter)));
        self.reset_covariance();
        for (parameter, variance) in kept {
            self.set_relative_variance(parameter, if variance < T::ONE { variance } else { T::ONE });
        }
    }

    /// Innovation of a deflection [m] whose noise has the standard deviation 1/`weight` [m].
    pub fn innovation(
        &self,
        table: &LearnerTable<T>,
        regressors: &Regressors<T, P>,
        deflection: T,
        weight: T,
    ) -> Innovation<T, P> {
        let scaled = Self::scaled(table, regressors, weight);
        let mut innovation = Innovation { projected: [T::ZERO; P], value: T::ZERO, variance: T::ONE };
        innovation.value = (deflection - self.deflection(regressors)) * weight;
        for (j, projected) in innovation.projected.iter_mut().enumerate() {
            let (f, d) = self.column(&scaled, j);
            *projected = f;
            innovation.variance += d * f * f;
        }
        innovation
    }

    /// Updates parameters and covariance with an innovation (O12).
    pub fn update(&mut self, table: &LearnerTable<T>, innovation: &Innovation<T, P>) {
        let mut gain = [T::ZERO; P];
        let mut alpha = T::ONE;
        for (j, (column, f)) in self.factors.iter_mut().zip(&innovation.projected).enumerate() {
            let d = column.get(j).copied().unwrap_or(T::ZERO);
            let v = d * *f;
            let before = alpha;
            alpha += *f * v;
            let rise = -(*f / before);
            for (entry, carried) in column.iter_mut().zip(gain.iter_mut()).take(j) {
                let u = *entry;
                *entry = u + rise * *carried;
                *carried += v * u;
            }
            if let (Some(d), Some(g)) = (column.get_mut(j), gain.get_mut(j)) {
                *d *= before / alpha;
                *g = v;
            }
        }
        let step = innovation.value / alpha;
        for (index, ((value, gain), deviation)) in self.values.iter_mut().zip(&gain).zip(&table.deviation).enumerate() {
            *value += *deviation * (*gain * step);
            if index != OFFSET {
                let mean = table.mean.get(index).copied().unwrap_or(T::ZERO);
                let max_distance = T::from_i32(LEAST_SQUARES.max_deviation) * *deviation;
                *value = clamp(*value, mean - max_distance, mean + max_distance);
            }
        }
        self.limit_half_gap();
    }

    /// Keeps the half-gap non-negative, whatever a failing encoder shows: teeth do not overlap.
    fn limit_half_gap(&mut self) {
        if let Some(half_gap) = self.values.get_mut(HALF_GAP)
            && *half_gap < T::ZERO
        {
            *half_gap = T::ZERO;
        }
    }

    /// Increases the variances by the share `by`, up to the initial variances.
    pub fn inflate(&mut self, by: T) {
        for (index, column) in self.factors.iter_mut().enumerate() {
            if let Some(d) = column.get_mut(index) {
                *d += *d * by;
                if *d > T::ONE {
                    *d = T::ONE;
                }
            }
        }
    }

    /// Keeps the parameters and adds the variance (`by` times half-gap)^2 to the half-gap, up to the initial variance.
    pub fn inflate_half_gap(&mut self, table: &LearnerTable<T>, by: T) {
        let [half_gap, deviation] = [self.value(HALF_GAP), table.deviation[HALF_GAP]];
        if let Some(width) = self.factors.first_mut().and_then(|column| column.first_mut()) {
            // A joint designed without a gap has a deviation of zero.
            let grown = if by * half_gap < deviation {
                *width + (by * by * half_gap * half_gap) / (deviation * deviation)
            } else {
                T::ONE
            };
            *width = if grown < T::ONE { grown } else { T::ONE };
        }
    }

    /// Keeps the parameters and resets the variance of the half-gap alone: its entry on the diagonal belongs to no
    /// other parameter, as the half-gap is the first.
    pub fn reset_half_gap_variance(&mut self) {
        if let Some(width) = self.factors.first_mut().and_then(|column| column.first_mut()) {
            *width = T::ONE;
        }
    }

    /// Resets the variances of offset and motor map after a slip of the motor encoder; teeth and shafts are unchanged.
    pub fn reset_motor_variances(&mut self) {
        let [width, offset, rest @ ..] = self.factors.as_mut_slice() else { return };
        // The half-gap keeps its total variance, including the part correlated with the offset; the new offset is
        // correlated with no parameter.
        let ([half_gap, ..], [correlation, offset_variance, ..]) = (width.as_mut_slice(), offset.as_mut_slice()) else {
            return;
        };
        *half_gap += *offset_variance * *correlation * *correlation;
        (*correlation, *offset_variance) = (T::ZERO, T::ONE);
        for (column, factors) in rest.iter_mut().enumerate() {
            let index = column + OFFSET + 1;
            if let Some(of_offset) = factors.get_mut(OFFSET) {
                *of_offset = T::ZERO;
            }
            if (PLAIN..PLAIN + MAP_PARAMETERS).contains(&index)
                && let Some(d) = factors.get_mut(index)
            {
                *d = T::ONE;
            }
        }
    }

    /// Keeps the parameters and resets the covariance.
    pub fn reset_covariance(&mut self) {
        for (index, column) in self.factors.iter_mut().enumerate() {
            *column = [T::ZERO; P];
            if let Some(d) = column.get_mut(index) {
                *d = T::ONE;
            }
        }
    }

    /// Sets the relative variance of a parameter without correlations.
    pub fn set_relative_variance(&mut self, parameter: usize, variance: T) {
        if let Some(d) = self.factors.get_mut(parameter).and_then(|column| column.get_mut(parameter)) {
            *d = variance;
        }
    }

    /// f_j = (U^T h)_j and d_j.
    fn column(&self, scaled: &[T; P], j: usize) -> (T, T) {
        let Some(column) = self.factors.get(j) else { return (T::ZERO, T::ZERO) };
        let mut f = scaled.get(j).copied().unwrap_or(T::ZERO);
        for (u, h) in column.iter().zip(scaled).take(j) {
            f += *u * *h;
        }
        (f, column.get(j).copied().unwrap_or(T::ZERO))
    }

    fn scaled(table: &LearnerTable<T>, regressors: &Regressors<T, P>, weight: T) -> [T; P] {
        array::from_fn(|i| match (regressors.get(i), table.deviation.get(i)) {
            (Some(regressor), Some(deviation)) => *regressor * *deviation * weight,
            _ => T::ZERO,
        })
    }
}
