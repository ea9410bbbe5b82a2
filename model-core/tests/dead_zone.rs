//! The dead zone, sharp (eq. 12) and smoothed (eq. 13).

use model_core::gears::dead_zone::{sharp, smoothed};

#[test]
fn separated_teeth_carry_no_force() {
    for deflection in [-1.0, -0.3, 0.0, 0.999, 1.0] {
        assert_eq!(sharp(deflection, 1.0), 0.0);
    }
}

#[test]
fn teeth_in_contact_deflect_by_what_exceeds_the_half_backlash() {
    assert_eq!(sharp(3.5, 1.0), 2.5);
    assert_eq!(sharp(-3.5, 1.0), -2.5);
    assert_eq!(sharp(0.25_f32, 0.0), 0.25);
}

#[test]
fn the_smoothed_dead_zone_nears_the_sharp_one_as_sharpness_grows() {
    for sharpness in [10.0, 100.0, 1000.0] {
        let worst = (-4000..=4000)
            .map(|i| f64::from(i) * 1e-3)
            .map(|deflection| (smoothed(deflection, 1.0, sharpness) - sharp(deflection, 1.0)).abs())
            .fold(0.0, f64::max);
        // The corner is rounded off by max over y > 0 of y (1 - tanh y) / 2 = 0.1392 over the sharpness.
        assert!(worst < 0.1393 / sharpness, "off by {worst:e} at sharpness {sharpness}");
    }
}

#[test]
fn as_printed_the_gap_would_give_x_less_one() {
    // Eq. 13 without its lost factor x, at the middle of a wide gap.
    let printed = |x: f64, b: f64, s: f64| {
        let (above, below) = ((s * (x - b)).tanh(), (s * (x + b)).tanh());
        x + 0.5 * (above - below) - 0.5 * b * (above + below)
    };
    assert!((printed(0.2, 1.0, 1000.0) - (0.2 - 1.0)).abs() < 1e-12);
    assert!(smoothed(0.2_f64, 1.0, 1000.0).abs() < 1e-12);
}
