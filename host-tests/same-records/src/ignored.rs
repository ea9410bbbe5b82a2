//! Everything that is not compared, in one place: what two runs of the same sources do not share. Each rule has a name, by
//! which the report counts what was left out, and a reason. Nothing else is left out anywhere.

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

/// Keys of JSON, and of the remarks in an MCAP log, by the end of the way to them; everything below such a key is left out.
pub const KEYS: &[(&str, &str)] = &[
    ("date", DATE),
    ("git_commit", COMMIT),
    ("commit", COMMIT),
    ("elf_sha256", ELF_DIGEST),
    // A test or a whole run of them.
    ("seconds", HOST_TIME),
    // Schemes of `joint sim --scheme all`.
    ("cost_ratio", HOST_TIME),
    ("cost_s_per_s", HOST_TIME),
    // Libraries of `joint bench`.
    ("host.times.cost", HOST_TIME),
    ("host_at_equal_error", HOST_TIME),
    // Runs on the emulated board.
    ("timing.counters.waited", LINE_TIMING),
    ("timing.idle_percent", LINE_TIMING),
    ("timing.stack_used_bytes", LINE_TIMING),
    ("samples.computation_s", LINE_TIMING),
];

/// Values of JSON that say what they are by a `name` beside them: the keys in such an object that are left out.
pub const NAMED: &[Named] = &[
    Named { name: "idle time", keys: &["figure"], rule: LINE_TIMING },
    Named { name: "ticks that waited for the schedule or the line", keys: &["figure"], rule: LINE_TIMING },
    Named { name: "RAM used", keys: &["figure", "note"], rule: LINE_TIMING },
];

/// Attributes of XML.
pub const ATTRIBUTES: &[(&str, &str)] = &[("time", HOST_TIME), ("timestamp", DATE)];

/// Words of a text, whichever file it is in: `#` is a number that is left out, `@` a digest of hexadecimal digits.
pub const PHRASES: &[Phrase] = &[
    Phrase { words: "runs, # s)", rule: HOST_TIME },
    Phrase { words: "commit @", rule: COMMIT },
    Phrase { words: "Commit @,", rule: COMMIT },
    Phrase { words: "image @", rule: ELF_DIGEST },
    Phrase { words: "idle time # %", rule: LINE_TIMING },
    Phrase { words: "waited for the schedule or the line #", rule: LINE_TIMING },
    Phrase { words: "RAM used # B", rule: LINE_TIMING },
    Phrase { words: "and # B of stack at its deepest", rule: LINE_TIMING },
];

/// Behind a commit: the sources were not quite it.
pub const CHANGED: &str = " (changed)";

/// Columns of tables in text and HTML, by the head of the table's first column and their own.
pub const COLUMNS: &[Column] = &[Column { first: "scheme", column: "cost", rule: HOST_TIME }];

/// Cells of HTML tables that have their meaning in the cell to the left; that may end with the mark [`MARK`].
pub const ROWS: &[(&str, &str)] = &[
    ("Source commit", COMMIT),
    ("Sources", COMMIT),
    ("Date", DATE),
    ("idle time", LINE_TIMING),
    ("Idle share", LINE_TIMING),
    ("ticks that waited for the schedule or the line", LINE_TIMING),
    ("Waits", LINE_TIMING),
    ("RAM used", LINE_TIMING),
    ("Deepest stack", LINE_TIMING),
];

/// Figures that stand beside their name on a page, before it or behind it, with the form that they have.
pub const TILES: &[Tile] = &[
    Tile { name: "On the clock", form: "# s", rule: HOST_TIME },
    Tile { name: "Idle", form: "# %", rule: LINE_TIMING },
];

/// What stands behind the name of a figure that an emulator has measured.
pub const MARK: &str = " EMULATED";

/// An object with this `name`.
#[derive(Debug, Clone, Copy)]
pub struct Named {
    /// Its name.
    pub name: &'static str,
    /// The keys.
    pub keys: &'static [&'static str],
    /// Name of the rule.
    pub rule: &'static str,
}

/// A phrase.
#[derive(Debug, Clone, Copy)]
pub struct Phrase {
    /// Its words with one space between them.
    pub words: &'static str,
    /// Name of the rule.
    pub rule: &'static str,
}

/// A column.
#[derive(Debug, Clone, Copy)]
pub struct Column {
    /// What stands at the head of the table's first column, in small letters or large ones.
    pub first: &'static str,
    /// Its own.
    pub column: &'static str,
    /// Name of the rule.
    pub rule: &'static str,
}

/// A figure beside its name.
#[derive(Debug, Clone, Copy)]
pub struct Tile {
    /// Its name, a line of its own.
    pub name: &'static str,
    /// The line beside it; `#` is the number.
    pub form: &'static str,
    /// Name of the rule.
    pub rule: &'static str,
}

/// The rule that leaves a value out, by the keys that lead to it.
pub fn ignored_key(keys: &[&str]) -> Option<&'static str> {
    let ends = |end: &str| {
        let end: Vec<&str> = end.split('.').collect();
        keys.ends_with(&end)
    };
    KEYS.iter().find(|(end, _)| ends(end)).map(|(_, rule)| *rule)
}

/// All of it, to be read.
pub fn list() -> String {
    let mut text = String::from("Not compared, wherever it stands:\n");
    for rule in [DATE, CLOCK, PATH] {
        text += &format!("  {rule}\n");
    }
    let named = |what: &'static str, list: &[(&'static str, &'static str)]| {
        list.iter().map(move |(name, rule)| format!("  {what} {name}: {rule}\n")).collect::<String>()
    };
    text += &named("key", KEYS);
    for Named { name, keys, rule } in NAMED {
        text += &format!("  {} of `{name}`: {rule}\n", keys.join(" and "));
    }
    text += &named("attribute", ATTRIBUTES);
    text += &named("cell beside", ROWS);
    for Phrase { words, rule } in PHRASES {
        text += &format!("  `#` or `@` in `{words}`: {rule}\n");
    }
    text += &format!("  `{}`: {COMMIT}\n", CHANGED.trim());
    for Column { first, column, rule } in COLUMNS {
        text += &format!("  column {column} of a table that begins with {first}: {rule}\n");
    }
    for Tile { name, form, rule } in TILES {
        text += &format!("  `#` in `{form}` beside `{name}`: {rule}\n");
    }
    text
}

/// The rule that leaves a value out, by the name beside it.
pub fn ignored_by_name(name: &str, key: &str) -> Option<&'static str> {
    NAMED.iter().find(|named| named.name == name && named.keys.contains(&key)).map(|named| named.rule)
}

/// The rule that leaves an attribute out.
pub fn ignored_attribute(name: &str) -> Option<&'static str> {
    ATTRIBUTES.iter().find(|(ignored, _)| *ignored == name).map(|(_, rule)| *rule)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_key_is_known_by_the_end_of_its_way() {
        assert_eq!(ignored_key(&["identity", "date"]), Some(DATE));
        assert_eq!(ignored_key(&["host", "times", "cost"]), Some(HOST_TIME));
        for kept in [&["methods", "cost"][..], &["duration_s"], &["date", "figure"], &["update"]] {
            assert_eq!(ignored_key(kept), None, "{kept:?}");
        }
    }
}
