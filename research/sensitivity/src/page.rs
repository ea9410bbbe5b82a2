//! The page with the table. The page is also the memory of the program: rows of the same runs are kept.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use model_core::numbers::sensitivity::Threshold;

use crate::runs::{FILES, Figures, digest_of};

/// Cells of a threshold under the factors 0.5 and 1.5.
pub type Row = [String; 2];

/// Cell of a threshold without figures.
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

    /// Returns true if the page has figures of a threshold.
    pub fn is_measured(&self, name: &str) -> bool {
        self.rows.contains_key(name)
    }

    /// Sets the cells of a threshold.
    pub fn set(&mut self, name: &str, row: Row) {
        self.rows.insert(name.to_owned(), row);
    }

    /// Text of the page.
    pub fn text(&self) -> String {
        let mut text = self.head.clone();
        text += &format!("{} of {} thresholds have figures.\n", self.rows.len(), self.thresholds.len());
        let mut folder = "";
        for threshold in self.thresholds {
            if threshold.folder != folder {
                folder = &threshold.folder;
                text +=
                    &format!("\n## {folder}\n\n| threshold | value | origin | x0.5 | x1.5 |\n|---|---|---|---|---|\n");
            }
            text += &self.row(threshold);
        }
        text
    }

    fn row(&self, threshold: &Threshold) -> String {
        let [halved, raised] = self.rows.get(threshold.name).cloned().unwrap_or([NOT_RUN; 2].map(str::to_owned));
        format!("{}{halved} | {raised} |\n", row_start(threshold))
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
    let (halved, raised) = cells.split_once(" | ")?;
    (halved != NOT_RUN).then(|| (threshold.name.to_owned(), [halved.to_owned(), raised.to_owned()]))
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
that rounding keeps at its value. Rows \"not run\" have no figures yet; the command measures them and keeps the others.

With few seeds a figure shows that a threshold matters, not whether another value is better: bounds hold for the seeds of
the test files, not for each seed. Thresholds of the wiring check are left out, because no test file runs the wiring check.

Files, {seeds_text}: {}.

{} Another digest discards all rows.

",
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
        page.set("A.a", ["moves nothing".into(), "t2: rms 1 to 2".into()]);
        fs::write(&path, page.text()).unwrap();
        let again = Page::open(&path, &thresholds, &Vec::new(), 1);
        assert_eq!(again.text(), page.text());
        assert!(again.is_measured("A.a") && !again.is_measured("A.b"));
        let other = [threshold("A.a", "3")];
        assert!(!Page::open(&path, &other, &Vec::new(), 1).is_measured("A.a"), "another value is measured again");
        fs::remove_file(&path).unwrap();
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
