//! Imports between files: an edge for every path that leads to an item in another file.
//!
//! `mod child` makes no edge, nor does a re-export of an item defined by the module's own descendants: a parent may name its children. A
//! plain `use` of a child's item is an edge like any other, and so is a child's `super::X`.

use std::collections::BTreeMap;

use crate::resolve::{Resolver, Target};
use crate::sources::{Place, Reference, Sources};

/// Names with the line of their first use.
pub type Names = BTreeMap<String, usize>;

/// Files of one target and their imports.
pub struct Graph {
    /// Sources as read.
    pub sources: Sources,
    /// Edges from the naming file to the defining file.
    pub edges: BTreeMap<(usize, usize), Names>,
    /// Number of paths resolved within this target.
    pub resolved: usize,
    /// Paths that begin in this target and cannot be resolved.
    pub unresolved: Vec<String>,
}

impl Graph {
    /// Resolves every path.
    pub fn new(sources: Sources) -> Self {
        let mut graph = Self { edges: BTreeMap::new(), resolved: 0, unresolved: sources.unread.clone(), sources };
        for at in 0..graph.sources.references.len() {
            graph.add_edges(at);
        }
        graph
    }

    /// `path:line`
    pub fn place(&self, file: usize, line: usize) -> String {
        format!("{}:{line}", self.sources.files[file].path.display())
    }

    fn add_edges(&mut self, at: usize) {
        let reference = &self.sources.references[at];
        let Reference { module, file, line, .. } = *reference;
        let named = self.sources.named(module);
        let targets = Resolver::new(&self.sources, module).resolve(module, &reference.path);
        let keyword = matches!(reference.path[0].as_str(), "crate" | "super" | "self");
        if targets.is_empty() && (keyword || reference.place != Place::Tokens) {
            let text = format!("{}: `{}` does not resolve", self.place(file, line), reference.path.join("::"));
            self.unresolved.push(text);
        }
        self.resolved +=
            usize::from(targets.iter().any(|target| *target != Target::Foreign) && reference.path.len() > 1);
        // Each end: name, its module, its defining file.
        let mut ends = vec![];
        let end = |name: &str, target: &Target| match target {
            Target::Item(item) => Some((item.name.clone(), item.module, item.file)),
            Target::Module(module) => Some((name.to_string(), *module, self.sources.modules[*module].file)),
            Target::Foreign => None,
        };
        let last = reference.path.last().expect("a path has a name");
        for target in &targets {
            match (target, reference.place) {
                // A module alone only gives access; a path through it makes the edge. Re-exporting it does make one.
                (Target::Module(_), Place::Code | Place::Tokens | Place::Use) => {}
                (Target::Module(within), Place::Glob | Place::GlobReexport) => {
                    for (name, target) in Resolver::new(&self.sources, module).all(*within) {
                        // A plain glob imports the items that its module defines, and traits wherever they are defined: their methods are
                        // used without a name. Other names make their edges where they are used.
                        let comes = match &target {
                            Target::Item(item) => item.module == *within || item.is_trait,
                            _ => false,
                        };
                        if comes || reference.place == Place::GlobReexport {
                            ends.extend(end(&name, &target));
                        }
                    }
                }
                _ => ends.extend(end(last, target)),
            }
        }
        let reexport = matches!(reference.place, Place::Reexport | Place::GlobReexport);
        for (name, owner, to) in ends {
            let excused = reexport && owner != named && self.sources.is_within(owner, named);
            if to != file && !excused {
                let first = self.edges.entry((file, to)).or_default().entry(name).or_insert(line);
                *first = line.min(*first);
            }
        }
    }
}

/// Strongly connected groups of the nodes `0..count`.
pub fn cycles(count: usize, edges: impl Iterator<Item = (usize, usize)>) -> Vec<Vec<usize>> {
    let mut next = vec![vec![]; count];
    edges.for_each(|(from, to)| next[from].push(to));
    let reach: Vec<Vec<bool>> = (0..count)
        .map(|start| {
            let mut seen = vec![false; count];
            let mut open = vec![start];
            while let Some(node) = open.pop() {
                for &node in &next[node] {
                    if !std::mem::replace(&mut seen[node], true) {
                        open.push(node);
                    }
                }
            }
            seen
        })
        .collect();
    let together = |a: usize, b: usize| a == b || (reach[a][b] && reach[b][a]);
    let group = |first: usize| (first..count).filter(|&node| together(first, node)).collect::<Vec<_>>();
    (0..count)
        .filter(|&first| !(0..first).any(|earlier| together(earlier, first)))
        .map(group)
        .filter(|cycle| cycle.len() > 1)
        .collect()
}
