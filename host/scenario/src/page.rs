//! Report of tests as a document, failures first. The terminal shows every assertion and the command that repeats each
//! failure. Pictures come from `pictures`.

use super::campaign::FinishedTest;
use super::controller::ControllerName;
use super::pictures;
use super::record::{AssertionRecord, BoardRun, NotRun, TestRecord, TestsRecord};
use report::checks::{Check, Verdict};
use report::document::{
    Block, Checks, Details, Document, Notice, PAGES, Section, TERMINALS, Text, Tone, alert, bad_notice, code, link,
    mark, notice, number, numbers, picture, quiet, row, section, section_bare, strong, table, text, tile, whole, words,
};
use report::number::{PAGE, fixed};

/// Columns of the comparison of controllers: name, heading, unit.
const COMPARED_FIGURES: [(&str, &str, &str); 9] = [
    ("rms_mrad", "error RMS", "mrad"),
    ("peak_mrad", "error peak", "mrad"),
    ("reversal_error_mrad", "reversal error", "mrad"),
    ("deviation_rms_mrad", "deviation RMS", "mrad"),
    ("lost_motion_ms", "lost motion", "ms"),
    ("crossings", "crossings", ""),
    ("effort_N_m", "torque effort", "N m"),
    ("peak_mesh_force_N", "peak mesh force", "N"),
    ("peak_mesh_force_ratio", "over rated", ""),
];

/// A finished test in one line.
pub fn line(test: &TestRecord) -> String {
    let word = if test.passed { "ok" } else { "FAILED" };
    let held = test.assertions.len() - test.failed().count();
    let of = format!("{held} of {} held", test.assertions.len());
    format!("{word:8} {} ({of}, {} runs, {:.1} s)", test.file, test.runs.len(), test.seconds)
}

/// Report of all tests.
pub fn document(record: &TestsRecord, tested: &[FinishedTest]) -> Document {
    let (failed, passed): (Vec<&FinishedTest>, Vec<&FinishedTest>) =
        tested.iter().partition(|test| !test.record.passed);
    let title = match (failed.len(), record.not_run.len()) {
        (0, 0) => "passed".to_owned(),
        (0, not_run) => format!("{not_run} not run"),
        (failed, _) => format!("{failed} failed"),
    };
    let mut blocks = vec![tiles(record)];
    if !failed.is_empty() {
        blocks.push(failures(record));
    }
    if !record.not_run.is_empty() {
        blocks.push(section_bare("What was not run", record.not_run.iter().map(not_run_notice).collect()));
    }
    if tested.len() > 1 {
        blocks.push(overview(record));
    }
    blocks.extend(failed.iter().chain(&passed).map(|test| test_section(test)));
    blocks.push(origin(record));
    let on = text("On the ")
        + distinct_words(record, |test| &test.on)
        + ", plant "
        + strong(distinct_words(record, |test| &test.plant));
    Document {
        title: format!("Tests: {title}"),
        heading: "Observer and compensation".into(),
        verdict: Some(overall_verdict(record, failed.len())),
        subtitle: if record.tests.is_empty() { text("Nothing ran") } else { on }
            + record.full.then_some(" · full lists of seeds")
            + " · "
            + &record.date,
        blocks,
        footer: format!(
            "joint {} · {} · every figure is in record.json, every run in runs/*.mcap",
            record.host_version, record.schema
        )
        .into(),
        ..Document::default()
    }
}

fn overall_verdict(record: &TestsRecord, failed: usize) -> (Tone, String) {
    let nothing_asserted = record.tests.iter().all(|test| test.assertions.is_empty());
    match (failed, record.not_run.len()) {
        (0, 0) if nothing_asserted => (Tone::Open, "RAN, NOTHING ASSERTED".to_owned()),
        (0, 0) => (Tone::Passed, "PASSED".to_owned()),
        (0, 1) => (Tone::Failed, "1 TEST NOT RUN".to_owned()),
        (0, many) => (Tone::Failed, format!("{many} TESTS NOT RUN")),
        (1, _) => (Tone::Failed, "1 TEST FAILED".to_owned()),
        (many, _) => (Tone::Failed, format!("{many} TESTS FAILED")),
    }
}

/// Verdict of a test; a test without assertions has merely run.
fn verdict(test: &TestRecord) -> (Tone, &'static str) {
    match (test.passed, test.assertions.is_empty()) {
        (false, _) => (Tone::Failed, "FAILED"),
        (true, true) => (Tone::Open, "ran"),
        (true, false) => (Tone::Passed, "passed"),
    }
}

/// Distinct words of all tests.
fn distinct_words(record: &TestsRecord, word: impl Fn(&TestRecord) -> &String) -> String {
    let mut words: Vec<&str> = record.tests.iter().map(|test| word(test).as_str()).collect();
    words.sort_unstable();
    words.dedup();
    words.join(" and ")
}

fn tiles(record: &TestsRecord) -> Block {
    let tests = &record.tests;
    let passed = tests.iter().filter(|test| test.passed).count();
    let asserted: usize = tests.iter().map(|test| test.assertions.len()).sum();
    let failed: usize = tests.iter().map(|test| test.failed().count()).sum();
    let runs: usize = tests.iter().map(|test| test.runs.len()).sum();
    let of = |part: usize, whole: usize| text(part) + quiet(format!(" of {whole}"));
    let all = tests.len() + record.not_run.len();
    Block::Tiles(vec![
        tile(if asserted > 0 { "Tests passed" } else { "Tests ran" }, of(passed, all)),
        tile("Assertions held", of(asserted - failed, asserted)),
        tile("Runs", text(runs)),
        tile("On the clock", number((10.0 * record.seconds).round() / 10.0) + quiet(" s")),
    ])
}

/// Failures of all tests, with the commands that repeat them.
fn failures(record: &TestsRecord) -> Block {
    let failure_notice = |test: &TestRecord| {
        let title = (!test.title.is_empty()).then(|| format!(" – {}", test.title));
        let broken = test.broken.iter().map(|why| format!("Broken off: {why}").into());
        let refused = test.runs.iter().filter_map(|run| {
            let why = run.refusal.as_ref()?;
            Some(format!("The width probe refused with seed {}: {why}", run.seed).into())
        });
        let more = broken.chain(test.failed().map(failure_text)).chain(refused).map(Block::Paragraph);
        let more = more.chain([Block::Again(test.replay.clone())]).collect();
        Block::Notice(Notice { tone: Tone::Failed, alert: false, text: strong(&test.file) + title, more })
    };
    section("What failed", record.tests.iter().filter(|test| !test.passed).map(failure_notice).collect())
}

fn failure_text(assertion: &AssertionRecord) -> Text {
    let check = assertion.check();
    let unit = if assertion.unit.is_empty() { String::new() } else { format!(" {}", assertion.unit) };
    let found = match assertion.figure {
        Some(figure) => text(" is ") + strong(PAGE.write(figure)) + &unit,
        None => text(" ") + strong("could not be had"),
    };
    let bound =
        check.bound.sign_and_value().map_or_else(|| text("–"), |(sign, bound)| text(sign) + " " + number(bound));
    let seed = assertion.seed.map(|seed| format!(", seed {seed}"));
    text(check.name) + found + ", bound " + bound + &unit + seed
}

/// A file that could not run, with its remedy.
fn not_run_notice(NotRun { file, why, remedy }: &NotRun) -> Block {
    let more = remedy.iter().map(|remedy| Block::Paragraph(remedy.into())).collect();
    let text = strong("NOT RUN") + format!(" {file}: {why}");
    Block::Notice(Notice { tone: Tone::Failed, alert: false, text, more })
}

/// One row for each test: with compensation, without, and the best rival.
fn overview(record: &TestsRecord) -> Block {
    let heads = ["tested", "baseline", "best rival", "seeds"].map(numbers);
    let columns = [words("Verdict"), words("Test")].into_iter().chain(heads).collect();
    let rows = record.tests.iter().map(|test| {
        let tested = ControllerName::from_word(&test.controller, false);
        let impedance = tested.wants_gains();
        let worst = |controller: ControllerName| {
            let figure = if impedance { "deviation_rms_mrad" } else { "rms_mrad" };
            test.largest(controller.word(), figure).map_or("–".into(), number)
        };
        let (tone, word) = verdict(test);
        row([
            mark(tone, word),
            link(format!("#{}", anchor(test)), &test.file) + " " + quiet(&test.title),
            worst(tested),
            worst(ControllerName::baseline(impedance)),
            worst(ControllerName::best_rival(impedance)),
            text(test.seeds.len()),
        ])
    });
    let lead = "Error of the link in mrad RMS, worst of all seeds; of an impedance its deviation from the same law \
                without a gap.";
    section("All tests", vec![Block::Lead(lead.into()), table(columns, rows.collect())])
}

fn anchor(test: &TestRecord) -> String {
    test.file.chars().map(|letter| if letter.is_ascii_alphanumeric() { letter } else { '-' }).collect()
}

/// Section of one test.
fn test_section(tested: &FinishedTest) -> Block {
    let test = &tested.record;
    let (tone, word) = verdict(test);
    let title = (!test.title.is_empty()).then(|| strong(&test.title) + " · ");
    let faults: String = test.faults.iter().map(|fault| format!(" · fault {fault}")).collect();
    let subtitle = Text::from(title)
        + format!(
            "joint {} · profile {} · controller {} · {} s, figures from {} s on{faults}",
            test.joint,
            test.profile,
            test.controller,
            PAGE.write(test.duration_s),
            PAGE.write(test.settle_s)
        );
    let seeds = match test.seeds.as_slice() {
        [seed] => format!("seed {seed}"),
        many => format!("{} seeds", many.len()),
    };
    let line = format!(
        "{}: {} of joint {}, {}, on {}, plant {}, {seeds}",
        test.file, test.profile, test.joint, test.controller, test.on, test.plant
    );
    let mut checks: Vec<Check> = test.assertions.iter().map(AssertionRecord::check).collect();
    checks.sort_by_key(|check| check.verdict != Verdict::Failed);
    let mut blocks = vec![Block::Only(TERMINALS, vec![Block::Paragraph(text("  ") + &test.title)])];
    if let Some(bandwidth) = &test.bandwidth {
        let words = format!("bandwidth {}", bandwidth.in_words());
        blocks.push(Block::Only(TERMINALS, vec![Block::Paragraph(text("  ") + &words)]));
        blocks.push(Block::Only(PAGES, vec![Block::Note(words.into())]));
    }
    blocks.extend(test.broken.as_ref().map(|why| alert(strong("BROKEN") + " off: " + why)));
    blocks.push(if checks.is_empty() {
        let rms = test.largest(&test.controller, "rms_mrad").map_or("–".to_owned(), |rms| fixed(3).write(rms));
        Block::Paragraph(format!("no assertions; worst error {rms} mrad RMS").into())
    } else {
        Block::Checks(Checks { checks, emulated: false, keys: true })
    });
    blocks.push(Block::Only(TERMINALS, run_notes(test)));
    blocks.push(Block::Only(PAGES, vec![comparison_table(test), picture_section(tested)]));
    let again = Block::Again(test.replay.clone());
    blocks.push(if test.passed { Block::Only(PAGES, vec![again]) } else { again });
    Block::Section(Section {
        heading: text(&test.file),
        anchor: anchor(test),
        verdict: Some((tone, word.to_uppercase())),
        subtitle,
        line: Some(line.into()),
        blocks,
    })
}

/// Notes of the runs: refusals, and the load of boards.
fn run_notes(test: &TestRecord) -> Vec<Block> {
    let refused = test.runs.iter().filter_map(|run| {
        let refusal = run.refusal.as_ref()?;
        Some(bad_notice(strong("refused:") + format!(" seed {}: {refusal}", run.seed)))
    });
    let boards = test.runs.iter().filter_map(|run| run.board.as_ref()).map(board);
    refused.chain(boards).collect()
}

fn board(board: &BoardRun) -> Block {
    notice(
        strong("board:")
            + format!(
                " {} periods the same in every bit; {} of {} timer counts a period, at most {}; {} overruns; \
                 {} B of stack; image {}",
                board.same_periods,
                board.computation_mean,
                board.period_counts,
                board.computation_most,
                board.overruns,
                board.stack_bytes,
                board.elf_sha256.get(..12).unwrap_or("not built here"),
            ),
    )
}

/// Figures of every controller, worst of all seeds.
fn comparison_table(test: &TestRecord) -> Block {
    let controllers = test.controllers();
    let had = |name: &str| controllers.iter().any(|controller| test.largest(controller, name).is_some());
    let shown: Vec<_> = COMPARED_FIGURES.into_iter().filter(|(name, _, _)| had(name)).collect();
    let heads = shown.iter().map(|(_, heading, unit)| numbers(*heading).in_unit(unit));
    let columns = [words("Controller")].into_iter().chain(heads).collect();
    let rows = controllers.iter().map(|controller| {
        let name = whole(ControllerName::from_word(controller, false).label());
        let figures = shown.iter().map(|(figure, _, _)| test.largest(controller, figure).map_or("–".into(), number));
        row([name].into_iter().chain(figures))
    });
    let mut blocks = vec![Block::Heading("With compensation and without".into()), table(columns, rows.collect())];
    if test.seeds.len() > 1 {
        blocks.push(Block::Note(format!("Largest of {} seeds.", test.seeds.len()).into()));
    }
    Block::Only(PAGES, blocks)
}

/// Pictures, collapsed if the test has passed.
fn picture_section(tested: &FinishedTest) -> Block {
    let test = &tested.record;
    let from = || number(test.settle_s);
    let all = pictures::whole_run(tested).map(|figure| {
        let caption = format!(
            "Seed {}, least and greatest error of each stretch; lost motion is the time that each crossing took. Figures \
             are taken from ",
            test.shown_seed
        );
        picture(figure, text(caption) + from() + " s on.")
    });
    let close = pictures::crossing(tested).map(|figure| {
        let caption = strong("Closely: ") + "the longest crossing of the gap after " + from();
        picture(figure, caption + " s, a point each millisecond.")
    });
    let blocks: Vec<Block> = all.into_iter().chain(close).collect();
    if !test.passed {
        return Block::Only(PAGES, blocks);
    }
    Block::Details(Details { summary: format!("Pictures, seed {}", test.shown_seed).into(), open: false, blocks })
}

/// Origin of the results: digests of files and runs.
fn origin(record: &TestsRecord) -> Block {
    let commit = record.git_commit.as_ref().map(|commit| text(" · commit ") + code(commit));
    let lead = text(format!("{} · joint {}", record.host, record.host_version)) + commit;
    let columns = vec![words("Test"), words("Controller"), numbers("Seed"), words("Digest"), words("Log")];
    let rows = record.tests.iter().flat_map(|test| {
        test.runs.iter().map(|run| {
            let log = run.log.as_ref().map(|log| link(log, log));
            let log = log.or_else(|| run.broken.as_ref().map(text)).unwrap_or_default();
            row([text(&test.file), text(&run.controller), run.seed.to_string().into(), code(&run.digest), log])
        })
    });
    let blocks = vec![table(columns, rows.collect())];
    let digests = Block::Details(Details { summary: "Digests of all runs".into(), open: false, blocks });
    section("Origin", vec![Block::Lead(lead), digests])
}
