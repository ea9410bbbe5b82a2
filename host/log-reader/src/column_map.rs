//! Column maps: quantity and unit of the columns of a manufacturer's log. A map stands for `--column` and `--unit` in
//! all logs of a kind; the command line overrides it.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use serde::Deserialize;

use super::columns::{DIFFERENCE, KNOWN};
use super::units::{self, Unit};
use report::failure::{Failure, Outcome};
use report::input;

/// Built-in maps.
const PRESETS: [(&str, &str); 5] = [
    ("ros2-joint-states", include_str!("../../../maps/ros2-joint-states.toml")),
    ("moteus", include_str!("../../../maps/moteus.toml")),
    ("odrive", include_str!("../../../maps/odrive.toml")),
    ("vesc-tool", include_str!("../../../maps/vesc-tool.toml")),
    ("feetech", include_str!("../../../maps/feetech.toml")),
];

/// Content of a map's file.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct MapFile {
    /// Name in the log by canonical name.
    #[serde(default)]
    columns: BTreeMap<String, String>,
    /// Unit by quantity.
    #[serde(default)]
    units: BTreeMap<String, String>,
    /// Several joints in one log, by name; the columns above belong to each of them.
    #[serde(default)]
    joints: BTreeMap<String, JointColumns>,
}

/// Map of one of several joints in a log.
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
struct JointColumns {
    /// Joint file or preset.
    joint: Option<PathBuf>,
    /// Name in the log by canonical name.
    columns: BTreeMap<String, String>,
    /// Unit by quantity.
    #[serde(default)]
    units: BTreeMap<String, String>,
}

/// Joint of a map with several joints.
#[derive(Debug, Clone, PartialEq)]
pub struct MappedJoint {
    /// Name in the map.
    pub name: String,
    /// Joint file or preset, if the map states one.
    pub file: Option<PathBuf>,
}

/// Column names and units of a log.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ColumnMap {
    /// Pairs of canonical name and name in the log.
    pub columns: Vec<(String, String)>,
    /// Units of columns with bare names.
    pub units: Vec<Unit>,
}

impl ColumnMap {
    /// Columns and units of the command line, completed by a map; `joint` selects one of the map's joints.
    pub fn new(map: Option<&Path>, joint: Option<&str>, columns: &[(String, String)], units: &[Unit]) -> Outcome<Self> {
        let mut all = Self { columns: columns.to_vec(), units: units.to_vec() };
        let Some(path) = map else { return Ok(all) };
        let map = parse_joint(&text(path)?, joint).map_err(|failure| failure.while_doing(path.display()))?;
        let is_on_command_line =
            |own: &str| columns.iter().any(|(name, _)| units::quantity_of(name) == units::quantity_of(own));
        all.columns.extend(map.columns.into_iter().filter(|(own, _)| !is_on_command_line(own)));
        // A column renamed with a unit in its name needs no unit of the map.
        let is_there = |unit: &Unit| all.columns.iter().any(|(own, _)| own == unit.name());
        let has_stated_unit = |unit: &Unit| units.iter().any(|other| other.name() == unit.name());
        all.units.extend(map.units.into_iter().filter(|unit| is_there(unit) && !has_stated_unit(unit)));
        Ok(all)
    }
}

/// Parses a value of `--column`.
pub fn parse_renaming(text: &str) -> Result<(String, String), String> {
    let (own, theirs) = text.split_once('=').ok_or("write COLUMN=NAME, as in motor_counts=pos_raw")?;
    let mut names = KNOWN.iter().map(|(name, _)| *name).chain(units::bare_names()).chain([DIFFERENCE]);
    if names.any(|name| name == own) && !theirs.is_empty() {
        return Ok((own.to_owned(), theirs.to_owned()));
    }
    let names: Vec<&str> = KNOWN.iter().map(|(name, _)| *name).chain(units::bare_names()).collect();
    Err(format!("`{own}` is not one of {}", names.join(", ")))
}

/// Joints of a map in order of their names; empty for a map of one joint.
pub fn joints(map: Option<&Path>) -> Outcome<Vec<MappedJoint>> {
    let Some(path) = map else { return Ok(Vec::new()) };
    let file = parse(&text(path)?).map_err(|failure| failure.while_doing(path.display()))?;
    Ok(file.joints.into_iter().map(|(name, own)| MappedJoint { name, file: own.joint }).collect())
}

fn text(path: &Path) -> Outcome<String> {
    let name = path.to_string_lossy();
    match PRESETS.iter().find(|(known, _)| *known == name).filter(|_| !path.exists()) {
        Some((_, text)) => Ok((*text).to_owned()),
        None => input::text(path, input::LARGEST_TYPED).map_err(|why| {
            let known: Vec<&str> = PRESETS.iter().map(|(name, _)| *name).collect();
            Failure::new(format!("cannot read the map {name}: {why}"))
                .with_help(format!("give the path of a TOML file, or one of {}", known.join(", ")))
        }),
    }
}

fn refused(why: &str) -> Failure {
    Failure::new(why.to_owned()).with_help(
        "[columns] has lines such as motor_angle = \"pos\", [units] such as motor_angle = \"turns\"; \
             [joints.NAME.columns] and [joints.NAME.units] define one of several joints",
    )
}

fn parse(text: &str) -> Outcome<MapFile> {
    let file: MapFile = toml::from_str(text).map_err(|error| {
        let line = error.span().map_or(0, |span| text[..span.start].lines().count().max(1));
        refused(&format!("line {line}: {}", error.message()))
    })?;
    // The columns may be on the command line.
    if file.columns.is_empty() && file.units.is_empty() && file.joints.is_empty() {
        return Err(refused("it has neither [columns] nor [joints.NAME.columns]"));
    }
    // The name becomes a folder's name.
    let is_name = |name: &str| {
        !name.is_empty() && name.chars().all(|letter| letter.is_ascii_alphanumeric() || "_-".contains(letter))
    };
    match file.joints.keys().find(|name| !is_name(name)) {
        Some(name) => Err(refused(&format!("[joints]: the name `{name}` may have letters, digits, `_` and `-`"))),
        None => Ok(file),
    }
}

/// Map from its text, of one of its joints if it has several; that joint's entries override the common ones.
fn parse_joint(text: &str, joint: Option<&str>) -> Outcome<ColumnMap> {
    let mut file = parse(text)?;
    let names: Vec<&str> = file.joints.keys().map(String::as_str).collect();
    let names = names.join(", ");
    let own = match joint {
        None if file.joints.is_empty() => JointColumns::default(),
        None => {
            return Err(Failure::new(format!("the map has several joints: {names}"))
                .with_help("choose one of them with --map-joint NAME"));
        }
        Some(name) => file.joints.remove(name).ok_or_else(|| {
            let help = if names.is_empty() {
                "it has none: leave --map-joint out".to_owned()
            } else {
                format!("it has {names}")
            };
            Failure::new(format!("the map has no joint `{name}`")).with_help(help)
        })?,
    };
    file.columns.extend(own.columns);
    file.units.extend(own.units);
    let columns = file.columns.iter().map(|(own, theirs)| parse_renaming(&format!("{own}={theirs}")));
    let units = file.units.iter().map(|(quantity, unit)| units::parse(&format!("{quantity}={unit}")));
    Ok(ColumnMap {
        columns: columns.collect::<Result<_, _>>().map_err(|why| refused(&format!("[columns]: {why}")))?,
        units: units.collect::<Result<_, _>>().map_err(|why| refused(&format!("[units]: {why}")))?,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every built-in map is readable and documented.
    #[test]
    fn preset_maps_are_read_and_documented() {
        let page = include_str!("../../../docs/reference/identify.md");
        for (name, text) in PRESETS {
            let map = parse_joint(text, None).unwrap_or_else(|failure| panic!("{name}: {failure}"));
            assert!(map.columns.iter().any(|(own, _)| own == "motor_angle"), "{name}");
            assert!(text.contains("# Source: "), "{name}");
            assert!(page.contains(&format!("`{name}`")), "{name}");
        }
    }

    /// The command line overrides a map.
    #[test]
    fn command_line_overrides_map() {
        let columns = [("output_counts".to_owned(), "raw".to_owned())];
        let units = [units::parse("motor_angle=deg").expect("a unit")];
        let map = ColumnMap::new(Some(Path::new("moteus")), None, &columns, &units).expect("a preset");
        assert_eq!(map.columns.iter().filter(|(own, _)| own.starts_with("output")).count(), 1);
        assert_eq!(map.units.iter().filter(|unit| unit.name() == "motor_angle").count(), 1);
        assert!(map.units.iter().all(|unit| unit.name() != "output_angle"));
    }

    /// An invalid map is rejected with the place of the fault.
    #[test]
    fn invalid_map_is_rejected_with_place() {
        for (text, why) in [
            ("[columns]\nspeed = \"v\"\n", "[columns]: `speed` is not one of"),
            ("[columns]\nmotor_angle = 3\n", "line 2"),
            ("[columns]\n[units]\nmotor_angle = \"grad\"\n", "[units]: `grad` is not one of"),
            ("[column]\n", "line 1"),
            ("", "columns"),
        ] {
            let refused = parse_joint(text, None).expect_err(text);
            assert!(refused.message().contains(why), "{text}: {refused}");
        }
    }

    /// A joint of a map has its own and the common columns.
    #[test]
    fn map_joint_inherits_common_columns() {
        let text = "[columns]\ntime_s = \"t\"\n[joints.knee.columns]\nmotor_counts = \"position[0]\"\n[joints.hip.columns]\nmotor_counts \
                    = \"position[2]\"\n";
        let map = parse_joint(text, Some("hip")).expect("a joint");
        let pair = |own: &str, theirs: &str| (own.to_owned(), theirs.to_owned());
        assert_eq!(map.columns, [pair("motor_counts", "position[2]"), pair("time_s", "t")]);
        assert!(parse_joint(text, None).expect_err("two joints").message().contains("several joints: hip, knee"));
        assert!(
            parse_joint(text, Some("toe")).expect_err("no toe").help().is_some_and(|help| help.contains("hip, knee"))
        );
        let outside = parse_joint("[joints.\"../x\".columns]\nmotor_counts = \"a\"\n", Some("../x"));
        assert!(outside.expect_err("a folder elsewhere").message().contains("may have letters"));
    }
}
