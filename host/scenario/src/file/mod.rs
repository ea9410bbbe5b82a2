//! Test files, `hil/*.toml`: TOML with the unit in every key's name. The reader reports all problems of a file at once,
//! each with its place in the text.
//!
//! `keys` lists every key; `section` reads values of a table by that list; `motion`, `faults`, `changes` and
//! `assertions` each read one kind of section. docs/reference/hil-file.md is the user's page.

mod assertions;
mod changes;
mod faults;
mod gains;
mod keys;
mod motion;
mod section;

pub use assertions::{Aggregate, Assertion};
pub use changes::{Change, NewValue};
pub use faults::{Fault, HostOnlyFault, Offset, Si, fault_is_active, fault_stream, fault_word};
pub use motion::{DisturbanceSpec, MotionProfile, ProfileLoad, RealMotion, STEP_RATE, Trajectory, Wave};

use joint_file::{Keys, Notes, Problem};
use link::messages::Role;
use toml::de::{DeTable, DeValue};

use super::controller::{ControllerName, Gains};
use super::random::NumberOrRange;

use keys::Kind;
use section::Section;

/// A valid test file; its joint has still to be loaded.
#[derive(Debug, Clone, PartialEq)]
pub struct TestFile {
    /// Title; may be empty.
    pub title: String,
    /// Preset or path of the joint file.
    pub joint: String,
    /// Seeds of a short run.
    pub seeds: Vec<u64>,
    /// Seeds of a full run.
    pub full_seeds: Vec<u64>,
    /// Role of the board in which a run without a file includes this test, if any.
    pub short_run: Option<Role>,
    /// Skips the file in a folder's run without `--full`.
    pub only_with_full: bool,
    /// Length of a run [s].
    pub duration: f64,
    /// True if the file states the duration.
    pub states_duration: bool,
    /// Start of the figures [s].
    pub settle: f64,
    /// Limit of the test's time on the clock [s].
    pub timeout: f64,
    /// Changes of the joint that controllers know.
    pub known: Vec<Change>,
    /// Changes of the joint that controllers do not know.
    pub plant: Vec<Change>,
    /// Motion of the link.
    pub profile: MotionProfile,
    /// Controller under test.
    pub controller: ControllerName,
    /// Controllers that run for comparison.
    pub rivals: Vec<ControllerName>,
    /// Bandwidth of all controllers [rad/s]; `None` is the default of the nominal joint.
    pub bandwidth: Option<f64>,
    /// Limit of the torque through the teeth [N m]; `None` is the motor's torque.
    pub peak_torque: Option<f64>,
    /// Guessed over true half-backlash; `None` is wrong by half, with the sign of the seed.
    pub width_guess: Option<NumberOrRange>,
    /// False hides the output encoder from the observer.
    pub output_encoder: bool,
    /// True if each seed runs twice, and the second run starts with the parameters that the first run saved.
    pub from_memory: bool,
    /// Impedance set-points in place of positions.
    pub gains: Option<Gains>,
    /// Torques on the link, added to the load of the profile.
    pub disturbances: Vec<DisturbanceSpec>,
    /// Injected faults.
    pub faults: Vec<Fault>,
    /// Bounds on figures.
    pub assertions: Vec<Assertion>,
}

/// Default limit of a test's time on the clock [s].
const DEFAULT_TIMEOUT: f64 = 600.0;

/// Returns true for the text of a test file, false for a joint file. If the text is not TOML, its headers decide.
pub fn is_test_file(text: &str) -> bool {
    const OF_JOINTS: [&str; 4] = ["geometry", "bodies", "mesh", "rated_output_torque_N_m"];
    match DeTable::parse(text) {
        Ok(table) => !OF_JOINTS.iter().any(|key| table.get_ref().get(*key).is_some()),
        Err(_) => {
            !OF_JOINTS.iter().any(|key| text.lines().any(|line| line.trim_start().starts_with(&format!("[{key}"))))
        }
    }
}

/// Reads the text of a test file; on failure returns every problem in the order of the text.
pub fn read(text: &str) -> Result<TestFile, Vec<Problem>> {
    let notes = Notes::new(text);
    let (table, syntax) = DeTable::parse_recoverable(text);
    syntax.iter().take(1).for_each(|error| notes.syntax(error));
    // After a syntax error the recovered table would lack keys that the parser dropped, and be blamed for it.
    let file = if syntax.is_empty() { read_table(table.get_ref(), &notes) } else { None };
    let (problems, _) = notes.into_parts();
    file.filter(|_| problems.is_empty()).ok_or(problems)
}

/// Reads the text of `[[fault]]` sections alone; on failure returns every problem.
pub fn read_faults(text: &str) -> Result<Vec<Fault>, Vec<Problem>> {
    let notes = Notes::new(text);
    let (table, syntax) = DeTable::parse_recoverable(text);
    syntax.iter().take(1).for_each(|error| notes.syntax(error));
    let top = Section::new("", 0..0, table.get_ref(), &notes);
    let faults = top.tables("fault").iter().filter_map(faults::read).collect();
    let (problems, _) = notes.into_parts();
    if problems.is_empty() { Ok(faults) } else { Err(problems) }
}

fn read_table(table: &DeTable<'_>, notes: &Notes<'_>) -> Option<TestFile> {
    let top = Section::new("", 0..0, table, notes);
    let profile = match table.get("profile") {
        Some(value) if matches!(value.get_ref(), DeValue::String(_)) => {
            let kind = Kind::find("profile", "kind").and_then(|key| top.word_of(value, key));
            kind.map(MotionProfile::default_of_kind)
        }
        _ => match top.table("profile") {
            Some((span, table)) => motion::read(&Section::new("profile", span, table, notes)),
            None => {
                if !top.has("profile") {
                    notes.error(0..0, "`profile` is missing", "write profile = \"T2\", or a section [profile]");
                }
                None
            }
        },
    };
    let empty = DeTable::new();
    let (span, table) = top.table("controller").unwrap_or((0..0, &empty));
    let controller = Section::new("controller", span, table, notes);
    let impedance_profile = profile.as_ref().is_some_and(|profile| profile.kind == "impedance");
    let default_mode = match profile.as_ref().map(|profile| profile.kind) {
        Some("impedance") => "impedance",
        Some("hysteresis") => "locked",
        Some("held") => "probe",
        _ => "preview",
    };
    let mode = controller.or("mode", Section::word, default_mode);
    let bare = matches!(mode, Some("none" | "locked" | "off"));
    let gains = gains::read(
        &controller,
        (impedance_profile && bare) || mode.is_some_and(|mode| ControllerName::from_word(mode, false).wants_gains()),
    );
    let name = mode.map(|mode| ControllerName::from_word(mode, gains.is_some()));
    let rivals = if controller.has("rivals") {
        controller.words("rivals")
    } else if name == Some(ControllerName::Probe) {
        Some(Vec::new())
    } else if gains.is_some() {
        Some(vec!["motor_side", "link_spring"])
    } else {
        Some(vec!["motor_pid", "output_integral"])
    };
    let mut rivals: Vec<ControllerName> =
        rivals?.into_iter().map(|word| ControllerName::from_word(word, gains.is_some())).collect();
    for rival in &rivals {
        if rival.wants_gains() != gains.is_some() {
            let help = match gains {
                Some(_) => "an impedance test has motor_side, link_spring and link_side to be held against",
                None => "a position test has motor_pid, velocity_sign, load_cascade and output_integral",
            };
            notes.error(controller.place("rivals"), format!("{} cannot run beside this", rival.word()), help);
        }
    }
    // Two runs of one control law are redundant unless a bound asks for both.
    rivals.retain(|rival| name.is_none_or(|name| !rival.has_same_law(name)));
    let about = assertions::TestTraits { controller: name, gains: gains.is_some(), profile: profile.as_ref() };
    let assertions = assertions::read(&top, &about);
    for rival in assertions.iter().filter_map(Assertion::rival) {
        if !rivals.contains(&rival) && Some(rival) != name {
            rivals.push(rival);
        }
    }
    rivals.retain(|rival| Some(*rival) != name);
    let [disturbance_sections, fault_sections] = ["disturbance", "fault"].map(|name| top.tables(name));
    let disturbances = disturbance_sections.iter().filter_map(motion::read_disturbance).collect();
    let faults = fault_sections.iter().filter_map(faults::read).collect();
    let seeds = top.or("seeds", Section::seeds, vec![1])?;
    let full_seeds = top.or("full_seeds", Section::seeds, seeds.clone())?;
    let known = changes::read(&top, "known");
    let plant = changes::read(&top, "plant");
    let profile = profile?;
    let settle = top.or("settle_s", Section::number, profile.settle)?;
    let duration = top.or("duration_s", Section::number, profile.duration.max(settle + 1.0))?;
    if settle >= duration {
        let help = "raise `duration_s`, or lower `settle_s`: figures are taken between the two";
        notes.error(top.place("settle_s"), format!("settling for {settle} s leaves no part of {duration} s"), help);
    }
    // A recorded motion has the length of its file unless the test file states a duration.
    if top.has("duration_s") || !matches!(profile.trajectory, Trajectory::File(_)) {
        reject_late(disturbance_sections.iter().chain(&fault_sections), duration);
    }
    let from_memory = controller.or("from_memory", Section::flag, false)?;
    if let (true, Some(name)) = (from_memory, name.filter(|name| !name.is_compensation())) {
        let help = "write mode = \"preview\", \"no_preview\" or \"impedance\", or leave it out";
        notes.error(controller.place("from_memory"), format!("{} does not learn", name.word()), help);
    }
    Some(TestFile {
        title: top.or("title", Section::text, String::new())?,
        joint: top.or("joint", Section::text, "q1".to_owned())?,
        short_run: match top.or("short_run", Section::word, "")? {
            "loop" => Some(Role::Loop),
            "" => None,
            _ => Some(Role::Observer),
        },
        only_with_full: top.or("only_with_full", Section::flag, false)?,
        timeout: top.or("timeout_s", Section::number, DEFAULT_TIMEOUT)?,
        bandwidth: controller.or("bandwidth_rad_per_s", |section, name| section.number(name).map(Some), None)?,
        peak_torque: controller.or("peak_torque_N_m", |section, name| section.number(name).map(Some), None)?,
        width_guess: controller.or("width_guess_ratio", |section, name| section.range(name).map(Some), None)?,
        output_encoder: controller.or("output_encoder", Section::flag, true)?,
        from_memory,
        controller: name?,
        seeds,
        full_seeds,
        duration,
        states_duration: top.has("duration_s"),
        settle,
        known,
        plant,
        profile,
        rivals,
        gains,
        disturbances,
        faults,
        assertions,
    })
}

/// Rejects disturbances and faults that begin after the run.
fn reject_late<'s>(sections: impl Iterator<Item = &'s Section<'s>>, duration: f64) {
    for section in sections {
        let start = section.table.get("start_s").and_then(section::number);
        if start.is_some_and(|start| start >= duration) {
            let message = format!("this begins when the run is over, at {} s", (1e3 * duration).round() / 1e3);
            let help = "raise `duration_s`, or let it begin earlier";
            section.notes.error(section.place("start_s"), message, help);
        }
    }
}
