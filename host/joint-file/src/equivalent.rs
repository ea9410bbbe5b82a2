//! Reads `[equivalent_gear]`, which stands in the place of all sections on teeth, and what `[bodies]` says beside it.

use parameters::{EquivalentGear, JointParameters};

use crate::problem::Severity;
use crate::section::Section;

/// Sections and keys of teeth, which an equivalent gear has none of.
const OF_TEETH: [&str; 7] =
    ["coherence", "characteristic_length_um", "geometry", "mesh", "compliance", "contact", "excitation"];

/// Keys of `[bodies]` that an equivalent gear has.
const BODIES: [&str; 3] = ["gear_inertia_at_input_kg_cm2", "rotor_inertia_kg_m2", "link_inertia_kg_m2"];

/// A decimal number has this many places at most; with more it is a fraction that was rounded.
const MOST_PLACES: usize = 5;

/// From this many places on it may be one.
const MANY_PLACES: usize = 3;

/// Ratio and parameters, as far as they are right; what is wrong has been noted.
pub(crate) fn read(
    top: &Section<'_>,
    section: &Section<'_>,
    name: Option<heapless::String<32>>,
    rated_output_torque: Option<f64>,
) -> (Option<f64>, Option<JointParameters>) {
    for word in OF_TEETH.into_iter().filter(|word| top.has(word)) {
        let message = format!("`{word}` is of gears with teeth, and [equivalent_gear] has none");
        let help = "leave one of the two out: [equivalent_gear] alone says ratio, lost motion, stiffness and damping";
        top.notes.error(top.place(word), message, help);
    }
    let ratio = ratio(section);
    let lost_motion =
        section.one_of(&["lost_motion_arcmin", "lost_motion_mrad"], true).and_then(|key| section.number(key));
    let stiffness = section
        .one_of(&["total_stiffness_N_m_per_arcmin", "stiffness_N_m_per_rad"], true)
        .and_then(|key| section.number(key));
    let damping_ratio = section.required_number("damping_ratio");
    let masses = top.required_section("bodies", "bodies").and_then(|bodies| masses(&bodies));
    let exact = ratio.map(|[over, under]| f64::from(over) / f64::from(under));
    let assemble = || {
        let [inertia_at_input, rotor_inertia, link_inertia] = masses?;
        let gear = EquivalentGear {
            ratio: ratio?,
            lost_motion: lost_motion?,
            stiffness: stiffness?,
            damping_ratio: damping_ratio?,
            inertia_at_input,
        };
        Some(gear.joint(name?, rotor_inertia, link_inertia, rated_output_torque?))
    };
    (exact, assemble())
}

/// Motor turns over link turns, in lowest terms.
fn ratio(section: &Section<'_>) -> Option<[u32; 2]> {
    const TURNS: [&str; 2] = ["motor_turns", "link_turns"];
    let stated = TURNS.into_iter().find(|key| section.has(key));
    let [over, under] = if let Some(key) = stated {
        if section.has("ratio") {
            let message = format!("`ratio` and `{key}` both say how motor and link turn");
            section.notes.error(section.place(key), message, "keep `ratio`, or `motor_turns` and `link_turns`");
            return None;
        }
        let [over, under] = TURNS.map(|key| section.required_whole(key));
        [over?, under?]
    } else {
        decimal(section)?
    };
    let shared = divisor(over, under);
    let ratio = [over / shared, under / shared];
    if ratio[0] <= ratio[1] {
        let message = format!("the ratio is {over}/{under}: the motor must turn faster than the link");
        section.notes.error(section.place(stated.unwrap_or("ratio")), message, "it is motor turns over link turns");
        return None;
    }
    Some(ratio)
}

/// A decimal number as a fraction of whole numbers.
fn decimal(section: &Section<'_>) -> Option<[u32; 2]> {
    let value = section.required_number("ratio")?;
    let typed = value.to_string();
    let places = typed.split_once('.').map_or(0, |(_, places)| places.len());
    let whole =
        "give `motor_turns` and `link_turns` in place of `ratio`: whole numbers of turns after which both are back";
    if places > MOST_PLACES {
        let message = format!("`ratio` = {typed} has {places} decimals: a fraction that was rounded");
        section.notes.error(section.place("ratio"), message, whole);
        return None;
    }
    let under = 10_u32.pow(places as u32);
    let over = (value * f64::from(under)).round() as u32;
    if places >= MANY_PLACES {
        let message = format!("`ratio` = {typed} is taken as {over}/{under}, to the last turn");
        section.notes.problem(section.place("ratio"), message, whole, Severity::Warning);
    }
    Some([over, under])
}

fn divisor(a: u32, b: u32) -> u32 {
    if b == 0 { a } else { divisor(b, a % b) }
}

/// Inertia of the gear at its input, of the rotor and of the link [kg m^2].
fn masses(section: &Section<'_>) -> Option<[f64; 3]> {
    for key in section.keys().filter(|key| !BODIES.contains(key)) {
        let message = format!("`{key}` is of gears with teeth, and [equivalent_gear] has none");
        let help = "give the gear's inertia at its input: gear_inertia_at_input_kg_cm2, rotor and link left out";
        section.notes.error(section.place(key), message, help);
    }
    let [gear, rotor, link] = BODIES.map(|key| if section.has(key) { section.number(key) } else { Some(0.0) });
    let [gear, rotor, link] = [gear?, rotor?, link?];
    if link == 0.0 {
        let help = "give `link_inertia_kg_m2` in [bodies], in kg m^2 about the joint's axis";
        section.notes.error(section.place(BODIES[2]), "an equivalent gear needs a link behind it", help);
    }
    if gear + rotor == 0.0 {
        let help = "give `gear_inertia_at_input_kg_cm2`, `rotor_inertia_kg_m2` or both in [bodies]";
        section.notes.error(section.place(BODIES[1]), "nothing turns at the motor's side of the gear", help);
    }
    (link > 0.0 && gear + rotor > 0.0).then_some([gear, rotor, link])
}
