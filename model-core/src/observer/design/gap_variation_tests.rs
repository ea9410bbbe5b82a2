//! Tests of the half-gap's uncertainty at an angle other than where it was estimated.

use super::{design_observer, observer_settings};
use crate::gears::Flank;
use crate::numbers::Real;
use crate::observer::identification::gap_variation::GapVariation;
use crate::observer::tables::CountTable;

const HALF_GAP: f32 = 80e-6;

fn counts() -> CountTable<f32> {
    let q1 = joint_file::read(joint_file::preset("q1").expect("a preset")).expect("a joint");
    design_observer(&q1.parameters, &observer_settings(&q1.surroundings)).expect("tables").counts
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
