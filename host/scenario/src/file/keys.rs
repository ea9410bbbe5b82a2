//! Every key of a test file: its section, what it holds, its bound, and a hint for who got it wrong. The page
//! docs/reference/hil-file.md says the same in more words.

use board::profile::LONGEST_RUN;
use joint_file::Keys;

/// What a key holds.
#[derive(Debug, Clone, Copy)]
pub(super) enum Kind {
    /// A string.
    Text,
    /// One of these words.
    Word(&'static [&'static str]),
    /// A list of these words.
    Words(&'static [&'static str]),
    /// true or false.
    Flag,
    /// A number with both ends allowed.
    Number(f64, f64),
    /// A number, or a range of which every seed draws one.
    Range(f64, f64),
    /// A number of seeds, or a list of them.
    Seeds,
    /// A table.
    Section,
    /// Tables in double brackets.
    Sections,
}

/// One key.
pub(super) type Key = joint_file::Key<Kind>;

impl Keys for Kind {
    const FILE: &'static str = "a test file";
    const ALL: &'static [Key] = KEYS;

    fn stray(section: &str, word: &str) -> String {
        if section.is_empty() && joint_file::full_key(word).is_ok() {
            return "this is a key of the joint file: write it in [known] or in [plant]".to_owned();
        }
        let known: Vec<String> = Self::of(section).map(|key| format!("`{}`", key.name)).collect();
        Self::belongs(word).unwrap_or_else(|| format!("known here: {}", known.join(", ")))
    }
}

const fn key(section: &'static str, name: &'static str, kind: Kind, hint: &'static str) -> Key {
    Key { section, name, kind, hint }
}

use Kind::{Flag, Number, Range, Section, Sections, Seeds, Text, Word, Words};

/// Controllers that a test may be about.
pub(super) const MODES: &[&str] = &[
    "preview",
    "no_preview",
    "impedance",
    "probe",
    "none",
    "locked",
    "off",
    "motor_pid",
    "velocity_sign",
    "load_cascade",
    "output_integral",
    "motor_side",
    "link_spring",
    "link_side",
];

/// Controllers that a test may be held against.
pub(super) const RIVALS: &[&str] =
    &["motor_pid", "velocity_sign", "load_cascade", "output_integral", "motor_side", "link_spring", "link_side"];

/// Motions.
pub(super) const PROFILES: &[&str] = &[
    "T1",
    "T2",
    "T2b",
    "sine",
    "random",
    "steps",
    "disturbed_hold",
    "free_hold",
    "impact",
    "impedance",
    "hysteresis",
    "held",
    "walking",
    "real",
    "any",
    "csv",
];

/// Motions of real joints.
pub(super) const REAL_MOTIONS: &[&str] = &["sine", "random", "moves", "slow_sine", "disturbed_hold", "walking", "rest"];

/// Kinds of faults.
pub(super) const FAULTS: &[&str] = &[
    "encoder_frozen",
    "encoder_offset",
    "encoder_noise",
    "encoder_missing_counts",
    "encoder_eccentric",
    "torque_bias",
    "torque_saturation",
    "lost_frames",
    "late_frames",
    "grown_backlash",
    "broken_tooth",
];

const TIME: Kind = Number(0.0, 1e5);
const AMPLITUDE: Kind = Number(0.0, 100.0);
const TORQUE: Kind = Number(-1e6, 1e6);

/// All keys, in the order of the documentation.
pub(super) const KEYS: &[Key] = &[
    key("", "title", Text, "a sentence that says what is tested"),
    key("", "joint", Text, "a preset (q1, s1, d2, l1 ...) or the path of a joint file; q1 if left out"),
    key("", "seeds", Seeds, "a number of seeds, as in 5, or a list of them, as in [7, 12]"),
    key("", "full_seeds", Seeds, "the seeds of a run with --full; `seeds` if left out"),
    key(
        "",
        "short_run",
        Word(&["observer", "loop"]),
        "the role in which a plain `joint hil` runs this file on the board",
    ),
    key("", "only_with_full", Flag, "true keeps the file out of a folder's run without --full"),
    key("", "duration_s", Number(0.01, LONGEST_RUN), "length of a run in s"),
    key(
        "",
        "settle_s",
        Number(0.0, LONGEST_RUN),
        "figures are taken from this time on; what comes before is for learning",
    ),
    key("", "timeout_s", Number(0.1, 1e5), "the test fails when it has taken so many seconds on the clock"),
    key("", "known", Section, "keys of the joint file that are changed for plant and controllers alike"),
    key("", "plant", Section, "keys of the joint file that are changed for the plant, behind the observer's back"),
    key("", "profile", Section, "what the link is asked to do: a kind such as \"T2\", with its keys"),
    key("", "controller", Section, "who controls: mode, bandwidth_rad_per_s, width_guess_ratio ..."),
    key("", "disturbance", Sections, "a torque on the link; write [[disturbance]] once for each"),
    key("", "fault", Sections, "something that goes wrong; write [[fault]] once for each"),
    key("", "assert", Section, "figures and their bounds, as in rms_gain_over_pid = \">= 8\""),
    // Profile
    key("profile", "kind", Word(PROFILES), "the motion"),
    key("profile", "motion", Word(REAL_MOTIONS), "which of the real motions; each seed's own if left out"),
    key("profile", "amplitude_rad", AMPLITUDE, "amplitude of the sine, or standard deviation of the random motion"),
    key("profile", "frequency_Hz", Number(0.001, 100.0), "of the sine, or of the load that changes its sign"),
    key("profile", "highest_Hz", Number(0.01, 100.0), "the random motion has nothing above it"),
    key("profile", "height_rad", AMPLITUDE, "height of the steps"),
    key("profile", "move_s", Number(0.0, 100.0), "duration of one step, on a least-jerk path; 0 jumps"),
    key("profile", "rest_s", Number(0.001, 1e3), "shortest rest between steps"),
    key("profile", "angle_rad", Number(-1e4, 1e4), "where to stay"),
    key("profile", "torque_N_m", TORQUE, "torque on the link that disturbs the hold"),
    key("profile", "wave", Word(&["sine", "square", "walk"]), "how the load that disturbs a hold goes to and fro"),
    key("profile", "pulse_s", Number(1e-4, 100.0), "length of a push"),
    key("profile", "file", Text, "a CSV with the columns time_s and position_rad, and load_torque_N_m if there is one"),
    // Controller
    key(
        "controller",
        "mode",
        Word(MODES),
        "preview, no_preview, impedance or probe; none or a rival for a test of those",
    ),
    key(
        "controller",
        "bandwidth_rad_per_s",
        Number(1.0, 1e4),
        "bandwidth of all controllers alike; 60, or as much as the joint allows, if left out",
    ),
    key(
        "controller",
        "peak_torque_N_m",
        Number(1e-3, 1e6),
        "most that the teeth shall pass on in position mode, at the link; if left out what the motor gives at its limit, but at \
         most twice the rated torque",
    ),
    key(
        "controller",
        "width_guess_ratio",
        Range(0.0, 10.0),
        "guessed over true backlash; if left out 0.5 for even seeds and 1.5 for odd ones",
    ),
    key("controller", "output_encoder", Flag, "false hides the output encoder from the observer"),
    key(
        "controller",
        "from_memory",
        Flag,
        "true has the run made twice: first to learn, then from what was kept of that; figures are of the second",
    ),
    key("controller", "rivals", Words(RIVALS), "who runs beside, for comparison"),
    key("controller", "stiffness_N_m_per_rad", Number(0.0, 1e6), "spring of the impedance; 100 if left out"),
    key("controller", "damping_N_m_s_per_rad", Number(0.0, 1e5), "damper of the impedance; 3 if left out"),
    key("controller", "rate_Hz", Number(1.0, 1e5), "impedance set-points a second; 1000 if left out"),
    key("controller", "feed_forward_kg_m2", Number(0.0, 1e6), "torque sent along for each rad/s^2 of the motion"),
    // Disturbance
    key("disturbance", "kind", Word(&["step", "pulse", "sine"]), "the torque's course"),
    key("disturbance", "start_s", TIME, "when it begins"),
    key("disturbance", "length_s", Number(1e-4, 1e4), "how long a pulse lasts"),
    key("disturbance", "torque_N_m", TORQUE, "it brakes when positive"),
    key("disturbance", "frequency_Hz", Number(0.001, 1e3), "of the sine"),
    // Fault
    key("fault", "kind", Word(FAULTS), "what goes wrong"),
    key("fault", "start_s", TIME, "when it begins; 0 if left out"),
    key("fault", "end_s", TIME, "when it is over; never if left out"),
    key("fault", "encoder", Word(&["motor", "output"]), "which encoder; output if left out"),
    key("fault", "counts", Number(-1e9, 1e9), "an offset in counts"),
    key("fault", "offset_mrad", Number(-1e6, 1e6), "an offset as an angle"),
    key("fault", "noise_counts", Number(0.0, 1e6), "standard deviation in counts"),
    key("fault", "share", Number(0.0, 1.0), "part of the counts, or of the frames, that is lost: 1 % is 0.01"),
    key("fault", "error_deg", Number(0.0, 30.0), "amplitude of an error that comes once a turn"),
    key("fault", "torque_N_m", TORQUE, "torque on the motor beyond what was commanded, or the limit of saturation"),
    key("fault", "ratio", Number(-1.0, 10.0), "torque in proportion to the command beyond it: 5 % is 0.05"),
    key("fault", "frames", Word(&["motor", "output", "set_points"]), "which frames; output if left out"),
    key("fault", "delay_ms", Number(0.0, 1e3), "by how much frames are late"),
    key("fault", "half_backlash_um", Number(0.0, 1000.0), "half-backlash of every mesh from then on"),
    key("fault", "stiffness_ratio", Number(0.01, 1.0), "stiffness left while the broken tooth is in mesh"),
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_key_and_every_word_is_documented() {
        let document = include_str!("../../../../docs/reference/hil-file.md");
        for key in KEYS {
            let row = format!("| `{}` |", key.name);
            let wanted = match key.kind {
                Kind::Number(low, high) | Kind::Range(low, high) => vec![format!("{low} to {high}")],
                Kind::Word(words) | Kind::Words(words) => words.iter().map(|word| format!("`{word}`")).collect(),
                _ => Vec::new(),
            };
            let documented = document.lines().any(|line| line.starts_with(&row));
            assert!(documented, "no row `{row}`");
            for words in wanted {
                let there = document.lines().any(|line| line.starts_with('|') && line.contains(&words));
                assert!(there, "`{words}` of {} is in no table", key.name);
            }
        }
    }
}
