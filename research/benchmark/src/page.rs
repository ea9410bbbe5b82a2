//! The comparison as a document: for a page, for a Markdown file, and, with every method at every step, for a terminal. Only units are
//! computed here.

use comparison::method::Method;
use comparison::run::AS_DESIGNED;

use super::BenchmarkRecord;
use super::in_a_sample::{Best, INSTRUCTIONS, InASample, REQUIRED, SAMPLE_RATE};
use super::method_results::{CaseRecord, MethodResult, StepResult};
use super::pictures;
use super::verdicts::{AtError, CLOCK_RATE, CYCLES_PER_INSTRUCTION, ERROR_LEVELS, InBudget, pareto_front};
use report::document::{
    Block, Details, Document, Medium, PAGES, Picture, Row, Text, facts, indexed, notice, numbers, row, section, strong,
    table, text, words,
};
use report::number::{SCIENTIFIC, fixed, powers_of_ten};
use report::plot::Figure;
use report::provenance::VERSION;

/// All media except Markdown files, which show the conclusions only.
const WITH_STEPS: &[Medium] = &[Medium::Page, Medium::Terminal];
/// Markdown files, which have one table for all cases.
const FILES: &[Medium] = &[Medium::Markdown];
/// All media except pages, which show the provenance elsewhere.
const LINES: &[Medium] = &[Medium::Terminal, Medium::Markdown];

/// The whole document.
pub fn document(figures: &BenchmarkRecord) -> Document {
    let mut blocks = vec![Block::Only(LINES, vec![Block::Paragraph(provenance(figures))])];
    blocks.extend(figures.cases.iter().map(|case| case_section(figures, case)));
    let instructions = by_case(&figures.cases, &figures.at_equal_error, &ERROR_LEVELS, million);
    blocks.push(Block::Only(FILES, vec![section("Instructions for a second of the joint", instructions)]));
    blocks.push(Block::Only(WITH_STEPS, vec![budget(figures), rounding(figures)]));
    blocks.extend(host(figures));
    blocks.push(Block::Only(PAGES, vec![origin(figures)]));
    Document {
        title: "Error against cost".into(),
        heading: "Error against cost".into(),
        subtitle: text("This step beside the methods that people use · instructions counted on the ")
            + strong("EMULATED")
            + " Cortex-M4F · error is the worst over phases of the excitation",
        blocks,
        footer: text("joint ") + VERSION,
        ..Document::default()
    }
}

/// File name of a case's picture, without its extension.
pub fn picture_name(case: &CaseRecord) -> String {
    format!("error-by-cost-{}", case.key.to_lowercase())
}

fn provenance(figures: &BenchmarkRecord) -> Text {
    let origin = &figures.origin;
    text("Instructions: ")
        + strong("EMULATED")
        + format!(
            " Cortex-M4F ({}), counted exactly, call of the step included; {}, {}.\n\
             Cycles: {CYCLES_PER_INSTRUCTION} an instruction, budgets of a {:.0} MHz core; nothing here was measured on silicon.\n\
             Every method came to the same bits on the emulated core as on the host, where its error was measured.\n\
             Host times: processor time on {}. Commit {}, {}.",
            origin.emulator,
            origin.compiler,
            origin.flags,
            CLOCK_RATE / 1e6,
            origin.host,
            origin.commit,
            origin.date
        )
}

/// Two digits and a power of ten, or `lost` for a diverged motion.
fn scientific(value: Option<f64>) -> String {
    value.map_or_else(|| "lost".into(), |value| SCIENTIFIC.write(value))
}

fn drawn(figure: Option<Figure>, file: String) -> Option<Block> {
    Some(Block::Picture(Picture { figures: vec![figure?], caption: Text::default(), file }))
}

fn case_section(figures: &BenchmarkRecord, case: &CaseRecord) -> Block {
    let lead = format!(
        "Error: {}; worst of {} phases, {:.4} s. A start moved by a millionth of b_c moves the reference by {}.{}",
        case.measure,
        case.phases,
        case.duration_s,
        scientific(Some(case.sensitivity)),
        windows(case)
    );
    let mut blocks = vec![Block::Lead(indexed(&lead))];
    blocks.extend(drawn(pictures::board(case, &figures.methods), picture_name(case)));
    let steps =
        Details { summary: "Every method at every step".into(), open: false, blocks: vec![steps(figures, case)] };
    blocks.push(Block::Only(WITH_STEPS, vec![Block::Details(steps)]));
    let found: Vec<&InASample> = figures.in_a_sample.iter().filter(|one| one.case == case.key).collect();
    if !found.is_empty() {
        blocks.extend(in_a_sample(&found));
    }
    let reached: Vec<&AtError> = figures.at_equal_error.iter().filter(|at| at.case == case.key).collect();
    if reached.iter().any(|at| at.cost.is_some()) {
        let lead = "Instructions for a second of the joint at equal error, and over those of this step:";
        let table = equal(&reached, million);
        blocks.push(Block::Only(WITH_STEPS, vec![Block::Paragraph(lead.into()), table]));
    }
    section(format!("Case {}: {}", case.key, case.title), blocks)
}

/// Sentence about the windows of a case.
fn windows(case: &CaseRecord) -> String {
    if case.windows == 1 {
        return String::new();
    }
    format!(
        " Judged in {} windows: where torques jump, every method restarts from the reference's state.",
        case.windows
    )
}

/// Table of every method at every step.
fn steps(figures: &BenchmarkRecord, case: &CaseRecord) -> Block {
    let heads =
        ["kHz", "h omega_n", "error", "link RMS", "link worst", "peak force", "instr/step", "worst", "M instr/s"];
    let columns = [words("method")].into_iter().chain(heads.map(numbers)).collect();
    let entries = figures.methods.iter().filter(|entry| entry.case == case.key);
    let rows = entries.flat_map(|entry| displayed_steps(entry).into_iter().map(|mark| step(entry, mark)));
    table(columns, rows.collect())
}

fn step(entry: &MethodResult, mark: &StepResult) -> Row {
    row([
        entry.name.to_owned(),
        match mark.substeps {
            AS_DESIGNED => format!("{}, as designed", mark.rate_Hz / 1000),
            1 => format!("{}", mark.rate_Hz / 1000),
            substeps => format!("{} x {substeps}", mark.rate_Hz / 1000),
        },
        fixed(3).write(mark.step),
        if entry.method.has_meshes() { scientific(mark.error) } else { "-".into() },
        scientific(mark.link_rms),
        scientific(mark.link_worst),
        scientific(mark.peak_force),
        fixed(0).write(mark.instructions),
        mark.instructions_most.to_string(),
        fixed(1).write(mark.cost() / 1e6),
    ])
}

/// Steps shown in a table: for this step the Pareto front, otherwise every other step of a long list, with the coarsest and the finest.
fn displayed_steps(entry: &MethodResult) -> Vec<&StepResult> {
    let best = pareto_front(entry.series().into_iter().flatten().collect());
    let last = entry.marks.len().saturating_sub(1);
    let every = if entry.marks.len() > 8 { 2 } else { 1 };
    let wanted = |(index, mark): &(usize, &StepResult)| match entry.method {
        Method::Realtime => mark.error.is_some_and(|error| best.contains(&(mark.cost(), error))),
        _ => index % every == 0 || *index == last,
    };
    let mut marks: Vec<&StepResult> = entry.marks.iter().enumerate().filter(wanted).map(|(_, mark)| mark).collect();
    marks.sort_by(|a, b| a.cost().total_cmp(&b.cost()));
    marks
}

/// Results of all methods within one sample.
fn in_a_sample(found: &[&InASample]) -> [Block; 2] {
    let [rms, worst, peak] = REQUIRED;
    let lead = format!(
        "Every method at its best in at most {INSTRUCTIONS:.0} instructions a sample (mean) at {} kHz. Required: link angle \
         within {} RMS and {} worst of the lost motion, peak mesh force within {:.0} %. Last column: instructions a sample \
         at the RMS error of this step.",
        SAMPLE_RATE / 1000,
        powers_of_ten(0).write(rms),
        powers_of_ten(0).write(worst),
        100.0 * peak,
    );
    let heads = ["steps", "link RMS", "link worst", "peak force", "instr/sample", "worst"].map(numbers);
    let last = [words("all kept"), numbers("at equal RMS")];
    let columns = [words("method")].into_iter().chain(heads).chain(last).collect();
    let rows = found.iter().map(|one| {
        let of = |cell: &dyn Fn(&Best) -> String| one.best.as_ref().map_or_else(|| "-".to_owned(), cell);
        let steps = |best: &Best| best.steps.map_or_else(|| "as designed".into(), |steps| steps.to_string());
        row([
            one.name.to_owned(),
            one.best.as_ref().map_or_else(|| "none follows".into(), steps),
            of(&|best| scientific(Some(best.link_rms))),
            of(&|best| scientific(Some(best.link_worst))),
            of(&|best| format!("{} %", fixed(1).write(100.0 * best.peak_force))),
            of(&|best| fixed(0).write(best.instructions)),
            of(&|best| best.instructions_most.to_string()),
            of(&|best| if best.meets_requirements() { "yes" } else { "no" }.into()),
            one.at_equal_error.map_or_else(|| "not reached".into(), |cost| fixed(0).write(cost)),
        ])
    });
    [Block::Paragraph(lead.into()), table(columns, rows.collect())]
}

/// Millions of instructions.
fn million(cost: f64) -> String {
    format!("{} M", fixed(1).write(cost / 1e6))
}

/// Milliseconds of a time in seconds.
fn milliseconds(cost: f64) -> String {
    format!("{} ms", fixed(2).write(1e3 * cost))
}

/// Tables with one level of error each and one column a case: costs of this step, ratios of the other methods to it.
fn by_case(cases: &[CaseRecord], found: &[AtError], levels: &[f64], cost: impl Fn(f64) -> String) -> Vec<Block> {
    if found.is_empty() {
        return Vec::new();
    }
    let mut names: Vec<&str> = Vec::new();
    for at in found {
        if !names.contains(&at.name.as_str()) {
            names.push(&at.name);
        }
    }
    let keys: Vec<&str> =
        cases.iter().map(|case| case.key.as_str()).filter(|key| found.iter().any(|at| at.case == *key)).collect();
    let cell = |name: &str, key: &str, level: f64| {
        let at = found.iter().find(|at| at.name == name && at.case == key && at.error.total_cmp(&level).is_eq());
        match at.and_then(|at| Some((at.cost?, at.ratio))) {
            Some((_, Some(ratio))) if !name.starts_with("this step") => fixed(2).write(ratio),
            Some((found, _)) => cost(found),
            None => "not reached".into(),
        }
    };
    let level = |&level: &f64| {
        let lead = format!("Error {}, other methods over this step:", powers_of_ten(0).write(level));
        let columns = [words("method")].into_iter().chain(keys.iter().map(|key| numbers(*key))).collect();
        let line =
            |name: &&str| row([(*name).to_owned()].into_iter().chain(keys.iter().map(|key| cell(name, key, level))));
        [Block::Paragraph(lead.into()), table(columns, names.iter().map(line).collect())]
    };
    levels.iter().flat_map(level).collect()
}

/// Table with one row a method and two columns for each error level.
fn equal(found: &[&AtError], cost: impl Fn(f64) -> String) -> Block {
    let mut rows: Vec<Vec<String>> = Vec::new();
    for at in found {
        let cells = [
            at.cost.map_or_else(|| "not reached".into(), &cost),
            at.ratio.map_or_else(|| "-".into(), |ratio| fixed(2).write(ratio)),
        ];
        match rows.last_mut().filter(|row| row[0] == at.name) {
            Some(row) => row.extend(cells),
            None => rows.push(std::iter::once(at.name.clone()).chain(cells).collect()),
        }
    }
    let levels = ERROR_LEVELS.map(|level| [numbers(format!("at {}", powers_of_ten(0).write(level))), numbers("ratio")]);
    let columns = [words("method")].into_iter().chain(levels.into_iter().flatten()).collect();
    table(columns, rows.into_iter().map(row).collect())
}

fn budget(figures: &BenchmarkRecord) -> Block {
    let cells = |found: &InBudget| {
        let none = || "-".to_owned();
        let cycles = |cycles: Option<f64>| cycles.map_or_else(none, |cycles| fixed(0).write(cycles));
        vec![
            found.case.clone(),
            format!("{} kHz", found.sample_rate_Hz / 1000),
            found.name.to_owned(),
            found.error.map_or_else(|| "none fits".into(), |error| SCIENTIFIC.write(error)),
            found.steps.map_or_else(none, |steps| steps.to_string()),
            cycles(found.cycles),
            cycles(found.cycles_most),
        ]
    };
    let mut rows: Vec<Vec<String>> = figures.in_budget.iter().map(cells).collect();
    rows.sort_by_key(|row| (figures.cases.iter().position(|case| case.key == row[0]), row[1].clone()));
    let columns = vec![
        words("case"),
        numbers("samples"),
        words("method"),
        numbers("error"),
        numbers("steps"),
        numbers("cycles, mean"),
        numbers("worst"),
    ];
    let lead = Block::Lead("The worst sample may take 1.5 times the budget.".into());
    section(
        format!("Least error within half a {:.0} MHz core", CLOCK_RATE / 1e6),
        vec![lead, table(columns, rows.into_iter().map(row).collect())],
    )
}

fn rounding(figures: &BenchmarkRecord) -> Block {
    let rows = figures.rounding.iter().map(|found| {
        let errors = [found.single, found.double, found.rounding].map(|error| SCIENTIFIC.write(error));
        row([found.case.clone(), fixed(4).write(found.step)].into_iter().chain(errors))
    });
    let heads = ["h omega_n", "f32", "f64", "rounding"].map(numbers);
    let columns = [words("case")].into_iter().chain(heads).collect();
    section("f32 beside f64, this step", vec![table(columns, rows.collect())])
}

fn host(figures: &BenchmarkRecord) -> Option<Block> {
    let host = figures.host.as_ref()?;
    let lead = "Milliseconds for a second of the joint, least of several rounds of one process; each library at its best \
                tolerance, all over the same compiled right-hand side.";
    let mut blocks = vec![Block::Lead(lead.into())];
    if let Some(reason) = &host.without_cvode {
        blocks.push(notice(strong("CVODE is not among them") + ": " + reason + "."));
    }
    blocks.push(Block::Only(
        FILES,
        by_case(&figures.cases, &figures.host_at_equal_error, &ERROR_LEVELS[..1], milliseconds),
    ));
    for case in &figures.cases {
        let found: Vec<&AtError> = figures.host_at_equal_error.iter().filter(|at| at.case == case.key).collect();
        let picture = drawn(pictures::host(case, &host.times), String::new());
        let mut parts = Vec::new();
        if !found.is_empty() || picture.is_some() {
            parts.push(Block::Paragraph(format!("Case {}:", case.key).into()));
        }
        parts.extend(picture);
        if !found.is_empty() {
            parts.push(equal(&found, milliseconds));
        }
        blocks.push(Block::Only(WITH_STEPS, parts));
    }
    Some(section("Host: processor time at equal error", blocks))
}

fn origin(figures: &BenchmarkRecord) -> Block {
    let origin = &figures.origin;
    let rows = [
        ("Board", &origin.emulator),
        ("Compiler", &origin.compiler),
        ("Flags", &origin.flags),
        ("Host", &origin.host),
        ("Source commit", &origin.commit),
        ("Date", &origin.date),
    ];
    section("What ran", vec![facts(rows)])
}
