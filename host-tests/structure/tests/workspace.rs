//! Rules of this workspace: imports between files, folders and crates, sizes of crates, and links of pages.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::LazyLock;

use structure::graph::Graph;
use structure::members::{Member, Workspace};
use structure::sources::Sources;
use structure::{dependencies, links, page, rules, size, unsafe_code};

/// Crate and its targets with their kinds.
type Crate = (&'static Member, Vec<(String, Graph)>);

static WORKSPACE: LazyLock<Workspace> = LazyLock::new(|| Workspace::read(&root()));
static CRATES: LazyLock<Vec<Crate>> = LazyLock::new(|| WORKSPACE.members.iter().map(|it| (it, graphs(it))).collect());

/// File that names missing pages on purpose.
const PLANTED: &str = "structure/tests/planted.rs";

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn graphs(member: &Member) -> Vec<(String, Graph)> {
    let reader = |path: &Path| std::fs::read_to_string(root().join(path)).ok();
    let graph = |path: &PathBuf| Graph::new(Sources::read(path, &reader));
    member.targets.iter().map(|(kind, path)| (kind.clone(), graph(path))).collect()
}

/// Fails with all findings, each under the first target that has it, since test programs share files.
fn check_every_target(judge: impl Fn(&str, &Graph) -> Vec<String>) {
    let mut found: Vec<String> = vec![];
    for (member, graphs) in CRATES.iter() {
        for (kind, graph) in graphs {
            let label = member.label(kind, &graph.sources.files[0].path);
            for finding in judge(kind, graph) {
                if !found.iter().any(|earlier| earlier.ends_with(&finding)) {
                    found.push(format!("{label}: {finding}"));
                }
            }
        }
    }
    assert_no_findings(found);
}

fn assert_no_findings(found: Vec<String>) {
    assert!(found.is_empty(), "{} findings\n\n{}\n", found.len(), found.join("\n\n"));
}

/// No cycle of imports between files.
#[test]
fn files_form_no_cycle() {
    check_every_target(|_, graph| rules::file_cycles(graph));
}

/// No cycle of imports between folders.
#[test]
fn folders_form_no_cycle() {
    check_every_target(|_, graph| rules::folder_cycles(graph));
}

/// The runtime does not import design.
#[test]
fn runtime_does_not_import_design() {
    check_every_target(|kind, graph| if kind == "lib" { rules::runtime_imports_design(graph) } else { vec![] });
}

/// Every path within a crate resolves.
#[test]
fn every_path_resolves() {
    let resolved: usize = CRATES.iter().flat_map(|(_, graphs)| graphs).map(|(_, graph)| graph.resolved).sum();
    println!("{resolved} paths within crates resolved");
    check_every_target(|_, graph| graph.unresolved.clone());
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

/// No crate depends on the command.
#[test]
fn nothing_depends_on_the_command() {
    assert_no_findings(WORKSPACE.command_imports("joint"));
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
    let files = CRATES.iter().flat_map(|(_, graphs)| graphs).flat_map(|(_, graph)| &graph.sources.files);
    let paths: BTreeSet<&PathBuf> = files.map(|file| &file.path).filter(|path| !path.ends_with(PLANTED)).collect();
    let mut found = vec![];
    for path in paths {
        let text = std::fs::read_to_string(root().join(path)).expect("a source");
        let lost = links::named(&text).into_iter().filter(|(_, page)| !root().join(page).exists());
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
    println!("{:<32} {:>6} {:>6} {:>6}", "crate or subject", "lines", "files", "edges");
    let mut found = vec![];
    for (member, graphs) in CRATES.iter() {
        let files: usize = graphs.iter().map(|(_, graph)| graph.sources.files.len()).sum();
        let edges: usize = graphs.iter().map(|(_, graph)| graph.edges.len()).sum();
        let sizes = size::sizes(member, graphs);
        println!("{:<32} {:>6} {files:>6} {edges:>6}", member.name, sizes.values().sum::<usize>());
        for (subject, lines) in sizes.iter().filter(|(subject, _)| **subject != member.name) {
            println!("  {subject:<30} {lines:>6}");
        }
        found.extend(size::too_large(&sizes));
    }
    assert_no_findings(found);
}

/// Every Rust file of the members, whatever target it belongs to.
fn rust_files() -> Vec<PathBuf> {
    let mut folders: Vec<PathBuf> = WORKSPACE.members.iter().map(|member| member.folder.clone()).collect();
    let mut files = BTreeSet::new();
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(root().join(&folder)).expect("a folder").map(|entry| entry.expect("an entry")) {
            let path = folder.join(entry.file_name());
            if entry.path().is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|kind| kind == "rs") {
                files.insert(path);
            }
        }
    }
    files.into_iter().collect()
}

/// Every `unsafe` is listed with its reason, and all other crates forbid it.
#[test]
fn every_unsafe_is_listed() {
    let page = std::fs::read_to_string(root().join(unsafe_code::PAGE)).expect("the list");
    let mut found = BTreeMap::new();
    for path in rust_files() {
        let source = std::fs::read_to_string(root().join(&path)).expect("a source");
        let count = unsafe_code::count(&source).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        if count > 0 {
            found.insert(path, count);
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
