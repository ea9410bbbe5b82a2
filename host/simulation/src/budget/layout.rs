//! The certificate as text for a person: one line each, in the units that data sheets use.

use super::figures::{Error, Figures, Work};
use report::document::{Sheet, terminal};

/// All of it, as a terminal shows it.
pub fn layout(figures: &Figures) -> String {
    let mut page = Sheet::new(format!("{} on {} at {} Hz", figures.joint, figures.board, figures.rate_Hz));
    step(&mut page, figures);
    error(&mut page, figures);
    work(&mut page, figures);
    memory(&mut page, figures);
    limits(&mut page, figures);
    page.heading("Verdict");
    page.row("", verdict(figures));
    terminal(&page.document())
}

fn step(page: &mut Sheet, figures: &Figures) {
    page.heading("Step");
    page.row("period", format!("{:.2} us", 1e6 / f64::from(figures.rate_Hz)));
    let method = if figures.method == "leaps" { "leapfrog sub-steps" } else { "corrected sub-steps" };
    page.row("at contact changes", format!("{} {method}", figures.parts));
    let phase = figures.fastest_mode_phase_rad;
    page.row("fastest mode in one", format!("{phase:.2} rad, unstable from {:.2} on", figures.largest_phase_rad));
}

fn error(page: &mut Sheet, figures: &Figures) {
    page.heading("Error of mesh deflections, RMS over the motion's standard deviation");
    let promise =
        |error: Error| format!("{:.1e} typical, {:.1e} in nine motions of ten", error.typical, error.nine_in_ten);
    page.row("while contact holds", promise(figures.error_holding));
    page.row("while meshes part and hit", promise(figures.error_losing));
}

fn work(page: &mut Sheet, figures: &Figures) {
    page.heading("Work of a tick (instructions of a Cortex-M4F; cycles reckoned, not measured)");
    let of = |work: Work| {
        let Work { instructions, time_s, part } = work;
        format!("{instructions} instructions, {:.1} us, {:.0} % of the period", 1e6 * time_s, 100.0 * part)
    };
    page.row("contact holds", of(figures.holding));
    page.row("parts, no crossing", of(figures.losing));
    page.row("every mesh crosses twice", of(figures.all_crossing));
    page.row("every mesh in every part", of(figures.bound));
    let megahertz = f64::from(figures.clock_Hz) / 1e6;
    page.row("processor", format!("{megahertz:.0} MHz, {:.1} cycles an instruction", figures.cycles_per_instruction));
}

fn memory(page: &mut Sheet, figures: &Figures) {
    page.heading("Memory");
    page.row("tables", format!("{} bytes of flash", figures.table_bytes));
    page.row("model", format!("{} bytes of RAM", figures.model_bytes));
}

fn limits(page: &mut Sheet, figures: &Figures) {
    page.heading("Limits");
    page.row("rates", format!("{} to {} Hz", figures.lowest_rate_Hz, figures.highest_rate_Hz));
    let duration = 1e6 * figures.unseen_for_s;
    let unseen = match figures.unseen_departure {
        Some(0.0) => "no mesh".to_owned(),
        Some(departure) => {
            format!("for {duration:.1} us and {:.2} of the deflection by its load", departure)
        }
        None => format!("for {duration:.1} us, which is half a period of the fastest mode or more"),
    };
    page.row("may leave and return unseen", unseen);
}

fn verdict(figures: &Figures) -> String {
    let fits = "fits: a tick in which every mesh crosses twice leaves time";
    if figures.bound.part <= figures.share {
        return format!("{fits}, and so does one in which every mesh crosses in every part");
    }
    let part = 100.0 * figures.bound.part;
    format!("{fits}; if every mesh crossed in every part, {part:.0} % of the period would be needed")
}
