//! Rules of this workspace: imports between files, folders and crates, sizes of crates, and links of pages.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::LazyLock;

use structure::imports::{Imports, Sources};
use structure::members::{Member, Workspace};
use structure::{dependencies, drawing, equations, features, links, page, size, unsafe_code};

static WORKSPACE: LazyLock<Workspace> = LazyLock::new(|| Workspace::read(&root()));
/// Rust files of the members with their texts, whatever target each belongs to.
static SOURCES: LazyLock<Sources> = LazyLock::new(sources);

/// File that names missing pages on purpose.
const PLANTED: &str = "structure/tests/planted.rs";

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn sources() -> Sources {
    let mut folders: Vec<PathBuf> = WORKSPACE.members.iter().map(|member| member.folder.clone()).collect();
    let mut sources = Sources::new();
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(root().join(&folder)).expect("a folder").map(|entry| entry.expect("an entry")) {
            let path = folder.join(entry.file_name());
            if entry.path().is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|kind| kind == "rs") {
                let text = std::fs::read_to_string(entry.path()).expect("a source");
                sources.insert(path, text);
            }
        }
    }
    sources
}

/// Sources of one member, without those of members in its folder.
fn sources_of(member: &Member) -> Sources {
    let inner: Vec<&PathBuf> = WORKSPACE
        .members
        .iter()
        .map(|other| &other.folder)
        .filter(|folder| **folder != member.folder && folder.starts_with(&member.folder))
        .collect();
    let mine = |path: &Path| path.starts_with(&member.folder) && !inner.iter().any(|folder| path.starts_with(folder));
    SOURCES.iter().filter(|(path, _)| mine(path)).map(|(path, text)| (path.clone(), text.clone())).collect()
}

/// Imports of every target whose root lies in a folder of its own, with the target's kind.
fn imports(member: &Member) -> Vec<(String, Imports)> {
    let sources = sources_of(member);
    let roots = member
        .targets
        .iter()
        .filter(|(_, root)| root.file_stem().is_some_and(|name| ["lib", "main"].iter().any(|it| name == *it)));
    roots
        .map(|(kind, root)| {
            let folder = root.parent().expect("a root lies in a folder");
            let files = sources.iter().filter(|(path, _)| path.starts_with(folder));
            let files: Sources = files.map(|(path, text)| (path.clone(), text.clone())).collect();
            (kind.clone(), Imports::read(folder, &files).unwrap_or_else(|broken| panic!("{}", broken.join("\n"))))
        })
        .collect()
}

fn assert_no_findings(found: Vec<String>) {
    assert!(found.is_empty(), "{} findings\n\n{}\n", found.len(), found.join("\n\n"));
}

/// Siblings of a folder do not import one another in a cycle.
#[test]
fn imports_form_no_cycle() {
    let all: Vec<(String, Imports)> = WORKSPACE.members.iter().flat_map(imports).collect();
    assert!(all.len() > WORKSPACE.members.len() / 2, "most crates are read");
    assert_no_findings(all.iter().flat_map(|(_, imports)| imports.cycles()).collect());
}

/// The runtime does not import design.
#[test]
fn runtime_does_not_import_design() {
    let all = WORKSPACE.members.iter().flat_map(imports);
    assert_no_findings(all.filter(|(kind, _)| kind == "lib").flat_map(|(_, it)| it.runtime_imports_design()).collect());
}

/// The reference does not depend on the core.
#[test]
fn reference_does_not_depend_on_the_core() {
    assert_no_findings(WORKSPACE.independence("reference", "model-core"));
}

/// Crates that ship depend neither on tests nor on research.
#[test]
fn shipped_crates_import_no_tests() {
    assert_no_findings(WORKSPACE.shipped_imports());
}

/// No crate depends on the command but the Python wheel, which ships it.
#[test]
fn nothing_else_depends_on_the_command() {
    assert_no_findings(WORKSPACE.command_imports("joint", "python-bindings"));
}

/// Default members do not depend on research.
#[test]
fn default_members_import_no_research() {
    assert_no_findings(WORKSPACE.research_by_default());
}

/// Crates import only as ARCHITECTURE.md allows.
#[test]
fn crates_import_as_the_page_allows() {
    let text = std::fs::read_to_string(root().join("ARCHITECTURE.md")).unwrap_or_default();
    assert_no_findings(page::differences(&text, &WORKSPACE, |path| root().join(path).exists()));
}

/// The drawing in ARCHITECTURE.md shows the present imports; `UPDATE_DRAWING=1` writes it.
#[test]
fn drawing_shows_present_imports() {
    let runs_on_board = |name: &str| {
        let member = WORKSPACE.member(name).expect("a crate");
        let without_std =
            |root: &PathBuf| SOURCES[root].lines().any(|line| line.starts_with("#![") && line.contains("no_std"));
        member.targets.iter().filter(|(kind, _)| kind != "custom-build").any(|(_, root)| without_std(root))
    };
    let drawn = drawing::svg(&WORKSPACE, runs_on_board);
    let path = root().join("docs/architecture-crates.svg");
    if std::env::var_os("UPDATE_DRAWING").is_some() {
        std::fs::write(&path, &drawn).expect("room");
    }
    let found = std::fs::read_to_string(&path).unwrap_or_default();
    assert!(found == drawn, "draw it anew: UPDATE_DRAWING=1 cargo test -p structure drawing");
}

/// ARCHITECTURE.md and CONTRIBUTING.md name existing paths only.
#[test]
fn newcomer_pages_name_existing_paths() {
    for name in ["ARCHITECTURE.md", "CONTRIBUTING.md"] {
        let text = std::fs::read_to_string(root().join(name)).expect("a page");
        assert_no_findings(page::missing(&text, |path| root().join(path).exists()));
    }
}

/// Markdown pages at the workspace's root, in docs and in firmware.
fn pages() -> links::Pages {
    let mut folders: Vec<PathBuf> = ["", links::BOOK, "firmware"].map(PathBuf::from).into();
    let mut pages = links::Pages::new();
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(root().join(&folder)).expect("a folder").map(|entry| entry.expect("an entry")) {
            let path = folder.join(entry.file_name());
            if entry.path().is_dir() {
                // Other folders of the root hold no pages.
                folders.extend(path.parent().is_some_and(|it| it.starts_with(links::BOOK)).then_some(path));
            } else if path.extension().is_some_and(|kind| kind == "md") {
                pages.insert(path, std::fs::read_to_string(entry.path()).expect("a page"));
            }
        }
    }
    pages
}

/// Every link of a page has a target.
#[test]
fn every_link_has_a_target() {
    let pages = pages();
    let count: usize = pages.values().map(|page| links::links(page).len()).sum();
    println!("{count} links on {} pages", pages.len());
    assert!(pages.contains_key(Path::new("README.md")) && count > 100);
    assert_no_findings(links::broken(&pages, |path| root().join(path).exists()));
}

/// Sources name existing pages only.
#[test]
fn sources_name_existing_pages() {
    let mut found = vec![];
    for (path, text) in SOURCES.iter().filter(|(path, _)| !path.ends_with(PLANTED)) {
        let lost = links::named(text).into_iter().filter(|(_, page)| !root().join(page).exists());
        found.extend(lost.map(|(line, page)| format!("{}:{line}: no {}", path.display(), page.display())));
    }
    assert_no_findings(found);
}

/// The book lists every page.
#[test]
fn book_lists_every_page() {
    assert_no_findings(links::unlisted(&pages()));
}

/// No crate exceeds the limit of lines; prints the table of crates.
#[test]
fn crates_stay_below_the_size_limit() {
    println!("{:<32} {:>6} {:>6}", "crate or subject", "lines", "files");
    let mut found = vec![];
    for member in &WORKSPACE.members {
        let files: Vec<(PathBuf, usize)> =
            sources_of(member).into_iter().map(|(path, text)| (path, size::lines(&text))).collect();
        let sizes = size::sizes(member, &files);
        println!("{:<32} {:>6} {:>6}", member.name, sizes.values().sum::<usize>(), files.len());
        for (subject, lines) in sizes.iter().filter(|(subject, _)| **subject != member.name) {
            println!("  {subject:<30} {lines:>6}");
        }
        found.extend(size::too_large(&sizes));
    }
    assert_no_findings(found);
}

/// Every `unsafe` is listed with its reason, and all other crates forbid it.
#[test]
fn every_unsafe_is_listed() {
    let page = std::fs::read_to_string(root().join(unsafe_code::PAGE)).expect("the list");
    let mut found = BTreeMap::new();
    for (path, text) in SOURCES.iter() {
        let count = unsafe_code::count(text).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        if count > 0 {
            found.insert(path.clone(), count);
        }
    }
    assert_no_findings(unsafe_code::differences(&page, &found));
    let manifest = |member: &Member| {
        let text = std::fs::read_to_string(root().join(&member.folder).join("Cargo.toml")).expect("a manifest");
        (member.folder.clone(), text)
    };
    assert_no_findings(unsafe_code::unforbidden(&page, &WORKSPACE.members.iter().map(manifest).collect::<Vec<_>>()));
    let workspace = std::fs::read_to_string(root().join("Cargo.toml")).expect("a manifest");
    assert!(workspace.contains("unsafe_code = \"forbid\""));
}

/// Third-party packages come from one registry, under allowed licences.
#[test]
fn dependencies_have_allowed_licences() {
    let lock = std::fs::read_to_string(root().join("Cargo.lock")).expect("a lock file");
    assert!(lock.matches("[[package]]").count() > 100);
    assert_no_findings(dependencies::foreign(&lock));
    assert_no_findings(dependencies::unlicensed(&dependencies::metadata(&root())));
}

/// Pages of docs/theory and comments of the code cite the same numbered equations.
#[test]
fn equation_numbers_of_pages_and_code_agree() {
    assert_no_findings(equations::mismatches(&root()));
}

#[test]
fn command_and_tests_share_a_build() {
    let tests = features::of(&root(), &["--edges", "normal,build,dev"]);
    let command = features::of(&root(), &["--edges", "normal,build", "--package", "joint"]);
    assert!(command.len() > 100 && tests.len() > command.len());
    assert_no_findings(features::unshared(&command, &tests));
    let research = ["paper", "comparison", "benchmark", "baselines"].map(|package| ["--package", package]).concat();
    let research = features::of(&root(), &[&["--edges", "normal,build,dev"], &research[..]].concat());
    assert_no_findings(features::unshared(&research, &tests));
}
