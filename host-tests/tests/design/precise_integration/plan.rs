//! Numbers of doublings and series terms over norms of every size: as few as possible and as many as necessary.

use model_core::gears::design::exponential::{REMAINDER, SERIES_NORM, ScalingPlan};

/// Norms from the smallest to the largest f64, and both neighbours of every power of two.
fn norms() -> Vec<f64> {
    let mut norms = vec![0.0, f64::from_bits(1), f64::MIN_POSITIVE, f64::MAX];
    for exponent in -60..1000 {
        let power = 2.0_f64.powi(exponent);
        norms.extend([power.next_down(), power, power.next_up(), 1.3 * power]);
    }
    norms
}

/// Norm at which the series of a plan starts.
fn start(norm: f64, plan: &ScalingPlan) -> f64 {
    // Two factors, since 2^N itself may overflow an f64.
    let half = plan.doublings / 2;
    norm * 2.0_f64.powi(-(half as i32)) * 2.0_f64.powi(-((plan.doublings - half) as i32))
}

/// Remainder of the series after `terms` terms, relative to its first.
fn left_out(start: f64, terms: u32) -> f64 {
    let all = |from: u32, to: u32| (from..=to).fold(1.0, |term, k| term * start / f64::from(k));
    (terms + 1..terms + 40).map(|last| all(2, last)).sum()
}

/// Doublings reduce the norm to the series' limit and no further.
#[test]
fn doublings_are_as_few_as_possible() {
    for norm in norms() {
        let plan = ScalingPlan::new(norm);
        let start = start(norm, &plan);
        assert!(start <= SERIES_NORM, "{norm:e}: {plan:?} leaves the series {start}");
        assert!(plan.doublings == 0 || 2.0 * start > SERIES_NORM, "{norm:e}: {plan:?} doubles once too often");
    }
}

/// The remainder is below its limit, with no term too many.
#[test]
fn series_terms_are_as_few_as_possible() {
    for norm in norms() {
        let plan = ScalingPlan::new(norm);
        let start = start(norm, &plan);
        assert!(left_out(start, plan.terms) <= REMAINDER, "{norm:e}: {plan:?} leaves too much");
        // The plan's bound on the remainder is a geometric series, above the sum by less than a hundredth.
        let fewer = 1.01 * left_out(start, plan.terms - 1);
        assert!(plan.terms == 1 || fewer > REMAINDER, "{norm:e}: {plan:?} has a term too many");
    }
}

/// An infinite or NaN norm ends the plan without doublings.
#[test]
fn non_finite_norm_ends_the_plan() {
    for norm in [f64::INFINITY, f64::NAN] {
        assert_eq!(ScalingPlan::new(norm).doublings, 0);
    }
}
