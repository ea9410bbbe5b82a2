//! Report of a study as a document: conclusion first, then the table of attractors, figures in the paper's order, diagrams and checks. A
//! terminal shows attractors, windows and the number of passed checks. Sentences come from the record; `conclusion` has the evaluating
//! ones.

use super::conclusion::{self, exponent, start};
use super::pictures::{self, Picture, micrometres};
use super::record::{AttractorRecord, Class, Reading, StudyRecord, Sweep};
use report::checks::Verdict;
use report::document::{
    Block, Checks, Details, Document, PAGES, Picture as Shown, Row, Section, TERMINALS, Text, facts, indexed, inked,
    line_break, number, number_as, numbers, picture, quiet, row, section, section_bare, strong, table, text, tile,
    verdict_of, whole, words,
};
use report::number::{PAGE, fixed};
use report::plot::ink::Ink;

/// The whole document.
pub fn document(record: &StudyRecord) -> Document {
    let first = &record.readings[0];
    let each = |part: fn(&Reading) -> Block| record.readings.iter().map(part);
    let mut blocks = vec![tiles(record), findings(record)];
    blocks.extend(each(attractors));
    blocks.push(ingredients(record));
    blocks.extend(each(regimes));
    blocks.extend(each(diagrams));
    blocks.extend([checks(record), identity(record)]);
    let heading = format!("Joint {}: backlash and regimes", record.identity.joint);
    Document {
        title: heading.clone(),
        heading: heading.into(),
        verdict: Some(verdict_of(count(record, Verdict::Failed))),
        subtitle: indexed("The study of He, Jia, Chen and Sun (2015), redone · ω/ω_n = ")
            + format!(
                "{} · drive torque {} N·m, load in balance · damping law {} · ",
                PAGE.write(first.omega),
                PAGE.write(first.drive_torque_nm),
                first.damping_law
            )
            + whole(&record.identity.date),
        blocks,
        footer: format!(
            "joint {} · schema version {} · every value of this page is in study.json, CSV and SVG files beside it",
            record.identity.host_version, record.schema_version
        )
        .into(),
        ..Document::default()
    }
}

fn count(record: &StudyRecord, verdict: Verdict) -> usize {
    record.checks.iter().filter(|check| check.verdict == verdict).count()
}

fn tiles(record: &StudyRecord) -> Block {
    let held = count(record, Verdict::Passed);
    let judged = held + count(record, Verdict::Failed);
    let points: usize = record.readings.iter().flat_map(|r| &r.sweeps).map(|sweep| sweep.points.len()).sum();
    let mut tiles = vec![tile("Checks held", text(held) + quiet(format!(" of {judged}")))];
    for found in &record.readings[0].attractors {
        tiles.push(tile(format!("b = {} µm", micrometres(found.half_backlash_m)), class(found.class)));
    }
    tiles.push(tile("Points of diagrams", number(points as f64)));
    Block::Tiles(tiles)
}

fn class(class: Class) -> Text {
    let ink = match class {
        Class::Periodic(_) => Ink::First,
        Class::Chaotic => Ink::Second,
        Class::Unsettled => Ink::Third,
    };
    inked(class.to_string(), ink)
}

fn findings(record: &StudyRecord) -> Block {
    let findings = conclusion::findings(record).into_iter().map(|finding| strong(finding.head) + " " + finding.text);
    section("Findings", vec![Block::List(findings.collect())])
}

fn attractors(reading: &Reading) -> Block {
    let description = if reading.description.is_empty() { String::new() } else { format!("{}. ", reading.description) };
    let masses = format!(
        "Carrier equivalent mass {:.4} kg, ω_n = {} rad/s, b_c = {} µm; from rest.",
        reading.carrier_equivalent_mass_kg,
        PAGE.write(reading.omega_n_rad_per_s),
        micrometres(reading.characteristic_length_m)
    );
    let lead = text(description) + indexed(&masses);
    let two = |above: &str, below: &str| numbers(text(above) + line_break() + below);
    let columns = vec![
        numbers("b [µm]"),
        words("Attractor"),
        words(text("Poincaré points ") + quiet("X_sp, X_sc, X_sp′, X_sc′")).only(PAGES),
        numbers("Points").only(TERMINALS),
        two("Exponent", "tangent"),
        two("Exponent", "two traj."),
        two("Between", "planets"),
        two("Non-fund.", "/ fund."),
        two("Peak to", "peak"),
        two("Parted", "[%]"),
    ];
    let note = "Exponents: largest Lyapunov exponent per unit of τ = ω_n t, by a tangent vector and by two trajectories; \
                between planets: of disturbances that drive planets apart, below zero if planets in phase stay in phase. \
                Non-fundamental: RMS of all that is neither mean nor at the mesh frequency. Parted: share of time in \
                which a mesh carries on neither flank.";
    Block::Section(Section {
        heading: text("Attractors of ") + &reading.joint,
        line: Some(
            format!(
                "{}, omega/omega_n = {:.4}, drive torque {:.4} N m",
                reading.joint, reading.omega, reading.drive_torque_nm
            )
            .into(),
        ),
        blocks: vec![
            Block::Only(PAGES, vec![Block::Lead(lead)]),
            table(columns, reading.attractors.iter().map(attractor).collect()),
            Block::Only(PAGES, vec![Block::Note(indexed(note))]),
        ],
        ..Section::default()
    })
}

fn attractor(found: &AttractorRecord) -> Row {
    let coordinate = |value: f64| format!("{value:.4}").replace('-', "\u{2212}");
    let points = match found.class {
        Class::Periodic(period) if period <= 8 => {
            let each =
                found.poincare_points.iter().map(|point| format!("({})", point.map(coordinate).join(", ")).into());
            Text::join(each, &line_break())
        }
        _ => format!("{} distinct of {}", found.distinct_points, found.points_looked_at).into(),
    };
    row([
        micrometres_to_two(found.half_backlash_m),
        class(found.class),
        points,
        format!("{} of {}", found.distinct_points, found.points_looked_at).into(),
        exponent(found.exponent_by_tangent_vector).into(),
        exponent(found.exponent_by_two_trajectories).into(),
        found.exponent_between_planets.map_or("–".to_owned(), exponent).into(),
        number_as(found.non_fundamental_ratio, fixed(4)),
        format!("{:.4}", found.peak_to_peak).into(),
        format!("{:.1}", found.contact_percent[1]).into(),
    ])
}

/// Half-backlash in micrometres, on a terminal with two decimals.
fn micrometres_to_two(length: f64) -> Text {
    number_as((length * 1e9).round() / 1e3, fixed(2))
}

/// Figs 3 to 5: elements of the model.
fn ingredients(record: &StudyRecord) -> Block {
    let wave = &record.stiffness;
    let stiffness = format!(
        "The rectangular stiffness wave, high for the fraction {} of a period (contact ratio {}: {}), and its first \
         harmonic, eq. 7 with K_a/K_m = {}.",
        PAGE.write(wave.contact_ratio.fract()),
        PAGE.write(wave.contact_ratio),
        wave.contact_ratio_source,
        PAGE.write(wave.first_harmonic_ratio)
    );
    let dead_zone = strong("Figs 4 and 5. ")
        + "Left: eq. 12 and its approximation by tanh. The print of eq. 13 lost a factor x in its first bracket: it leaves \
           x − 1 in the gap, a force between teeth that do not touch. Right: corrected, the largest error falls as \
           0.139/σ; as printed no sharpness removes it. The study uses the sharp dead zone and locates every contact.";
    section(
        "Model elements",
        vec![
            picture(pictures::stiffness(record).figure, strong("Fig. 3. ") + indexed(&stiffness)),
            beside(pictures::dead_zone(record), dead_zone),
        ],
    )
}

fn beside<const N: usize>(pictures: [Picture; N], caption: Text) -> Block {
    Block::Picture(Shown { figures: pictures.map(|picture| picture.figure).into(), caption, file: String::new() })
}

fn regimes(reading: &Reading) -> Block {
    let regimes = reading.attractors.iter().map(|found| beside(pictures::regime(reading, found), Text::default()));
    let note = "After the motion from rest has settled: X_sp over mesh periods, phase portrait with the points at \
                τ = 2πk/Ω, amplitude spectrum over the mesh frequency. Lines at fractions of the mesh frequency are what \
                distortion over whole harmonics does not see.";
    section(text("Figs 5 to 8: ") + &reading.joint, regimes.chain([Block::Note(note.into())]).collect())
}

fn diagrams(reading: &Reading) -> Block {
    let blocks = reading.sweeps.iter().flat_map(|sweep| {
        let caption = strong(start(sweep))
            + format!(
                " Poincaré points of X_sp and the largest Lyapunov exponent by half-backlash, {} values. Upright lines: \
                 half-backlashes of the table above.",
                sweep.points.len()
            );
        [picture(pictures::diagram(reading, sweep).figure, caption), windows(sweep)]
    });
    section_bare(text("Bifurcation diagram: ") + &reading.joint, blocks.collect())
}

fn windows(sweep: &Sweep) -> Block {
    let exponents = |from: f64, to: f64| {
        let inside = sweep.points.iter().filter(|point| (from..=to).contains(&point.half_backlash_m));
        inside.map(|point| point.exponent).fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(x), h.max(x)))
    };
    let columns = vec![
        numbers("from b [µm]"),
        numbers("to b [µm]"),
        words("Attractor"),
        numbers("least exponent"),
        numbers("greatest exponent"),
    ];
    let rows = sweep.windows.iter().map(|window| {
        let (least, greatest) = exponents(window.from_m, window.to_m);
        let [from, to] = [window.from_m, window.to_m].map(micrometres_to_two);
        row([from, to, class(window.class), exponent(least).into(), exponent(greatest).into()])
    });
    let how = match sweep.start.as_str() {
        "rest" => "from rest".to_owned(),
        direction => format!("carried {direction}ward"),
    };
    Block::Details(Details {
        summary: match sweep.windows.len() {
            1 => format!("1 window of one class, {how}"),
            count => format!("{count} windows of one class, {how}"),
        }
        .into(),
        open: sweep.windows.len() <= 16,
        blocks: vec![table(columns, rows.collect())],
    })
}

fn checks(record: &StudyRecord) -> Block {
    let failed = count(record, Verdict::Failed);
    let held = count(record, Verdict::Passed);
    let summary =
        format!("{} checks: known numbers, the two exponents, an independent integrator", record.checks.len());
    let checks = Checks { checks: record.checks.clone(), emulated: false, keys: false };
    let details = Details { summary: summary.into(), open: failed > 0, blocks: vec![Block::Checks(checks)] };
    let line = Block::Paragraph(format!("{held} of {} checks held", held + failed).into());
    section_bare("Checks", vec![Block::Only(TERMINALS, vec![line]), Block::Only(PAGES, vec![Block::Details(details)])])
}

fn identity(record: &StudyRecord) -> Block {
    let identity = &record.identity;
    let files: Vec<&str> = record.readings.iter().map(|reading| reading.joint_file.as_str()).collect();
    let rows = [
        ("Joint files", text(files.join(", "))),
        (
            "Motion",
            indexed(
                "Taylor series of order 14 between contact events, local error 1e-12 b_c, f64, full model of every planet",
            ),
        ),
        ("Sources", text(identity.git_commit.as_deref().unwrap_or("not under git"))),
        ("Host", text(format!("{}, joint {}", identity.host, identity.host_version))),
        ("Date", text(&identity.date)),
    ];
    section("Identity", vec![facts(rows), Block::Again(format!("cargo {}", identity.replay))])
}
