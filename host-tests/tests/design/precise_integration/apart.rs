//! Reason to keep E = exp(A h) - I apart from I while it is doubled: digits lost on the paper's joint when I + E is squared instead. The
//! board adds its tables to the identity for the same reason.

use host_tests::tolerance::DIGITS_KEPT;
use model_core::gears::design::exponential::exponential_minus_identity;
use nalgebra::DMatrix;

use super::fixtures::{Expected, Fixture, models};

fn paper_fixture() -> Fixture {
    models().into_iter().find(|fixture| fixture.name == "paper_3").expect("the fixture is there")
}

/// Taylor series at h / 2^doublings, squared in f64; the identity is subtracted at the end.
fn plain_squaring(matrix: &DMatrix<f64>, step: f64, doublings: u32) -> DMatrix<f64> {
    let start = matrix * (step / f64::from(2_u32.pow(doublings)));
    let identity = DMatrix::identity(start.nrows(), start.ncols());
    let horner = |sum: DMatrix<f64>, term: u32| &identity + &start * sum / f64::from(term);
    let mut whole = (1..=20).rev().fold(identity.clone(), horner);
    for _ in 0..doublings {
        whole = &whole * &whole;
    }
    whole - identity
}

/// Largest relative error on the diagonal, where the identity dominates.
fn error(found: &DMatrix<f64>, expected: &Expected) -> f64 {
    found.diagonal().zip_fold(&expected.transition.diagonal(), 0.0, |worst: f64, found, exact| {
        worst.max(((found - exact) / exact).abs())
    })
}

/// Decimal digits that plain squaring loses against precise integration.
fn digits_lost(expected: &Expected, matrix: &DMatrix<f64>, doublings: u32) -> f64 {
    let kept_apart = error(&exponential_minus_identity(matrix, expected.step), expected);
    let lost = (error(&plain_squaring(matrix, expected.step, doublings), expected) / f64::EPSILON).log10();
    print!("step {}, {doublings} doublings, {lost:.1} digits lost: ", expected.step);
    DIGITS_KEPT.check(kept_apart);
    lost
}

/// At small steps plain squaring loses the digits hidden by the identity.
#[test]
fn small_steps_lose_digits_when_squared() {
    let fixture = paper_fixture();
    let [smallest, small] = [0, 1].map(|index| &fixture.steps[index]);
    assert_eq!([smallest.step, small.step], [1e-4, 0.05]);
    // Damping moves the diagonal by about 1e-5 from 1, so five digits are lost before the first squaring.
    let lost = digits_lost(smallest, &fixture.matrix, 0);
    assert!((4.0..6.0).contains(&lost), "{lost} digits lost");
    let lost = digits_lost(small, &fixture.matrix, 0);
    assert!((1.0..3.0).contains(&lost), "{lost} digits lost");
}

/// Each doubling of plain squaring loses a third of a digit.
#[test]
fn squaring_loses_a_third_digit_a_doubling() {
    let fixture = paper_fixture();
    // A tick at 20 kHz. Zhong's precise integration starts at 2^-20 of the step.
    let tick = &fixture.steps[2];
    assert_eq!(tick.step, 1.025);
    let lost = [5, 10, 20].map(|doublings| digits_lost(tick, &fixture.matrix, doublings));
    assert!(lost[0] < lost[1] && lost[1] < lost[2], "{lost:?}");
    assert!((4.0..7.0).contains(&lost[2]), "20 doublings cost {} digits", lost[2]);
}
