//! The sections of figures: key figures, checks, motion and timing. Pictures come from `motion`, `close_up` and
//! `timing`; nothing is computed here beyond what a reader would do in the head.

use maud::{Markup, PreEscaped, html};

use super::whole::emulated;
use super::{close_up, motion, timing};
use crate::record::{Completeness, RunRecord};
use report::checks::Verdict;
use report::parts::{check_table, tile};
use report::plot::Figure;
use report::plot::unit::figure as number;

/// Key figures.
pub fn tiles(record: &RunRecord) -> Markup {
    let count = |verdict: Verdict| record.checks.iter().filter(|check| check.verdict == verdict).count();
    let judged = record.checks.iter().filter(|check| check.verdict != Verdict::Reported).count();
    let steps = match record.completeness {
        Completeness::Complete => record.settings.ticks,
        Completeness::Interrupted { tick, .. } => tick,
    };
    let seconds = f64::from(steps) / f64::from(record.settings.tick_rate_hz.max(1));
    let none = || html! {};
    html! {
        section.tiles {
            (tile("Checks held", none(), html! { (count(Verdict::Passed)) span.of { " of " (judged) } }))
            (tile("Steps", none(), html! { (number(f64::from(steps))) span.of { " · " (number(seconds)) " s" } }))
            @if let Some(timing) = &record.timing {
                (tile("Longest tick", emulated(record), html! {
                    (timing::micro(timing.computation.max_s)) span.of { " of " (timing::micro(timing.period_s)) " µs" }
                }))
                (tile("Idle", emulated(record), html! { (number(timing.idle_percent)) span.of { " %" } }))
            }
            @if let Some(image) = &record.identity.image {
                (tile("Flash", none(), html! { (kibibytes(image.flash_bytes)) span.of { " KiB" } }))
                (tile("RAM of statics", none(), html! { (kibibytes(image.ram_bytes)) span.of { " KiB" } }))
            }
        }
    }
}

fn kibibytes(bytes: u64) -> String {
    format!("{:.1}", bytes as f64 / 1024.0)
}

/// The table of checks, failed ones first.
pub fn checks(record: &RunRecord) -> Markup {
    html! { section { h2 { "Checks" } (check_table(&record.checks, &emulated(record))) } }
}

/// All pictures of the motion.
pub fn motion(record: &RunRecord) -> Markup {
    if record.samples.is_empty() {
        return html! { section { h2 { "Motion" } p.none { "No sample was received." } } };
    }
    let whole = motion::whole(record);
    let mut gap = vec![whole.gap()];
    gap.extend(whole.wind_up());
    let every = record.settings.decimation;
    html! {
        section {
            h2 { "Motion" (emulated(record)) }
            p.lead {
                (number(record.samples.len() as f64)) " samples, one every " (every) " ticks. Where a picture has fewer "
                "columns than samples, least and greatest of each column are kept."
            }
            (picture(record, &whole.figure("Torques", whole.torques()), html! { "Torques as commanded, held between commands." }))
            (picture(record, &whole.figure("Angles", whole.angles()), html! {
                "Angles from integer turns and small remainders. Shaded: the lost motion of "
                (number(record.joint.lost_motion_rad * 1e3)) " mrad at the link that backlash alone allows; "
                "teeth and shaft wind up beyond it."
            }))
            @if let Some(view) = close_up::view(record) {
                (picture(record, &close_up::figure(&view), html! {
                    strong { "A reversal through the gap, closely. " }
                    @match &record.close_up {
                        Some(stretch) => { "At every tick: " (stretch.method) "." }
                        None => { "From the samples of the line." }
                    }
                }))
            }
            (picture(record, &whole.figure("Gap coordinate", gap), html! {
                "Gap coordinate X = u" sub { "s" } " − 2 u" sub { "c" } " along the line of action. Shaded: "
                "where every mesh can be free at once, 4b = "
                (number((record.joint.gap_band_m[1] - record.joint.gap_band_m[0]) * 1e6)) " µm wide."
            }))
            (picture(record, &whole.figure("Mesh deflections", whole.deflections()), html! {
                "Deflection of every mesh. Above the shaded band the drive side carries, below it the back side, inside "
                "it the teeth are parted. Strips that stand for many samples show the share of each state by height."
            }))
            @if let Some(errors) = motion::errors(record) {
                (picture(record, &errors, html! {
                    "Board less reference, over the standard deviation of the reference"
                    @if let Some(reference) = &record.reference { " (" (reference.method) ")" } "."
                }))
            }
        }
    }
}

fn picture(record: &RunRecord, figure: &Figure, caption: Markup) -> Markup {
    html! { figure { (PreEscaped(figure.to_svg())) figcaption { (caption) (emulated(record)) } } }
}

/// How the board's time was spent.
pub fn timing(record: &RunRecord) -> Markup {
    let Some(figures) = &record.timing else {
        return html! { section { h2 { "Timing" } p.none { "The board could not be asked for its figures." } } };
    };
    html! {
        section {
            h2 { "Timing" (emulated(record)) }
            @if let Some(image) = &record.identity.image {
                p.lead.provenance {
                    (record.identity.board) ", " (record.identity.transport) " · ELF " code { (image.elf_sha256) } " · "
                    (image.compiler) " · " (image.flags)
                }
            }
            @if let Some(histogram) = timing::histogram(figures) {
                (picture(record, &histogram, html! { "Over " (number(f64::from(figures.ticks))) " ticks; the vertical axis is logarithmic." }))
            }
            div.columns {
                table {
                    thead { tr { th { "Time [µs]" (emulated(record)) } th.number { "least" } th.number { "mean" } th.number { "greatest" } th.number { "of period" } } }
                    tbody {
                        @for (name, values) in timing::times(figures) {
                            tr { td { (name) } @for value in values { td.number { (value) } } }
                        }
                        tr { td { "Idle share" (emulated(record)) } td.number colspan="4" { (number(figures.idle_percent)) " %" } }
                        tr { td { "Period" } td.number colspan="4" { (timing::micro(figures.period_s)) " µs" } }
                        tr { td { "Deepest stack" (emulated(record)) } td.number colspan="4" { (number(f64::from(figures.stack_used_bytes))) " bytes" } }
                        tr { td { "RAM of statics" } td.number colspan="4" { (number(f64::from(figures.static_ram_bytes))) " bytes" } }
                    }
                }
                table {
                    thead { tr { th { "Count" (emulated(record)) } th.number { } th { } } }
                    tbody {
                        @for (name, count, bad, meaning) in timing::counts(figures) {
                            tr.failed[bad && count > 0] { td { (name) } td.number { (number(f64::from(count))) } td.note { (meaning) } }
                        }
                    }
                }
            }
        }
    }
}
