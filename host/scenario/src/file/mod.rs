//! Test files, `hil/*.toml`: TOML with the unit in every key's name, read with all problems of a file found at once,
//! each with its place in the text.
//!
//! `keys` lists every key; `section` takes values out of a table by that list; `motion`, `faults`, `changes` and
//! `assertions` each read one kind of section. docs/reference/hil-file.md tells all of it to users.

mod assertions;
mod changes;
mod faults;
mod gains;
mod keys;
mod motion;
mod section;

pub use assertions::{Aggregate, Assertion};
pub use changes::{Change, NewValue};
pub use faults::{Fault, HostOnlyFault, Offset, Si, fault_is_on, fault_stream, fault_word};
pub use motion::{DisturbanceSpec, MotionProfile, ProfileLoad, RealMotion, STEPS, Trajectory, Wave};

use joint_file::{Keys, Notes, Problem};
use link::messages::Role;
use toml::de::{DeTable, DeValue};

use super::controller::{ControllerName, Gains};
use super::random::NumberOrRange;

use keys::Kind;
use section::Section;

/// A test file that can be run, once its joint has been found.
#[derive(Debug, Clone, PartialEq)]
pub struct TestFile {
    /// What is tested; may be empty.
    pub title: String,
    /// Preset or path of the joint file.
    pub joint: String,
    /// Seeds.
    pub seeds: Vec<u64>,
    /// Seeds of a full run.
    pub full_seeds: Vec<u64>,
    /// A run without any file has this one, on a board in this role.
    pub short_run: Option<Role>,
    /// Left out of a folder's run unless it is a full one.
    pub only_with_full: bool,
    /// Length of a run [s].
    pub duration: f64,
    /// The file says so itself.
    pub states_duration: bool,
    /// Figures are taken from here on [s].
    pub settle: f64,
    /// On the clock [s].
    pub timeout: f64,
    /// Changes of the joint that controllers know of.
    pub known: Vec<Change>,
    /// Changes that they do not know of.
    pub plant: Vec<Change>,
    /// What the link is asked to do.
    pub profile: MotionProfile,
    /// Who controls.
    pub controller: ControllerName,
    /// Who runs beside.
    pub rivals: Vec<ControllerName>,
    /// Bandwidth of all of them [rad/s]; what is good for the nominal joint if the file asks for none.
    pub bandwidth: Option<f64>,
    /// Most that the teeth shall pass on [N m]; `None` is what the motor gives.
    pub peak_torque: Option<f64>,
    /// Guessed over true half-backlash; `None` is wrong by half, one way or the other by the seed.
    pub width_guess: Option<NumberOrRange>,
    /// Whether the observer has the output encoder.
    pub output_encoder: bool,
    /// The run is made twice, the second time from what was learnt in the first.
    pub from_memory: bool,
    /// Impedance set-points in place of positions.
    pub gains: Option<Gains>,
    /// Torques on the link beside the profile's.
    pub disturbances: Vec<DisturbanceSpec>,
    /// What goes wrong.
    pub faults: Vec<Fault>,
    /// What must hold.
    pub assertions: Vec<Assertion>,
}

/// Time on the clock that a test may take by default [s].
const TIMEOUT: f64 = 600.0;

/// Whether a text is meant as a test file rather than as a joint file. What is no TOML is told apart by its headers.
pub fn is_test_file(text: &str) -> bool {
    const OF_JOINTS: [&str; 4] = ["geometry", "bodies", "mesh", "rated_output_torque_N_m"];
    match DeTable::parse(text) {
        Ok(table) => !OF_JOINTS.iter().any(|key| table.get_ref().get(*key).is_some()),
        Err(_) => {
            !OF_JOINTS.iter().any(|key| text.lines().any(|line| line.trim_start().starts_with(&format!("[{key}"))))
        }
    }
}

/// Reads the text of a test file. On failure gives every problem in the order of the text.
pub fn read(text: &str) -> Result<TestFile, Vec<Problem>> {
    let notes = Notes::new(text);
    let (table, syntax) = DeTable::parse_recoverable(text);
    syntax.iter().take(1).for_each(|error| notes.syntax(error));
    // What was recovered from broken syntax would be blamed for what the parser dropped.
    let file = if syntax.is_empty() { read_table(table.get_ref(), &notes) } else { None };
    let (problems, _) = notes.into_parts();
    file.filter(|_| problems.is_empty()).ok_or(problems)
}

fn read_table(table: &DeTable<'_>, notes: &Notes<'_>) -> Option<TestFile> {
    let top = Section::new("", 0..0, table, notes);
    let profile = match table.get("profile") {
        Some(value) if matches!(value.get_ref(), DeValue::String(_)) => {
            let kind = Kind::find("profile", "kind").and_then(|key| top.word_of(value, key));
            kind.map(MotionProfile::of_kind)
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
        (impedance_profile && bare) || mode.is_some_and(|mode| ControllerName::of_word(mode, false).wants_gains()),
    );
    let name = mode.map(|mode| ControllerName::of_word(mode, gains.is_some()));
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
        rivals?.into_iter().map(|word| ControllerName::of_word(word, gains.is_some())).collect();
    for rival in &rivals {
        if rival.wants_gains() != gains.is_some() {
            let help = match gains {
                Some(_) => "an impedance test has motor_side, link_spring and link_side to be held against",
                None => "a position test has motor_pid, velocity_sign, load_cascade and output_integral",
            };
            notes.error(controller.place("rivals"), format!("{} cannot run beside this", rival.word()), help);
        }
    }
    // The same law twice shows nothing, unless a bound asks for it.
    rivals.retain(|rival| name.is_none_or(|name| !rival.is_the_same_as(name)));
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
        notes.error(top.place("settle_s"), format!("nothing is left of {duration} s after {settle} s"), help);
    }
    // How long a recorded motion is says its file, unless this one does.
    if top.has("duration_s") || !matches!(profile.trajectory, Trajectory::File(_)) {
        refuse_late(disturbance_sections.iter().chain(&fault_sections), duration);
    }
    let from_memory = controller.or("from_memory", Section::flag, false)?;
    if let (true, Some(name)) = (from_memory, name.filter(|name| !name.is_compensation())) {
        let help = "write mode = \"preview\", \"no_preview\" or \"impedance\", or leave it out";
        notes.error(controller.place("from_memory"), format!("{} learns nothing", name.word()), help);
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
        timeout: top.or("timeout_s", Section::number, TIMEOUT)?,
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

/// Complains about what begins when the run is over.
fn refuse_late<'s>(sections: impl Iterator<Item = &'s Section<'s>>, duration: f64) {
    for section in sections {
        let start = section.table.get("start_s").and_then(section::number);
        if start.is_some_and(|start| start >= duration) {
            let message = format!("this begins when the run is over, at {} s", (1e3 * duration).round() / 1e3);
            let help = "raise `duration_s`, or let it begin earlier";
            section.notes.error(section.place("start_s"), message, help);
        }
    }
}
