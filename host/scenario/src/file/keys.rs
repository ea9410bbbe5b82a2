//! Every key of a test file: section, type, bounds, and a hint for error messages. The tables of
//! docs/reference/hil-file.md list every key.

use board::profile::LONGEST_RUN;
use joint_file::Keys;

/// Type of a key.
#[derive(Debug, Clone, Copy)]
pub(super) enum Kind {
    /// A string.
    Text,
    /// One of the given words.
    Word(&'static [&'static str]),
    /// A list of the given words.
    Words(&'static [&'static str]),
    /// `true` or `false`.
    Flag,
    /// A number between both ends, inclusive.
    Number(f64, f64),
    /// A number, or a range from which every seed draws.
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

/// Controllers that can be tested.
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

/// Controllers that can run for comparison.
pub(super) const RIVALS: &[&str] =
    &["motor_pid", "velocity_sign", "load_cascade", "output_integral", "motor_side", "link_spring", "link_side"];

/// Kinds of motion.
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
    key("", "title", Text, "title: a sentence that says which behaviour is tested"),
    key("", "joint", Text, "preset (q1, s1, d2, l1 ...) or path of a joint file; default q1"),
    key("", "seeds", Seeds, "number of seeds, as in 5, or list of seeds, as in [7, 12]"),
    key("", "full_seeds", Seeds, "seeds of a run with --full; default: `seeds`"),
    key(
        "",
        "short_run",
        Word(&["observer", "loop"]),
        "role in which `joint hil` without a file runs this file on the board",
    ),
    key("", "only_with_full", Flag, "true: the run of a folder without --full skips this file"),
    key("", "duration_s", Number(0.01, LONGEST_RUN), "duration of a run in s"),
    key("", "settle_s", Number(0.0, LONGEST_RUN), "start of the figures in s; parameters are estimated before"),
    key("", "timeout_s", Number(0.1, 1e5), "longest time of the test on the clock in s; the test fails beyond it"),
    key("", "known", Section, "keys of the joint file changed for plant and controllers"),
    key("", "plant", Section, "keys of the joint file changed for the plant only, unknown to the controllers"),
    key("", "profile", Section, "motion of the link: a kind such as \"T2\", with its keys"),
    key("", "controller", Section, "controller under test: mode, bandwidth_rad_per_s, width_guess_ratio ..."),
    key("", "disturbance", Sections, "torque on the link; one [[disturbance]] for each"),
    key("", "fault", Sections, "injected fault; one [[fault]] for each"),
    key("", "assert", Section, "figures and their bounds, as in rms_gain_over_pid = \">= 8\""),
    // Profile
    key("profile", "kind", Word(PROFILES), "kind of motion"),
    key("profile", "motion", Word(REAL_MOTIONS), "which of the real motions; default: each seed has its own"),
    key("profile", "amplitude_rad", AMPLITUDE, "amplitude of the sine, or standard deviation of the random motion"),
    key("profile", "frequency_Hz", Number(0.001, 100.0), "frequency of the sine, or of the load that changes its sign"),
    key("profile", "highest_Hz", Number(0.01, 100.0), "highest frequency of the random motion"),
    key("profile", "height_rad", AMPLITUDE, "height of the steps"),
    key("profile", "move_s", Number(0.0, 100.0), "duration of a step on a least-jerk path; 0 jumps"),
    key("profile", "rest_s", Number(0.001, 1e3), "shortest rest between steps"),
    key("profile", "angle_rad", Number(-1e4, 1e4), "angle to hold"),
    key("profile", "torque_N_m", TORQUE, "torque on the link that disturbs the hold"),
    key("profile", "wave", Word(&["sine", "square", "walk"]), "waveform of the load that disturbs a hold"),
    key("profile", "pulse_s", Number(1e-4, 100.0), "length of the push"),
    key("profile", "file", Text, "CSV with the columns time_s and position_rad, and optionally load_torque_N_m"),
    // Controller
    key("controller", "mode", Word(MODES), "controller under test"),
    key(
        "controller",
        "bandwidth_rad_per_s",
        Number(1.0, 1e4),
        "bandwidth of all controllers; default 60, or the widest that the joint allows if that is less",
    ),
    key(
        "controller",
        "peak_torque_N_m",
        Number(1e-3, 1e6),
        "limit of the torque through the teeth in position mode, at the link; default: the motor's torque at its limit, at most twice the rated torque",
    ),
    key(
        "controller",
        "width_guess_ratio",
        Range(0.0, 10.0),
        "guessed over true backlash; default 0.5 for even seeds, 1.5 for odd seeds",
    ),
    key("controller", "output_encoder", Flag, "false hides the output encoder from the observer"),
    key(
        "controller",
        "from_memory",
        Flag,
        "true runs each seed twice: the second run starts from the memory of the first, and its figures count",
    ),
    key("controller", "rivals", Words(RIVALS), "controllers that run for comparison"),
    key("controller", "stiffness_N_m_per_rad", Number(0.0, 1e6), "spring of the impedance; default 100"),
    key("controller", "damping_N_m_s_per_rad", Number(0.0, 1e5), "damper of the impedance; default 3"),
    key("controller", "rate_Hz", Number(1.0, 1e5), "impedance set-points a second; default 1000"),
    key("controller", "feed_forward_kg_m2", Number(0.0, 1e6), "feed-forward torque for each rad/s^2 of the motion"),
    // Disturbance
    key("disturbance", "kind", Word(&["step", "pulse", "sine"]), "waveform of the torque"),
    key("disturbance", "start_s", TIME, "start of the disturbance"),
    key("disturbance", "length_s", Number(1e-4, 1e4), "length of a pulse"),
    key("disturbance", "torque_N_m", TORQUE, "torque on the link; positive torque brakes"),
    key("disturbance", "frequency_Hz", Number(0.001, 1e3), "frequency of the sine"),
    // Fault
    key("fault", "kind", Word(FAULTS), "kind of fault"),
    key("fault", "start_s", TIME, "start of the fault; default 0"),
    key("fault", "end_s", TIME, "end of the fault; default: never"),
    key("fault", "encoder", Word(&["motor", "output"]), "faulty encoder; default output"),
    key("fault", "counts", Number(-1e9, 1e9), "offset in counts"),
    key("fault", "offset_mrad", Number(-1e6, 1e6), "offset as an angle"),
    key("fault", "noise_counts", Number(0.0, 1e6), "standard deviation of the noise in counts"),
    key("fault", "share", Number(0.0, 1.0), "share of the counts, or of the frames, that is lost: 1 % is 0.01"),
    key("fault", "error_deg", Number(0.0, 30.0), "amplitude of the error that comes once a turn"),
    key("fault", "torque_N_m", TORQUE, "torque on the motor beyond the command, or the limit of the saturation"),
    key("fault", "ratio", Number(-1.0, 10.0), "torque beyond the command over the command: 5 % is 0.05"),
    key("fault", "frames", Word(&["motor", "output", "set_points"]), "affected frames; default output"),
    key("fault", "delay_ms", Number(0.0, 1e3), "delay of the frames"),
    key("fault", "half_backlash_um", Number(0.0, 1000.0), "half-backlash of every mesh during the fault"),
    key("fault", "stiffness_ratio", Number(0.01, 1.0), "stiffness left while the broken tooth is in mesh"),
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_key_and_word_is_documented() {
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
                let is_documented = document.lines().any(|line| line.starts_with('|') && line.contains(&words));
                assert!(is_documented, "`{words}` of {} is in no table", key.name);
            }
        }
    }
}
