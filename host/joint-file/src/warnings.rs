//! Warnings of a joint file: `joint check` lists them among its figures; all other commands print them on standard
//! error before they begin.

use report::output;

use crate::named::Loaded;
use crate::problem::Severity;

/// Prints each warning with its file and line.
pub fn print(loaded: &Loaded) {
    for warning in lines(loaded) {
        output::remark(&warning);
    }
}

/// Each warning as a line.
fn lines(loaded: &Loaded) -> impl Iterator<Item = String> {
    let warnings = loaded.file.warnings.iter().filter(|warning| warning.severity == Severity::Warning);
    warnings.map(|warning| {
        let line = 1 + loaded.text[..warning.span.start].matches('\n').count();
        format!("warning: {}, line {line}: {} (help: {})", loaded.name, warning.message, warning.help)
    })
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::lines;
    use crate::named::load;

    /// Each warning names file, line and help.
    #[test]
    fn warning_has_file_line_and_help() {
        let paper = load(Path::new("paper")).expect("a preset");
        let printed: Vec<String> = lines(&paper).collect();
        assert_eq!(printed.len(), 2);
        assert!(printed[0].starts_with("warning: paper, line ") && printed[0].contains("not coaxial"), "{printed:?}");
        assert!(printed[0].ends_with("(help: ring_teeth = 97)"), "{printed:?}");
    }
}
