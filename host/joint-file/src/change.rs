//! Changes single values in the text of a joint file, as for a command line. Only keys are checked here; the changed
//! text is read like any other, with the same checks and messages.

use std::ops::Range;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use crate::bodies;
use crate::equivalent;
use crate::keys::{self, KEYS, Key, Kind};
use crate::spelling;

/// Reason why a value cannot be set.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Refused {
    /// Problem in one sentence.
    pub message: String,
    /// Remedy.
    pub help: String,
}

/// Keys of one quantity in different units or forms: setting one replaces the others.
const QUANTITY_FORMS: [&[&str]; 9] = [
    &["half_backlash_um", "backlash_um", "lost_motion_arcmin", "lost_motion_mrad"],
    &["stiffness_N_m_per_rad", "total_stiffness_N_m_per_arcmin"],
    &["motor_coulomb_friction_N_m", "no_load_torque_N_m"],
    &["sun_equivalent_mass_kg", "sun_inertia_kg_m2"],
    &["planet_equivalent_mass_kg", "planet_inertia_kg_m2"],
    &["carrier_inertia_over_radius_squared_kg", "carrier_equivalent_mass_kg", "carrier_inertia_kg_m2"],
    &["carrier_radius_mm", "carrier_base_radius_mm"],
    &["bits", "counts_per_turn"],
    &["mesh_frequency_rad_per_s", "mesh_frequency_Hz", "mesh_frequency_over_omega_n"],
];

/// Keys that replace several others together; none of these alone replaces them.
const COMBINED_KEYS: [(&str, &[&str]); 2] =
    [(bodies::COMBINED_KEY, &bodies::SEPARATE_KEYS), ("ratio", &["motor_turns", "link_turns"])];

/// Full path of a key, such as `mesh.sun_planet.half_backlash_um`. Its last parts suffice if they name a single key; a
/// key of `[mesh]` without a family stands for both. A key shared by equivalent gears and gears with teeth is taken for
/// the teeth's, as the joint is unknown here.
pub fn full_key(key: &str) -> Result<String, Refused> {
    find(key, None).map(|(path, _)| path)
}

/// Full path of a key in the joint file of a text; the kind of gears decides between two keys with one short name.
///
/// ```
/// let [q1, c1] = ["q1", "c1"].map(|name| joint_file::preset(name).unwrap());
/// assert_eq!(joint_file::full_key_in(q1, "lost_motion_arcmin").unwrap(), "mesh.lost_motion_arcmin");
/// assert_eq!(joint_file::full_key_in(c1, "lost_motion_arcmin").unwrap(), "equivalent_gear.lost_motion_arcmin");
/// let refused = joint_file::full_key_in(c1, "mesh.half_backlash_um").unwrap_err();
/// assert!(refused.help.contains("equivalent_gear.lost_motion_arcmin"));
/// ```
pub fn full_key_in(text: &str, key: &str) -> Result<String, Refused> {
    find(key, Gears::of_text(text)).map(|(path, _)| path)
}

/// Value of a key as typed, if the text states the quantity by this key.
pub fn value<'t>(text: &'t str, key: &str) -> Result<Option<&'t str>, Refused> {
    let (path, _) = find(key, Gears::of_text(text))?;
    Ok(lookup(text, &path).map(|(_, found)| &text[found]))
}

/// Returns the text with a key set to a value, as typed after the equals sign. Quotes around words may be omitted; an
/// empty value removes the key. Other keys of the quantity are replaced.
///
/// ```
/// let text = joint_file::preset("q1").unwrap();
/// let worn = joint_file::change(text, "mesh.half_backlash_um", "55").unwrap();
/// assert_eq!(joint_file::value(&worn, "mesh.half_backlash_um"), Ok(Some("55")));
/// let joint = joint_file::read(&worn).unwrap().parameters;
/// assert!((joint.ring_planet.half_backlash[2] - 55e-6).abs() < 1e-12);
/// // Keys are known: one that is not is refused.
/// assert!(joint_file::change(text, "mesh.backlsh_um", "55").is_err());
/// ```
pub fn change(text: &str, key: &str, value: &str) -> Result<String, Refused> {
    change_with_remark(text, key, value, DEFAULT_REMARK)
}

/// Returns the text with a key set to a value, followed by a one-line remark on its origin.
pub fn change_with_remark(text: &str, key: &str, value: &str, remark: &str) -> Result<String, Refused> {
    let (path, known) = find(key, Gears::of_text(text))?;
    let remark = format!(" # {}", remark.replace(char::is_control, " "));
    let (section, name) = path.rsplit_once('.').unwrap_or(("", &path));
    let mut text = text.to_owned();
    for other in replaced(section, name) {
        if other != path || value.trim().is_empty() {
            text = without(&text, &other).ok_or_else(|| cannot_remove(&other))?;
        }
    }
    if value.trim().is_empty() {
        return Ok(text);
    }
    let value = as_toml(value.trim(), known);
    let candidates = [
        replace(&text, &path, &value, &remark),
        insert(&text, section, name, &value, &remark),
        (!section.is_empty()).then(|| format!("{}\n\n[{section}]\n{name} = {value}{remark}\n", text.trim_end())),
        Some(format!("{path} = {value}{remark}\n{text}")),
    ];
    let set = |text: &String| lookup(text, &path).is_some_and(|(_, found)| text[found] == value);
    candidates.into_iter().flatten().find(set).ok_or_else(|| Refused {
        message: format!("`{path}` cannot be set to {value}"),
        help: "the joint file must be valid TOML before a value can be changed".into(),
    })
}

/// Remark behind a changed value, instead of the old value's source.
const DEFAULT_REMARK: &str = "set on the command line";

fn cannot_remove(path: &str) -> Refused {
    let message = format!("`{path}` conflicts with the change and cannot be removed by itself");
    Refused { message, help: "write every key of the joint file on a line of its own".into() }
}

/// Paths replaced by setting a key: the key itself, other forms of it, and for a key of both mesh families the keys of
/// either.
fn replaced(section: &str, name: &str) -> Vec<String> {
    let same = QUANTITY_FORMS.iter().find(|forms| forms.contains(&name)).copied();
    let parts = COMBINED_KEYS.iter().find(|(whole, _)| *whole == name).map(|(_, parts)| *parts);
    let forms = [same, parts].into_iter().flatten().flatten();
    let forms = forms.copied().filter(|form| *form != name).chain([name]);
    let sections: &[&str] = match section {
        "mesh" => &["mesh", "mesh.sun_planet", "mesh.ring_planet"],
        _ => &[section],
    };
    let full = |section: &str, name: &str| if section.is_empty() { name.into() } else { format!("{section}.{name}") };
    forms.flat_map(|form| sections.iter().map(move |section| full(section, form))).collect()
}

/// Every key with a value, by its full path.
fn paths() -> impl Iterator<Item = (String, &'static Key)> {
    KEYS.iter().filter(|key| !matches!(key.kind, Kind::Section)).flat_map(|key| {
        let sections: &[&str] = match key.section {
            "" => &[""],
            "mesh" => &["mesh.", "mesh.sun_planet.", "mesh.ring_planet."],
            "encoder" => &["drive_train.motor_encoder.", "drive_train.output_encoder."],
            _ => return vec![(format!("{}.{}", key.section, key.name), key)],
        };
        sections.iter().map(|section| (format!("{section}{}", key.name), key)).collect()
    })
}

/// Kind of gears of a joint file.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Gears {
    Equivalent,
    WithTeeth,
}

impl Gears {
    /// Kind of gears of a text; `None` if it is no TOML, or describes no gears.
    fn of_text(text: &str) -> Option<Self> {
        let table = DeTable::parse(text).ok()?;
        let holds = |section: &str| table.get_ref().contains_key(section);
        match (holds(EQUIVALENT), holds("geometry")) {
            (true, false) => Some(Self::Equivalent),
            (false, true) => Some(Self::WithTeeth),
            _ => None,
        }
    }

    /// Returns true if a joint with these gears may state a key.
    fn may_state(self, path: &str) -> bool {
        let top = path.split('.').next().unwrap_or(path);
        match self {
            Self::Equivalent => !equivalent::TEETH_KEYS.contains(&top),
            Self::WithTeeth => top != EQUIVALENT,
        }
    }

    /// Rejects a key of the other kind of gears; the help names the corresponding key.
    fn reject(self, path: &str) -> Refused {
        let (of, has) = match self {
            Self::Equivalent => ("of gears with teeth", "an equivalent gear"),
            Self::WithTeeth => ("of an equivalent gear", "gears with teeth"),
        };
        let name = path.rsplit('.').next().unwrap_or(path);
        let forms = QUANTITY_FORMS.iter().find(|forms| forms.contains(&name)).copied().unwrap_or_default();
        let same = [name].into_iter().chain(forms.iter().copied()).find_map(|form| {
            let of_form = |path: &String| path.rsplit('.').next() == Some(form);
            paths().map(|(path, _)| path).find(|path| self.may_state(path) && of_form(path))
        });
        let help = match same {
            Some(same) => format!("write {same}"),
            None => "docs/reference/joint-file.md lists the keys of both kinds".to_owned(),
        };
        Refused { message: format!("`{path}` is a key {of}, and this joint has {has}"), help }
    }
}

const EQUIVALENT: &str = "equivalent_gear";

fn find(key: &str, gears: Option<Gears>) -> Result<(String, &'static Key), Refused> {
    let key = key.trim();
    let matches_end = |path: &str| path == key || path.strip_suffix(key).is_some_and(|rest| rest.ends_with('.'));
    let mut found: Vec<_> = paths().filter(|(path, _)| matches_end(path)).collect();
    if let Some(gears) = gears {
        let other = found.first().map(|(path, _)| path.clone());
        found.retain(|(path, _)| gears.may_state(path));
        if let (true, Some(other)) = (found.is_empty(), other) {
            return Err(gears.reject(&other));
        }
    }
    let depth = |path: &str| path.matches('.').count();
    let least = found.iter().map(|(path, _)| depth(path)).min();
    found.retain(|(path, _)| Some(depth(path)) == least);
    // A key shared with gears with teeth needs the section `equivalent_gear` in front.
    let of_teeth = |path: &str| !path.starts_with("equivalent_gear.");
    if found.iter().any(|(path, _)| of_teeth(path)) {
        found.retain(|(path, _)| of_teeth(path));
    }
    match found.len() {
        0 => Err(unknown(key)),
        1 => Ok(found.remove(0)),
        _ => {
            let all: Vec<String> = found.iter().map(|(path, _)| format!("`{path}`")).collect();
            let message = format!("`{key}` names more than one key of a joint file");
            Err(Refused { message, help: format!("write one of {}", all.join(", ")) })
        }
    }
}

fn unknown(key: &str) -> Refused {
    let message = format!("unknown key `{key}`");
    let all: Vec<(String, &Key)> = paths().collect();
    // The user may have meant any run of last parts, such as `sun_planet.half_backlash_um`.
    let endings = all.iter().flat_map(|(path, _)| {
        std::iter::once(path.as_str()).chain(path.match_indices('.').map(|(dot, _)| &path[dot + 1..]))
    });
    let near = spelling::nearest(key, endings.clone()).or_else(|| {
        let name = key.rsplit('.').next().unwrap_or(key);
        spelling::nearest(name, all.iter().map(|(_, known)| known.name))
    });
    let help = match near {
        _ if keys::is_section(key) => format!("[{key}] is a section: name one of its keys, as in {key}.KEY"),
        Some(near) => {
            let hint = all.iter().find(|(path, _)| path.ends_with(near)).map_or("", |(_, known)| known.hint);
            format!("did you mean `{near}`? {hint}")
        }
        None => "docs/reference/joint-file.md lists all keys, such as mesh.half_backlash_um".to_owned(),
    };
    Refused { message, help }
}

/// Value in TOML: words are quoted, and numbers that only TOML rejects are rewritten.
fn as_toml(value: &str, key: &Key) -> String {
    let is_text = matches!(key.kind, Kind::Text | Kind::Choice(_));
    let quoted = || {
        let escaped = value.chars().map(|letter| match letter {
            '\\' | '"' => format!("\\{letter}"),
            letter if letter.is_control() => format!("\\u{:04x}", u32::from(letter)),
            letter => letter.to_string(),
        });
        format!("\"{}\"", escaped.collect::<String>())
    };
    match DeValue::parse(value) {
        Ok(parsed) if !is_text || matches!(parsed.get_ref(), DeValue::String(_)) => value.to_owned(),
        Err(_) if !is_text => {
            value.parse::<f64>().map_or_else(|_| quoted(), |number| format!("{number:?}").to_lowercase())
        }
        _ => quoted(),
    }
}

/// Spans of a key and its value.
fn lookup(text: &str, path: &str) -> Option<(Range<usize>, Range<usize>)> {
    let table = DeTable::parse(text).ok()?;
    let (section, name) = path.rsplit_once('.').unwrap_or(("", path));
    let inside = table_at(table.get_ref(), section)?.1;
    let (key, value) = inside.get_key_value(name)?;
    Some((key.span(), value.span()))
}

/// Table by its path, with the span of its header.
fn table_at<'a, 't>(top: &'a DeTable<'t>, section: &str) -> Option<(Range<usize>, &'a DeTable<'t>)> {
    let mut found = (0..0, top);
    for part in section.split('.').filter(|part| !part.is_empty()) {
        let value: &Spanned<DeValue<'_>> = found.1.get(part)?;
        let DeValue::Table(table) = value.get_ref() else { return None };
        found = (value.span(), table);
    }
    Some(found)
}

/// End of a value's line, if only a comment follows the value.
fn rest_of_line(text: &str, end: usize) -> Option<usize> {
    let rest = text[end..].split('\n').next().unwrap_or_default();
    let remark = rest.trim_start();
    (remark.is_empty() || remark.starts_with('#')).then_some(end + rest.trim_end_matches('\r').len())
}

fn replace(text: &str, path: &str, value: &str, remark: &str) -> Option<String> {
    let (_, old) = lookup(text, path)?;
    let (end, remark) = match rest_of_line(text, old.end) {
        Some(end) => (end, remark),
        None => (old.end, ""),
    };
    Some(format!("{}{value}{remark}{}", &text[..old.start], &text[end..]))
}

/// Text without a key; `None` if the key shares its line.
fn without(text: &str, path: &str) -> Option<String> {
    let Some((key, value)) = lookup(text, path) else { return Some(text.to_owned()) };
    let start = text[..key.start].rfind('\n').map_or(0, |newline| newline + 1);
    let end = rest_of_line(text, value.end)?;
    let shorter = format!(
        "{}{}",
        &text[..start],
        text[end..].strip_prefix('\r').unwrap_or(&text[end..]).trim_start_matches('\n')
    );
    (text[start..key.start].trim().is_empty() && lookup(&shorter, path).is_none()).then_some(shorter)
}

/// Inserts a key as the first of an existing section.
fn insert(text: &str, section: &str, name: &str, value: &str, remark: &str) -> Option<String> {
    if section.is_empty() {
        return Some(format!("{name} = {value}{remark}\n{text}"));
    }
    let table = DeTable::parse(text).ok()?;
    let (header, inside) = table_at(table.get_ref(), section)?;
    if text[header.clone()].starts_with('{') {
        let comma = if inside.is_empty() { "" } else { "," };
        let at = header.start + 1;
        return Some(format!("{} {name} = {value}{comma}{}", &text[..at], &text[at..]));
    }
    let at = text[header.end..].find('\n').map_or(text.len(), |newline| header.end + newline + 1);
    let newline = if text[..at].ends_with('\n') { "" } else { "\n" };
    Some(format!("{}{newline}{name} = {value}{remark}\n{}", &text[..at], &text[at..]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{PRESETS, preset, read};

    fn q1() -> &'static str {
        preset("q1").expect("the default preset")
    }

    fn half_backlash(text: &str) -> [f64; 2] {
        let joint = read(text).expect("still a joint").parameters;
        [joint.sun_planet.half_backlash[1], joint.ring_planet.half_backlash[1]]
    }

    /// Setting every key of every preset to its stated value leaves the joint unchanged.
    #[test]
    fn setting_the_stated_value_changes_nothing() {
        for name in PRESETS {
            let text = preset(name).expect("a preset");
            let before = read(text).expect("a good preset");
            for (path, _) in paths() {
                let Some((_, value)) = lookup(text, &path) else { continue };
                let changed = change(text, &path, &text[value]).unwrap_or_else(|why| panic!("{name}, {path}: {why:?}"));
                let after = read(&changed).unwrap_or_else(|why| panic!("{name}, {path}: {why:?}\n{changed}"));
                assert_eq!(after.parameters, before.parameters, "{name}, {path}");
                assert_eq!(after.surroundings, before.surroundings, "{name}, {path}");
            }
        }
    }

    /// A key of one mesh family gets its own section.
    #[test]
    fn family_key_gets_own_section() {
        let changed = change(q1(), "sun_planet.half_backlash_um", "60").expect("a known key");
        assert_eq!(half_backlash(&changed), [60e-6, 40e-6]);
        let again = change(&changed, "mesh.sun_planet.half_backlash_um", "70").expect("a known key");
        assert_eq!(half_backlash(&again), [70e-6, 40e-6]);
    }

    /// A key of both mesh families replaces the key of one.
    #[test]
    fn common_key_replaces_family_key() {
        let own = change(q1(), "ring_planet.half_backlash_um", "60").expect("a known key");
        let both = change(&own, "half_backlash_um", "10").expect("a known key");
        assert_eq!(half_backlash(&both), [10e-6, 10e-6]);
    }

    /// Another form of a quantity replaces the stated form.
    #[test]
    fn other_form_replaces_quantity() {
        let changed = change(q1(), "backlash_um", "30").expect("a known key");
        assert_eq!(half_backlash(&changed), [15e-6, 15e-6]);
        let own = change(q1(), "sun_planet.backlash_um", "30").expect("a known key");
        assert_eq!(half_backlash(&own), [15e-6, 40e-6]);
        let mass = change(q1(), "sun_inertia_kg_m2", "2e-6").expect("a known key");
        assert!(read(&mass).is_ok(), "{mass}");
    }

    /// An empty value removes the key, and words need no quotes.
    #[test]
    fn empty_value_removes_the_key() {
        let paper = preset("paper").expect("a preset");
        let still = change(paper, "mesh_frequency_over_omega_n", "").expect("a known key");
        let angle = change(&still, "excitation.mode", "angle").expect("a known key");
        let joint = read(&angle).expect("still a joint").parameters;
        assert_eq!(joint.excitation, parameters::Excitation::Angle);
    }

    /// Numbers may be written as in any programming language.
    #[test]
    fn common_number_formats_are_accepted() {
        for (text, value) in [("60", 60e-6), ("60.", 60e-6), (".5e2", 50e-6), ("[60, 60.0, 6e1]", 60e-6)] {
            let changed = change(q1(), "mesh.half_backlash_um", text).expect("a known key");
            assert_eq!(half_backlash(&changed), [value, value], "{text}");
        }
    }

    /// Bad values are left to the reader's checks and cannot inject lines.
    #[test]
    fn bad_values_cannot_inject_lines() {
        for value in ["6000", "NaN", "inf", "sixty", "-1", "60 um", "60\n[x]\ny=1", "[1, 2]", "\"60\""] {
            let changed = change(q1(), "mesh.half_backlash_um", value).expect("a known key");
            let problems = read(&changed).expect_err(value);
            assert_eq!(problems.len(), 1, "{value}: {problems:?}");
            assert!(problems[0].message.contains("half_backlash_um"), "{problems:?}");
        }
    }

    /// An unknown key is rejected with the nearest known one.
    #[test]
    fn unknown_key_suggests_nearest() {
        let refused = |key| change(q1(), key, "1").expect_err(key);
        assert!(refused("half_backlsh_um").help.contains("`half_backlash_um`"));
        assert!(refused("sun_planet.half_backlash").help.contains("`sun_planet.half_backlash_um`"));
        assert!(
            refused("meshes.damping_ratio").help.contains("damping_ratio`"),
            "{:?}",
            refused("meshes.damping_ratio")
        );
        assert!(refused("mesh").help.contains("section"), "{:?}", refused("mesh"));
        let nonsense = refused("weather_forecast");
        assert!(nonsense.help.contains("joint-file.md"), "{nonsense:?}");
        assert!(refused("bits").message.contains("more than one"));
    }

    /// Sections in one line or with dotted keys can be changed too.
    #[test]
    fn inline_sections_can_be_changed() {
        let inline = "name = \"x\"\ncontact = { dead_zone = \"sharp\" }\n";
        let changed = change(inline, "damping_law", "paper").expect("a known key");
        assert!(changed.contains("{ damping_law = \"paper\", dead_zone"), "{changed}");
        let dotted = "contact.dead_zone = \"sharp\"\n";
        assert!(
            change(dotted, "damping_law", "paper").expect("a known key").contains("contact.damping_law = \"paper\"")
        );
    }
}
