//! Conclusions of a study in sentences, derived from its record: regimes, order of the route to chaos, dependence on the initial state.

use super::pictures::micrometres;
use super::record::{Class, ClassWindow, Reading, StudyRecord, Sweep};
use super::windows::chaos_below;

/// Exponent with a sign and four decimals.
pub fn exponent(value: f64) -> String {
    format!("{value:+.4}").replace('-', "\u{2212}")
}

/// Sentence about the initial states of a sweep.
pub fn start(sweep: &Sweep) -> &'static str {
    match sweep.start.as_str() {
        "up" => "Upward, each b from the last state of the one before.",
        "down" => "Downward, each b from the last state of the one before.",
        _ => "From rest at each b.",
    }
}

/// Headed paragraph of one or two sentences.
pub struct Finding {
    /// Subject.
    pub head: String,
    /// Result.
    pub text: String,
}

fn finding(head: &str, text: String) -> Finding {
    Finding { head: head.to_owned(), text }
}

/// All findings, the most important first.
pub fn findings(record: &StudyRecord) -> Vec<Finding> {
    let first = &record.readings[0];
    let mut findings = vec![regimes(first)];
    findings.extend(first.sweeps.first().and_then(|sweep| route(first, sweep)));
    findings.extend(if is_papers(first) { Some(parameters()) } else { None });
    findings.extend(record.readings.get(1).map(|other| readings(first, other)));
    findings.extend(starts(first));
    findings.extend(planets(first));
    findings
}

/// Returns true for the paper's joint at the mesh frequency of set P.
fn is_papers(reading: &Reading) -> bool {
    let preset = reading.joint_file == "paper" || reading.joint_file == "paper_printed";
    preset && (reading.omega - 2.1).abs() < 1e-9
}

fn classes(reading: &Reading) -> String {
    let each: Vec<String> = reading
        .attractors
        .iter()
        .map(|a| format!("{} at b = {} µm", a.class, micrometres(a.half_backlash_m)))
        .collect();
    each.join(", ")
}

fn regimes(reading: &Reading) -> Finding {
    let wanted = [Class::Periodic(1), Class::Periodic(1), Class::Periodic(3), Class::Chaotic];
    let found: Vec<Class> = reading.attractors.iter().map(|attractor| attractor.class).collect();
    let found_all = is_papers(reading) && found == wanted;
    let head = if found_all { "The paper’s four regimes are real." } else { "Regimes." };
    let chaotic = reading.attractors.iter().find(|attractor| attractor.class == Class::Chaotic);
    let chaos = chaotic.map_or(String::new(), |attractor| {
        format!(
            " Chaos is chaos by its exponent: {} per τ by a tangent vector, {} by two trajectories.",
            exponent(attractor.exponent_by_tangent_vector),
            exponent(attractor.exponent_by_two_trajectories)
        )
    });
    finding(head, format!("From rest: {}.{chaos}", classes(reading)))
}

fn span(window: &ClassWindow) -> String {
    match (micrometres(window.from_m), micrometres(window.to_m)) {
        (from, to) if from == to => format!("at {from} µm"),
        (from, to) => format!("{from} to {to} µm"),
    }
}

/// Finding on whether disorder grows monotonically with backlash.
fn route(reading: &Reading, sweep: &Sweep) -> Option<Finding> {
    let periodic = |attractor: &&super::record::AttractorRecord| matches!(attractor.class, Class::Periodic(_));
    let last_periodic = reading.attractors.iter().filter(periodic).map(|a| a.half_backlash_m).fold(0.0, f64::max);
    let before = chaos_below(&sweep.windows, last_periodic);
    let onset = sweep.windows.iter().rev().find(|window| window.class == Class::Chaotic);
    if before.is_empty() {
        let onset = onset?;
        return Some(finding(
            "Route.",
            format!("Chaos from {} on the grid; none lies before periodic motion.", span(onset)),
        ));
    }
    let before: Vec<String> = before.into_iter().map(span).collect();
    let last = onset.map_or(String::new(), |window| format!(" The last chaotic window is {}.", span(window)));
    let text = format!(
        "More backlash does not mean more disorder step by step: chaos ({}) lies before the periodic motion at {} µm. The \
         response does not turn “quickly from single frequency to chaos” but through windows, with order between them.{last}",
        before.join(", "),
        micrometres(last_periodic)
    );
    Some(finding("The route is not monotone.", text))
}

fn parameters() -> Finding {
    let text =
        "The paper leaves damping ratio, stiffness ripple, transmission error, torque and mesh frequency unsaid. \
                The values here (damping ratio 0.05, Kₐ/Kₘ = 0.1, E = 30 µm, 80 N·m, ω/ωₙ = 2.1) show all of its \
                regimes; they need not be the authors’ own, and windows lie elsewhere for others."
            .to_owned();
    finding("The parameters are ours.", text)
}

fn readings(first: &Reading, other: &Reading) -> Finding {
    let same = first.attractors.iter().zip(&other.attractors).all(|(a, b)| a.class == b.class);
    let verdict = if same { "the same classes" } else { "other classes" };
    let exponents = |reading: &Reading| {
        let each: Vec<String> =
            reading.attractors.iter().map(|attractor| exponent(attractor.exponent_by_tangent_vector)).collect();
        each.join(", ")
    };
    let text = format!(
        "{} ({} kg for the carrier) has {verdict} as {} ({} kg): {}. Exponents {} against {}.",
        other.joint,
        kilograms(other),
        first.joint,
        kilograms(first),
        classes(other),
        exponents(other),
        exponents(first)
    );
    finding("The two readings of Table 1.", text)
}

fn kilograms(reading: &Reading) -> String {
    format!("{:.4}", reading.carrier_equivalent_mass_kg)
}

/// Finding on windows that depend on the start.
fn starts(reading: &Reading) -> Option<Finding> {
    let [first, others @ ..] = &reading.sweeps[..] else { return None };
    let differing = |other: &Sweep| {
        let differs = |(a, b): &(&super::record::SweepPoint, &super::record::SweepPoint)| a.class != b.class;
        let apart: Vec<f64> =
            first.points.iter().zip(&other.points).filter(differs).map(|(a, _)| a.half_backlash_m).collect();
        let range = apart.first().zip(apart.last());
        range.map(|(from, to)| {
            let name = start(other).split(',').next().unwrap_or_default().to_lowercase();
            format!(
                "{name}: {} of {} values between {} and {} µm",
                apart.len(),
                first.points.len(),
                micrometres(*from),
                micrometres(*to)
            )
        })
    };
    let starts_apart: Vec<String> = others.iter().filter_map(differing).collect();
    if starts_apart.is_empty() {
        let text =
            "Several attractors share a half-backlash in places: carried upward or downward from the last state \
                    (--sweep all) the inner windows move."
                .to_owned();
        return (others.is_empty() && is_papers(reading)).then(|| finding("Windows depend on the start.", text));
    }
    let text = format!("Another attractor than from rest is reached {}.", starts_apart.join("; "));
    Some(finding("Windows depend on the start.", text))
}

fn planets(reading: &Reading) -> Option<Finding> {
    let exponents: Option<Vec<f64>> = reading.attractors.iter().map(|a| a.exponent_between_planets).collect();
    let greatest = exponents.filter(|all| !all.is_empty())?.into_iter().fold(f64::NEG_INFINITY, f64::max);
    let text = format!(
        "All planets mesh in phase, and disturbances that drive planets apart {}: exponent {} at most.",
        if greatest < 0.0 { "die out, in chaos too" } else { "grow" },
        exponent(greatest)
    );
    let head = if greatest < 0.0 { "Planets stay together." } else { "Planets do not stay together." };
    Some(finding(head, text))
}
