//! Decides which pins a board file may use: pins that the chip's package brings out and that have no other use, each
//! once.

use std::cell::RefCell;
use std::ops::Range;

use joint_file::wording::listed_as;
use joint_file::{Notes, Severity};

use crate::board::ExternalClock;
use crate::chip::Part;
use crate::pin::{Alternate, Pin};
use crate::section::Section;

/// Pins of the debug probe. Reset has its own pin.
const PROBE_PINS: [(Pin, &str); 2] = [
    (Pin { port: 0, number: 13 }, "the debug probe's data (SWDIO)"),
    (Pin { port: 0, number: 14 }, "the debug probe's clock (SWCLK)"),
];

/// Use of a pin.
struct PinUse {
    /// Key with its section.
    key: String,
    pin: Pin,
    span: Range<usize>,
    /// Peripheral and wire, for a bus that several devices may share.
    bus: Option<(&'static str, String)>,
}

/// Reports a peripheral that the chip does not have or does not support for this purpose.
pub(crate) fn report_unknown_unit<T>(
    section: &Section<'_>,
    name: &str,
    part: Part,
    units: &[&str],
    why: Option<&str>,
) -> Option<T> {
    let chip = part.chip.name().to_uppercase();
    let message = match why {
        Some(why) => format!("{name} of {chip} cannot be used: {why}"),
        None => format!("{chip} has no {name} for [{}]", section.path),
    };
    section.notes.error(section.place("unit"), message, format!("use {}", listed_as(units, '"', "or")));
    None
}

/// Reads pins and records their uses.
pub(crate) struct Pins {
    /// `None` if the file's chip is missing or wrong.
    part: Option<Part>,
    /// `None` if the file's clock is missing or wrong.
    clock: Option<ExternalClock>,
    uses: RefCell<Vec<PinUse>>,
}

impl Pins {
    pub fn new(part: Option<Part>, clock: Option<ExternalClock>) -> Self {
        Self { part, clock, uses: RefCell::default() }
    }

    /// Reads a pin for the firmware's use.
    pub fn claim(&self, section: &Section<'_>, name: &str) -> Option<Pin> {
        let (pin, span) = (self.claim_unreserved(section, name, None)?, section.place(name));
        let boot = self.part.and_then(|part| part.chip.facts().boot_pin).filter(|boot| *boot == pin);
        if let Some(boot) = boot {
            let message =
                format!("{boot} is read as BOOT0 at a reset: while it is high the chip starts its boot loader");
            let help = "use another pin, or clear the option bit nSWBOOT0 of the chip";
            section.notes.problem(span, message, help, Severity::Warning);
        }
        Some(pin)
    }

    /// Reads a pin that the package has and that is not reserved. `bus` names the peripheral of a shared bus.
    fn claim_unreserved(&self, section: &Section<'_>, name: &str, bus: Option<&'static str>) -> Option<Pin> {
        let pin = section.required(name, Section::pin)?;
        let (key, span) = (section.full(name), section.place(name));
        self.uses.borrow_mut().push(PinUse {
            key,
            pin,
            span: span.clone(),
            bus: bus.map(|unit| (unit, name.to_owned())),
        });
        match self.reservation(pin) {
            None => Some(pin),
            Some((message, help)) => {
                section.notes.error(span, message, help);
                None
            }
        }
    }

    /// Reads a pin of a line that no image uses yet; `of` holds the peripheral's name and its possible pins, if the pin
    /// belongs to one.
    pub fn claim_line_pin(&self, section: &Section<'_>, name: &str, of: Option<(&str, &[Pin])>) -> Option<Pin> {
        let pin = self.claim_unreserved(section, name, None)?;
        of.is_none_or(|(unit, list)| self.check_listed(section, name, pin, unit, list)).then_some(pin)
    }

    /// Reads a pin of a bus that several devices may share.
    pub fn claim_bus_pin(&self, section: &Section<'_>, name: &str, unit: &'static str, list: &[Pin]) -> Option<Pin> {
        let pin = self.claim_unreserved(section, name, Some(unit))?;
        self.check_listed(section, name, pin, unit, list).then_some(pin)
    }

    /// Reads a pin in a peripheral's alternate function; `of` holds the peripheral's name and its possible pins.
    pub fn claim_alternate(
        &self,
        section: &Section<'_>,
        name: &str,
        of: Option<(&str, &[Alternate])>,
    ) -> Option<Alternate> {
        let pin = self.claim(section, name);
        let (unit, list) = of?;
        let pin = pin?;
        if let Some(found) = list.iter().find(|alternate| alternate.pin == pin) {
            return Some(*found);
        }
        let pins: Vec<Pin> = list.iter().map(|alternate| alternate.pin).collect();
        self.check_listed(section, name, pin, unit, &pins);
        None
    }

    /// Returns whether a pin is in the peripheral's list; reports an error if not.
    fn check_listed(&self, section: &Section<'_>, name: &str, pin: Pin, unit: &str, list: &[Pin]) -> bool {
        if list.contains(&pin) {
            return true;
        }
        let has = |pin: &&Pin| self.part.is_none_or(|part| part.has(**pin));
        let there: Vec<String> = list.iter().filter(has).map(Pin::to_string).collect();
        let help = match there.as_slice() {
            [] => format!("no pin of this package is `{name}` of {unit}: use another unit"),
            _ => format!("{unit} has {} for `{name}`", there.join(" or ")),
        };
        section.notes.error(section.place(name), format!("{pin} cannot be `{name}` of {unit}"), help);
        false
    }

    /// Reason why a pin is reserved, and the help.
    fn reservation(&self, pin: Pin) -> Option<(String, String)> {
        let part = self.part?;
        if !part.has(pin) {
            return Some((format!("{} has no {pin}", part.name()), format!("its package brings out {}", part.pins())));
        }
        if let Some((_, what)) = PROBE_PINS.iter().find(|(probe, _)| *probe == pin) {
            return Some((
                format!("{pin} is {what}"),
                "use another pin: without the debug probe the board cannot be flashed".to_owned(),
            ));
        }
        let what = match self.clock? {
            ExternalClock::None => return None,
            ExternalClock::Crystal(_) => "the crystal",
            ExternalClock::Signal(_) => "the clock signal",
        };
        let is_oscillator_pin = part.chip.facts().oscillator_pins.contains(&pin);
        is_oscillator_pin.then(|| {
            let help = "use another pin; with source = \"internal\" in [clock] it would be free".to_owned();
            (format!("{pin} is the pin of {what}"), help)
        })
    }

    /// Reads `[never_driven]`.
    pub fn never_driven(&self, top: &Section<'_>) -> Option<Vec<(Pin, String)>> {
        use toml::de::DeValue;
        const NAME: &str = "never_driven";
        if !top.has(NAME) {
            return Some(Vec::new());
        }
        let DeValue::Table(table) = top.table(NAME)?.get_ref() else { return None };
        let mut list = Some(Vec::new());
        for (key, value) in table {
            let word = key.get_ref().as_ref();
            let pin = word.parse::<Pin>().ok();
            let (message, help) = match (pin, value.get_ref()) {
                (None, _) => (format!("`{word}` in [{NAME}] is no pin"), "write PA8 = \"its use\"".to_owned()),
                (Some(pin), _) if self.part.is_some_and(|part| !part.has(pin)) => {
                    let pins = self.part.map_or(String::new(), |part| part.pins());
                    (format!("the chip has no {pin}"), format!("its package brings out {pins}"))
                }
                (Some(pin), DeValue::String(what)) if !what.trim().is_empty() => {
                    top.notes.source(format!("{NAME}.{pin}"), &value.span());
                    list.iter_mut().for_each(|list: &mut Vec<_>| list.push((pin, what.to_string())));
                    continue;
                }
                (Some(pin), _) => (
                    format!("`{pin}` in [{NAME}] must state the pin's use"),
                    "write it as a string: \"gate of phase A\"".to_owned(),
                ),
            };
            let place = if pin.is_some() { value.span() } else { key.span() };
            top.notes.error(place, message, help);
            list = None;
        }
        if let Some(list) = &mut list {
            list.sort();
        }
        list
    }

    /// Reports pins that are used twice, and used pins that must never be driven.
    pub fn check(&self, never_driven: &[(Pin, String)], notes: &Notes<'_>) {
        let uses = self.uses.borrow();
        for (at, PinUse { key, pin, span, bus }) in uses.iter().enumerate() {
            let is_other = |other: &&PinUse| other.pin == *pin && (bus.is_none() || other.bus != *bus);
            if let Some(first) = uses[..at].iter().find(is_other) {
                let message = format!("{pin} is used twice, for `{}` and for `{key}`", first.key);
                notes.error(span.clone(), message, "give one of them another pin");
            }
            if let Some((_, what)) = never_driven.iter().find(|(left, _)| left == pin) {
                let message = format!("{pin} of `{key}` is never driven: {what}");
                notes.error(
                    span.clone(),
                    message,
                    "use another pin, or take it out of [never_driven] if that is wrong",
                );
            }
        }
    }
}
