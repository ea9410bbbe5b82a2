//! Reads a whole joint file: parses it, hands each section to its reader, checks that the gears fit, and returns either
//! the joint with its warnings or all problems.

use std::ops::Range;

use model_core::gears::{Kinematics, Scales};
use parameters::{Coherence, Excitation, JointParameters, Surroundings};
use toml::de::DeTable;

use crate::contents::JointFile;
use crate::motion;
use crate::notes::Notes;
use crate::problem::Problems;
use crate::section::Section;
use crate::{bodies, coherence, drive_train, equivalent, geometry, meshes, plausible};

/// Reads the text of a joint file. Returns all problems on failure, including warnings, in order of the text.
///
/// ```
/// let text = joint_file::preset("q1").unwrap();
/// let q1 = joint_file::read(text).unwrap();
/// assert_eq!((q1.parameters.name.as_str(), q1.parameters.geometry.planets), ("Q1", 3));
/// // Units stand in the keys, SI in the parameters.
/// assert!((q1.parameters.sun_planet.half_backlash[0] - 40e-6).abs() < 1e-12);
///
/// let slip = text.replace("half_backlash_um", "half_backlsh_um");
/// let problems = joint_file::read(&slip).unwrap_err();
/// // Each problem has its place in the text and a help; the key is missing as well.
/// let misspelt = problems.iter().find(|problem| &slip[problem.span.clone()] == "half_backlsh_um").unwrap();
/// assert!(misspelt.help.contains("half_backlash_um"), "{misspelt}");
/// assert!(problems.iter().any(|problem| &slip[problem.span.clone()] == "[mesh]"));
/// ```
pub fn read(text: &str) -> Result<JointFile, Problems> {
    let notes = Notes::new(text);
    let (table, syntax) = DeTable::parse_recoverable(text);
    let mut blamed_lines: Vec<Range<usize>> = Vec::new();
    for error in &syntax {
        if notes.is_full() {
            break;
        }
        let at = error.span().unwrap_or(notes.top()).start;
        // After one slip the parser reports errors for the rest of the line.
        if !blamed_lines.iter().any(|line| line.contains(&at)) {
            blamed_lines.push(line_around(text, at));
            notes.syntax(error);
        }
    }
    // A table recovered from broken syntax would be blamed for the dropped parts.
    let joint = if syntax.is_empty() { read_table(&Section::top(table.get_ref(), &notes)) } else { None };
    let failed = notes.has_errors();
    let (problems, sources) = notes.into_parts();
    match joint {
        Some(joint) if !failed => Ok(JointFile { warnings: problems, sources, ..joint }),
        _ => Err(problems.into()),
    }
}

/// Line of a place including its end, where an error may stand too.
fn line_around(text: &str, at: usize) -> Range<usize> {
    let (before, after) = text.as_bytes().split_at(at.min(text.len()));
    let start = before.iter().rposition(|byte| *byte == b'\n').map_or(0, |end| end + 1);
    let end = after.iter().position(|byte| *byte == b'\n').map_or(text.len(), |end| at + end);
    start..end + 1
}

fn read_table(top: &Section<'_>) -> Option<JointFile> {
    let name = read_name(top);
    let description = if top.has("description") { top.text("description") } else { Some(Default::default()) };
    let rated_output_torque = top.required_number("rated_output_torque_N_m");
    let (ratio, parameters) = match top.section("equivalent_gear", "equivalent_gear") {
        Some(section) => equivalent::read(top, &section, name, rated_output_torque),
        None => read_planetary(top, name, rated_output_torque),
    };
    let profile_section = top.section("profile", "profile");
    let profile = motion::read_profile(profile_section.as_ref(), ratio, rated_output_torque);
    let surroundings = drive_train::read(top.section("drive_train", "drive_train").as_ref(), ratio);
    let file = JointFile {
        parameters: parameters?,
        description: description?,
        surroundings: Surroundings { torque_limit: profile.as_ref()?.motor_torque_limit, ..surroundings },
        profile: profile?,
        warnings: Vec::new(),
        sources: Vec::new(),
    };
    drive_train::check(&file.parameters, &file.surroundings, top.notes);
    // A value wrong by itself contradicts everything.
    if !top.notes.has_errors() {
        plausible::check(&file, top.notes);
    }
    Some(file)
}

/// Planetary gear: ratio and parameters, as far as they are valid; problems are noted.
fn read_planetary(
    top: &Section<'_>,
    name: Option<heapless::String<32>>,
    rated_output_torque: Option<f64>,
) -> (Option<f64>, Option<JointParameters>) {
    let coherence = match top.choice("coherence") {
        Some("warn") => Coherence::Warned,
        _ => Coherence::Required,
    };
    let characteristic_length =
        if top.has("characteristic_length_um") { top.number("characteristic_length_um") } else { Some(10e-6) };

    let geometry_section = top.required_section("geometry", "geometry");
    let geometry = geometry_section.as_ref().and_then(|section| geometry::read(section, coherence));
    // The meshes need only the number of planets.
    let planets = geometry_section.as_ref().and_then(|section| section.whole("planets")).map(|count| count as usize);
    let masses = top.required_section("bodies", "bodies").and_then(|section| bodies::read(&section, geometry.as_ref()));
    let meshes =
        top.required_section("mesh", "mesh").and_then(|section| meshes::read(&section, planets, geometry.as_ref()));
    let compliance_section = top.section("compliance", "compliance");
    let compliance = match &compliance_section {
        Some(section) => bodies::read_compliance(section, geometry.as_ref(), meshes.as_ref()).map(Some),
        None => Some(None),
    };
    if let (Some(section), Some(masses)) = (&compliance_section, &masses)
        && masses.link_inertia == 0.0
    {
        let help = "give `link_inertia_kg_m2` in [bodies], or leave [compliance] out";
        top.notes.error(section.header.clone(), "a compliance needs a link behind it", help);
    }
    let contact = motion::read_contact(top.section("contact", "contact").as_ref());

    if let Some(geometry) = &geometry {
        coherence::check(geometry, top.notes);
    }

    let ratio = geometry.as_ref().map(Kinematics::ratio_by_radii);
    let assemble = || {
        let (damping_law, dead_zone) = contact?;
        let [sun_planet, ring_planet] = meshes?;
        let masses = masses?;
        Some(JointParameters {
            name: name?,
            geometry: geometry?,
            bodies: masses.bodies,
            rotor_inertia: masses.rotor_inertia,
            link_inertia: masses.link_inertia,
            compliance: compliance?,
            sun_planet,
            ring_planet,
            damping_law,
            dead_zone,
            excitation: Excitation::Angle,
            characteristic_length: characteristic_length?,
            rated_output_torque: rated_output_torque?,
        })
    };
    let parameters = assemble();
    let omega_n = parameters.as_ref().map(|parameters| Scales::new(parameters).frequency);
    let excitation = motion::read_excitation(top.section("excitation", "excitation").as_ref(), omega_n);
    let parameters = parameters.zip(excitation);
    (ratio, parameters.map(|(parameters, excitation)| JointParameters { excitation, ..parameters }))
}

/// Reads the name, short and plain enough for the board's identity message.
fn read_name(top: &Section<'_>) -> Option<heapless::String<32>> {
    if !top.has("name") {
        top.missing("name");
    }
    let text = top.text("name")?;
    let plain = |letter: char| letter.is_ascii_alphanumeric() || " -_.+()".contains(letter);
    let name = heapless::String::try_from(text.as_str()).ok();
    let good = name.filter(|name| !name.trim().is_empty() && name.chars().all(plain));
    if good.is_none() {
        let message = match text.len() {
            33.. => format!("`name` has {} letters", text.chars().count()),
            _ => format!("`name` cannot be \"{text}\""),
        };
        top.notes.error(top.place("name"), message, top.value("name")?.1.hint);
    }
    good
}
