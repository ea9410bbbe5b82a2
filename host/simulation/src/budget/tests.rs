//! Verdicts: what is refused, which rate is offered instead, and that more work is never cheaper.

use std::path::Path;

use joint_file::{PRESETS, named};
use model_core::gears::design::{Effort, StepSize, certificate};
use parameters::JointParameters;

use super::layout::layout;
use super::summary;
use super::verdict::{nearest, refuse};
use board::target::board::Board;
use report::output;

fn preset(name: &str) -> JointParameters {
    named::load(Path::new(name)).expect("a preset").file.parameters
}

#[test]
fn every_preset_can_be_stepped_at_the_usual_rate_on_the_emulated_board() {
    for name in PRESETS {
        if let Err(failure) = refuse(&preset(name), &Board::emulated(), 20_000) {
            panic!("{failure}");
        }
    }
}

#[test]
fn a_rate_that_takes_too_long_is_refused_with_the_nearest_that_fits() {
    let q1 = preset("q1");
    let failure = refuse(&q1, &Board::emulated(), 80_000).expect_err("far too fast");
    assert!(failure.message().contains("q1") || failure.message().contains("Q1"), "{failure}");
    assert!(failure.message().contains("of the period"), "{failure}");
    assert_eq!(failure.exit_code(), 2);
    let offered = nearest(&StepSize::new(&q1), &Board::emulated().processor(), 80_000).expect("there is one");
    assert!(failure.help().expect("a help").contains(&format!("--rate {offered}")), "{failure}");
    assert!(refuse(&q1, &Board::emulated(), offered).is_ok(), "{offered}");
}

#[test]
fn a_rate_that_is_unstable_or_cannot_be_made_is_refused_with_one_that_can() {
    for (rate, why) in [(100, "no step is stable"), (20_001, "no multiple")] {
        let failure = refuse(&preset("q1"), &Board::emulated(), rate).expect_err("not possible");
        assert!(failure.message().contains(why), "{failure}");
        assert!(failure.help().expect("a help").contains("--rate "), "{failure}");
    }
}

#[test]
fn what_is_offered_is_nearest() {
    let (step_size, processor) = (StepSize::new(&preset("l1")), Board::emulated().processor());
    for rate in [19_999, 33_333, 70_000] {
        let offered = nearest(&step_size, &processor, rate).expect("there is one");
        let l1 = preset("l1");
        let nearer = (1..offered.abs_diff(rate)).flat_map(|off| [rate.saturating_sub(off), rate + off]);
        let fits = |rate: &u32| *rate > 0 && refuse(&l1, &Board::emulated(), *rate).is_ok();
        assert_eq!(nearer.filter(|rate| processor.clock.is_multiple_of((*rate).max(1))).find(fits), None, "{rate}");
    }
}

#[test]
fn a_faster_board_takes_no_more_of_the_period_and_no_fewer_sub_steps() {
    for name in PRESETS {
        let joint = preset(name);
        let on = |board| summary(&joint, board, 20_000).expect("figures");
        let (slow, fast) = (on(&Board::emulated()), on(&Board::load("nucleo-h743zi").expect("a preset")));
        assert!(fast.parts >= slow.parts && fast.holding.part < slow.holding.part, "{name}");
    }
}

#[test]
fn work_rises_from_holding_to_the_bound() {
    for name in PRESETS {
        let summary =
            summary(&preset(name), &Board::load("nucleo-h743zi").expect("a preset"), 20_000).expect("figures");
        let work = [summary.losing, summary.all_crossing, summary.bound].map(|work| work.instructions);
        assert!(work.is_sorted() && summary.holding.instructions < summary.all_crossing.instructions, "{name}");
    }
}

#[test]
fn errors_fall_with_the_rate_and_the_typical_one_is_the_smaller() {
    for name in PRESETS {
        let (joint, processor) = (preset(name), Board::emulated().processor());
        let at = |rate| certificate(&joint, rate, Effort::Substeps(2), &processor).expect("a certificate");
        let promises = [20_000, 40_000, 80_000, 160_000]
            .map(|rate| [at(rate).contact_holds, at(rate).contact_changes])
            .into_iter();
        let pairs = promises.clone().zip(promises.skip(1));
        for (slow, fast) in pairs.flat_map(|(slow, fast)| slow.into_iter().zip(fast)) {
            assert!(fast.typical <= slow.typical && fast.nine_in_ten <= slow.nine_in_ten, "{name}");
            assert!(fast.typical < fast.nine_in_ten, "{name}");
        }
    }
}

#[test]
fn text_and_json_say_the_same() {
    let summary = summary(&preset("q1"), &Board::emulated(), 20_000).expect("figures");
    let (text, json) = (layout(&summary), output::json("figures", &summary).expect("finite numbers"));
    let instructions = summary.all_crossing.instructions.to_string();
    assert!(text.contains(&instructions) && json.contains(&instructions), "{text}{json}");
    assert!(json.contains("\"schema\": \"joint-budget/1\""), "{json}");
    assert!(text.contains("fits"), "{text}");
}

#[test]
fn a_rate_that_fits_is_within_the_limits_that_are_told() {
    for name in PRESETS {
        for board in Board::presets().expect("good presets") {
            for rate in [5000, 20_000, 40_000].into_iter().filter(|rate| refuse(&preset(name), &board, *rate).is_ok()) {
                let told = summary(&preset(name), &board, rate).expect("it fits");
                let (lowest, highest) = (told.lowest_rate_Hz, told.highest_rate_Hz);
                assert!(
                    (lowest..=highest).contains(&rate),
                    "{name}, {}: {rate} of {lowest} to {highest}",
                    board.name()
                );
                assert!(refuse(&preset(name), &board, highest).is_ok(), "{name}, {}: {highest}", board.name());
            }
        }
    }
}
