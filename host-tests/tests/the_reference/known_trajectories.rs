//! The reference against mesh deflections computed by another integrator: cases A and Q of the data folder.

use host_tests::tolerance::CASE_DATA;
use reference::integrator::Counters;
use reference::scenarios::{CASE_A_OMEGA, CASE_Q_OMEGA, PAPER_LENGTH, case, paper_natural_frequency, run_at};

const CASE_A: &str = include_str!("../../data/case_a.csv");
const CASE_Q: &str = include_str!("../../data/case_q.csv");

/// Rows of tau and the six mesh deflections over b_c.
fn rows(text: &str) -> Vec<[f64; 7]> {
    let number = |field: &str| field.parse().expect("a number");
    let row = |line: &str| line.split(',').map(number).collect::<Vec<f64>>().try_into().expect("seven columns");
    text.lines().skip(1).map(row).collect()
}

/// RMS difference over six meshes and tau = 100..300, over the standard deviation of the expected deflections.
fn trajectory_error(omega: f64, text: &str) -> (f64, Counters) {
    let expected = rows(text);
    let times: Vec<f64> = expected.iter().map(|row| row[0] / paper_natural_frequency()).collect();
    let found = run_at(&case("case", omega), &times).expect("the case runs");
    let (mut squares, mut sum, mut sum_of_squares, mut count) = (0.0, 0.0, 0.0, 0.0);
    for (row, sample) in expected.iter().zip(&found.samples).filter(|(row, _)| row[0] >= 100.0) {
        for (expected, found) in row[1..].iter().zip(sample.deflections.iter().flatten()) {
            squares += (found / PAPER_LENGTH - expected).powi(2);
            sum += expected;
            sum_of_squares += expected * expected;
            count += 1.0;
        }
    }
    let mean = sum / count;
    let deviation = (sum_of_squares / count - mean * mean).sqrt();
    ((squares / count).sqrt() / deviation, found.counters)
}

/// Case A separates and hits as in the data.
#[test]
fn case_a_matches_the_data() {
    let (error, counters) = trajectory_error(CASE_A_OMEGA, CASE_A);
    CASE_DATA.check(error);
    // 300 omega_n seconds are 38.2 mesh periods, each with 11.3 events.
    assert!((420..=440).contains(&counters.events), "{counters:?}");
    assert_eq!(counters.unguarded_steps, 0);
}

/// Case Q keeps contact as in the data.
#[test]
fn case_q_matches_the_data() {
    let (error, counters) = trajectory_error(CASE_Q_OMEGA, CASE_Q);
    CASE_DATA.check(error);
    assert_eq!(counters.events, 0, "contact holds in case Q");
}
