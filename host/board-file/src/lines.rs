//! Encoders of motor and output, which no image reads yet. Their pins are checked against the chip and against all
//! other uses, so that they stay reserved; the firmware leaves them in their reset state.

use joint_file::wording::listed;

use crate::board::{Encoder, EncoderPins};
use crate::chip::{Part, TimerUnit};
use crate::pins::{Pins, report_unknown_unit};
use crate::section::Section;

/// Keys of an SPI encoder, and of a pulse encoder.
const SPI_KEYS: [&str; 4] = ["select", "clock", "out", "in"];
const PULSE_KEYS: [&str; 3] = ["a", "b", "index"];

/// Reads both encoders; each may be left out. Returns `None` if a stated encoder is wrong.
pub(crate) fn read_encoders(section: &Section<'_>, part: Option<Part>, pins: &Pins) -> Option<[Option<Encoder>; 2]> {
    let [motor, output] = ["motor", "output"].map(|name| match section.has(name) {
        true => section.section(name).and_then(|section| read_encoder(&section, part, pins)).map(Some),
        false => Some(None),
    });
    Some([motor?, output?])
}

fn read_encoder(section: &Section<'_>, part: Option<Part>, pins: &Pins) -> Option<Encoder> {
    let name = section.required("unit", Section::text_with_source)?;
    let part = part?;
    let facts = part.chip.facts();
    let spi = facts.spi.unwrap_or_default();
    if let Some(unit) = spi.iter().find(|unit| unit.name == name) {
        report_foreign_keys(section, &PULSE_KEYS, &name, &SPI_KEYS);
        let plain = |list: &'static [crate::pin::Alternate]| list.iter().map(|it| it.pin).collect::<Vec<_>>();
        let select = pins.claim_line_pin(section, "select", None);
        let [clock, out, input] = [("clock", unit.clock), ("out", unit.out), ("in", unit.input)]
            .map(|(key, list)| pins.claim_bus_pin(section, key, unit.name, &plain(list)));
        let pins = EncoderPins::Spi { select: select?, clock: clock?, out: out?, input: input? };
        return Some(Encoder { unit: unit.name, pins });
    }
    if let Some(unit) = facts.timers.iter().find(|unit| unit.name == name) {
        report_foreign_keys(section, &SPI_KEYS, &name, &PULSE_KEYS);
        let TimerUnit { name, a, b } = *unit;
        let a = pins.claim_line_pin(section, "a", Some((name, a)));
        let b = pins.claim_line_pin(section, "b", Some((name, b)));
        let index =
            if section.has("index") { pins.claim_line_pin(section, "index", None).map(Some) } else { Some(None) };
        return Some(Encoder { unit: name, pins: EncoderPins::Pulses { a: a?, b: b?, index: index? } });
    }
    let units: Vec<&str> = spi.iter().map(|it| it.name).chain(facts.timers.iter().map(|it| it.name)).collect();
    let why = (facts.spi.is_err() && name.starts_with("SPI")).then_some("the pins of its SPI are not in this program");
    report_unknown_unit(section, &name, part, &units, why)
}

/// Reports keys that belong to an encoder of the other kind.
fn report_foreign_keys(section: &Section<'_>, others: &[&str], unit: &str, own: &[&str]) {
    for key in others.iter().filter(|key| section.has(key)) {
        let message = format!("`{key}` is no pin of an encoder on {unit}");
        section.notes.error(section.place(key), message, format!("use {}", listed(own)));
    }
}
