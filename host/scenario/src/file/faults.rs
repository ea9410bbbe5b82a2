//! Reads `[[fault]]`: what goes wrong, from when to when. How it goes wrong is `injection`'s business.

use super::motion::refuse_others;
use super::section::Section;

/// One fault.
#[derive(Debug, Clone, PartialEq)]
pub struct Fault {
    /// Its word in the file.
    pub word: &'static str,
    /// What goes wrong.
    pub kind: FaultKind,
    /// [s].
    pub start: f64,
    /// [s]; infinite for a fault that stays.
    pub end: f64,
}

/// Which encoder.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum EncoderName {
    /// On the motor.
    Motor,
    /// On the link.
    Output,
}

/// Which frames.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FrameName {
    /// Readings of the motor's encoder.
    Motor,
    /// Readings of the output encoder.
    Output,
    /// Set-points.
    SetPoints,
}

/// What goes wrong.
#[derive(Debug, Clone, PartialEq)]
pub enum FaultKind {
    /// Counts stand still.
    Frozen(EncoderName),
    /// Counts are off by counts and by an angle [rad].
    Offset(EncoderName, f64, f64),
    /// Counts scatter by a standard deviation.
    Noise(EncoderName, f64),
    /// A part of all counts is not counted.
    MissingCounts(EncoderName, f64),
    /// An error once a turn of an amplitude [rad].
    Eccentric(EncoderName, f64),
    /// Torque beyond the command: a ratio of it, and a torque [N m].
    TorqueBias(f64, f64),
    /// The motor gives no more than this [N m].
    Saturation(f64),
    /// A part of the frames never comes.
    LostFrames(FrameName, f64),
    /// Frames come late [s].
    LateFrames(FrameName, f64),
    /// Every mesh has this half-backlash [m].
    GrownBacklash(f64),
    /// One tooth of the sun has only a part of its stiffness.
    BrokenTooth(f64),
}

/// Reads one `[[fault]]`.
pub(super) fn read(section: &Section<'_>) -> Option<Fault> {
    if !section.has("kind") {
        section.missing("kind");
    }
    let word = section.word("kind")?;
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
    let taken: Vec<&str> = ["kind", "start_s", "end_s"].into_iter().chain(own.iter().copied()).collect();
    refuse_others(section, &taken, word);
    let encoder = match section.word("encoder") {
        Some("motor") => EncoderName::Motor,
        _ => EncoderName::Output,
    };
    let frames = match section.word("frames") {
        Some("motor") => FrameName::Motor,
        Some("set_points") => FrameName::SetPoints,
        _ => FrameName::Output,
    };
    let needed = |name: &str| {
        if !section.has(name) {
            section.missing(name);
        }
        section.number(name)
    };
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
            FaultKind::Offset(encoder, counts, 1e-3 * angle)
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
                section.problems.error(section.span("torque_N_m"), format!("a limit of {limit} N m is none"), help);
            }
            FaultKind::Saturation(limit)
        }
        "lost_frames" => FaultKind::LostFrames(frames, needed("share")?),
        "late_frames" => FaultKind::LateFrames(frames, needed("delay_ms")? / 1e3),
        "grown_backlash" => FaultKind::GrownBacklash(needed("half_backlash_um")? / 1e6),
        _ => FaultKind::BrokenTooth(needed("stiffness_ratio")?),
    };
    let start = section.number("start_s").unwrap_or(0.0);
    let end = section.number("end_s").unwrap_or(f64::INFINITY);
    if end <= start {
        let help = "give an `end_s` after `start_s`, or leave it out for a fault that stays";
        section.problems.error(section.span("end_s"), format!("the fault ends at {end} s, before it begins"), help);
        return None;
    }
    Some(Fault { word, kind, start, end })
}
