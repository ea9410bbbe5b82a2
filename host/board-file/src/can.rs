//! CAN line of a board: peripheral, pins, bit rates, and the transceiver that the board has or has not.

use crate::bit_timing::BitTiming;
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
    let timing = timing(section, unit, bitrate, SAMPLE_POINT, "bitrate", Some(unit.timing));
    let data = match data_bitrate {
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
        clock: unit.clock,
        send: send?,
        receive: receive?,
        bitrate,
        data_bitrate,
        timing: timing?,
        data_timing: data,
        transceiver,
    })
}

fn timing_of_data(section: &Section<'_>, unit: &CanUnit, rate: u32) -> Option<BitTiming> {
    if unit.data_timing.is_none() {
        let message = format!("{} has no second bit rate: it is classical CAN", unit.name);
        section.notes.error(section.place("data_bitrate"), message, "leave `data_bitrate` out");
        return None;
    }
    timing(section, unit, rate, DATA_SAMPLE_POINT, "data_bitrate", unit.data_timing)
}

fn timing(
    section: &Section<'_>,
    unit: &CanUnit,
    rate: u32,
    sample_point: u32,
    key: &str,
    limits: Option<crate::bit_timing::TimingLimits>,
) -> Option<BitTiming> {
    let found = limits.and_then(|limits| BitTiming::new(unit.clock, rate, sample_point, limits));
    if found.is_none() {
        let (name, mega) = (unit.name, f64::from(unit.clock) / 1e6);
        let message = format!(
            "`{key}` of {rate} bit/s cannot be made from the {mega} MHz of {name}: no prescaler gives whole quanta with \
             the sample point within 5 % of {} %",
            f64::from(sample_point) / 10.0
        );
        let usual = [5_000_000, 2_000_000, 1_000_000, 500_000, 250_000, 125_000];
        let fits =
            |rate: &u32| limits.is_some_and(|limits| BitTiming::new(unit.clock, *rate, sample_point, limits).is_some());
        let able: Vec<String> = usual.iter().filter(|rate| fits(rate)).map(u32::to_string).collect();
        let place = if section.has(key) { section.place(key) } else { section.header.clone() };
        section.notes.error(place, message, format!("rates that can be made: {}", able.join(", ")));
    }
    found
}
