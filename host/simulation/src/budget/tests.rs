//! Verdicts: agreement with the refusals, and of text, JSON and rates with one another.

use std::path::Path;

use joint_file::{JointFile, PRESETS, named};
use link::messages::Role;
use model_core::compensation::design::{compensation_settings, design_compensation};
use model_core::gears::design::{Effort, Processor, certificate};
use parameters::JointParameters;

use super::{BudgetSummary, layout, summary};
use crate::verdicts::DEFAULT_ACCURACY;
use board::device::board::Board;
use board::device::tick_time::RateCheck;
use report::output;

fn file(name: &str) -> JointFile {
    named::load(Path::new(name)).expect("a preset").file
}

fn preset(name: &str) -> JointParameters {
    file(name).parameters
}

fn budget(name: &str, board: &Board, rate: u32) -> BudgetSummary {
    summary(&file(name), board, Role::Plant, rate, DEFAULT_ACCURACY).expect("figures")
}

#[test]
fn presets_fit_emulated_board_at_20_khz() {
    for name in PRESETS {
        let (joint, board) = (preset(name), Board::emulated());
        if let Err(failure) = RateCheck::new(&joint, &board, Role::Plant).check(20_000) {
            panic!("{failure}");
        }
    }
}

#[test]
fn too_fast_rate_gets_nearest_fitting_rate() {
    let board = Board::emulated();
    let figures = budget("q1", &board, 168_000);
    let rate = figures.verdicts.time.rate_that_fits_Hz.expect("there is one");
    assert!(!figures.verdicts.time.fits && layout(&figures).contains("DOES NOT FIT"), "{}", layout(&figures));
    assert!(layout(&figures).contains(&format!("{rate} Hz would fit")), "{}", layout(&figures));
    let joint = preset("q1");
    let on_board = RateCheck::new(&joint, &board, Role::Plant);
    assert!(on_board.check(rate).is_ok());
    let nearer = (1..rate.abs_diff(168_000)).flat_map(|off| [168_000 - off, 168_000 + off]);
    assert_eq!(nearer.into_iter().find(|rate| on_board.obstacle(*rate).is_none()), None);
}

/// A rate without a stable step is an error; a rate that the timer cannot make is a verdict.
#[test]
fn unstable_rate_fails_inexact_rate_is_reported() {
    let failure =
        summary(&file("q1"), &Board::emulated(), Role::Plant, 100, DEFAULT_ACCURACY).expect_err("not possible");
    assert!(failure.message().contains("no step is stable"), "{failure}");
    assert!(failure.help().expect("a help").contains("--rate "), "{failure}");
    let figures = budget("q1", &Board::emulated(), 20_001);
    assert!(!figures.verdicts.time.fits && !figures.verdicts.time.rate_can_be_made, "{figures:?}");
}

#[test]
fn offered_rate_reaches_accuracy() {
    let (joint, board) = (file("q1"), Board::emulated());
    let error = budget("q1", &board, 20_000).verdicts.accuracy.error.expect("a motion that can be predicted");
    let wanted = 0.5 * error;
    let figures = summary(&joint, &board, Role::Plant, 20_000, wanted).expect("figures").verdicts.accuracy;
    assert!(!figures.reached && figures.wanted == wanted, "{figures:?}");
    let rate = figures.rate_that_reaches_it_Hz.expect("more sub-steps or a higher rate help");
    let at_rate = summary(&joint, &board, Role::Plant, rate, wanted).expect("figures").verdicts;
    assert!(at_rate.accuracy.reached && Some(at_rate.time.fits) == figures.fits_there, "{at_rate:?}");
}

/// An equivalent gear under constant torques does not swing, so only the reversals have an error.
#[test]
fn equivalent_gear_has_no_steady_error() {
    let figures = budget("c1", &Board::emulated(), 20_000);
    assert!(figures.verdicts.errors.steady.typical.is_none() && figures.verdicts.errors.reversals.typical.is_some());
    let page = layout(&figures);
    assert!(page.contains("no oscillation, so no error to measure") && !page.contains("breaks off"), "{page}");
}

#[test]
fn work_rises_with_contact_changes() {
    let effort = Effort::Within(Processor::STM32H743);
    for name in PRESETS {
        let work = certificate(&preset(name), 20_000, effort).expect("a certificate").instructions;
        assert!([work.contact_changes, work.all_crossing, work.bound].is_sorted(), "{name}");
        assert!(work.contact_holds < work.all_crossing, "{name}");
    }
}

#[test]
fn text_and_json_agree() {
    let summary = budget("q1", &Board::emulated(), 20_000);
    let (text, json) = (layout(&summary), output::json("figures", &summary).expect("finite numbers"));
    let instructions = summary.all_crossing.instructions.to_string();
    assert!(text.contains(&instructions) && json.contains(&instructions), "{text}{json}");
    assert!(json.contains("\"schema\": \"joint-budget/2\""), "{json}");
    assert!(text.contains("fits:") && text.contains(&summary.verdicts.substeps_in_words()), "{text}");
}

#[test]
fn widest_bandwidth_names_its_limit() {
    for name in PRESETS {
        let file = file(name);
        let bandwidth = budget(name, &Board::emulated(), 20_000).bandwidth.expect("a drive train");
        let asked = |bandwidth: f64| {
            design_compensation::<f32>(&file.parameters, &compensation_settings(&file.surroundings, bandwidth))
        };
        let widest = bandwidth.widest_rad_per_s;
        asked(widest).unwrap_or_else(|error| panic!("{name}: {error}"));
        let refused = asked(1.02 * widest).expect_err("more than the widest").to_string();
        assert!(refused.contains(&widest.to_string()), "{name}: {refused}");
        let slow = refused.contains("too slow") && bandwidth.limited_by.starts_with("control rate");
        assert!(slow || refused.contains(&bandwidth.limited_by), "{name}: {refused}, not {}", bandwidth.limited_by);
        assert!(bandwidth.usual_rad_per_s <= widest, "{name}");
    }
}
