//! Reads `[equivalent_gear]`, which replaces all sections on teeth, and its keys of `[bodies]`.

use parameters::{EquivalentGear, JointParameters};

use crate::problem::Severity;
use crate::section::Section;

/// Sections and keys on teeth, invalid for an equivalent gear.
pub(crate) const TEETH_KEYS: [&str; 7] =
    ["coherence", "characteristic_length_um", "geometry", "mesh", "compliance", "contact", "excitation"];

/// Keys of `[bodies]` for an equivalent gear.
const BODY_KEYS: [&str; 3] = ["gear_inertia_at_input_kg_cm2", "rotor_inertia_kg_m2", "link_inertia_kg_m2"];

/// Most decimals of an exact ratio; with more it is a rounded fraction.
const EXACT_DECIMALS_MAX: usize = 5;

/// Decimals from which a ratio may be a rounded fraction.
const AMBIGUOUS_DECIMALS: usize = 3;

/// Largest whole number of a ratio: the difference of two encoders is counted in units of it.
const WHOLE_NUMBER_MAX: u64 = 100_000_000;

/// Ratio and parameters, as far as they are valid; problems are noted.
pub(crate) fn read(
    top: &Section<'_>,
    section: &Section<'_>,
    name: Option<heapless::String<32>>,
    rated_output_torque: Option<f64>,
) -> (Option<f64>, Option<JointParameters>) {
    for word in TEETH_KEYS.into_iter().filter(|word| top.has(word)) {
        let message = format!("`{word}` is for gears with teeth, but [equivalent_gear] has none");
        let help = "leave one of the two out: [equivalent_gear] alone states ratio, lost motion, stiffness and damping";
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
            let message = format!("`ratio` and `{key}` both state the ratio of motor and link");
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

/// Decimal number as a fraction of whole numbers: exact, or with many digits the simplest fraction rounded to it.
/// Ambiguity is a warning.
fn decimal(section: &Section<'_>) -> Option<[u32; 2]> {
    let value = section.required_number("ratio")?;
    let typed = value.to_string();
    let (whole, decimals) = typed.split_once('.').unwrap_or((&typed, ""));
    let places = decimals.len();
    let digits: u64 = format!("{whole}{decimals}").parse().ok()?;
    let under = 10_u64.checked_pow(places as u32)?;
    let half = [2 * digits - 1, 2 * digits + 1].map(|twice| [twice, 2 * under]);
    let simple = simplest(half[0], half[1]);
    let note = |message: String, help: String| {
        section.notes.problem(section.place("ratio"), message, help, Severity::Warning);
    };
    if places > EXACT_DECIMALS_MAX || digits > WHOLE_NUMBER_MAX {
        let [over, under] = simple;
        note(
            format!("`ratio` = {typed} is a rounded fraction and is taken as {over}/{under}"),
            "give `motor_turns` and `link_turns` instead of `ratio` if this is wrong".to_owned(),
        );
        return Some([u32::try_from(over).ok()?, u32::try_from(under).ok()?]);
    }
    let [over, few] = simple;
    // One ratio in six with two decimals may be a fraction of teeth; a divisor of 100 is exact.
    let may_be_rounded = few * few < under && under % few != 0;
    let turns = format!("`motor_turns` = {over} and `link_turns` = {few} in place of `ratio`");
    if places >= AMBIGUOUS_DECIMALS {
        let help = match may_be_rounded {
            true => format!("give {turns} if the teeth have this ratio; otherwise the whole turns after which both are back"),
            false => "give `motor_turns` and `link_turns` in place of `ratio`: whole numbers of turns after which both are back"
                .to_owned(),
        };
        note(format!("`ratio` = {typed} is taken as {digits}/{under}, to the last turn"), help);
    } else if may_be_rounded {
        note(
            format!("`ratio` = {typed} is taken as {digits}/{under}, but {over}/{few} rounds to it as well"),
            format!("give {turns} if the teeth have this ratio: the encoders distinguish the two"),
        );
    }
    Some([u32::try_from(digits).ok()?, u32::try_from(under).ok()?])
}

/// Fraction with the least denominator between two fractions.
fn simplest([a, b]: [u64; 2], [c, d]: [u64; 2]) -> [u64; 2] {
    let whole = a / b;
    if whole * b == a {
        return [whole, 1];
    }
    if (whole + 1) * d <= c {
        return [whole + 1, 1];
    }
    let [over, under] = simplest([d, c - whole * d], [b, a - whole * b]);
    [whole * over + under, over]
}

fn divisor(a: u32, b: u32) -> u32 {
    if b == 0 { a } else { divisor(b, a % b) }
}

/// Inertias of the gear at its input, the rotor and the link [kg m^2].
fn masses(section: &Section<'_>) -> Option<[f64; 3]> {
    for key in section.keys().filter(|key| !BODY_KEYS.contains(key)) {
        let message = format!("`{key}` is for gears with teeth, but [equivalent_gear] has none");
        let help = "give the gear's inertia at its input: gear_inertia_at_input_kg_cm2, rotor and link left out";
        section.notes.error(section.place(key), message, help);
    }
    let [gear, rotor, link] = BODY_KEYS.map(|key| if section.has(key) { section.number(key) } else { Some(0.0) });
    let [gear, rotor, link] = [gear?, rotor?, link?];
    if link == 0.0 {
        let help = "give `link_inertia_kg_m2` in [bodies], in kg m^2 about the joint's axis";
        section.notes.error(section.place(BODY_KEYS[2]), "an equivalent gear needs a link behind it", help);
    }
    if gear + rotor == 0.0 {
        let help = "give `gear_inertia_at_input_kg_cm2`, `rotor_inertia_kg_m2` or both in [bodies]";
        section.notes.error(section.place(BODY_KEYS[1]), "the motor's side of the gear has no inertia", help);
    }
    (link > 0.0 && gear + rotor > 0.0).then_some([gear, rotor, link])
}

#[cfg(test)]
mod tests {
    use super::simplest;

    /// The simplest fraction that rounds to a decimal number is found.
    #[test]
    fn simplest_fraction_is_found() {
        let of = |digits: u64, under: u64| simplest([2 * digits - 1, 2 * under], [2 * digits + 1, 2 * under]);
        assert_eq!(of(9_333_333, 1_000_000), [28, 3]);
        assert_eq!(of(933, 100), [28, 3]);
        assert_eq!(of(1_296_714_286, 1_000_000), [9077, 7]);
        assert_eq!(of(275, 10), [55, 2]);
        assert_eq!(of(50, 1), [50, 1]);
    }
}
