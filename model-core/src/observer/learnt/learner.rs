//! One small recursive least squares for everything about joint and encoders that contact shows: half-gap, offset,
//! compliance, skew, transmission error and, with `P` = [`MAPPED`](super::regressors::MAPPED), the error maps.
//!
//! Deflection = side * half-gap + offset + compliance * force + skew * speed + maps. The covariance is kept in units of the
//! parameters' standard deviations beforehand and as U D U^T (Bierman), so that it stays positive in single precision
//! whatever happens.

#[cfg(test)]
mod tests;

use core::array;

use super::regressors::{COMPLIANCE, ERROR, HALF_GAP, MAP, OFFSET, PLAIN, Regressors, SKEW};
use crate::numbers::Real;
use crate::numbers::arithmetic::clamp;
use crate::observer::tables::{LearnerTable, ObserverTables};

/// Standard deviations beforehand beyond which nothing is believed of a parameter, whatever a failing encoder shows: four
/// times what a joint that fits its file can reach. An offset may be any.
const FURTHEST: i32 = 16;

/// The most that a factor above the diagonal can be, in which parameters stand in units of their standard deviations
/// beforehand: by how much more one parameter moves than another that it is told apart from.
const LARGEST_FACTOR: i32 = 1000;

/// Parameters with their covariance.
#[derive(Debug, Clone, Copy)]
pub struct Learner<T: Real, const P: usize> {
    /// U above the diagonal, D on it; the row of a column's entries is contiguous.
    factors: [[T; P]; P],
    /// Parameters, in SI.
    pub values: [T; P],
}

/// What a deflection is beyond the predicted one, in standard deviations of one deflection's noise.
#[derive(Debug, Clone, Copy)]
pub struct Innovation<T: Real, const P: usize> {
    /// Regressors in the factors' coordinates, U^T h.
    projected: [T; P],
    /// Measured less predicted deflection.
    pub value: T,
    /// Variance of that.
    pub variance: T,
}

impl<T: Real, const P: usize> Innovation<T, P> {
    /// Whether the deflection belongs to what was learnt: its normalised innovation is within so many standard deviations.
    pub fn is_within(&self, deviations: i32) -> bool {
        self.value * self.value < T::from_i32(deviations * deviations) * self.variance
    }
}

impl<T: Real, const P: usize> Learner<T, P> {
    /// A constant, so that the compiler clears its place instead of copying one from the stack.
    const UNBEGUN: Self = Self { factors: [[T::ZERO; P]; P], values: [T::ZERO; P] };

    /// A learner that has not taken its table yet.
    #[inline(always)]
    pub fn unbegun() -> Self {
        Self::UNBEGUN
    }

    /// Back to what was designed.
    pub fn restart(&mut self, table: &LearnerTable<T>) {
        for (parameter, value) in self.values.iter_mut().enumerate() {
            *value = table.mean.get(parameter).copied().unwrap_or(T::ZERO);
        }
        self.reopen();
    }

    /// A parameter, in SI.
    pub fn value(&self, parameter: usize) -> T {
        self.values.get(parameter).copied().unwrap_or(T::ZERO)
    }

    /// Deflection that a set of regressors has [m].
    pub fn deflection(&self, regressors: &Regressors<T, P>) -> T {
        self.values.iter().zip(regressors).fold(T::ZERO, |sum, (value, regressor)| sum + *value * *regressor)
    }

    /// Variance of that deflection as far as the parameters are uncertain [m^2].
    pub fn variance(&self, table: &LearnerTable<T>, regressors: &Regressors<T, P>) -> T {
        let scaled = Self::scaled(table, regressors, T::ONE);
        let mut sum = T::ZERO;
        for j in 0..P {
            let (f, d) = self.column(&scaled, j);
            sum += d * f * f;
        }
        sum
    }

    /// Variance of one parameter, in SI.
    pub fn variance_of(&self, table: &LearnerTable<T>, parameter: usize) -> T {
        let deviation = table.deviation.get(parameter).copied().unwrap_or(T::ZERO);
        self.relative_variance(parameter) * deviation * deviation
    }

    /// Variance of one parameter over that beforehand [-].
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

    /// Standard deviation that the transmission error has, and by how much less that is than beforehand [m].
    pub fn error_deviation(&self, table: &LearnerTable<T>) -> (T, T) {
        let [sine, cosine] = [ERROR, ERROR + 1].map(|parameter| self.variance_of(table, parameter));
        let before = [ERROR, ERROR + 1].map(|parameter| table.deviation.get(parameter).copied().unwrap_or(T::ZERO));
        let before = (before[0] * before[0] + before[1] * before[1]).square_root();
        let now = (sine + cosine).square_root();
        (now, if now < before { before - now } else { T::ZERO })
    }

    /// Everything that is learnt: parameters, then each column of the factors down to its diagonal.
    pub fn numbers(&self) -> impl Iterator<Item = T> {
        let columns = self.factors.iter().enumerate().flat_map(|(index, column)| column.iter().take(index + 1));
        self.values.iter().chain(columns).copied()
    }

    /// Takes the same back.
    pub fn set_numbers(&mut self, next: &mut impl FnMut() -> T) {
        self.values.iter_mut().for_each(|value| *value = next());
        for (index, column) in self.factors.iter_mut().enumerate() {
            column.iter_mut().take(index + 1).for_each(|factor| *factor = next());
        }
    }

    /// Whether all of it is what a joint of this design can show: parameters as far from their mean as learning goes, an
    /// offset within what whole turns leave open, factors of a covariance that is no larger than beforehand.
    pub fn is_possible(&self, tables: &ObserverTables<T>) -> bool {
        let table = &tables.learner;
        let turns = T::from_i64(tables.counts.modulus) * tables.counts.length;
        let parameters = self.values.iter().zip(&table.mean).zip(&table.deviation).enumerate();
        let values = parameters.map(|(index, ((value, mean), deviation))| {
            let most = if index == OFFSET { turns } else { T::from_i32(FURTHEST) * *deviation };
            (*value - *mean).abs() <= most
        });
        let factors = self.factors.iter().enumerate().map(|(index, column)| {
            let (above, rest) = column.split_at_checked(index).unwrap_or_default();
            let on = rest.first().copied().unwrap_or(T::ZERO);
            on >= T::ZERO && on <= T::ONE && above.iter().all(|factor| factor.abs() <= T::from_i32(LARGEST_FACTOR))
        });
        self.value(HALF_GAP) >= T::ZERO && values.chain(factors).all(|possible| possible)
    }

    /// Forgets how sure everything is that depends on where the encoders' zeros are. Half-gap, compliance and skew keep the variances
    /// that they have with everything else unknown.
    #[cold]
    pub fn forget_places(&mut self) {
        let kept = [HALF_GAP, COMPLIANCE, SKEW].map(|parameter| (parameter, self.relative_variance(parameter)));
        self.reopen();
        for (parameter, variance) in kept {
            self.set_relative_variance(parameter, if variance < T::ONE { variance } else { T::ONE });
        }
    }

    /// The innovation of a deflection [m] whose noise has a standard deviation of 1 over `weight` [1/m].
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

    /// Learns from an innovation.
    pub fn learn(&mut self, table: &LearnerTable<T>, innovation: &Innovation<T, P>) {
        let mut gain = [T::ZERO; P];
        let mut alpha = T::ONE;
        for (j, (column, f)) in self.factors.iter_mut().zip(&innovation.projected).enumerate() {
            let d = column.get(j).copied().unwrap_or(T::ZERO);
            let v = d * *f;
            let before = alpha;
            alpha += *f * v;
            let rise = -f.over(before);
            for (entry, carried) in column.iter_mut().zip(gain.iter_mut()).take(j) {
                let u = *entry;
                *entry = u + rise * *carried;
                *carried += v * u;
            }
            if let (Some(d), Some(g)) = (column.get_mut(j), gain.get_mut(j)) {
                *d *= before.over(alpha);
                *g = v;
            }
        }
        let step = innovation.value.over(alpha);
        for (index, ((value, gain), deviation)) in self.values.iter_mut().zip(&gain).zip(&table.deviation).enumerate() {
            *value += *deviation * (*gain * step);
            if index != OFFSET {
                let mean = table.mean.get(index).copied().unwrap_or(T::ZERO);
                let most = T::from_i32(FURTHEST) * *deviation;
                *value = clamp(*value, mean - most, mean + most);
            }
        }
        self.keep_half_gap();
    }

    /// Teeth do not overlap, whatever a failing encoder shows.
    fn keep_half_gap(&mut self) {
        if let Some(half_gap) = self.values.get_mut(HALF_GAP)
            && *half_gap < T::ZERO
        {
            *half_gap = T::ZERO;
        }
    }

    /// Lets what was learnt grow uncertain, up to what was known beforehand.
    pub fn forget(&mut self, by: T) {
        for (index, column) in self.factors.iter_mut().enumerate() {
            if let Some(d) = column.get_mut(index) {
                *d += *d * by;
                if *d > T::ONE {
                    *d = T::ONE;
                }
            }
        }
    }

    /// Keeps the parameters and adds a variance to the half-gap: the square of a part of it [-], up to what was known beforehand.
    pub fn loosen_half_gap(&mut self, table: &LearnerTable<T>, by: T) {
        let [half_gap, deviation] = [self.value(HALF_GAP), table.deviation[HALF_GAP]];
        if let Some(width) = self.factors.first_mut().and_then(|column| column.first_mut()) {
            // A joint that is designed without a gap has no deviation to divide by.
            let grown = if by * half_gap < deviation {
                *width + (by * by * half_gap * half_gap).over(deviation * deviation)
            } else {
                T::ONE
            };
            *width = if grown < T::ONE { grown } else { T::ONE };
        }
    }

    /// Keeps the parameters and forgets how sure the half-gap is, and nothing else: it is the first of them, so its
    /// entry on the diagonal is its own.
    pub fn doubt_half_gap(&mut self) {
        if let Some(width) = self.factors.first_mut().and_then(|column| column.first_mut()) {
            *width = T::ONE;
        }
    }

    /// Forgets how sure offset and the motor's error map are: its encoder has slipped, teeth and shafts are as they were.
    pub fn doubt_motor(&mut self) {
        let [width, offset, rest @ ..] = self.factors.as_mut_slice() else { return };
        // What the half-gap owes to the offset becomes its own uncertainty; nothing is related to the new offset.
        let ([half_gap, ..], [owed, known, ..]) = (width.as_mut_slice(), offset.as_mut_slice()) else { return };
        *half_gap += *known * *owed * *owed;
        (*owed, *known) = (T::ZERO, T::ONE);
        for (column, factors) in rest.iter_mut().enumerate() {
            let index = column + OFFSET + 1;
            if let Some(of_offset) = factors.get_mut(OFFSET) {
                *of_offset = T::ZERO;
            }
            if (PLAIN..PLAIN + MAP).contains(&index)
                && let Some(d) = factors.get_mut(index)
            {
                *d = T::ONE;
            }
        }
    }

    /// Keeps the parameters and forgets how sure they are.
    pub fn reopen(&mut self) {
        for (index, column) in self.factors.iter_mut().enumerate() {
            *column = [T::ZERO; P];
            if let Some(d) = column.get_mut(index) {
                *d = T::ONE;
            }
        }
    }

    /// Sets how sure a parameter is that depends on no other.
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
