//! The table of attractors and the windows, as they are printed when a study is done. Everything else is in the report.

use std::fmt::Write as _;

use super::record::{Reading, StudyRecord};
use report::checks::Verdict;

/// All joints of a study.
pub fn table(record: &StudyRecord) -> String {
    let mut text = String::new();
    for reading in &record.readings {
        attractors(reading, &mut text);
        windows(reading, &mut text);
    }
    let count = |verdict: Verdict| record.checks.iter().filter(|check| check.verdict == verdict).count();
    let held = count(Verdict::Passed);
    // Writing to a string cannot fail.
    let _ = writeln!(text, "{held} of {} checks held", held + count(Verdict::Failed));
    text
}

fn attractors(reading: &Reading, text: &mut String) {
    let _ = writeln!(
        text,
        "{}, omega/omega_n = {:.4}, drive torque {:.4} N m\n",
        reading.joint, reading.omega, reading.drive_torque_nm
    );
    let _ = writeln!(
        text,
        "{:>8}  {:<16}{:>14}{:>12}{:>18}{:>18}{:>14}{:>14}",
        "b [um]", "attractor", "points", "exponent", "two trajectories", "between planets", "non-fund.", "peak to peak"
    );
    for found in &reading.attractors {
        let points = format!("{} of {}", found.distinct_points, found.points_looked_at);
        let between = found.exponent_between_planets.map_or("-".to_owned(), |exponent| format!("{exponent:+.4}"));
        let _ = writeln!(
            text,
            "{:>8.2}  {:<16}{points:>14}{:>+12.4}{:>+18.4}{between:>18}{:>14.4}{:>14.4}",
            found.half_backlash_m * 1e6,
            found.class.to_string(),
            found.exponent_by_tangent_vector,
            found.exponent_by_two_trajectories,
            found.non_fundamental_ratio,
            found.peak_to_peak,
        );
    }
    text.push('\n');
}

fn windows(reading: &Reading, text: &mut String) {
    for sweep in &reading.sweeps {
        let how = if sweep.start == "rest" { "from rest" } else { "carried" };
        let direction = if sweep.start == "rest" { String::new() } else { format!(" {}ward", sweep.start) };
        let _ = writeln!(text, "windows of b [um] {how}{direction}:");
        for window in &sweep.windows {
            let _ = writeln!(text, "  {:>7.2} to {:>7.2}  {}", window.from_m * 1e6, window.to_m * 1e6, window.class);
        }
        text.push('\n');
    }
}
