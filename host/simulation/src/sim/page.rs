//! Report of a simulation as a document. Pictures come from `pictures`, `portraits` and `scheme_pictures`, figures from
//! `summary`.

use super::comparison::Row as SchemeRow;
use super::pictures::View;
use super::portraits::{self, Portrait};
use super::result::SimulationResult;
use super::scheme::SchemeName;
use super::scheme_pictures;
use super::summary::SimulationSummary;
use report::document::{
    Block, Document, PAGES, Section, TERMINALS, alert, code, facts, indexed, notes, notice, number, number_as, numbers,
    picture, quiet, row, section, section_bare, strong, table, text, tile, words,
};
use report::number::{PAGE, fixed, powers_of_ten};
use report::panels::{DEFLECTIONS, THINNED, gap_coordinate};
use report::provenance::VERSION;

/// The whole report.
pub fn document(result: &SimulationResult<'_>, figures: &SimulationSummary, replay: &str) -> Document {
    let rate = f64::from(figures.tick_rate_Hz);
    let mut blocks = notices(result, figures);
    blocks.extend([tiles(result, figures), motion(result)]);
    blocks.extend(portraits(result, figures));
    blocks.push(contacts(figures));
    blocks.extend(energy(result, figures));
    blocks.extend(schemes(result, figures));
    blocks.push(origin(result, figures, replay));
    Document {
        title: format!("Joint {}, simulated", figures.joint),
        heading: text("Joint ") + &figures.joint,
        subtitle: text("Simulated by scheme ")
            + strong(figures.scheme)
            + format!(
                " ({}, {}) · {} · from {} · {} kHz",
                result.scheme.description(),
                figures.scalar,
                figures.torques,
                figures.start,
                PAGE.write(rate / 1e3)
            ),
        line: format!(
            "{} by scheme {} ({}): {} of {} ticks at {rate} Hz, {:.4} s; {}; {}, from {}",
            figures.joint,
            figures.scheme,
            figures.scalar,
            figures.ticks,
            figures.of_ticks,
            f64::from(figures.ticks) / rate,
            figures.substeps_in_words(),
            figures.torques,
            figures.start
        )
        .into(),
        blocks,
        footer: text("joint ") + VERSION + " · every sample is in history.csv and history.mcap",
        ..Document::default()
    }
}

fn notices(result: &SimulationResult<'_>, figures: &SimulationSummary) -> Vec<Block> {
    let mut notices = Vec::new();
    if let Some(time) = figures.diverged_at_s {
        notices.push(alert(
            strong("DIVERGED")
                + format!(
                    " at {time:.6} s: at this rate the scheme does not hold this motion. What came before is shown."
                ),
        ));
    }
    let changed = figures.set.iter().map(|change| notice(strong("Changed for this run: ") + code(change)));
    let warned = result.plan.warnings.iter();
    let warned = warned.map(|warning| notice(strong("The joint file: ") + &warning.message));
    notices.push(Block::Only(PAGES, changed.chain(warned).collect()));
    notices
}

fn tiles(result: &SimulationResult<'_>, figures: &SimulationSummary) -> Block {
    let done = f64::from(figures.ticks) / f64::from(figures.tick_rate_Hz);
    let (length, unit) = if done < 0.5 { (1e3 * done, " ms") } else { (done, " s") };
    let mut tiles = vec![
        tile("Simulated", number(length) + quiet(format!("{unit} · {} ticks", PAGE.write(f64::from(figures.ticks))))),
        tile("Teeth separated", number(1e2 * figures.separated_share()) + quiet(" % of the time")),
        tile("Impacts", number(figures.impacts_per_s) + quiet(" /s, all meshes")),
        tile("Peak mesh force", number(figures.peak_force()) + quiet(" N")),
    ];
    if result.plan.constant {
        let period = match figures.period {
            Some(period) => text(period) + quiet(if period == 1 { " mesh period" } else { " mesh periods" }),
            None => text("–") + quiet(" not within 32 periods"),
        };
        tiles.push(tile("Motion repeats after", period));
    }
    Block::Tiles(tiles)
}

fn motion(result: &SimulationResult<'_>) -> Block {
    let whole = View::whole(result.plan, &result.samples);
    if result.samples.len() < 2 {
        return section("Motion", vec![Block::Paragraph("Nothing moved.".into())]);
    }
    let mut blocks = vec![Block::Lead(number(result.samples.len() as f64) + " samples. " + THINNED)];
    if !result.plan.constant {
        blocks.push(picture(whole.figure("Torques", whole.torques()), "Commanded torques.".into()));
    }
    let gap = gap_coordinate()
        + ", and the twist that it leaves between motor and link. Shaded: where every mesh can be free at once.";
    blocks.push(picture(whole.figure("Gap", whole.gap()), gap));
    blocks.push(picture(whole.figure("Mesh deflections", whole.deflections()), DEFLECTIONS.into()));
    match whole.close() {
        Some(close) => {
            let caption = strong("The last 12 mesh periods, closely. ") + "Deflections and contact, sample by sample.";
            blocks.push(picture(close.figure("The last mesh periods", close.deflections()), caption));
            let caption = "Mesh forces over the same time.".into();
            blocks.push(picture(close.figure("Mesh forces", close.forces()), caption));
        }
        None => {
            let caption = "Elastic and damping force along the line of action.".into();
            blocks.push(picture(whole.figure("Mesh forces", whole.forces()), caption));
        }
    }
    section("Motion", blocks)
}

fn portraits(result: &SimulationResult<'_>, figures: &SimulationSummary) -> Option<Block> {
    let (plan, samples) = (result.plan, result.settled());
    if samples.len() < 16 {
        return None;
    }
    let points = (result.statistics.points(), figures.period);
    let repeats = match figures.period {
        _ if !plan.constant => String::new(),
        Some(1) => "The motion repeats with every mesh period.".to_owned(),
        Some(period) => format!("The motion repeats after {period} mesh periods."),
        None => {
            "The motion does not repeat within 32 mesh periods: it is chaotic, has more than one frequency, or has \
                 not settled."
                .to_owned()
        }
    };
    let mut blocks = vec![
        Block::Lead(text("Counted from ") + number(1e3 * figures.settle_s) + " ms on. " + repeats),
        picture(
            portraits::portrait(plan, samples, points, Portrait::Deflection),
            format!(
                "Deflection rate over deflection. Marked: the points at which the mesh phase completes a period \
                 (Poincaré points), {} of them.",
                result.statistics.points().len()
            )
            .into(),
        ),
        picture(
            portraits::portrait(plan, samples, points, Portrait::Gap),
            "Gap rate over gap coordinate, with its Poincaré points.".into(),
        ),
    ];
    if let Some(spectrum) = &result.spectrum {
        let beside = figures
            .non_fundamental_over_fundamental
            .map(|ratio| format!("RMS beside over RMS at the mesh frequency: {}.", PAGE.write(ratio)));
        let caption = text("Hann window, about the mean. ") + beside;
        blocks.push(picture(portraits::spectrum(plan, spectrum), caption));
    }
    Some(section("Phase portraits and spectrum", blocks))
}

fn contacts(figures: &SimulationSummary) -> Block {
    let columns = ["drive side", "separated", "back side", "impacts", "mean", "RMS", "peak to peak", "peak force"];
    let columns = [words("Mesh")].into_iter().chain(columns.map(numbers)).collect();
    let rows = figures.meshes.iter().map(|mesh| {
        let statistics = &mesh.figures;
        let of = |value: f64, decimals: usize, unit: &str| number_as(value, fixed(decimals)) + unit;
        row([
            text(&mesh.name),
            of(1e2 * statistics.drive_side_share, 2, " %"),
            of(1e2 * statistics.separated_share, 2, " %"),
            of(1e2 * statistics.back_side_share, 2, " %"),
            of(statistics.impacts_per_s, 1, " /s"),
            of(1e6 * statistics.deflection_mean_m, 3, " µm"),
            of(1e6 * statistics.deflection_rms_m, 3, " µm"),
            of(1e6 * statistics.deflection_peak_to_peak_m, 3, " µm"),
            of(statistics.peak_force_N, 1, " N"),
        ])
    });
    let lead = "Counted from tick to tick: an impact is a landing on either flank.";
    let from = number_as(figures.settle_s, fixed(4));
    Block::Section(Section {
        heading: "Contact".into(),
        line: Some(text("figures are counted from ") + from + " s on"),
        blocks: vec![
            Block::Only(PAGES, vec![Block::Lead(lead.into())]),
            table(columns, rows.collect()),
            Block::Only(TERMINALS, vec![section_bare("", vec![facts(motion_facts(figures))])]),
        ],
        ..Section::default()
    })
}

/// Facts about the motion for a terminal; a page shows them beside the pictures.
fn motion_facts(figures: &SimulationSummary) -> Vec<(&'static str, String)> {
    let period = match figures.period {
        Some(1) => "1 mesh period".to_owned(),
        Some(period) => format!("{period} mesh periods"),
        None => "none within 32 mesh periods".to_owned(),
    };
    let mut facts = vec![("period", period)];
    if let Some(ratio) = figures.non_fundamental_over_fundamental {
        facts.push(("spectrum", format!("RMS beside over RMS at the mesh frequency: {ratio:.4}")));
    }
    if let Some(energy) = &figures.energy {
        let [residual, dissipated] = [energy.residual_J, energy.dissipated_J].map(|work| powers_of_ten(3).write(work));
        let share = powers_of_ten(2).write(energy.residual_over_dissipated);
        facts.push(("energy", format!("residual {residual} J, {share} of the {dissipated} J dissipated")));
    }
    facts
}

fn energy(result: &SimulationResult<'_>, figures: &SimulationSummary) -> Option<Block> {
    let (balance, account) = (figures.energy.as_ref()?, result.energy.as_ref()?);
    let rows = [
        ("Stored energy has grown by", balance.stored_at_end_J - balance.stored_at_start_J),
        ("Drive torque less load has supplied", balance.supplied_J),
        ("Damping has dissipated", balance.dissipated_J),
        ("Done against transmission errors", balance.against_errors_J),
        ("Brought in by changing stiffness", balance.by_stiffness_J),
        ("Residual: made or lost by the scheme", balance.residual_J),
    ];
    let lead = format!(
        "d/dt (kinetic + Σ K f² / 2) = T_D ω_s − T_L ω_l − losses − Σ F e′ + Σ K′ f² / 2, summed over the run. The work of \
         every tick is that of an event-located integration from the tick’s own start, so that the residual is the \
         scheme’s. It is {} % of what is dissipated.",
        PAGE.write(1e2 * balance.residual_over_dissipated)
    );
    let rows = rows.map(|(name, joules)| row([text(name), number(1e3 * joules) + " mJ"]));
    Some(section(
        "Balance of energy",
        vec![
            Block::Lead(indexed(&lead)),
            picture(scheme_pictures::energy(result.plan, &account.entries), "The books over the run.".into()),
            table(vec![words(""), numbers("")], rows.into()),
        ],
    ))
}

fn schemes(result: &SimulationResult<'_>, figures: &SimulationSummary) -> Option<Block> {
    let (comparison, until) = (result.comparison.as_ref()?, figures.compared_until_s?);
    let percent = |row: &SchemeRow, error: Option<f64>| match error {
        _ if row.scheme == SchemeName::Reference.name() => text("–"),
        Some(error) => number(1e2 * error) + " %",
        None if row.diverged_at_s.is_some() => text("diverged"),
        None => text("–"),
    };
    let whole = result.plan.duration();
    let predictable = if until < 0.99 * whole {
        ": a millionth of the torque moves the reference itself visibly from then on"
    } else {
        ""
    };
    let compared = if comparison.is_constant() {
        "No oscillation under these torques, so no error to measure; --profile reversals crosses the gap.".to_owned()
    } else {
        format!(
            "Root mean square error against the reference over the motion’s standard deviation, up to {} ms of {} \
         ms{predictable}.",
            PAGE.write(1e3 * until),
            PAGE.write(1e3 * whole),
        )
    };
    let lead = format!(
        "{compared} Cost is processor time for a simulated second over that of {}, measured on this machine in one process.",
        SchemeName::Realtime.name()
    );
    let heads = ["deflections", "gap", "link offset", "cost", "sub-steps a tick"].map(numbers);
    let columns = [words("Scheme"), notes("").only(PAGES)].into_iter().chain(heads).collect();
    let rows = comparison.rows.iter().zip(&comparison.tracks).map(|(scheme, track)| {
        let errors = scheme.errors.map(|error| percent(scheme, error));
        let method = scheme.method.map_or_else(String::new, |method| format!(" {method}"));
        let substeps = scheme.substeps.map_or_else(|| "its own".into(), |count| format!("{count}{method}"));
        let about = [strong(scheme.scheme), text(track.scheme.description())];
        let cost = [number_as(scheme.cost_ratio, fixed(2)), text(substeps)];
        row(about.into_iter().chain(errors).chain(cost))
    });
    let mut blocks = vec![Block::Lead(lead.into()), table(columns, rows.collect())];
    let caption = "The reference is the broad line; 0 dB is an error as large as the motion, −40 dB is 1 %.";
    let pictures = scheme_pictures::schemes(result.plan, comparison);
    blocks.extend(pictures.into_iter().map(|figure| picture(figure, caption.into())));
    Some(section_bare("Schemes", blocks))
}

fn origin(result: &SimulationResult<'_>, figures: &SimulationSummary, replay: &str) -> Block {
    let plan = result.plan;
    let rows = [
        ("Joint", format!("{} ({})", figures.joint, figures.file)),
        ("Scheme", format!("{}: {}", figures.scheme, result.scheme.description())),
        ("Scalar", figures.scalar.to_owned()),
        ("Rate", format!("{} Hz", figures.tick_rate_Hz)),
        ("At contact changes", figures.substeps_in_words()),
        ("Torques", figures.torques.clone()),
        ("Start", format!("{}, carrier at {} rad/s", figures.start, PAGE.write(plan.speed))),
        ("Mesh frequency", format!("{} Hz", PAGE.write(plan.mesh_frequency()))),
        ("Command", VERSION.to_owned()),
    ];
    section("What ran", vec![facts(rows), Block::Again(replay.to_owned())])
}
