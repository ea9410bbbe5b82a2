//! Reads `[[fault]]`: kind, start and end of a fault, in SI.

use model_core::virtual_joint::fault::{self, EncoderShaft, FaultKind, FaultUnits};

use super::motion::reject_unused_keys;
use super::section::Section;
use crate::random::RandomStream;

/// One fault of a test.
pub type Fault = fault::Fault<Si>;

/// Units of faults in test files and on the host: seconds, radians, counts of the encoder, shares of one, N m. The seed
/// of a fault is set in each run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Si;

impl FaultUnits for Si {
    type Time = f64;
    type Seed = ();
    type Offset = Offset;
    type Deviation = f64;
    type Share = f64;
    type Real = f64;
    type Other = HostOnlyFault;
}

/// Offset of an encoder: the sum of both fields.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Offset {
    /// Offset in the encoder's counts.
    pub counts: f64,
    /// Offset as an angle [rad].
    pub angle: f64,
}

/// Faults that only the host can apply: a board stores no past readings, receives no set-points over a line, and has
/// its teeth as tables in flash.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum HostOnlyFault {
    /// Readings of an encoder arrive late [s].
    LateReadings(EncoderShaft, f64),
    /// Share of the set-points that are lost.
    LostSetPoints(f64),
    /// Set-points arrive late [s].
    LateSetPoints(f64),
    /// Half-backlash of every mesh [m].
    GrownBacklash(f64),
    /// Remaining share of the stiffness of one tooth of the sun.
    BrokenTooth(f64),
}

/// Source of frames.
#[derive(Clone, Copy)]
enum FrameSource {
    Readings(EncoderShaft),
    SetPoints,
}

/// Tolerance for times that are whole control periods [s].
const TIME_TOLERANCE: f64 = 1e-9;

/// Returns true if a fault is active at a time [s].
pub fn fault_is_active(fault: &Fault, time: f64) -> bool {
    (fault.start - TIME_TOLERANCE..fault.end - TIME_TOLERANCE).contains(&time)
}

/// Word of a fault in test files.
pub fn fault_word(fault: &Fault) -> &'static str {
    match fault.kind {
        FaultKind::Frozen(_) => "encoder_frozen",
        FaultKind::Offset(..) => "encoder_offset",
        FaultKind::Noise(..) => "encoder_noise",
        FaultKind::MissingCounts(..) => "encoder_missing_counts",
        FaultKind::Eccentric(..) => "encoder_eccentric",
        FaultKind::TorqueBias(..) => "torque_bias",
        FaultKind::Saturation(_) => "torque_saturation",
        FaultKind::LostReadings(..) | FaultKind::Other(HostOnlyFault::LostSetPoints(_)) => "lost_frames",
        FaultKind::Other(HostOnlyFault::LateReadings(..) | HostOnlyFault::LateSetPoints(_)) => "late_frames",
        FaultKind::Other(HostOnlyFault::GrownBacklash(_)) => "grown_backlash",
        FaultKind::Other(HostOnlyFault::BrokenTooth(_)) => "broken_tooth",
    }
}

/// Random stream of a fault at a place in the file, for a seed.
pub fn fault_stream(fault: &Fault, place: usize, seed: u64) -> RandomStream {
    RandomStream::new(seed, &format!("fault {place} {}", fault_word(fault)))
}

/// Reads one `[[fault]]`.
pub(super) fn read(section: &Section<'_>) -> Option<Fault> {
    let word = section.required("kind", Section::word)?;
    let own: &[&'static str] = match word {
        "encoder_frozen" => &["encoder"],
        "encoder_offset" => &["encoder", "counts", "offset_mrad"],
        "encoder_noise" => &["encoder", "noise_counts"],
        "encoder_missing_counts" => &["encoder", "share"],
        "encoder_eccentric" => &["encoder", "error_deg"],
        "torque_bias" => &["ratio", "torque_N_m"],
        "torque_saturation" => &["torque_N_m"],
        "lost_frames" => &["frames", "share"],
        "late_frames" => &["frames", "delay_ms"],
        "grown_backlash" => &["half_backlash_um"],
        _ => &["stiffness_ratio"],
    };
    let known_keys: Vec<&str> = ["kind", "start_s", "end_s"].into_iter().chain(own.iter().copied()).collect();
    reject_unused_keys(section, &known_keys, word);
    let encoder = match section.word("encoder") {
        Some("motor") => EncoderShaft::Motor,
        _ => EncoderShaft::Link,
    };
    let frames = match section.word("frames") {
        Some("motor") => FrameSource::Readings(EncoderShaft::Motor),
        Some("set_points") => FrameSource::SetPoints,
        _ => FrameSource::Readings(EncoderShaft::Link),
    };
    let needed = |name: &str| section.required(name, Section::number);
    let one_of = |names: [&str; 2]| {
        if !names.iter().any(|name| section.has(name)) {
            section.missing(names[0]);
        }
        names.map(|name| section.number(name).unwrap_or(0.0))
    };
    let kind = match word {
        "encoder_frozen" => FaultKind::Frozen(encoder),
        "encoder_offset" => {
            let [counts, angle] = one_of(["counts", "offset_mrad"]);
            FaultKind::Offset(encoder, Offset { counts, angle: 1e-3 * angle })
        }
        "encoder_noise" => FaultKind::Noise(encoder, needed("noise_counts")?),
        "encoder_missing_counts" => FaultKind::MissingCounts(encoder, needed("share")?),
        "encoder_eccentric" => FaultKind::Eccentric(encoder, needed("error_deg")?.to_radians()),
        "torque_bias" => {
            let [ratio, torque] = one_of(["ratio", "torque_N_m"]);
            FaultKind::TorqueBias(ratio, torque)
        }
        "torque_saturation" => {
            let limit = needed("torque_N_m")?;
            if limit < 0.0 {
                let help = "write the most that the motor gives, to either side";
                section.notes.error(
                    section.place("torque_N_m"),
                    format!("the torque limit of {limit} N m is negative"),
                    help,
                );
            }
            FaultKind::Saturation(limit)
        }
        "lost_frames" => {
            let share = needed("share")?;
            match frames {
                FrameSource::Readings(of) => FaultKind::LostReadings(of, share),
                FrameSource::SetPoints => FaultKind::Other(HostOnlyFault::LostSetPoints(share)),
            }
        }
        "late_frames" => {
            let delay = needed("delay_ms")? / 1e3;
            FaultKind::Other(match frames {
                FrameSource::Readings(of) => HostOnlyFault::LateReadings(of, delay),
                FrameSource::SetPoints => HostOnlyFault::LateSetPoints(delay),
            })
        }
        "grown_backlash" => FaultKind::Other(HostOnlyFault::GrownBacklash(needed("half_backlash_um")? / 1e6)),
        _ => FaultKind::Other(HostOnlyFault::BrokenTooth(needed("stiffness_ratio")?)),
    };
    let start = section.number("start_s").unwrap_or(0.0);
    let end = section.number("end_s").unwrap_or(f64::INFINITY);
    if end <= start {
        let help = "give an `end_s` after `start_s`, or leave it out for a fault that stays";
        section.notes.error(section.place("end_s"), format!("the fault ends at {end} s, before it begins"), help);
        return None;
    }
    Some(Fault { start, end, seed: (), kind })
}

#[cfg(test)]
mod tests {
    use super::super::{keys, read};
    use super::*;

    /// Every word with the keys that it needs.
    const WORDS: [(&str, &str); 11] = [
        ("encoder_frozen", ""),
        ("encoder_offset", "counts = 5"),
        ("encoder_noise", "noise_counts = 4"),
        ("encoder_missing_counts", "share = 0.1"),
        ("encoder_eccentric", "error_deg = 0.1"),
        ("torque_bias", "torque_N_m = 0.1"),
        ("torque_saturation", "torque_N_m = 1"),
        ("lost_frames", "share = 0.1"),
        ("late_frames", "delay_ms = 1"),
        ("grown_backlash", "half_backlash_um = 60"),
        ("broken_tooth", "stiffness_ratio = 0.5"),
    ];

    #[test]
    fn every_word_is_read_as_its_own_fault() {
        for word in keys::FAULTS {
            let (_, needed) =
                WORDS.iter().find(|(known, _)| known == word).unwrap_or_else(|| panic!("no keys of {word}"));
            let file = read(&format!("profile = \"T2\"\n[[fault]]\nkind = \"{word}\"\n{needed}")).expect("a good file");
            assert_eq!(file.faults.iter().map(fault_word).collect::<Vec<_>>(), [*word]);
        }
    }
}
