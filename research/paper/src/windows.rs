//! Ranges of half-backlash with one class in a sweep.

use super::record::{Class, ClassWindow, SweepPoint};

/// Neighbouring points of one class, in the order of the points.
pub fn windows(points: &[SweepPoint]) -> Vec<ClassWindow> {
    let segments = points.chunk_by(|one, next| one.class == next.class);
    segments
        .map(|segment| ClassWindow {
            from_m: segment[0].half_backlash_m,
            to_m: segment[segment.len() - 1].half_backlash_m,
            class: segment[0].class,
        })
        .collect()
}

/// Chaotic windows that end below a half-backlash [m] at which the motion is periodic.
pub fn chaos_below(windows: &[ClassWindow], half_backlash: f64) -> Vec<&ClassWindow> {
    let chaotic = |window: &&ClassWindow| window.class == Class::Chaotic;
    windows.iter().filter(chaotic).filter(|window| window.to_m < half_backlash).collect()
}

/// The class at a half-backlash [m], if it lies within a window; between two windows either may be right.
pub fn class_at(windows: &[ClassWindow], half_backlash: f64) -> Option<Class> {
    // Micrometres typed in decimals come with rounding noise.
    const NOISE: f64 = 1e-12;
    let within = |window: &&ClassWindow| (window.from_m - NOISE..=window.to_m + NOISE).contains(&half_backlash);
    windows.iter().find(within).map(|window| window.class)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn class_is_known_within_windows_only() {
        let window = |from_m, to_m, class| ClassWindow { from_m, to_m, class };
        let windows = [window(0.0, 10e-6, Class::Periodic(1)), window(20e-6, 20e-6, Class::Chaotic)];
        let classes = [0.0, 5e-6, 10e-6, 15e-6, 20e-6, 25e-6].map(|b| class_at(&windows, b));
        let (one, chaos) = (Some(Class::Periodic(1)), Some(Class::Chaotic));
        assert_eq!(classes, [one, one, one, None, chaos, None]);
    }

    #[test]
    fn neighbours_of_one_class_form_a_window() {
        use Class::{Chaotic, Periodic};
        let classes = [Periodic(1), Periodic(1), Periodic(2), Chaotic, Chaotic, Periodic(1)];
        let points: Vec<SweepPoint> = classes
            .iter()
            .enumerate()
            .map(|(b, class)| SweepPoint { half_backlash_m: b as f64, class: *class, exponent: 0.0, x_sp: vec![] })
            .collect();
        let windows = windows(&points);
        let ends: Vec<(f64, f64)> = windows.iter().map(|window| (window.from_m, window.to_m)).collect();
        assert_eq!(ends, [(0.0, 1.0), (2.0, 2.0), (3.0, 4.0), (5.0, 5.0)]);
        assert_eq!(chaos_below(&windows, 5.0).len(), 1);
        assert!(chaos_below(&windows, 4.0).is_empty());
    }
}
