//! Numbered lists of docs/theory/observer.md (evidence for a flank, checks of both encoders) agree with the lists at the head of their
//! sources, and each row of a source names an existing test.

use std::fs;
use std::path::Path;

const PAGE: &str = include_str!("../../../docs/theory/observer.md");
const FLANK: &str = include_str!("../../../model-core/src/observer/identification/flank.rs");
const OUTPUT_FAULTS: &str = include_str!("../../../model-core/src/observer/health/output_faults.rs");

const MOTOR_FAULTS: &str = include_str!("../../../model-core/src/observer/health/motor_faults.rs");

/// Rows of a numbered table in the page, between two marks.
fn page_rows(mark: &str) -> Vec<Vec<String>> {
    let (from, to) = (format!("<!-- {mark} -->"), format!("<!-- /{mark} -->"));
    let (_, rest) = PAGE.split_once(&from).expect("a beginning of the table");
    let (table, _) = rest.split_once(&to).expect("an end of the table");
    rows(table.lines())
}

/// Rows of the numbered table at the head of a source.
fn source_rows(source: &str) -> Vec<Vec<String>> {
    rows(source.lines().filter_map(|line| line.strip_prefix("//! ")))
}

/// Cells of each row that begins with a number.
fn rows<'a>(lines: impl Iterator<Item = &'a str>) -> Vec<Vec<String>> {
    lines
        .filter_map(|line| line.strip_prefix("| "))
        .map(|line| line.trim_end_matches('|').split(" | ").map(|cell| cell.trim().to_owned()).collect())
        .filter(|cells: &Vec<String>| cells.first().is_some_and(|cell| cell.parse::<u32>().is_ok()))
        .collect()
}

/// File and function of the test at the end of a source's row: "`program module::function`".
fn test_of(row: &[String]) -> (String, String) {
    let name = row.last().expect("a row has cells").trim_matches('`');
    let (program, path) = name.split_once(' ').expect("a program and a path");
    let (module, function) = path.split_once("::").expect("a module and a function");
    (format!("tests/{program}/{module}.rs"), function.to_owned())
}

/// Page and sources list the same checks in the same order, each with an existing test.
#[test]
fn page_lists_the_checks_of_the_sources() {
    for (mark, source) in [("flank", FLANK), ("output faults", OUTPUT_FAULTS), ("motor faults", MOTOR_FAULTS)] {
        let (page, source) = (page_rows(mark), source_rows(source));
        assert!(page.len() >= 5, "the list of {mark} is read");
        assert_eq!(page.len(), source.len(), "docs/theory/observer.md and the source list other ways under {mark}");
        for (shown, written) in page.iter().zip(&source) {
            assert_eq!(shown.first(), written.first(), "the order under {mark}");
            let (file, function) = test_of(written);
            let tests = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join(&file)).expect(&file);
            assert!(tests.contains(&format!("#[test]\nfn {function}()")), "{file} has no test {function}");
        }
    }
}
