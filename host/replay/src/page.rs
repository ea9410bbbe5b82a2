//! A replay as a document: comparison with the run, estimated parameters, sources of the estimates, pictures.

use crate::record::{Difference, ReplayRecord};
use identify::page::findings;
use report::document::{
    Block, Document, Text, Tone, bad_notice, facts, notes, number, numbers, picture, row, section, section_bare,
    section_everywhere, strong, table, text, words,
};
use report::plot::Figure;
use report::provenance::VERSION;

/// Differing values shown at most.
const VALUES_SHOWN: usize = 12;

/// Whole report; `file` is the text of the joint file.
pub fn document(record: &ReplayRecord, file: &str, figures: Vec<Figure>) -> Document {
    let ReplayRecord { joint, log, periods, duration_s, control_rate, repeats, .. } = record;
    let verdict = repeats.as_ref().map(|repeats| match repeats.every_bit {
        true => (Tone::Passed, "REPEATED".to_owned()),
        false => (Tone::Failed, "NOT REPEATED".to_owned()),
    });
    let line = match repeats {
        Some(repeats) => format!("{log}: {}", repeats.sentence()),
        None => format!("{log}: estimates of the observer of joint {joint}"),
    };
    let mut blocks = Vec::new();
    if let Some(difference) = repeats.as_ref().and_then(|repeats| repeats.first_difference.as_ref()) {
        blocks.push(differences(difference));
    }
    blocks.push(section_everywhere("Wiring", vec![wiring(record)]));
    blocks.push(section_everywhere("What the estimates stand on", estimate_sources(record)));
    blocks.push(section_bare("What was learnt", findings(&record.learnt, file)));
    blocks.push(section("The estimates", figures.into_iter().map(|figure| picture(figure, Text::default())).collect()));
    Document {
        title: format!("{log} replayed"),
        heading: format!("{log} replayed").into(),
        verdict,
        subtitle: format!("joint {joint} · {periods} control periods at {control_rate:.0} Hz · {duration_s:.2} s")
            .into(),
        line: line.into(),
        blocks,
        footer: text("joint ") + VERSION,
        ..Document::default()
    }
}

/// Verdicts on the wiring; right items share one row.
fn wiring(record: &ReplayRecord) -> Block {
    let of = |verdict: &str| {
        let items = record.wiring.iter().filter(|finding| finding.verdict == verdict);
        items.map(|finding| finding.item.replace('_', " ")).collect::<Vec<_>>().join(", ")
    };
    let bad = record.wiring.iter().filter(|finding| finding.help.is_some()).map(|finding| {
        let found = number(finding.found.unwrap_or_default());
        row([
            text(finding.verdict.as_str()),
            text(finding.item.replace('_', " ")),
            found,
            text(finding.help.clone().unwrap_or_default()),
        ])
    });
    let rest = ["right", "not_seen"]
        .into_iter()
        .filter(|verdict| !of(verdict).is_empty())
        .map(|verdict| row([text(verdict.replace('_', " ")), text(of(verdict)), text(""), text("")]));
    let columns = vec![words("verdict"), words("item"), numbers("found"), notes("what to do")];
    table(columns, bad.chain(rest).collect())
}

fn estimate_sources(record: &ReplayRecord) -> Vec<Block> {
    let mut rows: Vec<(Text, Text)> = vec![
        ("both encoders trusted [%]".into(), number(record.both_encoders_percent)),
        ("gap coordinate valid [%]".into(), number(record.gap_valid_percent)),
    ];
    if record.counts_from_angles {
        rows.push(("counts".into(), "from angles, by the resolution of the joint file's encoders".into()));
    }
    rows.extend(record.log_notes.iter().map(|note| ("log".into(), note.as_str().into())));
    for (notice, count) in &record.notices {
        rows.push((format!("control periods with {notice}").into(), number(*count as f64)));
    }
    let mut blocks = vec![facts(rows)];
    // The first entry is the start, before any sample.
    if record.sources.len() > 2 {
        let columns = vec![numbers("from").in_unit("s"), words("estimates from"), notes("because")];
        let cells = record.sources.iter().map(|change| {
            row([
                text(format!("{:.4}", change.time_s)),
                text(change.estimates_from.replace('_', " ")),
                text(change.encoder_fault.replace('_', " ")),
            ])
        });
        blocks.push(table(columns, cells.collect()));
        if record.sources_left_out > 0 {
            blocks.push(Block::Note(format!("{} later changes are not shown.", record.sources_left_out).into()));
        }
    }
    blocks
}

fn differences(of: &Difference) -> Block {
    let heading =
        strong("Not repeated: ") + format!("from control period {} on, t = {:.4} s", of.period, of.time_s).as_str();
    let mut blocks = vec![bad_notice(heading)];
    if let Some(time) = of.values_time_s {
        let columns = vec![words("value"), numbers("in the log"), numbers("here")];
        let cells = of.values.iter().take(VALUES_SHOWN).map(|value| {
            row([text(&value.name), text(format!("{:e}", value.recorded)), text(format!("{:e}", value.replayed))])
        });
        blocks.push(Block::Lead(format!("The first logged values after it, at t = {time:.4} s:").into()));
        blocks.push(table(columns, cells.collect()));
    }
    section_bare("The first difference", blocks)
}
