//! The report of a study as one HTML page without network and scripts: conclusion first, then the table of attractors,
//! figures in the paper's order, diagrams and checks. Sentences are made from the record; `conclusion` has those that
//! judge.

use maud::{Markup, PreEscaped, html};

use super::conclusion;
use super::pictures::{self, Picture};
use super::record::{AttractorRecord, ClassRecord, Reading, StudyRecord, Sweep};
use report::checks::Verdict;
use report::parts::{check_table, tile};
use report::plot::unit::figure as number;
use report::shell::page;

/// What this page needs beyond the style of all reports.
const OWN_STYLE: &str = ".trio,.pair{display:grid;gap:4px;margin:0 0 6px}.trio{grid-template-columns:400fr 330fr 380fr}\
.pair{grid-template-columns:1fr 1fr}.trio svg,.pair svg{min-width:0}ul.findings{margin:0;padding-left:20px}\
ul.findings li{margin:0 0 7px}.attractors td,.attractors th{padding-right:8px}details summary{cursor:pointer;\
color:var(--muted)}details[open] summary{margin-bottom:10px}details+figure{margin-top:34px}.class{font-weight:650;white-space:nowrap}\
.date{white-space:nowrap}.class.chaotic{color:var(--line-2)}.class.periodic{color:var(--line-1)}.class.unsettled{color:var(--line-3)}\
@media (max-width:820px){.trio,.pair{grid-template-columns:1fr}}";

/// The whole page.
pub fn render(record: &StudyRecord) -> String {
    let body = html! {
        (header(record))
        (tiles(record))
        section { h2 { "What came out" } ul.findings {
            @for finding in conclusion::findings(record) { li { strong { (finding.head) " " } (finding.text) } }
        } }
        @for reading in &record.readings { (attractors(reading)) }
        (ingredients(record))
        @for reading in &record.readings { (regimes(reading)) }
        @for reading in &record.readings { (diagrams(reading)) }
        (checks(record))
        (identity(record))
        footer {
            "joint " (record.identity.host_version) " · schema version " (record.schema_version)
            " · every value of this page is in study.json, CSV and SVG files beside it"
        }
    };
    page(&format!("Joint {}: backlash and regimes", record.identity.joint), OWN_STYLE, &body)
}

/// b in micrometres, without the noise of the way to metres and back.
pub(super) fn micrometres(length: f64) -> String {
    number((length * 1e9).round() / 1e3)
}

/// With a sign and four decimals.
pub(super) fn exponent(value: f64) -> String {
    format!("{value:+.4}").replace('-', "\u{2212}")
}

fn failed(record: &StudyRecord) -> usize {
    record.checks.iter().filter(|check| check.verdict == Verdict::Failed).count()
}

fn header(record: &StudyRecord) -> Markup {
    let first = &record.readings[0];
    let (class, word) = match failed(record) {
        0 => ("passed", "PASSED".to_owned()),
        1 => ("failed", "1 CHECK FAILED".to_owned()),
        count => ("failed", format!("{count} CHECKS FAILED")),
    };
    html! {
        header {
            div.title {
                h1 { "Joint " (record.identity.joint) ": backlash and regimes" }
                span class={ "pill " (class) } { (word) }
            }
            p.subtitle {
                "The study of He, Jia, Chen and Sun (2015), redone · ω/ω" sub { "n" } " = " (number(first.omega))
                " · drive torque " (number(first.drive_torque_nm)) " N·m, load in balance · damping law "
                (first.damping_law) " · " span.date { (record.identity.date) }
            }
        }
    }
}

fn tiles(record: &StudyRecord) -> Markup {
    let none = || html! {};
    let first = &record.readings[0];
    let judged = record.checks.iter().filter(|c| matches!(c.verdict, Verdict::Passed | Verdict::Failed)).count();
    let points: usize = record.readings.iter().flat_map(|r| &r.sweeps).map(|sweep| sweep.points.len()).sum();
    html! {
        section.tiles {
            (tile("Checks held", none(), html! { (judged - failed(record)) span.of { " of " (judged) } }))
            @for found in &first.attractors {
                @let name = format!("b = {} µm", micrometres(found.half_backlash_m));
                (tile(&name, none(), class_mark(found.class)))
            }
            (tile("Points of diagrams", none(), html! { (number(points as f64)) }))
        }
    }
}

fn class_mark(class: ClassRecord) -> Markup {
    let name = match class {
        ClassRecord::Periodic(_) => "periodic",
        ClassRecord::Chaotic => "chaotic",
        ClassRecord::Unsettled => "unsettled",
    };
    html! { span class={ "class " (name) } { (class) } }
}

fn attractors(reading: &Reading) -> Markup {
    html! {
        section {
            h2 { "Attractors of " (reading.joint) }
            p.lead {
                (reading.description) @if !reading.description.is_empty() { ". " }
                "Carrier equivalent mass " (format!("{:.4}", reading.carrier_equivalent_mass_kg)) " kg, ω" sub { "n" } " = "
                (number(reading.omega_n_rad_per_s)) " rad/s, b" sub { "c" } " = "
                (micrometres(reading.characteristic_length_m)) " µm; from rest."
            }
            table.attractors {
                thead {
                    tr {
                        th.number { "b [µm]" } th { "Attractor" } th { "Poincaré points " span.note { "X_sp, X_sc, X_sp′, X_sc′" } }
                        th.number { "Exponent" br; "tangent" } th.number { "Exponent" br; "two traj." }
                        th.number { "Between" br; "planets" } th.number { "Non-fund." br; "/ fund." }
                        th.number { "Peak to" br; "peak" } th.number { "Parted" br; "[%]" }
                    }
                }
                tbody { @for found in &reading.attractors { (attractor_row(found)) } }
            }
            p.note {
                "Exponents: largest Lyapunov exponent per unit of τ = ω" sub { "n" } "t, by a tangent vector and by two "
                "trajectories; between planets: of disturbances that drive planets apart, below zero if planets in phase "
                "stay in phase. Non-fundamental: RMS of all that is neither mean nor at the mesh frequency. Parted: share "
                "of time in which a mesh carries on neither flank."
            }
        }
    }
}

fn attractor_row(found: &AttractorRecord) -> Markup {
    let fixed = |value: f64| format!("{value:.4}").replace('-', "\u{2212}");
    html! {
        tr {
            td.number { (micrometres(found.half_backlash_m)) }
            td { (class_mark(found.class)) }
            td {
                @match found.class {
                    ClassRecord::Periodic(period) if period <= 8 => {
                        @for (index, point) in found.poincare_points.iter().enumerate() {
                            @if index > 0 { br; }
                            "(" (point.map(fixed).join(", ")) ")"
                        }
                    }
                    _ => { (found.distinct_points) " distinct of " (found.points_looked_at) }
                }
            }
            td.number { (exponent(found.exponent_by_tangent_vector)) }
            td.number { (exponent(found.exponent_by_two_trajectories)) }
            td.number { (found.exponent_between_planets.map_or("–".to_owned(), exponent)) }
            td.number { (number(found.non_fundamental_ratio)) }
            td.number { (format!("{:.3}", found.peak_to_peak)) }
            td.number { (format!("{:.1}", found.contact_percent[1])) }
        }
    }
}

/// Figs 3 to 5: what the model is made of.
fn ingredients(record: &StudyRecord) -> Markup {
    let wave = &record.stiffness;
    let [curves, errors] = pictures::dead_zone(record);
    html! {
        section {
            h2 { "What the model is made of" }
            figure {
                (svg(&pictures::stiffness(record)))
                figcaption {
                    strong { "Fig. 3. " } "The rectangular stiffness wave, high for the fraction "
                    (number(wave.contact_ratio.fract())) " of a period (contact ratio " (number(wave.contact_ratio))
                    ": " (wave.contact_ratio_source) "), and its first harmonic, eq. 7 with K" sub { "a" } "/K" sub { "m" }
                    " = " (number(wave.first_harmonic_ratio)) "."
                }
            }
            figure {
                div.pair { (svg(&curves)) (svg(&errors)) }
                figcaption {
                    strong { "Figs 4 and 5. " } "Left: eq. 12 and its approximation by tanh. The print of eq. 13 lost a "
                    "factor x in its first bracket: it leaves x − 1 in the gap, a force between teeth that do not touch. "
                    "Right: corrected, the largest error falls as 0.139/σ; as printed no sharpness removes it. The study "
                    "uses the sharp dead zone and locates every contact."
                }
            }
        }
    }
}

fn regimes(reading: &Reading) -> Markup {
    html! {
        section {
            h2 { "Figs 5 to 8: " (reading.joint) }
            @for found in &reading.attractors {
                figure { div.trio { @for picture in pictures::regime(reading, found) { (svg(&picture)) } } }
            }
            p.note {
                "After the motion from rest has settled: X_sp over mesh periods, phase portrait with the points at "
                "τ = 2πk/Ω, amplitude spectrum over the mesh frequency"
                ". Lines at fractions of the mesh frequency are what distortion over whole harmonics does not see."
            }
        }
    }
}

fn diagrams(reading: &Reading) -> Markup {
    html! {
        section {
            h2 { "Bifurcation diagram: " (reading.joint) }
            @for sweep in &reading.sweeps {
                figure {
                    (svg(&pictures::diagram(reading, sweep)))
                    figcaption {
                        strong { (start(sweep)) " " }
                        "Poincaré points of X_sp and the largest Lyapunov exponent by half-backlash, "
                        (sweep.points.len()) " values. Upright lines: half-backlashes of the table above."
                    }
                }
                details open[sweep.windows.len() <= 16] {
                    summary { (sweep.windows.len()) " windows of one class" }
                    (windows(sweep))
                }
            }
        }
    }
}

pub(super) fn start(sweep: &Sweep) -> &'static str {
    match sweep.start.as_str() {
        "up" => "Upward, each b from the last state of the one before.",
        "down" => "Downward, each b from the last state of the one before.",
        _ => "From rest at each b.",
    }
}

fn windows(sweep: &Sweep) -> Markup {
    let exponents = |from: f64, to: f64| {
        let inside = sweep.points.iter().filter(|point| (from..=to).contains(&point.half_backlash_m));
        inside.map(|point| point.exponent).fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(x), h.max(x)))
    };
    html! {
        table {
            thead { tr { th.number { "from b [µm]" } th.number { "to b [µm]" } th { "Attractor" } th.number { "least exponent" } th.number { "greatest exponent" } } }
            tbody {
                @for window in &sweep.windows {
                    @let (least, greatest) = exponents(window.from_m, window.to_m);
                    tr {
                        td.number { (micrometres(window.from_m)) } td.number { (micrometres(window.to_m)) }
                        td { (class_mark(window.class)) } td.number { (exponent(least)) } td.number { (exponent(greatest)) }
                    }
                }
            }
        }
    }
}

fn checks(record: &StudyRecord) -> Markup {
    html! {
        section {
            h2 { "Checks" }
            details open[failed(record) > 0] {
                summary { (record.checks.len()) " checks: known numbers, the two exponents, an independent integrator" }
                (check_table(&record.checks, &html! {}))
            }
        }
    }
}

fn identity(record: &StudyRecord) -> Markup {
    let identity = &record.identity;
    html! {
        section {
            h2 { "Identity" }
            table.identity {
                tbody {
                    tr { th { "Joint files" } td { @for (i, reading) in record.readings.iter().enumerate() { @if i > 0 { ", " } (reading.joint_file) } } }
                    tr { th { "Motion" } td { "Taylor series of order 14 between contact events, local error 1e-12 b" sub { "c" } ", f64, full model of every planet" } }
                    tr { th { "Sources" } td { (identity.git_commit.as_deref().unwrap_or("not under git")) } }
                    tr { th { "Host" } td { (identity.host) ", joint " (identity.host_version) } }
                    tr { th { "Date" } td { (identity.date) } }
                }
            }
            h3 { "Run it again" }
            pre { "cargo " (identity.replay) }
        }
    }
}

fn svg(picture: &Picture) -> Markup {
    html! { (PreEscaped(picture.figure.to_svg())) }
}
