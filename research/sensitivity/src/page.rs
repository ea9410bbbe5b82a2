//! The page with the table. The page is also the memory of the program: rows of the same runs are kept.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use model_core::numbers::sensitivity::Threshold;
use report::failure::{Failure, Outcome};

use crate::runs::{FILES, Figures, digest_of};

/// Cells of a threshold.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Row {
    /// Closed loops under the factors 0.5 and 1.5.
    pub loops: [String; 2],
    /// Unit tests that fail under one of the factors.
    pub unit_tests: String,
}

impl Default for Row {
    fn default() -> Self {
        Self { loops: [NOT_RUN; 2].map(str::to_owned), unit_tests: NOT_RUN.to_owned() }
    }
}

impl Row {
    /// True if the unit tests have not run.
    pub fn lacks_unit_tests(&self) -> bool {
        self.unit_tests == NOT_RUN
    }

    /// True if closed loops have not run.
    pub fn lacks_loops(&self) -> bool {
        self.loops.iter().any(|cell| cell == NOT_RUN)
    }

    /// True if a changed value moves a figure or fails a unit test.
    fn is_held(&self) -> bool {
        let moves = |cell: &String| !["moves nothing", NOT_RUN].contains(&cell.as_str()) && !cell.starts_with("stays ");
        self.loops.iter().any(moves) || self.unit_tests.starts_with('`')
    }
}

/// End of the lines above the table.
const DISCARDS: &str = "Another digest discards all rows.\n\n";

/// Cell without a result.
const NOT_RUN: &str = "not run";

/// Page with the table.
pub struct Page<'t> {
    thresholds: &'t [Threshold],
    /// Lines above the table.
    head: String,
    /// Cells by name of the threshold.
    rows: BTreeMap<String, Row>,
}

impl<'t> Page<'t> {
    /// Page for these thresholds. Keeps the rows of an existing page that was measured against the same runs.
    pub fn open(path: &Path, thresholds: &'t [Threshold], base: &Figures, seeds: u64) -> Self {
        let mut page = Self { thresholds, head: head(base, seeds), rows: BTreeMap::new() };
        let text = fs::read_to_string(path).unwrap_or_default();
        if text.contains(&digest_line(base)) {
            page.rows = thresholds.iter().filter_map(|threshold| kept_row(threshold, &text)).collect();
        }
        page
    }

    /// Existing page with all its rows, whatever runs it was measured against.
    pub fn open_without_runs(path: &Path, thresholds: &'t [Threshold]) -> Outcome<Self> {
        let text = fs::read_to_string(path).unwrap_or_default();
        let Some(head) = text.find(DISCARDS).map(|at| text[..at + DISCARDS.len()].to_owned()) else {
            return Err(Failure::new(format!("{} is no page of this command", path.display()))
                .with_help("without --unit-tests the command writes a page"));
        };
        let rows = thresholds.iter().filter_map(|threshold| kept_row(threshold, &text)).collect();
        Ok(Self { thresholds, head, rows })
    }

    /// Cells of a threshold.
    pub fn row(&self, name: &str) -> Row {
        self.rows.get(name).cloned().unwrap_or_default()
    }

    /// Sets the cells of a threshold.
    pub fn set(&mut self, name: &str, row: Row) {
        self.rows.insert(name.to_owned(), row);
    }

    /// Text of the page.
    pub fn text(&self) -> String {
        let mut text = self.head.clone();
        let held = self.rows.values().filter(|row| row.is_held()).count();
        let run = self.rows.values().filter(|row| !row.lacks_loops()).count();
        text += &format!(
            "{held} of {} thresholds move a figure or fail a unit test. Closed loops have run for {run}.\n",
            self.thresholds.len()
        );
        let mut folder = "";
        for threshold in self.thresholds {
            if threshold.folder != folder {
                folder = &threshold.folder;
                text += &format!(
                    "\n## {folder}\n\n| threshold | value | origin | x0.5 | x1.5 | unit tests |\n|---|---|---|---|---|---|\n"
                );
            }
            let Row { loops: [halved, raised], unit_tests } = self.row(threshold.name);
            text += &format!("{}{halved} | {raised} | {unit_tests} |\n", row_start(threshold));
        }
        text
    }
}

/// Columns of a threshold before its cells. A threshold with another value or text is measured again.
fn row_start(threshold: &Threshold) -> String {
    let doc = threshold.doc.replace('|', "\\|").replace('<', "&lt;");
    format!("| `{}` | {} | {doc} | ", threshold.name, threshold.value)
}

fn kept_row(threshold: &Threshold, text: &str) -> Option<(String, Row)> {
    let start = row_start(threshold);
    let cells = text.lines().find_map(|line| line.strip_prefix(&start)?.strip_suffix(" |"))?;
    let [halved, raised, unit_tests] = cells.split(" | ").map(str::to_owned).collect::<Vec<_>>().try_into().ok()?;
    Some((threshold.name.to_owned(), Row { loops: [halved, raised], unit_tests }))
}

fn digest_line(base: &Figures) -> String {
    format!("Digest of the runs with the tuned thresholds: `{}`.", digest_of(base))
}

fn head(base: &Figures, seeds: u64) -> String {
    let files: Vec<String> = FILES.iter().map(|name| format!("`hil/{name}.toml`")).collect();
    format!(
        "# Sensitivity of the thresholds

`cargo run -p sensitivity` writes this page. The command halves each threshold of observer, compensation and width probe,
raises it by half, and runs closed loops around the reference plant on the host. A cell names the figure that moved most
relative to its bound: figure with the tuned value, figure with the changed value, bound, and change over the bound. A
figure bounded by zero counts as it is, 1 as 100 %. \"Moves nothing\": no bit of any run changed. \"Rounded\": an integer
that rounding keeps at its value. The last column names a unit test of the core that fails under one of the factors: many
thresholds guard against faults that these files do not have. Cells \"not run\" have no result yet; the command fills them
and keeps the others.

With few seeds a figure shows that a threshold matters, not whether another value is better: bounds hold for the seeds of
the test files, not for each seed. Thresholds of the wiring check are left out, because no test file runs the wiring check.

Files, {seeds_text}: {}.

{} {DISCARDS}",
        files.join(", "),
        digest_line(base),
        seeds_text = if seeds == 1 { "seed 1".to_owned() } else { format!("seeds 1 to {seeds}") },
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn threshold(name: &'static str, value: &str) -> Threshold {
        let scaled = ["1".to_owned(), "3".to_owned()];
        Threshold { folder: "observer".into(), name, value: value.into(), doc: "Size |x| [-]. Tuned.".into(), scaled }
    }

    #[test]
    fn written_rows_are_read_back() {
        let thresholds = [threshold("A.a", "2"), threshold("A.b", "2")];
        let path = std::env::temp_dir().join(format!("sensitivity-{}.md", std::process::id()));
        let mut page = Page::open(&path, &thresholds, &Vec::new(), 1);
        let row = Row {
            loops: ["moves nothing".into(), "t2: rms 1 to 2".into()],
            unit_tests: "`a::falls` and 1 more".into(),
        };
        page.set("A.a", row.clone());
        fs::write(&path, page.text()).unwrap();
        let again = Page::open(&path, &thresholds, &Vec::new(), 1);
        assert_eq!(again.text(), page.text());
        assert_eq!(again.row("A.a"), row);
        assert!(again.row("A.b").lacks_loops());
        let other = [threshold("A.a", "3")];
        assert!(Page::open(&path, &other, &Vec::new(), 1).row("A.a").lacks_loops(), "another value is measured again");
        assert_eq!(Page::open_without_runs(&path, &thresholds).unwrap().text(), page.text());
        fs::remove_file(&path).unwrap();
    }

    #[test]
    fn page_counts_thresholds_that_are_held() {
        let thresholds = [threshold("A.a", "2"), threshold("A.b", "2"), threshold("A.c", "2"), threshold("A.d", "2")];
        let mut page = Page::open(Path::new("missing"), &thresholds, &Vec::new(), 1);
        let row = |halved: &str, unit_tests: &str| Row {
            loops: [halved.into(), "moves nothing".into()],
            unit_tests: unit_tests.into(),
        };
        page.set("A.a", row("t2: rms 1 to 2", "none"));
        page.set("A.b", row("stays 2: rounded", "none"));
        page.set("A.c", row("moves nothing", "`a::falls`"));
        page.set("A.d", row(NOT_RUN, "`a::falls`"));
        assert!(
            page.text().contains("3 of 4 thresholds move a figure or fail a unit test. Closed loops have run for 3.")
        );
    }

    /// Every field of a `thresholds!` in the core's sources is in the list.
    #[test]
    fn list_has_every_threshold_of_the_sources() {
        let mut folders = vec![report::workspace::workspace().join("model-core/src")];
        let mut fields = 0;
        while let Some(folder) = folders.pop() {
            for entry in fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()) {
                if entry.is_dir() {
                    folders.push(entry);
                } else {
                    fields += declared_fields(&fs::read_to_string(entry).unwrap());
                }
            }
        }
        assert_eq!(model_core::thresholds().len(), fields);
        let names: std::collections::BTreeSet<&str> = model_core::thresholds().iter().map(|it| it.name).collect();
        assert_eq!(names.len(), fields, "names are unique");
    }

    /// Number of fields in the declarations of a file: lines `field: type = value,` two levels deep.
    fn declared_fields(source: &str) -> usize {
        let declarations = source.split("\nthresholds! {\n").skip(1);
        let is_field = |line: &&str| {
            line.starts_with("        ") && !line.starts_with("         ") && !line.trim().starts_with("//")
        };
        declarations.map(|text| text.lines().take_while(|line| *line != "}").filter(is_field).count()).sum()
    }
}
