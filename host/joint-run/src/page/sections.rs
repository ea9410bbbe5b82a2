//! Sections of the report with figures: key figures, motion and timing. The pictures come from `motion`, `close_up` and
//! `timing`.

use super::{close_up, motion, timing};
use crate::record::{Completeness, RunRecord, TimingFigures};
use report::checks::Verdict;
use report::document::{
    Block, Row, Text, Tone, code, emulated, notes, number, numbers, picture, quiet, row, section, strong, table, text,
    tile, words,
};
use report::number::PAGE;
use report::panels;
use report::plot::Figure;

/// Mark of figures measured by an emulator.
pub fn mark(record: &RunRecord) -> Text {
    Text::from(record.identity.emulated.then_some(" ")) + emulated(record.identity.emulated)
}

/// Key figures.
pub fn tiles(record: &RunRecord) -> Block {
    let count = |verdict: Verdict| record.checks.iter().filter(|check| check.verdict == verdict).count();
    let judged = record.checks.iter().filter(|check| check.verdict != Verdict::Reported).count();
    let steps = match record.completeness {
        Completeness::Complete => record.settings.ticks,
        Completeness::Interrupted { tick, .. } => tick,
    };
    let seconds = f64::from(steps) / f64::from(record.settings.tick_rate_hz.max(1));
    let mut tiles = vec![
        tile("Checks held", text(count(Verdict::Passed)) + quiet(format!(" of {judged}"))),
        tile("Steps", number(f64::from(steps)) + quiet(format!(" · {} s", PAGE.write(seconds)))),
    ];
    if let Some(timing) = &record.timing {
        let longest = micro(timing.computation.max_s) + quiet(format!(" of {} µs", PAGE.write(1e6 * timing.period_s)));
        tiles.push(tile(text("Longest tick") + mark(record), longest));
        tiles.push(tile(text("Idle") + mark(record), number(timing.idle_percent) + quiet(" %")));
    }
    if let Some(image) = &record.identity.image {
        let kibibytes = |bytes: u64| text(format!("{:.1}", bytes as f64 / 1024.0)) + quiet(" KiB");
        tiles.push(tile("Flash", kibibytes(image.flash_bytes)));
        tiles.push(tile("RAM of statics", kibibytes(image.ram_bytes)));
    }
    Block::Tiles(tiles)
}

/// All pictures of the motion.
pub fn motion(record: &RunRecord) -> Block {
    if record.samples.is_empty() {
        return section("Motion", vec![Block::Paragraph("No sample was received.".into())]);
    }
    let whole = motion::whole(record);
    let mut gap = vec![whole.gap()];
    gap.extend(whole.wind_up());
    let marked = |figure: Figure, caption: Text| picture(figure, caption + mark(record));
    let mut blocks = vec![
        Block::Lead(
            number(record.samples.len() as f64)
                + format!(" samples, one every {} ticks. ", record.settings.decimation)
                + panels::THINNED,
        ),
        marked(whole.figure("Torques", whole.torques()), "Torques as commanded, held between commands.".into()),
        marked(
            whole.figure("Angles", whole.angles()),
            format!(
                "Angles from integer turns and small remainders. Shaded: the lost motion of {} mrad at the link that \
                 backlash alone allows; teeth and shaft wind up beyond it.",
                PAGE.write(record.joint.lost_motion_rad * 1e3)
            )
            .into(),
        ),
    ];
    if let Some(view) = close_up::view(record) {
        let how = match &record.close_up {
            Some(stretch) => format!("At every tick: {}.", stretch.method),
            None => "From the samples of the line.".to_owned(),
        };
        blocks.push(marked(close_up::figure(&view), strong("A reversal through the gap, closely. ") + how));
    }
    let band = PAGE.write((record.joint.gap_band_m[1] - record.joint.gap_band_m[0]) * 1e6);
    let free = format!(". Shaded: where every mesh can be free at once, 4b = {band} µm wide.");
    blocks.push(marked(whole.figure("Gap coordinate", gap), panels::gap_coordinate() + free));
    blocks.push(marked(whole.figure("Mesh deflections", whole.deflections()), panels::DEFLECTIONS.into()));
    if let Some(errors) = motion::errors(record) {
        let method = record.reference.as_ref().map(|reference| format!(" ({})", reference.method));
        let caption = text("Board less reference, over the standard deviation of the reference") + method + ".";
        blocks.push(marked(errors, caption));
    }
    section(text("Motion") + mark(record), blocks)
}

/// Timing of the board.
pub fn timing(record: &RunRecord) -> Block {
    let Some(figures) = &record.timing else {
        return section("Timing", vec![Block::Paragraph("The board did not report its figures.".into())]);
    };
    let mut blocks = Vec::new();
    if let Some(image) = &record.identity.image {
        blocks.push(Block::Note(
            text(format!("{}, {} · ELF ", record.identity.board, record.identity.transport))
                + code(&image.elf_sha256)
                + format!(" · {} · {}", image.compiler, image.flags),
        ));
    }
    if let Some(histogram) = timing::histogram(figures) {
        let caption = text("Over ") + number(f64::from(figures.ticks)) + " ticks; the vertical axis is logarithmic.";
        blocks.push(picture(histogram, caption + mark(record)));
    }
    blocks.push(Block::Columns(vec![times(record, figures), counts(record, figures)]));
    section(text("Timing") + mark(record), blocks)
}

fn times(record: &RunRecord, figures: &TimingFigures) -> Block {
    let mark = || mark(record);
    let heads = ["least", "mean", "greatest", "of period"].map(numbers);
    let columns = [words(text("Time [µs]") + mark())].into_iter().chain(heads).collect();
    let share = |greatest: f64| number(100.0 * greatest / figures.period_s) + " %";
    let three = |name: &str, times: &crate::record::MinMeanMax| {
        row([text(name), micro(times.min_s), micro(times.mean_s), micro(times.max_s), share(times.max_s)])
    };
    let one = |name: Text, value: Text| Row { spans: true, ..row([name, value]) };
    let bytes = |bytes: u32| number(f64::from(bytes)) + " bytes";
    let rows = vec![
        three("Computation", &figures.computation),
        three("Lateness of the tick", &figures.lateness),
        one(text("Idle share") + mark(), number(figures.idle_percent) + " %"),
        one("Period".into(), micro(figures.period_s) + " µs"),
        one(text("Deepest stack") + mark(), bytes(figures.stack_used_bytes)),
        one("RAM of statics".into(), bytes(figures.static_ram_bytes)),
    ];
    table(columns, rows)
}

fn counts(record: &RunRecord, figures: &TimingFigures) -> Block {
    let columns = vec![words(text("Count") + mark(record)), numbers(""), notes("")];
    let rows = timing::counts(figures).into_iter().map(|(name, count, bad, meaning)| Row {
        tone: if bad && count > 0 { Tone::Failed } else { Tone::Plain },
        ..row([text(name), number(f64::from(count)), text(meaning)])
    });
    table(columns, rows.collect())
}

/// Converts seconds to microseconds.
fn micro(seconds: f64) -> Text {
    number(seconds * 1e6)
}
