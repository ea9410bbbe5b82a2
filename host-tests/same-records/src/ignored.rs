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
/// How the line between host and emulator was shared out in time: it costs no step.
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
];

/// Attributes of XML.
pub const ATTRIBUTES: &[(&str, &str)] = &[("time", HOST_TIME), ("timestamp", DATE)];

/// Words of a text, whichever file it is in: `#` is the figure or digest that is left out.
pub const PHRASES: &[Phrase] = &[
    Phrase { words: "runs, # s)", rule: HOST_TIME },
    Phrase { words: "On the clock # s", rule: HOST_TIME },
    Phrase { words: "commit #", rule: COMMIT },
    Phrase { words: "image #", rule: ELF_DIGEST },
];

/// Columns of tables in text and HTML, by the whole head of the table and the head of the column.
pub const COLUMNS: &[Column] =
    &[Column { table: "scheme deflections gap link offset cost sub-steps", column: "cost", rule: HOST_TIME }];

/// Cells of HTML tables that have their meaning in the cell to the left.
pub const ROWS: &[(&str, &str)] = &[("Source commit", COMMIT), ("Sources", COMMIT), ("Date", DATE)];

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
    /// The words at the head of the table.
    pub table: &'static str,
    /// Its own.
    pub column: &'static str,
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
    text += &named("attribute", ATTRIBUTES);
    text += &named("cell beside", ROWS);
    for Phrase { words, rule } in PHRASES {
        text += &format!("  `#` in `{words}`: {rule}\n");
    }
    for Column { table, column, rule } in COLUMNS {
        text += &format!("  column {column} of the table `{table}`: {rule}\n");
    }
    text
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
