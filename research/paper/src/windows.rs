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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neighbours_of_one_class_are_one_window() {
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
