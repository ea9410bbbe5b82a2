//! The report of tests: one HTML page that needs neither network nor scripts, what failed first. Pictures come from
//! `pictures`, the look from the run reports.

mod section;

use maud::{Markup, html};
use section::section;

use super::campaign::Tested;
use super::controller::ControllerName;
use super::record::{NotRun, TestRecord, TestsRecord};
use report::checks::Check;
use report::parts::tile;
use report::plot::unit::figure as number;
use report::shell::page;

/// The whole page.
pub fn render(record: &TestsRecord, tested: &[Tested]) -> String {
    let (failed, passed): (Vec<&Tested>, Vec<&Tested>) = tested.iter().partition(|test| !test.record.passed);
    let title = match (failed.len(), record.not_run.len()) {
        (0, 0) => "passed".to_owned(),
        (0, not_run) => format!("{not_run} not run"),
        (failed, _) => format!("{failed} failed"),
    };
    let body = html! {
        (header(record, failed.len()))
        (tiles(record))
        @if !failed.is_empty() { (failures(record)) }
        @if !record.not_run.is_empty() { (not_run(&record.not_run)) }
        @if tested.len() > 1 { (overview(record)) }
        @for test in failed.iter().chain(&passed) { (section(test)) }
        (origin(record))
        footer { "joint " (record.host_version) " · " (record.schema) " · every figure is in record.json, every run in runs/*.mcap" }
    };
    page(&format!("Tests: {title}"), "", &body)
}

/// What came of a test, as a class and a word: one that asserts nothing has nothing to pass.
fn verdict(test: &TestRecord) -> (&'static str, &'static str) {
    match (test.passed, test.assertions.is_empty()) {
        (false, _) => ("failed", "FAILED"),
        (true, true) => ("open", "ran"),
        (true, false) => ("passed", "passed"),
    }
}

fn pill(test: &TestRecord) -> Markup {
    let (class, word) = verdict(test);
    html! { span class={ "pill " (class) } { (word.to_uppercase()) } }
}

fn header(record: &TestsRecord, failed: usize) -> Markup {
    let nothing_asserted = record.tests.iter().all(|test| test.assertions.is_empty());
    let (class, word) = match (failed, record.not_run.len()) {
        (0, 0) if nothing_asserted => ("open", "RAN, NOTHING ASSERTED".to_owned()),
        (0, 0) => ("passed", "PASSED".to_owned()),
        (0, 1) => ("failed", "1 TEST NOT RUN".to_owned()),
        (0, many) => ("failed", format!("{many} TESTS NOT RUN")),
        (1, _) => ("failed", "1 TEST FAILED".to_owned()),
        (many, _) => ("failed", format!("{many} TESTS FAILED")),
    };
    html! {
        header {
            div.title { h1 { "Observer and compensation" } span class={ "pill " (class) } { (word) } }
            p.subtitle {
                @if record.tests.is_empty() { "Nothing ran" } @else {
                    "On the " (each(record, |test| &test.on)) ", plant " strong { (each(record, |test| &test.plant)) }
                }
                @if record.full { " · full lists of seeds" } " · " (record.date)
            }
        }
    }
}

/// A word of every test, each word once.
fn each(record: &TestsRecord, word: impl Fn(&TestRecord) -> &String) -> String {
    let mut words: Vec<&str> = record.tests.iter().map(|test| word(test).as_str()).collect();
    words.sort_unstable();
    words.dedup();
    words.join(" and ")
}

fn tiles(record: &TestsRecord) -> Markup {
    let tests = &record.tests;
    let passed = tests.iter().filter(|test| test.passed).count();
    let asserted: usize = tests.iter().map(|test| test.assertions.len()).sum();
    let failed: usize = tests.iter().map(|test| test.failed().count()).sum();
    let runs: usize = tests.iter().map(|test| test.runs.len()).sum();
    let of = |part: usize, whole: usize| html! { (part) span.of { " of " (whole) } };
    html! {
        section.tiles {
            (tile(if asserted > 0 { "Tests passed" } else { "Tests ran" }, html! {}, of(passed, tests.len() + record.not_run.len())))
            (tile("Assertions held", html! {}, of(asserted - failed, asserted)))
            (tile("Runs", html! {}, html! { (runs) }))
            (tile("On the clock", html! {}, html! { (number((10.0 * record.seconds).round() / 10.0)) span.of { " s" } }))
        }
    }
}

/// What failed, over all tests, with the line that runs it again.
fn failures(record: &TestsRecord) -> Markup {
    html! {
        section {
            h2 { "What failed" }
            @for test in record.tests.iter().filter(|test| !test.passed) {
                div.notice.bad {
                    strong { (test.file) } @if !test.title.is_empty() { " – " (test.title) }
                    @if let Some(why) = &test.broken { div { "Broken off: " (why) } }
                    @for assertion in test.failed() {
                        div {
                            (assertion.check().name)
                            @match assertion.figure {
                                Some(figure) => { " is " strong { (number(figure)) } (spaced(&assertion.unit)) }
                                None => { " " strong { "could not be had" } }
                            }
                            ", bound " (bound(&assertion.check())) (spaced(&assertion.unit)) @if let Some(seed) = assertion.seed { ", seed " (seed) }
                        }
                    }
                    @for run in &test.runs { @if let Some(why) = &run.refusal {
                        div { "The width probe refused with seed " (run.seed) ": " (why) }
                    } }
                    pre { (test.replay) }
                }
            }
        }
    }
}

/// A unit behind a number.
fn spaced(unit: &str) -> String {
    if unit.is_empty() { String::new() } else { format!(" {unit}") }
}

/// What could not run, and what to do about it.
fn not_run(files: &[NotRun]) -> Markup {
    html! {
        section {
            h2 { "What was not run" }
            @for NotRun { file, why, mend } in files {
                div.notice.bad {
                    strong { (file) }
                    div { (why) }
                    @if let Some(mend) = mend { div { (mend) } }
                }
            }
        }
    }
}

fn bound(check: &Check) -> String {
    use report::checks::Bound;
    match check.bound {
        Bound::AtMost(bound) => format!("≤ {}", number(bound)),
        Bound::AtLeast(bound) => format!("≥ {}", number(bound)),
        Bound::Exactly(bound) => format!("= {}", number(bound)),
        Bound::None => "–".into(),
    }
}

/// One row for each test: with compensation, without, against the best rival.
fn overview(record: &TestsRecord) -> Markup {
    let worst = |test: &TestRecord, controller: ControllerName, impedance: bool| {
        let figure = if impedance { "deviation_rms_mrad" } else { "rms_mrad" };
        test.largest(controller.word(), figure).map_or("–".into(), number)
    };
    html! {
        section {
            h2 { "All tests" }
            p.lead { "Error of the link in mrad RMS, worst of all seeds; of an impedance its deviation from the same law without a gap." }
            table {
                thead { tr { th { "Verdict" } th { "Test" } th.number { "tested" } th.number { "baseline" } th.number { "best rival" } th.number { "seeds" } } }
                tbody { @for test in &record.tests {
                    @let tested = ControllerName::of_word(&test.controller, false);
                    @let impedance = tested.wants_gains();
                    @let (class, word) = verdict(test);
                    tr {
                        td.verdict { span class={ "mark " (class) } { (word) } }
                        td { a href={ "#" (anchor(test)) } { (test.file) } " " span.note { (test.title) } }
                        td.number { (worst(test, tested, impedance)) }
                        td.number { (worst(test, ControllerName::baseline(impedance), impedance)) }
                        td.number { (worst(test, ControllerName::best_rival(impedance), impedance)) }
                        td.number { (test.seeds.len()) }
                    }
                } }
            }
        }
    }
}

fn anchor(test: &TestRecord) -> String {
    test.file.chars().map(|letter| if letter.is_ascii_alphanumeric() { letter } else { '-' }).collect()
}

/// Where it comes from: digests of files and runs.
fn origin(record: &TestsRecord) -> Markup {
    html! {
        section {
            h2 { "Origin" }
            p.lead { (record.host) " · joint " (record.host_version) @if let Some(commit) = &record.git_commit { " · commit " code { (commit) } } }
            details { summary { "Digests of all runs" }
                table {
                    thead { tr { th { "Test" } th { "Controller" } th.number { "Seed" } th { "Digest" } th { "Log" } } }
                    tbody { @for test in &record.tests { @for run in &test.runs {
                        tr {
                            td { (test.file) } td { (run.controller) } td.number { (run.seed) } td { code { (run.digest) } }
                            td { @if let Some(log) = &run.log { a href=(log) { (log) } } @else if let Some(why) = &run.broken { (why) } }
                        }
                    } } }
                }
            }
        }
    }
}
