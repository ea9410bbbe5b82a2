//! Variances of all estimates and the thresholds that follow from them, updated in parts, one per interval, so that no
//! period has to do all the work.
//!
//! ```text
//! (O13) r' = max(1, r (1 + (v^2/var(v) - 1)/40))
//! (O18) open:      var(X) = h^T P h + κ^2 (var(bias + friction dir) + ripple^2/2) + noise + (T rate)^2
//! (O19) touching:  var(X) = h^T P h + κ^2 (dir^2 var(friction) + ripple^2)/2 + noise
//! ```
//!
//! Symbols: r = `dwell_deviation`, v = `innovation`, var(X) = `gap_variance` (touching, open), κ^2 terms =
//! `wind_up_variance` (open, touching), noise = `deflection_variance` of the contact table. `outputs` adds (T rate)^2.

use super::bias::TorqueBias;
use super::least_squares::LeastSquares;
use super::regressors::{self, COMPLIANCE, ContactSample, HALF_GAP, OFFSET, Regressors, SKEW, TRANSMISSION_ERROR};
use super::thresholds::UncertaintyThresholds;
use crate::gears::Flank;
use crate::numbers::Real;
use crate::numbers::state_words::state_words;
use crate::observer::tables::ObserverTables;

/// Parts of an update.
const PARTS: u8 = 4;

/// Variances and thresholds that hold from the end of an interval until the next.
#[derive(Debug, Clone, Copy, Default)]
pub struct Uncertainty<T: Real> {
    /// Standard deviation of the mesh force from the motor side [N].
    pub force_deviation: T,
    /// Standard deviation of the mesh force averaged over an interval [N].
    pub mean_force_deviation: T,
    /// Standard deviation of the mesh force averaged over the few intervals in which contact settles [N].
    pub steady_force_deviation: T,
    /// Standard deviation of the mesh force from motor side and deflection [N].
    pub combined_deviation: T,
    /// Variance of the deflection less offset, skew and maps [m^2].
    pub deflection_variance: T,
    /// Standard deviation of the deflection less the nearer edge [m].
    pub edge_deviation: T,
    /// Variance by the errors of force that no mean removes, as wind-up, from bias, friction and ripple: of the
    /// deflection, and of a flank, whose distance from the other flank is free of bias [m^2].
    pub wind_up_variance: [T; 2],
    /// Variances of half-gap [m^2], offset [m^2], compliance [m^2/N^2] and skew [m^2 s^2].
    pub variances: [T; 4],
    /// Two standard deviations of a deflection's distance from an edge [m].
    pub blur: T,
    /// Distance from an edge within which teeth that come across the gap count as touching [m].
    pub near: T,
    /// Weight of the deflection against the motor side in the mesh force [-].
    pub position_weight: T,
    /// True if positions decide about contact that updates the parameters.
    pub half_gap_is_known: bool,
    /// True if positions decide about reported contact.
    pub half_gap_is_usable: bool,
    /// 1 over the compliance [N/m].
    pub stiffness: T,
    /// Share of the meshes in the compliance [-].
    pub mesh_share: T,
    /// Two standard deviations of the compliance [m/N].
    pub compliance_uncertainty: T,
    /// Guess of the half-gap plus three standard deviations; zero once the half-gap has been trusted on both flanks
    /// [m]. A half-gap estimated on one flank, or with counts wider than the gap, may be wrong in spite of a small
    /// variance.
    pub guessed_half_gap: T,
    /// Largest distance of the deflection from the middle of the gap without wind-up [m].
    pub reach: T,
    /// Variance of the gap coordinate while teeth touch (O19), and in the open gap (O18) [m^2].
    pub gap_variance: [T; 2],
    /// Largest variance of a valid gap coordinate; zero without a half-gap, and in a gap narrower than a count [m^2].
    pub widest_variance: T,
    /// True if the transmission error shifts a flank over the middle of the gap.
    pub flanks_swap: bool,
    /// True if the last interval was in settled contact.
    pub settled: bool,
    /// Standard deviation of a dwell's noise over the standard deviation of the encoders' noise, at least 1 (O13) [-].
    /// Effects outside the model count as noise.
    pub dwell_deviation: T,
    /// Mean normalised innovation of dwells, positive if the dwells show a wider gap [-].
    half_gap_error: T,
    /// Part that is updated next.
    next_part: u8,
}
state_words! {
    struct Uncertainty<T> {
        force_deviation, mean_force_deviation, steady_force_deviation, combined_deviation, deflection_variance,
        edge_deviation, wind_up_variance, variances, blur, near, position_weight, half_gap_is_known,
        half_gap_is_usable, stiffness, mesh_share, compliance_uncertainty, guessed_half_gap, reach, gap_variance,
        widest_variance, flanks_swap, settled, dwell_deviation, half_gap_error, next_part,
    }
}

impl<T: Real> Uncertainty<T> {
    const LIMITS: UncertaintyThresholds<T> = UncertaintyThresholds::TUNED;

    /// Returns an uncertainty without its tables.
    #[inline(always)]
    pub fn uninitialized() -> Self {
        Self { dwell_deviation: T::ONE, ..Self::default() }
    }

    /// Resets to the state before any estimation.
    pub fn reset<const P: usize>(&mut self, tables: &ObserverTables<T>, least_squares: &LeastSquares<T, P>) {
        *self = Self::uninitialized();
        let open_gap = regressors::open_gap(T::ZERO, 0, Some(0));
        let contact = ContactSample { flank: Some(Flank::Drive), ..ContactSample::OPEN };
        self.update_force_variances(
            tables,
            &TorqueBias::new(&tables.contact),
            least_squares.value(COMPLIANCE),
            T::ZERO,
        );
        for _ in 0..PARTS {
            self.update_next_part(tables, least_squares, &open_gap, &contact);
        }
        self.update_limits(tables, least_squares, false);
    }

    /// Updates the variances of the mesh force from the motor side.
    pub fn update_force_variances(
        &mut self,
        tables: &ObserverTables<T>,
        bias: &TorqueBias<T>,
        compliance: T,
        direction: T,
    ) {
        let contact = &tables.contact;
        let known = bias.variance_at(direction) + contact.ripple_variance;
        let ripple = T::HALF * contact.ripple_variance;
        let [_, friction, _] = bias.variance;
        // Variance of the force that no mean removes, with and without bias.
        let lasting = [bias.variance_at(direction) + ripple, direction * direction * friction * T::HALF + ripple];
        self.wind_up_variance = lasting.map(|force| force * compliance * compliance);
        self.force_deviation = (known + contact.force_variance).square_root();
        let noise = contact.force_variance * tables.learner.per_periods * Self::LIMITS.steady_noise;
        self.steady_force_deviation = (known + noise).square_root();
        self.mean_force_deviation = (known + contact.force_variance * tables.learner.per_periods).square_root();
    }

    /// Updates the noise of dwells and the error of the half-gap with an accepted dwell on a flank: its innovation v
    /// and the variance of v.
    ///
    /// With n = v^2 / variance, the standard deviation r of a dwell's noise follows r' = max(1, r (1 + share (n - 1) /
    /// 2)) (O13), so that n is 1 in the mean (covariance matching: R. K. Mehra, *On the identification of variances and
    /// adaptive Kalman filtering*, IEEE Transactions on Automatic Control 15(2), 1970). Outliers leave r unchanged: the
    /// joint has changed, or its encoder fails.
    pub fn adapt_dwell_noise(&mut self, innovation: T, variance: T, flank: Flank) {
        let square = (innovation * innovation) / variance;
        let grown = self.dwell_deviation * (T::ONE + T::HALF * Self::LIMITS.dwell_weight * (square - T::ONE));
        self.dwell_deviation = if grown > T::ONE { grown } else { T::ONE };
        let size = square.square_root();
        let wider = if innovation * flank.sign() < T::ZERO { -size } else { size };
        self.half_gap_error += Self::LIMITS.dwell_weight * (wider - self.half_gap_error);
    }

    /// Returns true once the mean innovation of dwells shows a changed half-gap; the mean then begins anew. Offset
    /// errors cancel between the flanks.
    pub fn detect_half_gap_change(&mut self) -> bool {
        let changed = self.half_gap_error.abs() > Self::LIMITS.changed_half_gap;
        if changed {
            self.half_gap_error = T::ZERO;
        }
        changed
    }

    /// Updates the next part of the variances.
    pub fn update_next_part<const P: usize>(
        &mut self,
        tables: &ObserverTables<T>,
        least_squares: &LeastSquares<T, P>,
        open_gap: &Regressors<T, P>,
        contact: &ContactSample<T>,
    ) {
        let table = &tables.learner;
        let noise = tables.contact.deflection_variance;
        let [of_deflection, of_flank] = self.wind_up_variance;
        let [touching, open] = &mut self.gap_variance;
        match self.next_part {
            0 => {
                self.deflection_variance = least_squares.variance(table, open_gap);
                *open = self.deflection_variance + of_deflection + noise;
            }
            1 => *touching = least_squares.variance(table, &contact.add_to(&[T::ZERO; P])) + of_flank + noise,
            2 => {
                self.variances =
                    [HALF_GAP, OFFSET, COMPLIANCE, SKEW].map(|parameter| least_squares.variance_of(table, parameter));
            }
            _ => {
                self.update_edge_limits(tables, least_squares, least_squares.variance(table, &contact.add_to(open_gap)))
            }
        }
        self.next_part = if self.next_part + 1 < PARTS { self.next_part + 1 } else { 0 };
    }

    /// Updates the thresholds that depend on the variance of the nearer edge.
    fn update_edge_limits<const P: usize>(
        &mut self,
        tables: &ObserverTables<T>,
        least_squares: &LeastSquares<T, P>,
        variance: T,
    ) {
        self.edge_deviation = variance.square_root();
        let edge = variance + tables.contact.deflection_variance;
        self.blur = T::TWO * edge.square_root();
        let compliance = least_squares.value(COMPLIANCE);
        let force = self.force_deviation * self.force_deviation;
        // Weights in inverse proportion to the variances, both as deflection.
        let from_force = force * compliance * compliance;
        self.position_weight = from_force / (from_force + edge);
        self.combined_deviation = (force * (T::ONE - self.position_weight)).square_root();
        let half_gap = least_squares.value(HALF_GAP);
        let part = half_gap * tables.contact.known_part;
        self.half_gap_is_known = half_gap > T::ZERO && variance < part * part;
        // A known half-gap serves up to three times the deviation: a place in the turn outside the known maps is no new
        // joint.
        let thrice = T::THREE * part;
        self.half_gap_is_usable =
            self.half_gap_is_known || self.half_gap_is_usable && half_gap > T::ZERO && variance < thrice * thrice;
    }

    /// Updates the values that hold in every period until the next interval; `trusted` is true once a half-gap was
    /// trusted on both flanks.
    pub fn update_limits<const P: usize>(
        &mut self,
        tables: &ObserverTables<T>,
        least_squares: &LeastSquares<T, P>,
        trusted: bool,
    ) {
        let (half_gap, compliance) = (least_squares.value(HALF_GAP), least_squares.value(COMPLIANCE));
        let [_, _, compliance_variance, _] = self.variances;
        self.stiffness = if compliance > T::ZERO { T::ONE / compliance } else { T::ZERO };
        self.mesh_share = tables.learner.mesh_compliance * self.stiffness;
        self.compliance_uncertainty = T::TWO * compliance_variance.square_root();
        let [guess, deviation] = [tables.learner.mean[HALF_GAP], tables.learner.deviation[HALF_GAP]];
        self.guessed_half_gap = if trusted { T::ZERO } else { guess + T::THREE * deviation };
        // A rounding error is uniform within plus or minus `rounding`.
        let rounding = tables.rounding();
        let edge = self.edge_deviation * self.edge_deviation + T::THIRD * rounding * rounding;
        let [by_estimate, by_guess] =
            [half_gap + T::THREE * edge.square_root(), self.guessed_half_gap + T::TWO * rounding];
        self.reach = tables.supervisor.margin + if by_guess > by_estimate { by_guess } else { by_estimate };
        let widest = T::TWO * half_gap * tables.supervisor.widest_part;
        // In a gap narrower than an output count the position of the teeth cannot be observed.
        self.widest_variance = if half_gap > rounding { widest * widest } else { T::ZERO };
        let [sine, cosine] = [least_squares.value(TRANSMISSION_ERROR), least_squares.value(TRANSMISSION_ERROR + 1)];
        let error = (sine * sine + cosine * cosine).square_root();
        self.flanks_swap = error > half_gap;
        // The planets' errors differ: some teeth meet earlier by half of the error on average, and noise hides the
        // moment.
        let (reached, largest) = (self.blur + T::HALF * error, Self::LIMITS.near_share * half_gap);
        self.near = if reached < largest { reached } else { largest };
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::observer::identification::regressors::PLAIN;
    use crate::observer::test_tables::{Q1_DOUBLE, observer};

    #[test]
    fn steady_force_keeps_an_eighth_of_noise() {
        let (tables, mut uncertainty) = (observer(), Uncertainty::uninitialized());
        let known = TorqueBias { variance: [0.0; 3], ..TorqueBias::new(&tables.contact) };
        uncertainty.update_force_variances(&tables, &known, 0.0, 0.0);
        // 1 N in a period; an interval has 10 periods.
        let Uncertainty { mean_force_deviation, steady_force_deviation, .. } = uncertainty;
        assert!((mean_force_deviation - 0.316).abs() < 1e-3, "{mean_force_deviation}");
        assert!((steady_force_deviation - 0.112).abs() < 1e-3, "{steady_force_deviation}");
    }

    #[test]
    fn gap_known_to_a_tenth_is_valid() {
        let tables = &Q1_DOUBLE;
        let (mut uncertainty, mut least_squares) =
            (Uncertainty::uninitialized(), LeastSquares::<_, PLAIN>::UNINITIALIZED);
        least_squares.reset(&tables.learner);
        uncertainty.update_limits(tables, &least_squares, false);
        // Gap of 160 um.
        assert!((uncertainty.widest_variance.square_root() - 16e-6).abs() < 1e-9);
    }
}
