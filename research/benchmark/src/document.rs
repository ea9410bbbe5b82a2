//! The comparison in a Markdown file, between two marks, with a picture beside the file; and the origin of its figures. Text outside the
//! marks stays unchanged.

use std::fs;
use std::path::Path;

use super::{BenchmarkRecord, Origin, page, pictures};
use board::device::compile::PROFILE;
use board::device::emulator::MACHINE;
use board::device::toolchain::Toolchain;
use report::document::{Document, Medium, markdown};
use report::failure::{Failure, Outcome};
use report::provenance;
use report::write::write_text;

const BEGIN: &str = "<!-- comparison: written by `cargo joint bench --document` -->";
const END: &str = "<!-- end of comparison -->";

/// Origin of the figures of this run.
pub fn origin(toolchain: &Toolchain, emulator: String) -> Origin {
    let model = fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let model = model
        .lines()
        .find_map(|line| line.strip_prefix("model name")?.split(':').nth(1).map(str::trim).map(String::from));
    Origin {
        commit: provenance::git_commit().unwrap_or_else(|| "not under git".into()),
        date: provenance::date(),
        compiler: toolchain.compiler().to_owned(),
        flags: format!("profile {PROFILE} (opt-level 3, fat LTO, one codegen unit), {}", toolchain.flags()),
        emulator: format!("{emulator}, {MACHINE}, -icount shift=6,sleep=off"),
        host: model.unwrap_or_else(|| std::env::consts::ARCH.into()),
    }
}

fn failed(path: &Path, error: &std::io::Error) -> Failure {
    Failure::new(format!("{}: {error}", path.display())).with_help("name a Markdown file that can be read and written")
}

/// Text of the Markdown file.
pub fn read(path: &Path) -> Outcome<String> {
    fs::read_to_string(path).map_err(|error| failed(path, &error))
}

/// Replaces the comparison in the file, or appends it if there is none.
pub fn update(path: &Path, figures: &BenchmarkRecord, document: &Document) -> Outcome<()> {
    let before = read(path)?;
    for case in &figures.cases {
        let Some(figure) = pictures::board(case, &figures.methods) else { continue };
        let name = page::picture_name(case) + ".svg";
        write_text(&path.with_file_name(name), &figure.to_file())?;
    }
    let section = format!("{BEGIN}\n\n{}\n{END}", markdown(document, Medium::Markdown));
    let after = match (before.find(BEGIN), before.find(END)) {
        (Some(from), Some(to)) if from < to => format!("{}{section}{}", &before[..from], &before[to + END.len()..]),
        _ => format!("{}\n\n## Error against cost\n\n{section}\n", before.trim_end()),
    };
    write_text(path, &after)
}
