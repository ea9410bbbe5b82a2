//! The figures as Markdown tables, aligned so that a terminal shows them as well as a page does. Nothing is computed here
//! but units.

use std::fmt::Write as _;

use contest::method::Method;
use contest::run::AS_DESIGNED;

use super::Figures;
use super::columns::{scientific, table};
use super::in_a_sample::{self, InASample};
use super::lineup::{CaseFigures, Entry, Mark};
use super::verdicts::{AtError, CLOCK, CYCLES, InBudget, LEVELS, front};

/// How much is shown.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Detail {
    /// Every method at every step, too.
    Steps,
    /// What follows from them.
    Conclusions,
}

/// All tables, ending with a newline.
pub fn layout(figures: &Figures, detail: Detail) -> String {
    let mut text = origin(figures);
    for case in &figures.cases {
        text += &case_tables(figures, case, detail);
    }
    text += &budget(figures);
    text += &rounding(figures);
    text += &host(figures);
    text
}

fn origin(figures: &Figures) -> String {
    let origin = &figures.origin;
    format!(
        "Instructions: **EMULATED** Cortex-M4F ({}), counted exactly, call of the step included; {}, {}.\n\
         Cycles: {CYCLES} an instruction, budgets of a {:.0} MHz core; nothing here was measured on silicon.\n\
         Every method came to the same bits on the emulated core as on the host, where its error was measured.\n\
         Host times: processor time on {}. Commit {}, {}.\n",
        origin.emulator,
        origin.compiler,
        origin.flags,
        CLOCK / 1e6,
        origin.host,
        origin.commit,
        origin.date
    )
}

fn case_tables(figures: &Figures, case: &CaseFigures, detail: Detail) -> String {
    let mut text = format!(
        "\n### Case {}: {}\n\nError: {}; worst of {} phases, {:.4} s. A start moved by a millionth of b_c moves the \
         reference itself by {}.{}\n\n",
        case.key,
        case.title,
        case.measure,
        case.phases,
        case.duration_s,
        scientific(Some(case.sensitivity)),
        windows(case)
    );
    if detail == Detail::Steps {
        text += &steps(figures, case);
    }
    let found: Vec<&InASample> = figures.in_a_sample.iter().filter(|one| one.case == case.key).collect();
    if !found.is_empty() {
        text += &in_a_sample::layout(&found);
    }
    let reached: Vec<&AtError> = figures.at_equal_error.iter().filter(|at| at.case == case.key).collect();
    if reached.iter().any(|at| at.cost.is_some()) {
        text += "\nInstructions for a second of the joint at equal error, and over those of this step:\n\n";
        text += &equal(&reached, |cost| format!("{:.1} M", cost / 1e6));
    }
    text
}

/// What windows there are, as a sentence after another.
pub fn windows(case: &CaseFigures) -> String {
    if case.windows == 1 {
        return String::new();
    }
    format!(
        " The motion is judged in {} windows: wherever torques jump, every method is put back into the reference's state, as \
         else the smallest error decides in the end where in its gap the joint goes on.",
        case.windows
    )
}

/// Every method at every step.
fn steps(figures: &Figures, case: &CaseFigures) -> String {
    let entries: Vec<&Entry> = figures.methods.iter().filter(|entry| entry.case == case.key).collect();
    let mut rows = Vec::new();
    for entry in &entries {
        for mark in shown(entry) {
            rows.push(vec![
                entry.name.to_owned(),
                match mark.substeps {
                    AS_DESIGNED => format!("{}, as designed", mark.rate_Hz / 1000),
                    1 => format!("{}", mark.rate_Hz / 1000),
                    substeps => format!("{} x {substeps}", mark.rate_Hz / 1000),
                },
                format!("{:.3}", mark.step),
                if entry.method.has_meshes() { scientific(mark.error) } else { "-".into() },
                scientific(mark.link_rms),
                scientific(mark.link_worst),
                scientific(mark.peak_force),
                format!("{:.0}", mark.instructions),
                mark.instructions_most.to_string(),
                format!("{:.1}", mark.cost() / 1e6),
            ]);
        }
    }
    let heads = [
        "method",
        "kHz",
        "h omega_n",
        "error",
        "link RMS",
        "link worst",
        "peak force",
        "instr/step",
        "worst",
        "M instr/s",
    ];
    table(&heads, &rows)
}

/// Steps that a table shows: of this step those that no other one undercuts, else every other one of a long list, the
/// coarsest and the finest always.
fn shown(entry: &Entry) -> Vec<&Mark> {
    let best = front(entry.series().into_iter().flatten().collect());
    let last = entry.marks.len().saturating_sub(1);
    let every = if entry.marks.len() > 8 { 2 } else { 1 };
    let wanted = |(index, mark): &(usize, &Mark)| match entry.method {
        Method::Realtime => mark.error.is_some_and(|error| best.contains(&(mark.cost(), error))),
        _ => index % every == 0 || *index == last,
    };
    let mut marks: Vec<&Mark> = entry.marks.iter().enumerate().filter(wanted).map(|(_, mark)| mark).collect();
    marks.sort_by(|a, b| a.cost().total_cmp(&b.cost()));
    marks
}

/// One row a contestant, two columns a level of error.
fn equal(found: &[&AtError], cost: impl Fn(f64) -> String) -> String {
    let mut rows: Vec<Vec<String>> = Vec::new();
    for at in found {
        let cells = [
            at.cost.map_or_else(|| "not reached".into(), &cost),
            at.ratio.map_or_else(|| "-".into(), |ratio| format!("{ratio:.2}")),
        ];
        match rows.last_mut().filter(|row| row[0] == at.name) {
            Some(row) => row.extend(cells),
            None => rows.push(std::iter::once(at.name.clone()).chain(cells).collect()),
        }
    }
    let levels = LEVELS.map(|level| [format!("at {level:.0e}"), "ratio".into()]);
    let heads: Vec<String> = std::iter::once("method".into()).chain(levels.into_iter().flatten()).collect();
    table(&heads, &rows)
}

fn budget(figures: &Figures) -> String {
    let mut text = format!(
        "\n### Least error within half a {:.0} MHz core\n\nThe worst sample may take 1.5 times the budget.\n\n",
        CLOCK / 1e6
    );
    let row = |found: &InBudget| {
        let none = || "-".to_owned();
        vec![
            found.case.clone(),
            format!("{} kHz", found.sample_rate_Hz / 1000),
            found.name.to_owned(),
            found.error.map_or_else(|| "none fits".into(), |error| scientific(Some(error))),
            found.steps.map_or_else(none, |steps| steps.to_string()),
            found.cycles.map_or_else(none, |cycles| format!("{cycles:.0}")),
            found.cycles_most.map_or_else(none, |cycles| format!("{cycles:.0}")),
        ]
    };
    let mut rows: Vec<Vec<String>> = figures.in_budget.iter().map(row).collect();
    rows.sort_by_key(|row| (figures.cases.iter().position(|case| case.key == row[0]), row[1].clone()));
    text += &table(&["case", "samples", "method", "error", "steps", "cycles, mean", "worst"], &rows);
    text
}

fn rounding(figures: &Figures) -> String {
    let rows: Vec<Vec<String>> = figures
        .rounding
        .iter()
        .map(|found| {
            vec![
                found.case.clone(),
                format!("{:.4}", found.step),
                scientific(Some(found.single)),
                scientific(Some(found.double)),
                scientific(Some(found.rounding)),
            ]
        })
        .collect();
    let heads = ["case", "h omega_n", "f32", "f64", "rounding"];
    format!("\n### f32 beside f64, this step\n\n{}", table(&heads, &rows))
}

fn host(figures: &Figures) -> String {
    let Some(host) = &figures.host else { return String::new() };
    let mut text = String::from(
        "\n### Host: processor time at equal error\n\nMilliseconds for a second of the joint, least of several rounds of one \
         process; each library at its best tolerance, all over the same compiled right-hand side.\n",
    );
    if let Some(reason) = &host.without_cvode {
        let _ = writeln!(text, "\n**CVODE is not among them**: {reason}.");
    }
    for case in &figures.cases {
        let found: Vec<&AtError> = figures.host_at_equal_error.iter().filter(|at| at.case == case.key).collect();
        if !found.is_empty() {
            let _ = write!(text, "\nCase {}:\n\n{}", case.key, equal(&found, |cost| format!("{:.2} ms", 1e3 * cost)));
        }
    }
    text
}
