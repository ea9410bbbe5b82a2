//! Lines of a board that no image uses yet: CAN, and the encoders of motor and output. Their pins are checked against
//! the chip and against all other uses, so that they stay reserved; the firmware leaves them in their reset state.

use joint_file::wording::listed;

use crate::board::{Can, Encoder, EncoderPins};
use crate::chip::{CanUnit, Part, TimerUnit};
use crate::pin::Pin;
use crate::pins::{Pins, no_unit};
use crate::section::Section;

/// Keys of an SPI encoder, and of a pulse encoder.
const ON_SPI: [&str; 4] = ["select", "clock", "out", "in"];
const BY_PULSES: [&str; 3] = ["a", "b", "index"];

pub(crate) fn read_can(section: &Section<'_>, part: Option<Part>, pins: &Pins) -> Option<Can> {
    let name = section.required("unit", Section::stated);
    let unit = name.zip(part).and_then(|(name, part)| {
        let all = part.chip.facts().can;
        let units: Vec<&str> = all.iter().map(|unit| unit.name).collect();
        all.iter().find(|unit| unit.name == name).or_else(|| no_unit(section, &name, part, &units, None))
    });
    let of = |list: fn(&CanUnit) -> &'static [Pin]| unit.map(|unit| (unit.name, list(unit)));
    let send = pins.of_line(section, "send", of(|unit| unit.send));
    let receive = pins.of_line(section, "receive", of(|unit| unit.receive));
    Some(Can { unit: unit?.name, send: send?, receive: receive? })
}

/// Reads both encoders; each may be left out. Returns `None` if a stated encoder is wrong.
pub(crate) fn read_encoders(section: &Section<'_>, part: Option<Part>, pins: &Pins) -> Option<[Option<Encoder>; 2]> {
    let [motor, output] = ["motor", "output"].map(|name| match section.has(name) {
        true => section.section(name).and_then(|section| read_encoder(&section, part, pins)).map(Some),
        false => Some(None),
    });
    Some([motor?, output?])
}

fn read_encoder(section: &Section<'_>, part: Option<Part>, pins: &Pins) -> Option<Encoder> {
    let name = section.required("unit", Section::stated)?;
    let part = part?;
    let facts = part.chip.facts();
    let spi = facts.spi.unwrap_or_default();
    if let Some(unit) = spi.iter().find(|unit| unit.name == name) {
        refuse(section, &BY_PULSES, &name, &ON_SPI);
        let plain = |list: &'static [crate::pin::Alternate]| list.iter().map(|it| it.pin).collect::<Vec<_>>();
        let select = pins.of_line(section, "select", None);
        let [clock, out, input] = [("clock", unit.clock), ("out", unit.out), ("in", unit.input)]
            .map(|(key, list)| pins.of_bus(section, key, unit.name, &plain(list)));
        let pins = EncoderPins::Spi { select: select?, clock: clock?, out: out?, input: input? };
        return Some(Encoder { unit: unit.name, pins });
    }
    if let Some(unit) = facts.timers.iter().find(|unit| unit.name == name) {
        refuse(section, &ON_SPI, &name, &BY_PULSES);
        let TimerUnit { name, a, b } = *unit;
        let a = pins.of_line(section, "a", Some((name, a)));
        let b = pins.of_line(section, "b", Some((name, b)));
        let index = if section.has("index") { pins.of_line(section, "index", None).map(Some) } else { Some(None) };
        return Some(Encoder { unit: name, pins: EncoderPins::Pulses { a: a?, b: b?, index: index? } });
    }
    let units: Vec<&str> = spi.iter().map(|it| it.name).chain(facts.timers.iter().map(|it| it.name)).collect();
    let why = (facts.spi.is_err() && name.starts_with("SPI")).then_some("the pins of its SPI are not known here");
    no_unit(section, &name, part, &units, why)
}

/// Reports keys that belong to an encoder of the other kind.
fn refuse(section: &Section<'_>, others: &[&str], unit: &str, own: &[&str]) {
    for key in others.iter().filter(|key| section.has(key)) {
        let message = format!("`{key}` is no pin of an encoder on {unit}");
        section.notes.error(section.place(key), message, format!("it has {}", listed(own)));
    }
}
