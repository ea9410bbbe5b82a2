//! Results of a slow log as a document, and as a record for JSON.

use serde::Serialize;

use super::prediction::Prediction;
use super::results::{Curve, Quantity, Results};
use super::samples::Samples;
use report::document::{
    Align, Block, Document, Text, notes, numbers, picture, row, section, section_bare, table, text, words,
};
use report::number::ESTIMATE;
use report::plot::Figure;
use report::provenance::VERSION;

/// Name and version of the record.
pub const SCHEMA: &str = "joint-identify-quasi-static/1";

/// Record of a slow log.
#[derive(Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Record<'a> {
    schema: &'static str,
    log: &'a str,
    unit: &'a str,
    units_per_turn: Option<f64>,
    duration_s: f64,
    samples: usize,
    period_s: f64,
    /// 5 and 95 % quantile of the time between samples.
    jitter_s: [f64; 2],
    /// Steps of more than ten periods.
    gaps: usize,
    longest_step_s: f64,
    left_out_at_ends: f64,
    bin_width: f64,
    assumptions: Vec<String>,
    quantities: &'a [Quantity],
    prediction: &'a Prediction,
    passes: Vec<Pass>,
    place: &'a [f64],
    width_over_place: &'a Curve,
    hysteresis_over_place: &'a [Curve],
    map_over_place: &'a [f64],
    long_wave_over_place: &'a [f64],
    /// Mean difference by direction and load, each over the place.
    difference_over_place: &'a [Vec<f64>],
}

#[derive(Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
struct Pass {
    forwards: bool,
    load: &'static str,
    from_s: f64,
    to_s: f64,
    speed_per_s: f64,
}

impl<'a> Record<'a> {
    /// Record of a log's results.
    pub fn of(log: &'a str, samples: &Samples, results: &'a Results) -> Self {
        let pass = |one: &super::profiles::Profile| Pass {
            forwards: one.pass.forwards,
            load: results.loading.names()[results.loading.group(one) / 2],
            from_s: one.time[0],
            to_s: one.time[2],
            speed_per_s: one.speed,
        };
        Self {
            schema: SCHEMA,
            log,
            unit: results.scale.unit,
            units_per_turn: results.scale.per_turn,
            duration_s: samples.time.last().copied().unwrap_or_default(),
            samples: samples.time.len(),
            period_s: samples.period,
            jitter_s: samples.jitter,
            gaps: samples.gaps.0,
            longest_step_s: samples.gaps.1,
            left_out_at_ends: results.left_out,
            bin_width: results.profiles.width,
            assumptions: assumptions(samples, results),
            quantities: &results.quantities,
            prediction: &results.prediction,
            passes: results.profiles.all.iter().map(pass).collect(),
            place: &results.profiles.places,
            width_over_place: &results.width,
            hysteresis_over_place: &results.hysteresis,
            map_over_place: &results.map.whole,
            long_wave_over_place: &results.map.long_wave,
            difference_over_place: &results.groups,
        }
    }
}

fn assumptions(samples: &Samples, results: &Results) -> Vec<String> {
    let Results { scale, profiles, left_out, loading, .. } = results;
    let number = |value: f64| ESTIMATE.write(value);
    let (unit, count) = (scale.unit, profiles.all.len());
    let mut all = vec![
        loading.sentence().to_owned(),
        match scale.per_turn {
            Some(turn) if unit == "units" => format!("A turn of the output is {} units, as stated.", number(turn)),
            Some(_) => "Angles are in radians.".to_owned(),
            None => "Figures are in the log's own unit; its size per turn was not stated (--output-units-per-turn)."
                .to_owned(),
        },
        format!(
            "{count} passes, {} bins of {} {unit}, {} {unit} excluded at each end of a pass; median speed {} \
                 {unit}/s.",
            profiles.places.len(),
            number(profiles.width),
            number(*left_out),
            number(profiles.speed())
        ),
        format!(
            "Samples every {} ms (5 to 95 %: {} to {} ms), {} gaps of more than ten periods, longest step {} ms.",
            number(1e3 * samples.period),
            number(1e3 * samples.jitter[0]),
            number(1e3 * samples.jitter[1]),
            samples.gaps.0,
            number(1e3 * samples.gaps.1)
        ),
        "The intervals treat passes as independent repeats; errors common to all passes are not included.".to_owned(),
        format!(
            "The resolution of both encoders together is {} {unit}; half of an interval is at least this.",
            number(samples.resolution)
        ),
    ];
    all.extend(samples.notes.iter().cloned());
    all
}

/// Whole report, with pictures in the given order.
pub fn document(log: &str, samples: &Samples, results: &Results, figures: Vec<Figure>) -> Document {
    let figures = figures.into_iter().map(|figure| picture(figure, Text::default()));
    let seconds = samples.time.last().copied().unwrap_or_default();
    let heading = format!("{log}: slow sweeps");
    Document {
        title: heading.clone(),
        heading: heading.into(),
        subtitle: format!("{seconds:.1} s · {} samples · {} passes", samples.time.len(), results.profiles.all.len())
            .into(),
        blocks: vec![
            section_bare("What was found", vec![quantities(results)]),
            section_bare("Cross-validation", predictions(results)),
            section("Pictures", figures.collect()),
            section_bare(
                "What it rests on",
                vec![Block::List(assumptions(samples, results).into_iter().map(Text::from).collect())],
            ),
        ],
        footer: text("joint ") + VERSION,
        ..Document::default()
    }
}

fn quantities(results: &Results) -> Block {
    let none = || text("–");
    let number = |value: Option<f64>| value.map_or_else(none, |value| ESTIMATE.write(value).into());
    let ends = |ends: Option<[f64; 2]>| {
        ends.map(|ends| ends.map(|end| ESTIMATE.write(end)))
            .map_or_else(none, |[low, high]| format!("{low} … {high}").into())
    };
    let in_degrees = results.scale.per_turn.is_some();
    let mut columns =
        vec![words("Quantity"), numbers("found"), words("95 % interval").aligned(Align::Centre), words("unit")];
    if in_degrees {
        columns.extend([numbers("degrees"), words("95 % interval").aligned(Align::Centre)]);
    }
    columns.push(notes("note"));
    let rows = results.quantities.iter().map(|one| {
        let mut cells = vec![text(&one.name), number(one.value), ends(one.interval), text(&one.unit)];
        if in_degrees {
            cells.extend([number(one.value_deg), ends(one.interval_deg)]);
        }
        cells.push(text(&one.note));
        row(cells)
    });
    table(columns, rows.collect())
}

fn predictions(results: &Results) -> Vec<Block> {
    let Results { prediction, scale, .. } = results;
    let rows = [
        ("a map alone", prediction.map),
        ("a map and one number per direction and load", prediction.map_and_width),
        ("a curve per direction and load", prediction.curves),
        ("expected residual of the curves from repeatability alone", prediction.repeatability),
        ("explained by the curves beyond one number", prediction.unexplained()),
    ];
    let rows = rows.map(|(name, value)| row([text(name), text(ESTIMATE.write(value)), text(scale.unit)]));
    let lead = format!(
        "Fitted on {} passes, tested on the other {}: root mean square of the residuals, by bins.",
        prediction.fitted, prediction.predicted
    );
    let mut blocks = vec![
        Block::Paragraph(lead.into()),
        table(vec![words("Model"), numbers("left over"), words("unit")], rows.into_iter().collect()),
    ];
    let groups = results.groups.len();
    if (prediction.fitted, prediction.predicted) == (groups, groups) {
        let note = "With two passes of each kind the third and the fourth line are equal by construction.";
        blocks.push(Block::Note(note.into()));
    }
    blocks
}
