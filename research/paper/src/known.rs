//! Known results for the paper's joint under set P, from independent earlier computations, and the tolerances for reproducing them. For
//! other joints only the two integrators and the two exponents are compared.

use super::plan::{StudyPlan, SweepStart};
use super::record::{AttractorRecord, Class, ClassWindow, DeadZoneFigure, Reading};
use super::windows::class_at;
use report::checks::{Bound, Check, Source};

/// Tolerance of a known Poincare point, over b_c.
const POINT: f64 = 1e-3;
/// Tolerance of a known exponent of a periodic motion.
const PERIODIC_EXPONENT: f64 = 0.002;
/// Tolerance of a known exponent of chaos.
const CHAOTIC_EXPONENT: f64 = 0.01;
/// Tolerance of a known edge of a window [um].
const EDGE: f64 = 1.0;
/// Largest distance between exponents by tangent vector and by two trajectories.
const METHODS: f64 = 0.002;
/// Largest distance between the two integrators, over b_c: measured 3e-11 on periodic motions and 2e-10 in chaos.
const INTEGRATORS: f64 = 1e-8;
/// Largest error of eq. 13 times its sharpness: max over u of u (1 - tanh u) / 2.
const DEAD_ZONE: f64 = 0.13924;

/// Known results at one half-backlash.
struct Known {
    half_backlash_um: f64,
    class: Class,
    exponent: f64,
    points: &'static [[f64; 4]],
    non_fundamental_ratio: Option<f64>,
    peak_to_peak: Option<f64>,
}

/// Results with the corrected carrier.
const CORRECTED: [Known; 4] = [
    Known {
        half_backlash_um: 0.0,
        class: Class::Periodic(1),
        exponent: -0.0324,
        points: &[[-0.0678, 0.8675, -11.5051, -5.0495]],
        non_fundamental_ratio: Some(0.007),
        peak_to_peak: Some(11.136),
    },
    Known {
        half_backlash_um: 10.0,
        class: Class::Periodic(1),
        exponent: -0.0324,
        points: &[[0.3748, 1.4129, -9.0687, -2.7137]],
        non_fundamental_ratio: Some(0.005),
        peak_to_peak: Some(8.961),
    },
    Known {
        half_backlash_um: 60.0,
        class: Class::Periodic(3),
        exponent: -0.0319,
        points: &[
            [0.7489, 6.1283, -13.9408, -6.2729],
            [-6.2003, 0.6379, -4.3947, 0.8576],
            [6.5018, 10.4328, -2.1416, 3.4190],
        ],
        non_fundamental_ratio: Some(2.66),
        peak_to_peak: Some(20.021),
    },
    Known {
        half_backlash_um: 120.0,
        class: Class::Chaotic,
        exponent: 0.1402,
        points: &[],
        non_fundamental_ratio: None,
        peak_to_peak: None,
    },
];

/// Results with the carrier as printed.
const PRINTED: [Known; 4] = [
    known_class(0.0, Class::Periodic(1), -0.0374),
    known_class(10.0, Class::Periodic(1), -0.0374),
    known_class(60.0, Class::Periodic(3), -0.0371),
    known_class(120.0, Class::Chaotic, 0.1410),
];

const fn known_class(half_backlash_um: f64, class: Class, exponent: f64) -> Known {
    Known { half_backlash_um, class, exponent, points: &[], non_fundamental_ratio: None, peak_to_peak: None }
}

/// Windows from rest with the corrected carrier: class, first and last half-backlash [um], where known.
const WINDOWS: [(Class, Option<f64>, Option<f64>); 6] = [
    (Class::Periodic(1), None, Some(19.0)),
    (Class::Periodic(2), None, Some(34.5)),
    (Class::Chaotic, Some(35.0), Some(41.5)),
    (Class::Periodic(3), Some(46.5), Some(69.0)),
    (Class::Periodic(6), None, Some(70.5)),
    (Class::Chaotic, Some(71.0), None),
];

/// Half-backlash of a narrow chaotic window from rest [um].
const NARROW_WINDOW: f64 = 45.0;

/// Last half-backlash with period 2 in an upward sweep [um].
const PERIOD_2_UPWARD: f64 = 40.0;

/// All checks of a study.
pub fn checks(plan: &StudyPlan, readings: &[Reading], dead_zone: &DeadZoneFigure) -> Vec<Check> {
    let mut checks = Vec::new();
    for (index, reading) in readings.iter().enumerate() {
        if plan.is_set_p {
            let known = if index == 0 { &CORRECTED } else { &PRINTED };
            for (known, found) in known.iter().zip(&reading.attractors) {
                attractor(reading, known, found, &mut checks);
            }
        }
        for found in &reading.attractors {
            consistency(reading, found, &mut checks);
            checks.extend(same_in_diagram(reading, found));
        }
    }
    if plan.is_set_p {
        windows(&readings[0], &mut checks);
    }
    smoothing(dead_zone, &mut checks);
    checks
}

fn place(reading: &Reading, found: &AttractorRecord) -> String {
    // Conversion from decimal micrometres leaves rounding noise.
    format!("{}, b = {} µm", reading.joint, (found.half_backlash_m * 1e9).round() / 1e3)
}

fn attractor(reading: &Reading, known: &Known, found: &AttractorRecord, checks: &mut Vec<Check>) {
    let place = place(reading, found);
    let mut judge = |name: String, figure: f64, bound: Bound, note: String| {
        checks.push(Check::new(name, figure, "", bound, Source::Host).note(note));
    };
    debug_assert!((found.half_backlash_m * 1e6 - known.half_backlash_um).abs() < 1e-6, "the same half-backlash");
    let (figure, bound, exponent_bound) = match (known.class, found.class) {
        (Class::Periodic(expected), Class::Periodic(period)) => {
            (period as f64, Bound::Exactly(expected as f64), PERIODIC_EXPONENT)
        }
        (Class::Periodic(expected), _) => (f64::NAN, Bound::Exactly(expected as f64), PERIODIC_EXPONENT),
        _ => (f64::from(u8::from(found.class == known.class)), Bound::Exactly(1.0), CHAOTIC_EXPONENT),
    };
    let what = if known.class == Class::Chaotic { "chaos" } else { "period count" };
    judge(format!("{place}: {what}"), figure, bound, format!("known: {}", known.class));
    judge(
        format!("{place}: Lyapunov exponent"),
        (found.exponent_by_tangent_vector - known.exponent).abs(),
        Bound::AtMost(exponent_bound),
        format!("distance of {:+.4} from the known {:+.4}", found.exponent_by_tangent_vector, known.exponent),
    );
    if !known.points.is_empty() {
        let nearest = |point: &[f64; 4]| {
            let distances = found.poincare_points.iter().map(|other| largest_difference(point, other));
            distances.fold(f64::INFINITY, f64::min)
        };
        let worst = known.points.iter().map(nearest).fold(0.0, f64::max);
        let note = format!("greatest distance from the {} known, in any coordinate", known.points.len());
        judge(format!("{place}: Poincaré points"), worst, Bound::AtMost(POINT), note);
    }
    if let (Some(ratio), Some(peak)) = (known.non_fundamental_ratio, known.peak_to_peak) {
        // Both are known to their last printed digit only.
        let last_digit = if ratio < 1.0 { 0.0005 } else { 0.005 };
        let note = format!("distance of {:.4} from the known {ratio}", found.non_fundamental_ratio);
        let distance = (found.non_fundamental_ratio - ratio).abs();
        judge(format!("{place}: non-fundamental over fundamental"), distance, Bound::AtMost(last_digit), note);
        let note = format!("distance of {:.4} from the known {peak}", found.peak_to_peak);
        judge(format!("{place}: peak to peak"), (found.peak_to_peak - peak).abs(), Bound::AtMost(1e-3), note);
    }
}

fn largest_difference(one: &[f64; 4], other: &[f64; 4]) -> f64 {
    one.iter().zip(other).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// Checks that apply to any joint.
fn consistency(reading: &Reading, found: &AttractorRecord, checks: &mut Vec<Check>) {
    let place = place(reading, found);
    let distance = (found.exponent_by_tangent_vector - found.exponent_by_two_trajectories).abs();
    let note = format!(
        "tangent vector {:+.4}, two trajectories {:+.4}",
        found.exponent_by_tangent_vector, found.exponent_by_two_trajectories
    );
    let name = format!("{place}: the two exponents agree");
    checks.push(Check::new(name, distance, "", Bound::AtMost(METHODS), Source::Host).note(note));
    let name = format!("{place}: an independent integrator agrees");
    let bound = Bound::AtMost(INTEGRATORS);
    checks.push(match found.reference_distance {
        Some(distance) => Check::new(name, distance, "", bound, Source::Host)
            .note("Runge-Kutta of order 8 in absolute coordinates, at the next Poincaré points"),
        None => Check::not_run(name, "", bound, "the independent integrator refuses this joint"),
    });
}

/// Attractor and diagram from the same start have one class at one half-backlash: if they differ, one of them had not settled and neither
/// is reliable.
fn same_in_diagram(reading: &Reading, found: &AttractorRecord) -> Option<Check> {
    let rest = reading.sweeps.iter().find(|sweep| sweep.start == SweepStart::Rest.word())?;
    let shown = class_at(&rest.windows, found.half_backlash_m)?;
    let name = format!("{}: attractor and diagram agree", place(reading, found));
    let same = f64::from(u8::from(shown == found.class));
    let note = format!("attractor: {}, diagram: {shown}", found.class);
    Some(Check::new(name, same, "", Bound::Exactly(1.0), Source::Host).note(note))
}

fn windows(reading: &Reading, checks: &mut Vec<Check>) {
    let sweep = |start: SweepStart| reading.sweeps.iter().find(|sweep| sweep.start == start.word());
    let mut edge = |name: String, found: Option<f64>, known: f64| {
        let bound = Bound::AtMost(EDGE);
        let figure = found.map_or(f64::NAN, |found| (found * 1e6 - known).abs());
        let note = match found {
            Some(found) => format!("found at {:.1} µm, known {known} µm", found * 1e6),
            None => format!("no such window; known {known} µm"),
        };
        checks.push(Check::new(name, figure, "µm", bound, Source::Host).note(note));
    };
    let nearest = |windows: &[ClassWindow], class: Class, at: f64, end: fn(&ClassWindow) -> f64| {
        let own = windows.iter().filter(|window| window.class == class).map(end);
        own.min_by(|a, b| (a * 1e6 - at).abs().total_cmp(&(b * 1e6 - at).abs()))
    };
    if let Some(rest) = sweep(SweepStart::Rest) {
        for (class, from, to) in WINDOWS {
            if let Some(from) = from {
                let found = nearest(&rest.windows, class, from, |window| window.from_m);
                edge(format!("from rest: {class} begins"), found, from);
            }
            if let Some(to) = to {
                let found = nearest(&rest.windows, class, to, |window| window.to_m);
                edge(format!("from rest: {class} ends"), found, to);
            }
        }
        let found = nearest(&rest.windows, Class::Chaotic, NARROW_WINDOW, |window| window.from_m);
        edge("from rest: narrow chaotic window".to_owned(), found, NARROW_WINDOW);
    }
    if let Some(up) = sweep(SweepStart::Up) {
        let found = nearest(&up.windows, Class::Periodic(2), PERIOD_2_UPWARD, |window| window.to_m);
        edge("upward: period 2 ends".to_owned(), found, PERIOD_2_UPWARD);
    }
}

fn smoothing(figure: &DeadZoneFigure, checks: &mut Vec<Check>) {
    let Some(sharpest) = figure.errors.last() else { return };
    let scaled = sharpest.sharpness * sharpest.corrected;
    let note = format!("at sharpness {:.0}; the closed form is {DEAD_ZONE} over the sharpness", sharpest.sharpness);
    let distance = (scaled / DEAD_ZONE - 1.0).abs();
    let name = "eq. 13 corrected: largest error times sharpness";
    checks.push(Check::new(name, distance, "", Bound::AtMost(1e-2), Source::Host).note(note));
    let name = "eq. 13 as printed: error that no sharpness removes";
    let note = "in the middle of the gap it gives −1 in place of 0";
    checks.push(Check::new(name, sharpest.printed, "", Bound::AtLeast(0.99), Source::Host).note(note));
}
