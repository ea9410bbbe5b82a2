//! Everything that is not compared, in one place: what two runs of the same sources do not share. Each rule has a name, by
//! which the report counts what was left out, and a reason. Nothing else is left out anywhere.

use std::fmt;

/// When it ran.
pub const DATE: &str = "date";
/// At what time of day.
pub const CLOCK: &str = "time of day";
/// Where the sources and results lie on this machine; the last part of a path is compared.
pub const PATH: &str = "folder";
/// How long the host took, by its clock or by its processor's time.
pub const HOST_TIME: &str = "host time";
/// Which sources.
pub const COMMIT: &str = "commit";
/// Digest of an ELF file: names and paths in its debugging information, which no board ever sees, are in it. Its sizes and
/// everything that it does on a board are compared.
pub const ELF_DIGEST: &str = "digest of an ELF file";
/// When bytes came over the line between host and emulator, which is the host's affair: how often a tick waited for them,
/// and which tick or deepest call an interrupt of the line fell into. It costs no step; mean, least and greatest time of a
/// tick are compared, so are the RAM of statics, and the deepest stack that `joint hil --check` finds in the image.
pub const LINE_TIMING: &str = "timing of the line";

/// Lists of the files beside them, with digests of whole files, dates and all: what is in a file is compared there.
pub const FILES: [&str; 1] = [".written-by-joint"];

/// Where something stands that is left out. In words, `#` is a number that is left out, `@` a digest of hexadecimal digits.
#[derive(Debug, Clone, Copy)]
pub enum Place {
    /// Below this key of JSON, or of the remarks in an MCAP log: the end of the way to it.
    Key(&'static str),
    /// In an object of JSON that has this `name`, below this key.
    Named(&'static str, &'static str),
    /// In this attribute of XML.
    Attribute(&'static str),
    /// In these words of a text with one space between them, whichever file it is in.
    Phrase(&'static str),
    /// In a table of text or HTML whose first column has this head, in small letters or large ones: in this column.
    Column(&'static str, &'static str),
    /// In a cell of an HTML table to the right of this one, which may end with [`MARK`].
    Beside(&'static str),
    /// On a page, beside the line with this name of a figure, before it or behind it: in a line of this form.
    Tile(&'static str, &'static str),
}

/// What stands behind the name of a figure that an emulator has measured.
pub const MARK: &str = " EMULATED";

/// Behind a commit: the sources were not quite it.
pub const CHANGED: &str = " (changed)";

/// Where which rule holds; those for dates, times of day and folders hold everywhere besides.
pub const RULES: &[(Place, &str)] = &[
    (Place::Key("date"), DATE),
    (Place::Key("git_commit"), COMMIT),
    (Place::Key("commit"), COMMIT),
    (Place::Key("elf_sha256"), ELF_DIGEST),
    // A test or a whole run of them.
    (Place::Key("seconds"), HOST_TIME),
    // Schemes of `joint sim --scheme all`.
    (Place::Key("cost_ratio"), HOST_TIME),
    (Place::Key("cost_s_per_s"), HOST_TIME),
    // Libraries of `joint bench`.
    (Place::Key("host.times.cost"), HOST_TIME),
    (Place::Key("host_at_equal_error"), HOST_TIME),
    // Runs on the emulated board.
    (Place::Key("timing.counters.waited"), LINE_TIMING),
    (Place::Key("timing.idle_percent"), LINE_TIMING),
    (Place::Key("timing.stack_used_bytes"), LINE_TIMING),
    (Place::Key("samples.computation_s"), LINE_TIMING),
    (Place::Named("idle time", "figure"), LINE_TIMING),
    (Place::Named("ticks that waited for the schedule or the line", "figure"), LINE_TIMING),
    (Place::Named("RAM used", "figure"), LINE_TIMING),
    (Place::Named("RAM used", "note"), LINE_TIMING),
    (Place::Attribute("time"), HOST_TIME),
    (Place::Attribute("timestamp"), DATE),
    (Place::Phrase("runs, # s)"), HOST_TIME),
    (Place::Phrase("commit @"), COMMIT),
    (Place::Phrase("Commit @,"), COMMIT),
    (Place::Phrase("image @"), ELF_DIGEST),
    (Place::Phrase("idle time # %"), LINE_TIMING),
    (Place::Phrase("waited for the schedule or the line #"), LINE_TIMING),
    (Place::Phrase("RAM used # B"), LINE_TIMING),
    (Place::Phrase("and # B of stack at its deepest"), LINE_TIMING),
    (Place::Column("scheme", "cost"), HOST_TIME),
    (Place::Beside("Source commit"), COMMIT),
    (Place::Beside("Sources"), COMMIT),
    (Place::Beside("Date"), DATE),
    (Place::Beside("idle time"), LINE_TIMING),
    (Place::Beside("Idle share"), LINE_TIMING),
    (Place::Beside("ticks that waited for the schedule or the line"), LINE_TIMING),
    (Place::Beside("Waits"), LINE_TIMING),
    (Place::Beside("RAM used"), LINE_TIMING),
    (Place::Beside("Deepest stack"), LINE_TIMING),
    (Place::Tile("On the clock", "# s"), HOST_TIME),
    (Place::Tile("Idle", "# %"), LINE_TIMING),
];

/// The rule that holds at such a place.
pub fn rule(is_there: impl Fn(&Place) -> bool) -> Option<&'static str> {
    RULES.iter().find(|(place, _)| is_there(place)).map(|(_, rule)| *rule)
}

/// The rule that leaves out what is below a key, by all keys that lead to it with a dot between them.
pub fn ignored_key(way: &str) -> Option<&'static str> {
    let ends = |end: &str| way.strip_suffix(end).is_some_and(|before| before.is_empty() || before.ends_with('.'));
    rule(|place| matches!(place, Place::Key(end) if ends(end)))
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Key(end) => write!(f, "key {end}"),
            Self::Named(name, key) => write!(f, "{key} of `{name}`"),
            Self::Attribute(name) => write!(f, "attribute {name}"),
            Self::Phrase(words) => write!(f, "`#` or `@` in `{words}`"),
            Self::Column(first, column) => write!(f, "column {column} of a table that begins with {first}"),
            Self::Beside(name) => write!(f, "cell beside {name}"),
            Self::Tile(name, form) => write!(f, "`#` in `{form}` beside `{name}`"),
        }
    }
}

/// All of it, to be read.
pub fn list() -> String {
    let places: String = RULES.iter().map(|(place, rule)| format!("  {place}: {rule}\n")).collect();
    format!(
        "Not compared, wherever it stands:\n  {DATE}\n  {CLOCK}\n  {PATH}\n  `{}`: {COMMIT}\n\
         Not compared, where it stands:\n{places}",
        CHANGED.trim()
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_key_is_known_by_the_end_of_its_way() {
        assert_eq!(ignored_key("identity.date"), Some(DATE));
        assert_eq!(ignored_key("host.times.cost"), Some(HOST_TIME));
        for kept in ["methods.cost", "duration_s", "date.figure", "update"] {
            assert_eq!(ignored_key(kept), None, "{kept}");
        }
    }
}
