//! CAN line of a board: peripheral, pins, bit rates, and the transceiver that the board has or has not.

use crate::bit_timing::{BitTiming, TimingLimits};
use crate::board::{Can, Transceiver};
use crate::chip::{CanUnit, Part};
use crate::pins::{Pins, report_unknown_unit};
use crate::section::Section;

/// Bit rate of a file that names none [bit/s]: that of most drives.
const USUAL_BITRATE: u32 = 1_000_000;
/// Sample point of the arbitration, by CiA 301 [thousandths of a bit].
const SAMPLE_POINT: u32 = 875;
/// Sample point of the data at the second bit rate, by CiA 601-3 [thousandths of a bit].
const DATA_SAMPLE_POINT: u32 = 800;

pub(crate) fn read(section: &Section<'_>, part: Option<Part>, pins: &Pins) -> Option<Can> {
    let name = section.required("unit", Section::text_with_source);
    let unit = name.zip(part).and_then(|(name, part)| {
        let all = part.chip.facts().can;
        let units: Vec<&str> = all.iter().map(|unit| unit.name).collect();
        all.iter().find(|unit| unit.name == name).or_else(|| report_unknown_unit(section, &name, part, &units, None))
    });
    let unit_pins = |list: fn(&CanUnit) -> &'static [_]| unit.map(|unit| (unit.name, list(unit)));
    let send = pins.claim_alternate(section, "send", unit_pins(|unit| unit.send));
    let receive = pins.claim_alternate(section, "receive", unit_pins(|unit| unit.receive));
    let bitrate = if section.has("bitrate") { section.whole("bitrate")? } else { USUAL_BITRATE };
    let data_bitrate = if section.has("data_bitrate") { Some(section.whole("data_bitrate")?) } else { None };
    let transceiver = match section.has("transceiver").then(|| section.choice("transceiver")) {
        Some(Some("yes")) => Transceiver::OnBoard,
        Some(Some(_)) => Transceiver::None,
        Some(None) => return None,
        None => Transceiver::Unknown,
    };
    let unit = unit?;
    let timing = timing(section, unit, bitrate, &FIRST);
    let data_timing = match data_bitrate {
        Some(rate) if rate < bitrate => {
            let message = format!("`data_bitrate` of {rate} bit/s is below `bitrate` of {bitrate} bit/s");
            let help = "data at the second bit rate is at least as fast as the arbitration";
            section.notes.error(section.place("data_bitrate"), message, help);
            return None;
        }
        Some(rate) => Some(timing_of_data(section, unit, rate)?),
        None => None,
    };
    Some(Can {
        unit: unit.name,
        send: send?,
        receive: receive?,
        bitrate,
        data_bitrate,
        timing: timing?,
        data_timing,
        transceiver,
    })
}

fn timing_of_data(section: &Section<'_>, unit: &CanUnit, rate: u32) -> Option<BitTiming> {
    if unit.data_timing.is_none() {
        let message = format!("{} has no second bit rate: it is classical CAN", unit.name);
        section.notes.error(section.place("data_bitrate"), message, "leave `data_bitrate` out");
        return None;
    }
    timing(section, unit, rate, &SECOND)
}

/// Requirements on a bit rate.
struct Wanted {
    key: &'static str,
    /// Sample point [thousandths of a bit].
    sample_point: u32,
    limits: fn(&CanUnit) -> Option<TimingLimits>,
    /// Prescalers in the words of an error.
    prescalers: &'static str,
}

const FIRST: Wanted = Wanted {
    key: "bitrate",
    sample_point: SAMPLE_POINT,
    limits: |unit| Some(unit.timing),
    prescalers: "no prescaler gives",
};
const SECOND: Wanted = Wanted {
    key: "data_bitrate",
    sample_point: DATA_SAMPLE_POINT,
    limits: |unit| unit.data_timing,
    prescalers: "neither prescaler that the transmitter delay compensation allows, 1 and 2, gives",
};

fn timing(section: &Section<'_>, unit: &CanUnit, rate: u32, wanted: &Wanted) -> Option<BitTiming> {
    let Wanted { key, sample_point, limits, prescalers } = wanted;
    let limits = limits(unit)?;
    let of = |rate| BitTiming::new(unit.clock, rate, *sample_point, limits);
    let found = of(rate);
    if found.is_none() {
        let (name, mega) = (unit.name, f64::from(unit.clock) / 1e6);
        let message = format!(
            "`{key}` of {rate} bit/s cannot be made from the {mega} MHz of {name}: {prescalers} whole quanta with the \
             sample point within 5 % of {} %",
            f64::from(*sample_point) / 10.0
        );
        let usual = [5_000_000, 2_000_000, 1_000_000, 500_000, 250_000, 125_000];
        let able: Vec<String> =
            usual.into_iter().filter(|rate| of(*rate).is_some()).map(|rate| rate.to_string()).collect();
        let place = if section.has(key) { section.place(key) } else { section.header.clone() };
        section.notes.error(place, message, format!("rates that can be made: {}", able.join(", ")));
    }
    found
}
