//! Rules for the files of one target: no cycles of files, no cycles of folders, no import of design by the runtime.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use crate::graph::{Graph, Names, cycles};

/// Number of nodes, and the node of a file, if any.
type Nodes<'a> = (usize, &'a dyn Fn(usize) -> Option<usize>);

/// Cycles of files, with their edges and a place to cut.
pub fn file_cycles(graph: &Graph) -> Vec<String> {
    let title = |cycle: &[usize]| format!("{} files import one another", cycle.len());
    all_cycles(graph, (graph.sources.files.len(), &Some), title)
}

/// Cycles of folders, at every level: `foo.rs` and the files in `foo/` are one node, and the file of the folder itself (`mod.rs`, the root)
/// is none.
pub fn folder_cycles(graph: &Graph) -> Vec<String> {
    let files = &graph.sources.files;
    let folders: BTreeSet<&Path> = files.iter().flat_map(|file| file.path.ancestors().skip(1)).collect();
    let mut found = vec![];
    for folder in folders {
        let name = |file: usize| {
            let path = files[file].path.strip_prefix(folder).ok()?;
            let first = Path::new(path.components().next()?.as_os_str()).with_extension("");
            (file != 0 && path != Path::new("mod.rs")).then_some(first)
        };
        let names: BTreeSet<PathBuf> = (0..files.len()).filter_map(name).collect();
        let names: Vec<PathBuf> = names.into_iter().collect();
        let node = |file| name(file).map(|name| names.binary_search(&name).expect("it is among all"));
        let title = |cycle: &[usize]| {
            let names: Vec<String> = cycle.iter().map(|&node| names[node].display().to_string()).collect();
            format!("in {}/, {} import one another", folder.display(), names.join(", "))
        };
        found.extend(all_cycles(graph, (names.len(), &node), title));
    }
    found
}

/// Imports from a module `design` by files outside every such module: a board is built without it.
pub fn runtime_imports_design(graph: &Graph) -> Vec<String> {
    let files = &graph.sources.files;
    let wrong = |edge: &&(usize, usize)| !files[edge.0].design && files[edge.1].design;
    let text = |edge: &(usize, usize)| {
        let help = "move what both need into a file outside `design`, or the import into it";
        format!("runtime imports design\n    {}\n  help: {help}", line(graph, *edge, &graph.edges[edge]))
    };
    graph.edges.keys().filter(wrong).map(text).collect()
}

fn line(graph: &Graph, (from, to): (usize, usize), names: &Names) -> String {
    let to = graph.sources.files[to].path.display();
    let names: Vec<String> = names.iter().map(|(name, line)| format!("{name} (line {line})")).collect();
    format!("{} -> {to}: {}", graph.sources.files[from].path.display(), names.join(", "))
}

/// Every cycle with all its edges and the cheapest cut.
fn all_cycles(graph: &Graph, (count, node): Nodes, title: impl Fn(&[usize]) -> String) -> Vec<String> {
    let pair = |edge: &(usize, usize)| Some((node(edge.0)?, node(edge.1)?)).filter(|(from, to)| from != to);
    let all = graph.edges.keys().filter_map(pair);
    let text = |cycle: Vec<usize>| {
        let mut ties: BTreeMap<(usize, usize), Vec<(usize, usize)>> = BTreeMap::new();
        for edge in graph.edges.keys() {
            if let Some(pair) = pair(edge).filter(|(from, to)| cycle.contains(from) && cycle.contains(to)) {
                ties.entry(pair).or_default().push(*edge);
            }
        }
        let lines = ties.values().flatten().map(|edge| format!("\n    {}", line(graph, *edge, &graph.edges[edge])));
        format!("{}{}\n  help: {}", title(&cycle), lines.collect::<String>(), cut(graph, count, &ties))
    };
    cycles(count, all).into_iter().map(text).collect()
}

/// Cheapest cut among all ties between two nodes: the one that leaves the least of the cycle; then rather a child's import from its parent
/// than the reverse; then the one with the fewest names.
fn cut(graph: &Graph, count: usize, ties: &BTreeMap<(usize, usize), Vec<(usize, usize)>>) -> String {
    let names = |edges: &[(usize, usize)]| -> BTreeSet<&str> {
        edges.iter().flat_map(|edge| graph.edges[edge].keys()).map(String::as_str).collect()
    };
    let cost = |(tie, edges): &(&(usize, usize), &Vec<(usize, usize)>)| {
        let left = cycles(count, ties.keys().copied().filter(|other| other != *tie));
        let down =
            edges.iter().any(|&(from, to)| !is_above(&graph.sources.files[to].path, &graph.sources.files[from].path));
        (left.iter().map(Vec::len).sum::<usize>(), down, names(edges).len())
    };
    let (_, edges) = ties.iter().min_by_key(cost).expect("a circle has edges");
    let files = |files: BTreeSet<usize>| {
        let paths: Vec<_> = files.iter().map(|&at| graph.sources.files[at].path.display().to_string()).collect();
        paths.join(", ")
    };
    let (from, to) = (edges.iter().map(|edge| edge.0).collect(), edges.iter().map(|edge| edge.1).collect());
    let (names, from, to) = (names(edges).into_iter().collect::<Vec<_>>().join(", "), files(from), files(to));
    format!("move {names} from {to} into a separate file that both sides import, or remove its use in {from}")
}

/// Returns true if the module of the file `above` contains the module of `file`.
fn is_above(above: &Path, file: &Path) -> bool {
    let stem = above.file_stem().unwrap_or_default();
    let folder = above.with_extension("");
    file.starts_with(if ["mod", "lib", "main"].iter().any(|it| stem == *it) {
        above.with_file_name("")
    } else {
        folder
    })
}
