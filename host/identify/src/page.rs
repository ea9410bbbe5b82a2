//! The identified parameters as a document: a table of every parameter with its interval beside the joint file's value,
//! the fit, and its assumptions.

use super::findings::{Finding, Record};
use report::document::{
    Align, Block, Document, PAGES, Text, notes, numbers, picture, row, section, section_bare, strong, table, text,
    words,
};
use report::number::ESTIMATE;
use report::plot::Figure;
use report::provenance::VERSION;

/// Name of the report.
pub const REPORT: &str = "report.html";
/// Name of the patched joint file.
pub const JOINT: &str = "joint.toml";
/// Name of the findings.
pub const FINDINGS: &str = "findings.json";

/// Whole report: findings beside the values of the joint file, given as text, and pictures, the most telling first.
pub fn document(record: &Record<'_>, file: &str, figures: Vec<Figure>) -> Document {
    let Record { joint, log, duration_s, crossings, findings, .. } = record;
    let figures = figures.into_iter().map(|figure| picture(figure, Text::default()));
    let assumptions = record.assumptions.iter().map(|assumption| typeset(assumption).into());
    Document {
        title: format!("Joint {joint} identified"),
        heading: format!("Joint {joint} identified").into(),
        subtitle: format!("{log} · {duration_s:.2} s · {crossings} crossings of the gap").into(),
        blocks: vec![
            section_bare("What was found", self::findings(findings, file)),
            section("How it fits", figures.collect()),
            section("What it rests on", vec![Block::List(assumptions.collect())]),
        ],
        footer: text("joint ") + VERSION,
        ..Document::default()
    }
}

/// Findings with their intervals beside the values of the joint file, given as text.
pub fn findings(findings: &[Finding], file: &str) -> Vec<Block> {
    let columns = vec![
        words("Parameter"),
        numbers("found"),
        words("95 % interval").aligned(Align::Centre),
        words("unit"),
        numbers("joint file"),
        notes("note"),
    ];
    let none = || text("–");
    let rows = findings.iter().map(|finding| {
        let interval = finding.interval.map(|ends| ends.map(|end| ESTIMATE.write(end)));
        let stated = match stated(file, finding) {
            Some(stated) if differs(finding, &stated) => strong(stated),
            Some(stated) => text(stated),
            None => none(),
        };
        row([
            text(&finding.name),
            finding.value.map_or_else(none, |value| ESTIMATE.write(value).into()),
            interval.map_or_else(none, |[low, high]| format!("{low} … {high}").into()),
            unit(&finding.unit).into(),
            stated,
            typeset(&finding.note).into(),
        ])
    });
    let mut blocks = vec![table(columns, rows.collect())];
    if findings.iter().any(|one| stated(file, one).is_some_and(|stated| differs(one, &stated))) {
        let note = Block::Note("Bold: the joint file's value is outside of the interval.".into());
        blocks.push(Block::Only(PAGES, vec![note]));
    }
    blocks
}

/// Value of the joint file for a finding, written like the findings.
pub fn stated(file: &str, finding: &Finding) -> Option<String> {
    let value = joint_file::value(file, finding.key.as_deref()?).ok()??;
    Some(value.replace('_', "").parse().map_or_else(|_| value.to_owned(), |value| ESTIMATE.write(value)))
}

/// Returns true if a stated value is outside of the interval.
fn differs(finding: &Finding, stated: &str) -> bool {
    let stated: Option<f64> = stated.replace('_', "").parse().ok();
    stated.zip(finding.interval).is_some_and(|(stated, [low, high])| !(low..=high).contains(&stated))
}

/// Typographic signs, which the text of written findings avoids.
fn typeset(text: &str) -> String {
    text.replace("+- ", "± ").replace(" us", " µs")
}

/// Unit with Greek letters and centred dots.
fn unit(unit: &str) -> String {
    let micro = unit.strip_prefix('u').map_or(unit.to_owned(), |rest| format!("µ{rest}"));
    micro.replace(' ', "·")
}
