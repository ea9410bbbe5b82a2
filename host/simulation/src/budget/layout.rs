//! Budget as text: one line for each figure, in the units of data sheets.

use super::summary::{BudgetSummary, TickWork};
use report::document::{Sheet, terminal};

/// Budget for a terminal.
pub fn layout(summary: &BudgetSummary) -> String {
    let verdicts = &summary.verdicts;
    let mut page = Sheet::new(format!("{} on {} at {} Hz", summary.joint, verdicts.board, verdicts.rate_Hz));
    step(&mut page, summary);
    work(&mut page, summary);
    memory(&mut page, summary);
    limits(&mut page, summary);
    if let Some(bandwidth) = &summary.bandwidth {
        bandwidth.rows(&mut page);
    }
    verdicts.rows(&mut page);
    terminal(&page.document())
}

fn step(page: &mut Sheet, summary: &BudgetSummary) {
    page.heading("Step");
    page.row("period", format!("{:.2} us", 1e6 / f64::from(summary.verdicts.rate_Hz)));
    page.row("at contact changes", summary.verdicts.substeps_in_words());
    let phase = summary.fastest_mode_phase_rad;
    page.row("fastest mode in one", format!("{phase:.2} rad, unstable from {:.2} on", summary.largest_phase_rad));
}

fn work(page: &mut Sheet, summary: &BudgetSummary) {
    page.heading("Work of a step (instructions of a Cortex-M4F; cycles reckoned, not measured)");
    let of = |work: TickWork| {
        let TickWork { instructions, time_s, part } = work;
        format!("{instructions} instructions, {:.1} us, {:.0} % of the period", 1e6 * time_s, 100.0 * part)
    };
    page.row("contact holds", of(summary.contact_holds));
    page.row("sub-steps, no crossing", of(summary.contact_changes));
    page.row("every mesh crosses twice", of(summary.all_crossing));
    page.row("every mesh in every sub-step", of(summary.bound));
    let megahertz = f64::from(summary.clock_Hz) / 1e6;
    page.row("processor", format!("{megahertz:.0} MHz, {:.1} cycles an instruction", summary.cycles_per_instruction));
}

fn memory(page: &mut Sheet, summary: &BudgetSummary) {
    page.heading("Memory");
    page.row("tables", format!("{} bytes of flash", summary.table_bytes));
    page.row("model", format!("{} bytes of RAM", summary.model_bytes));
}

fn limits(page: &mut Sheet, summary: &BudgetSummary) {
    page.heading("Limits");
    page.row("stable", format!("from {} Hz on", summary.lowest_rate_Hz));
    let duration = 1e6 * summary.unseen_for_s;
    let unseen = match summary.unseen_departure {
        Some(0.0) => "no mesh".to_owned(),
        Some(departure) => {
            format!("for {duration:.1} us and {:.2} of the deflection by its load", departure)
        }
        None => format!("for {duration:.1} us, which is half a period of the fastest mode or more"),
    };
    page.row("may leave and return unseen", unseen);
}
