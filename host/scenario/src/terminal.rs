//! What tests say on a terminal: a line for each as it ends, then every assertion, failed ones first. The report shows the
//! same with more room.

use super::record::{NotRun, TestRecord, TestsRecord};
use report::checks::{Check, Verdict};
use report::table;

/// A test that has ended.
pub fn line(test: &TestRecord) -> String {
    let word = if test.passed { "ok" } else { "FAILED" };
    let held = test.assertions.len() - test.failed().count();
    let of = format!("{held} of {} held", test.assertions.len());
    format!("{word:8} {} ({of}, {} runs, {:.1} s)", test.file, test.runs.len(), test.seconds)
}

/// All tests.
pub fn table(record: &TestsRecord) -> String {
    let mut tests: Vec<&TestRecord> = record.tests.iter().collect();
    tests.sort_by_key(|test| test.passed);
    let mut text = String::new();
    for NotRun { file, why, mend } in &record.not_run {
        text += &format!("NOT RUN  {file}: {why}\n");
        mend.iter().for_each(|mend| text += &format!("         {mend}\n"));
    }
    if !record.not_run.is_empty() {
        text.push('\n');
    }
    for test in tests {
        let seeds = match test.seeds.as_slice() {
            [one] => format!("seed {one}"),
            many => format!("{} seeds", many.len()),
        };
        text += &format!(
            "{}: {} of joint {}, {}, on {}, plant {}, {seeds}\n",
            test.file, test.profile, test.joint, test.controller, test.on, test.plant
        );
        if !test.title.is_empty() {
            text += &format!("  {}\n", test.title);
        }
        if let Some(why) = &test.broken {
            text += &format!("BROKEN   {why}\n");
        }
        let mut checks: Vec<Check> = test.assertions.iter().map(|assertion| assertion.check()).collect();
        checks.sort_by_key(|check| check.verdict != Verdict::Failed);
        text += &table::table(&checks, false);
        if checks.is_empty() {
            let rms = test.largest(&test.controller, "rms_mrad");
            text += &format!(
                "nothing is asserted; error {} mrad RMS at worst\n",
                rms.map_or("-".to_owned(), |rms| format!("{rms:.3}"))
            );
        }
        for run in &test.runs {
            let Some(refusal) = &run.refusal else { continue };
            text += &format!("refused: seed {}: {refusal}\n", run.seed);
        }
        for run in &test.runs {
            let Some(board) = &run.board else { continue };
            text += &format!(
                "board:   {} periods the same in every bit; {} of {} timer counts a period, at most {}; {} overruns; \
                 {} B of stack; image {}\n",
                board.same_periods,
                board.computation_mean,
                board.period_counts,
                board.computation_most,
                board.overruns,
                board.stack_bytes,
                board.elf_sha256.get(..12).unwrap_or("not built here"),
            );
        }
        if !test.passed {
            text += &format!("again:   {}\n", test.replay);
        }
        text.push('\n');
    }
    text
}
