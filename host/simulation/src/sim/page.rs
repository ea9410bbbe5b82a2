//! The report of a simulation: one HTML page that needs neither network nor scripts, in the style of the run reports.
//! Pictures come from `pictures`, `portraits` and `judgement`, figures from `figures`.

use maud::{Markup, PreEscaped, html};

use super::comparison::Comparison;
use super::energy::Entry;
use super::figures::Figures;
use super::judgement;
use super::moment::Moment;
use super::pictures::View;
use super::plan::Plan;
use super::portraits::{self, Portrait};
use super::scheme::SchemeName;
use super::spectrum::Spectrum;
use super::statistics::Point;
use report::plot::Figure;
use report::plot::unit::figure as number;
use report::shell::page;

/// What the page shows.
pub struct Content<'a> {
    /// What was asked.
    pub plan: &'a Plan,
    /// Figures.
    pub figures: &'a Figures,
    /// Which scheme.
    pub scheme: SchemeName,
    /// Kept samples.
    pub samples: &'a [Moment],
    /// Poincare points.
    pub points: &'a [Point],
    /// Spectrum.
    pub spectrum: Option<&'a Spectrum>,
    /// The books of energy.
    pub energy: &'a [Entry],
    /// All schemes.
    pub comparison: Option<&'a Comparison>,
    /// Command that makes this run again.
    pub replay: &'a str,
}

/// The whole page.
pub fn render(content: &Content<'_>) -> String {
    let figures = content.figures;
    let body = html! {
        (header(content))
        (notices(content))
        (tiles(content))
        (schemes(content))
        (motion(content))
        (portraits(content))
        (contacts(content))
        (energy(content))
        (origin(content))
        footer { "joint " (env!("CARGO_PKG_VERSION")) " · every sample is in history.csv and history.mcap" }
    };
    page(&format!("Joint {}, simulated", figures.joint), "", &body)
}

fn header(content: &Content<'_>) -> Markup {
    let figures = content.figures;
    html! {
        header {
            div.title { h1 { "Joint " (figures.joint) } }
            p.subtitle {
                "Simulated by scheme " strong { (figures.scheme) } " (" (content.scheme.description()) ", " (figures.scalar) ") · "
                (figures.torques) " · from " (figures.start) " · " (number(f64::from(figures.tick_rate_Hz) / 1e3)) " kHz"
            }
        }
    }
}

fn notices(content: &Content<'_>) -> Markup {
    let figures = content.figures;
    html! {
        @if let Some(time) = figures.diverged_at_s {
            div.notice.bad role="alert" {
                strong { "DIVERGED " } "at " (number(1e3 * time)) " ms: at this rate the scheme does not hold this motion. "
                "What came before is shown."
            }
        }
        @for change in &figures.set { div.notice { strong { "Changed for this run: " } code { (change) } } }
        @for warning in &content.plan.joint.warnings { div.notice { strong { "The joint file: " } (warning.message) } }
    }
}

fn tiles(content: &Content<'_>) -> Markup {
    let figures = content.figures;
    let tile = |name: &str, value: Markup| html! { div.tile { div.value { (value) } div.name { (name) } } };
    let done = f64::from(figures.ticks) / f64::from(figures.tick_rate_Hz);
    let (length, unit) = if done < 0.5 { (1e3 * done, " ms") } else { (done, " s") };
    html! {
        section.tiles {
            (tile("Simulated", html! { (number(length)) span.of { (unit) " · " (number(f64::from(figures.ticks))) " ticks" } }))
            (tile("Teeth parted", html! { (number(1e2 * figures.separated_share())) span.of { " % of the time" } }))
            (tile("Impacts", html! { (number(figures.impacts_per_s)) span.of { " /s, all meshes" } }))
            (tile("Peak mesh force", html! { (number(figures.peak_force())) span.of { " N" } }))
            @if content.plan.constant {
                (tile("Motion repeats after", html! {
                    @match figures.period {
                        Some(period) => { (period) span.of { @if period == 1 { " mesh period" } @else { " mesh periods" } } }
                        None => { "–" span.of { " not within 32 periods" } }
                    }
                }))
            }
        }
    }
}

fn picture(figure: &Figure, caption: Markup) -> Markup {
    html! { figure { (PreEscaped(figure.to_svg())) figcaption { (caption) } } }
}

fn motion(content: &Content<'_>) -> Markup {
    let whole = View::whole(content.plan, content.samples);
    if content.samples.len() < 2 {
        return html! { section { h2 { "Motion" } p.none { "Nothing moved." } } };
    }
    let close = whole.close();
    html! {
        section {
            h2 { "Motion" }
            p.lead {
                (number(content.samples.len() as f64)) " samples. Where a picture has fewer columns than samples, least "
                "and greatest of each column are kept."
            }
            @if !content.plan.constant { (picture(&whole.figure("Torques", whole.torques()), html! { "Torques as asked for." })) }
            (picture(&whole.figure("Gap", whole.gap()), html! {
                "Gap coordinate X = u" sub { "s" } " − 2 u" sub { "c" } " along the line of action, and the twist that it "
                "leaves between motor and link. Shaded: where every mesh can be free at once."
            }))
            (picture(&whole.figure("Mesh deflections", whole.deflections()), html! {
                "Deflection of every mesh. Above the shaded band the drive side carries, below it the back side, inside "
                "it the teeth are parted. Strips that stand for many samples show the share of each state by height."
            }))
            @if let Some(close) = &close {
                (picture(&close.figure("The last mesh periods", close.deflections()), html! {
                    strong { "The last 12 mesh periods, closely. " } "Deflections and contact, sample by sample."
                }))
                (picture(&close.figure("Mesh forces", close.forces()), html! { "Mesh forces over the same stretch." }))
            } @else {
                (picture(&whole.figure("Mesh forces", whole.forces()), html! { "Elastic and damping force along the line of action." }))
            }
        }
    }
}

fn portraits(content: &Content<'_>) -> Markup {
    let settled = content.samples.partition_point(|moment| moment.tick < content.plan.settle);
    let samples = &content.samples[settled..];
    if samples.len() < 16 {
        return html! {};
    }
    let figures = content.figures;
    let points = (content.points, figures.period);
    html! {
        section {
            h2 { "Phase portraits and spectrum" }
            p.lead {
                "Counted from " (number(1e3 * figures.settle_s)) " ms on. "
                @if content.plan.constant { @match figures.period {
                    Some(1) => { "The motion repeats with every mesh period." }
                    Some(period) => { "The motion repeats after " (period) " mesh periods." }
                    None => { "The motion does not repeat within 32 mesh periods: it is chaotic, has more than one frequency, or has not settled." }
                } }
            }
            (picture(&portraits::portrait(content.plan, samples, points, Portrait::Deflection), html! {
                "Deflection rate over deflection. Marked: the points at which the mesh phase comes round (Poincaré points), "
                (content.points.len()) " of them."
            }))
            (picture(&portraits::portrait(content.plan, samples, points, Portrait::Gap), html! { "The same of the gap coordinate." }))
            @if let Some(spectrum) = content.spectrum {
                (picture(&portraits::spectrum(content.plan, spectrum), html! {
                    "Hann window, about the mean. "
                    @if let Some(ratio) = figures.non_fundamental_over_fundamental {
                        "Beside the mesh frequency there is " (number(ratio)) " of what is at it (root of the powers)."
                    }
                }))
            }
        }
    }
}

fn contacts(content: &Content<'_>) -> Markup {
    html! {
        section {
            h2 { "Contact" }
            p.lead { "Counted from tick to tick: an impact is a landing on either flank." }
            table {
                thead { tr {
                    th { "Mesh" } th.number { "drive side" } th.number { "parted" } th.number { "back side" }
                    th.number { "impacts" } th.number { "mean" } th.number { "RMS" } th.number { "peak to peak" } th.number { "peak force" }
                } }
                tbody { @for mesh in &content.figures.meshes { tr {
                    td { (mesh.name) }
                    td.number { (number(1e2 * mesh.figures.drive_side_share)) " %" }
                    td.number { (number(1e2 * mesh.figures.separated_share)) " %" }
                    td.number { (number(1e2 * mesh.figures.back_side_share)) " %" }
                    td.number { (number(mesh.figures.impacts_per_s)) " /s" }
                    td.number { (number(1e6 * mesh.figures.deflection_mean_m)) " µm" }
                    td.number { (number(1e6 * mesh.figures.deflection_rms_m)) " µm" }
                    td.number { (number(1e6 * mesh.figures.deflection_peak_to_peak_m)) " µm" }
                    td.number { (number(mesh.figures.peak_force_N)) " N" }
                } } }
            }
        }
    }
}

fn energy(content: &Content<'_>) -> Markup {
    let Some(balance) = &content.figures.energy else { return html! {} };
    let rows = [
        ("Stored energy has grown by", balance.stored_at_end_J - balance.stored_at_start_J),
        ("Drive torque less load has supplied", balance.supplied_J),
        ("Damping has dissipated", balance.dissipated_J),
        ("Done against transmission errors", balance.against_errors_J),
        ("Brought in by changing stiffness", balance.by_stiffness_J),
        ("Residual: made or lost by the scheme", balance.residual_J),
    ];
    html! {
        section {
            h2 { "Balance of energy" }
            p.lead {
                "d/dt (kinetic + Σ K f² / 2) = T" sub { "D" } " ω" sub { "s" } " − T" sub { "L" } " ω" sub { "l" }
                " − losses − Σ F e′ + Σ K′ f² / 2, summed over the run. The work of every tick is that of an event-located "
                "integration from the tick’s own start, so that the residual is the scheme’s. It is "
                (number(1e2 * balance.residual_over_dissipated)) " % of what is dissipated."
            }
            (picture(&judgement::energy(content.plan, content.energy), html! { "The books over the run." }))
            table { tbody { @for (name, joules) in rows { tr { td { (name) } td.number { (number(1e3 * joules)) " mJ" } } } } }
        }
    }
}

fn schemes(content: &Content<'_>) -> Markup {
    let (Some(comparison), Some(until)) = (content.comparison, content.figures.compared_until_s) else {
        return html! {};
    };
    let percent = |row: &super::comparison::Row, error: Option<f64>| match error {
        _ if row.scheme == SchemeName::Reference.name() => "–".to_owned(),
        Some(error) => format!("{} %", number(1e2 * error)),
        None => "diverged".to_owned(),
    };
    let whole = content.plan.duration();
    html! {
        section {
            h2 { "Schemes" }
            p.lead {
                "Root mean square error against the reference over the motion’s standard deviation, up to "
                (number(1e3 * until)) " ms of " (number(1e3 * whole)) " ms"
                @if until < 0.99 * whole { ": a millionth of the torque moves the reference itself visibly from then on" }
                ". Cost is processor time for a simulated second over that of " code { "realtime" } ", measured on this machine in one process."
            }
            table {
                thead { tr {
                    th { "Scheme" } th { } th.number { "deflections" } th.number { "gap" } th.number { "link offset" }
                    th.number { "cost" } th.number { "sub-steps a tick" }
                } }
                tbody { @for (row, track) in comparison.rows.iter().zip(&comparison.tracks) { tr {
                    td { strong { (row.scheme) } }
                    td.note { (track.scheme.description()) }
                    @for error in row.errors { td.number { (percent(row, error)) } }
                    td.number { (number(row.cost_ratio)) }
                    td.number { @match row.substeps { Some(count) => { (count) } None => { "its own" } } }
                } } }
            }
            @for figure in judgement::schemes(content.plan, comparison) {
                (picture(&figure, html! { "The reference is the broad line; 0 dB is an error as large as the motion, −40 dB is 1 %." }))
            }
        }
    }
}

fn origin(content: &Content<'_>) -> Markup {
    let figures = content.figures;
    let rows = [
        ("Joint", format!("{} ({})", figures.joint, figures.file)),
        ("Scheme", format!("{}: {}", figures.scheme, content.scheme.description())),
        ("Scalar", figures.scalar.to_owned()),
        ("Rate", format!("{} Hz", figures.tick_rate_Hz)),
        ("Torques", figures.torques.clone()),
        ("Start", format!("{}, carrier at {} rad/s", figures.start, number(content.plan.speed))),
        ("Mesh frequency", format!("{} Hz", number(content.plan.mesh_frequency()))),
        ("Command", env!("CARGO_PKG_VERSION").to_owned()),
    ];
    html! {
        section {
            h2 { "What ran" }
            table.identity { tbody { @for (name, value) in rows { tr { th { (name) } td { (value) } } } } }
            h3 { "To run exactly this again" }
            pre { (content.replay) }
        }
    }
}
