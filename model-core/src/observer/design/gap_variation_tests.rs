//! Tests of the half-gap's uncertainty at an angle other than where it was estimated.

use crate::gears::Flank;
use crate::numbers::Real;
use crate::observer::identification::gap_variation::GapVariation;
use crate::observer::tables::CountTable;
use crate::observer::test_tables::observer;

const HALF_GAP: f32 = 80e-6;

fn counts() -> CountTable<f32> {
    observer().counts
}

/// Phase of a link [2^-32 turns] at an angle [rad].
fn phase(angle: f64) -> u32 {
    (angle / core::f64::consts::TAU * 4_294_967_296.0) as i64 as u32
}

/// Standard deviation of the half-gap at an angle, over the half-gap.
fn deviation(variation: &mut GapVariation<f32>, table: &CountTable<f32>, angle: f64) -> f32 {
    variation.set_position(phase(angle));
    variation.variance(table, HALF_GAP).square_root() / HALF_GAP
}

/// Reports rests on both flanks at an angle, each with an error `off` over the half-gap.
fn see(variation: &mut GapVariation<f32>, table: &CountTable<f32>, angle: f64, off: f32) {
    variation.set_position(phase(angle));
    for flank in [Flank::Drive, Flank::Back] {
        variation.add_dwell(table, flank, [(off * HALF_GAP).powi(2), 0.0], HALF_GAP, true);
    }
}

#[test]
fn variance_is_zero_where_both_flanks_were_seen() {
    let (table, mut variation) = (counts(), GapVariation::new());
    assert_eq!(
        deviation(&mut variation, &table, 1.0),
        0.0,
        "nothing was seen yet: the half-gap itself says that it is not known"
    );
    see(&mut variation, &table, -0.1, 0.0);
    assert_eq!(deviation(&mut variation, &table, -0.1), 0.0);
}

#[test]
fn variance_grows_with_distance() {
    let (table, mut variation) = (counts(), GapVariation::new());
    see(&mut variation, &table, -0.1, 0.0);
    let [near, far] = [0.2, 0.5].map(|angle| deviation(&mut variation, &table, angle));
    assert!((near - 0.3 * 0.25).abs() < 1e-3 && (far - 0.6 * 0.25).abs() < 1e-3, "{near} {far}");
}

#[test]
fn worn_gears_have_more_variance_than_even_ones() {
    let table = counts();
    let [even, worn] = [0.0, 0.3].map(|off| {
        let mut variation = GapVariation::new();
        (0..8).for_each(|pass| see(&mut variation, &table, if pass % 2 == 0 { 0.0 } else { 0.8 }, off));
        deviation(&mut variation, &table, 0.4)
    });
    assert!(even < 0.04 && worn > 0.12, "{even} {worn}");
}

#[test]
fn prior_variation_counts_as_half_a_radian() {
    let (table, mut variation) = (counts(), GapVariation::new());
    see(&mut variation, &table, 0.0, 0.0);
    see(&mut variation, &table, 0.5, 0.0);
    // 25 % seen over half a radian, then nothing seen over half a radian by either flank.
    let deviation = deviation(&mut variation, &table, 1.0);
    assert!((deviation - 0.5 * 0.25 / f32::sqrt(3.0)).abs() < 1e-3, "{deviation}");
}

#[test]
fn quarter_radian_shows_variation() {
    let table = counts();
    let after = |angle: f64| {
        let mut variation = GapVariation::new();
        see(&mut variation, &table, 0.0, 0.0);
        see(&mut variation, &table, angle, 0.3);
        deviation(&mut variation, &table, angle + 0.4)
    };
    assert!((after(0.24) - 0.4 * 0.25).abs() < 1e-3 && after(0.26) > 0.2, "{} {}", after(0.24), after(0.26));
}

#[test]
fn variance_grows_up_to_two_radians() {
    let (table, mut variation) = (counts(), GapVariation::new());
    see(&mut variation, &table, -1.0, 0.0);
    let deviations = [0.9, 1.1, 1.5].map(|angle| deviation(&mut variation, &table, angle));
    assert!((deviations[0] - 1.9 * 0.25).abs() < 1e-3, "{deviations:?}");
    assert!((deviations[1] - 0.5).abs() < 1e-3 && (deviations[2] - 0.5).abs() < 1e-3, "{deviations:?}");
}

#[test]
fn wear_is_seen_within_three_strokes() {
    let table = counts();
    // A hundred strokes of a radian without a variation, then `worn` strokes with 30 %.
    let after = |worn: u32| {
        let mut variation = GapVariation::new();
        (0..100 + worn).for_each(|stroke| {
            see(&mut variation, &table, f64::from(stroke % 2), if stroke < 100 { 0.0 } else { 0.3 });
        });
        deviation(&mut variation, &table, f64::from((99 + worn) % 2) + 0.5) / 0.5
    };
    assert!(after(1) < 0.2 && after(3) > 0.24, "{} {}", after(1), after(3));
}
