//! Imports between the folders of a crate: every path that begins with `crate`, `super` or `self` and leads through
//! modules of the same crate. A module is a file, `name.rs` or `name/mod.rs`.
//!
//! Tests are left out. Siblings of one folder must not import one another in a cycle; a folder's own `mod.rs` is left out, because it hands
//! on what its children define. An item that a `mod.rs` hands on counts as an item of that `mod.rs`.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use proc_macro2::{Delimiter, TokenStream, TokenTree};

use crate::size::is_test;

/// Names from the root of a crate to a module.
type ModulePath = Vec<String>;

/// Sources of one target: files below the folder of its root, with their texts.
pub type Sources = BTreeMap<PathBuf, String>;

/// Modules of one target and the imports among them.
pub struct Imports {
    modules: BTreeMap<ModulePath, PathBuf>,
    edges: BTreeSet<(ModulePath, ModulePath)>,
}

impl Imports {
    /// Reads the target whose root lies in `folder`.
    ///
    /// # Errors
    ///
    /// Names the files that are not Rust.
    pub fn read(folder: &Path, sources: &Sources) -> Result<Self, Vec<String>> {
        let module = |path: &PathBuf| Some((module_of(path.strip_prefix(folder).ok()?)?, path.clone()));
        let modules: BTreeMap<ModulePath, PathBuf> = sources.keys().filter_map(module).collect();
        let (mut edges, mut broken) = (BTreeSet::new(), vec![]);
        for (module, path) in &modules {
            let mut paths = vec![];
            match sources[path].parse::<TokenStream>() {
                Ok(tokens) => collect(tokens, 0, &mut paths),
                Err(error) => broken.push(format!("{}: {error}", path.display())),
            }
            let targets =
                paths.iter().filter_map(|(depth, path)| resolve(module, *depth, path, |it| modules.contains_key(it)));
            edges.extend(targets.filter(|target| target != module).map(|target| (module.clone(), target)));
        }
        if broken.is_empty() { Ok(Self { modules, edges }) } else { Err(broken) }
    }

    /// Cycles among the siblings of every folder, with the imports that close each.
    pub fn cycles(&self) -> Vec<String> {
        let all = self.modules.keys();
        let parents: BTreeSet<&[String]> =
            all.flat_map(|module| (0..module.len()).map(|length| &module[..length])).collect();
        parents.into_iter().flat_map(|parent| self.cycles_below(parent)).collect()
    }

    fn cycles_below(&self, parent: &[String]) -> Vec<String> {
        let child = |module: &ModulePath| module.strip_prefix(parent)?.first().cloned();
        let siblings =
            |(from, to): &(ModulePath, ModulePath)| Some((child(from)?, child(to)?)).filter(|(from, to)| from != to);
        let ties: BTreeSet<(String, String)> = self.edges.iter().filter_map(siblings).collect();
        let text = |cycle: BTreeSet<String>| {
            let inside = |edge: &&(ModulePath, ModulePath)| {
                siblings(edge).is_some_and(|(from, to)| cycle.contains(&from) && cycle.contains(&to))
            };
            let lines: String = self.edges.iter().filter(inside).map(|edge| self.line(edge)).collect();
            let names = cycle.iter().cloned().collect::<Vec<_>>().join(", ");
            format!("{names} import one another{lines}\n  help: move what both sides need into a third file")
        };
        cycle_groups(&ties).into_iter().map(text).collect()
    }

    /// Files outside every module `design` that import from one; a board is built without these modules.
    pub fn runtime_imports_design(&self) -> Vec<String> {
        let design = |module: &ModulePath| module.iter().any(|name| name == "design");
        let wrong = self.edges.iter().filter(|(from, to)| !design(from) && design(to));
        wrong.map(|edge| format!("runtime imports design{}", self.line(edge))).collect()
    }

    fn line(&self, (from, to): &(ModulePath, ModulePath)) -> String {
        format!("\n    {} -> {}", self.modules[from].display(), self.modules[to].display())
    }
}

/// Module of a file, from its path below the root's folder; `None` for programs in `bin` and for files of tests.
fn module_of(path: &Path) -> Option<ModulePath> {
    let mut names: ModulePath =
        path.with_extension("").components().map(|part| part.as_os_str().to_string_lossy().into_owned()).collect();
    if names.first().is_some_and(|name| name == "bin") || names.iter().any(|name| is_test(name)) {
        return None;
    }
    if names.last().is_some_and(|name| name == "mod") || ["lib", "main"].iter().any(|root| names == [*root]) {
        names.pop();
    }
    Some(names)
}

/// Paths with their depth in inline modules.
fn collect(tokens: TokenStream, depth: usize, found: &mut Vec<(usize, ModulePath)>) {
    let tokens: Vec<TokenTree> = tokens.into_iter().collect();
    let word = |at: usize| match tokens.get(at) {
        Some(TokenTree::Ident(word)) => Some(word.to_string()),
        _ => None,
    };
    let separator = |at: usize| {
        let colon = |at| matches!(tokens.get(at), Some(TokenTree::Punct(sign)) if sign.as_char() == ':');
        colon(at) && colon(at + 1)
    };
    let mut at = 0;
    while at < tokens.len() {
        let first = word(at);
        if first.as_deref() == Some("pub") && group(&tokens, at + 1, Delimiter::Parenthesis).is_some() {
            at += 2;
        } else if first.as_deref() == Some("mod") && group(&tokens, at + 2, Delimiter::Brace).is_some() {
            if !word(at + 1).is_some_and(|name| is_test(&name)) {
                collect(group(&tokens, at + 2, Delimiter::Brace).unwrap_or_default(), depth + 1, found);
            }
            at += 3;
        } else if first.as_deref().is_some_and(|it| ["crate", "super", "self"].contains(&it)) && separator(at + 1) {
            let mut path = vec![];
            while let Some(name) = word(at) {
                path.push(name);
                at += 1;
                if !separator(at) {
                    break;
                }
                at += 2;
            }
            match group(&tokens, at, Delimiter::Brace)
                .filter(|_| matches!(tokens.get(at.wrapping_sub(1)), Some(TokenTree::Punct(_))))
            {
                Some(inner) => {
                    expand(&path, inner, depth, found);
                    at += 1;
                }
                None => found.push((depth, path)),
            }
        } else {
            if let Some(TokenTree::Group(inner)) = tokens.get(at) {
                collect(inner.stream(), depth, found);
            }
            at += 1;
        }
    }
}

fn group(tokens: &[TokenTree], at: usize, delimiter: Delimiter) -> Option<TokenStream> {
    match tokens.get(at) {
        Some(TokenTree::Group(group)) if group.delimiter() == delimiter => Some(group.stream()),
        _ => None,
    }
}

/// Paths of the braces behind `prefix` in a `use`.
fn expand(prefix: &[String], inner: TokenStream, depth: usize, found: &mut Vec<(usize, ModulePath)>) {
    let mut path = prefix.to_vec();
    let mut grouped = false;
    for token in inner {
        match token {
            TokenTree::Punct(sign) if sign.as_char() == ',' => {
                if !std::mem::take(&mut grouped) {
                    found.push((depth, path));
                }
                path = prefix.to_vec();
            }
            TokenTree::Ident(word) if word != "self" => path.push(word.to_string()),
            TokenTree::Group(inner) => {
                expand(&path, inner.stream(), depth, found);
                grouped = true;
            }
            _ => {}
        }
    }
    if !grouped {
        found.push((depth, path));
    }
}

/// Module that a path of `from` leads to: the longest beginning of the path that is a module.
fn resolve(
    from: &ModulePath,
    depth: usize,
    path: &[String],
    is_module: impl Fn(&ModulePath) -> bool,
) -> Option<ModulePath> {
    let (mut module, mut inline) = (from.clone(), depth);
    let mut rest = path;
    while let Some((first, others)) = rest.split_first() {
        match first.as_str() {
            "crate" => module.clear(),
            "super" if inline > 0 => inline -= 1,
            "super" => {
                module.pop()?;
            }
            "self" => {}
            _ => break,
        }
        rest = others;
    }
    for name in rest {
        module.push(name.clone());
        if !is_module(&module) {
            module.pop();
            break;
        }
    }
    Some(module)
}

/// Groups of names that lead to one another.
fn cycle_groups(ties: &BTreeSet<(String, String)>) -> Vec<BTreeSet<String>> {
    let reach = |start: &String| {
        let (mut seen, mut open) = (BTreeSet::new(), vec![start.clone()]);
        while let Some(name) = open.pop() {
            let next = ties.iter().filter(|(from, _)| *from == name).map(|(_, to)| to.clone());
            open.extend(next.filter(|to| seen.insert(to.clone())).collect::<Vec<_>>());
        }
        seen
    };
    let names: BTreeSet<&String> = ties.iter().map(|(from, _)| from).collect();
    let reached: BTreeMap<&String, BTreeSet<String>> = names.iter().map(|name| (*name, reach(name))).collect();
    let mut groups: Vec<BTreeSet<String>> = vec![];
    for name in names {
        let back = |other: &&String| reached.get(*other).is_some_and(|it| it.contains(name));
        if reached[name].contains(name) && !groups.iter().any(|group| group.contains(name)) {
            groups.push(reached[name].iter().filter(back).cloned().collect());
        }
    }
    groups
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `src/a.rs` imports from `src/b.rs`, which has the given text.
    fn read(b: &str) -> Imports {
        let files = [("src/lib.rs", "mod a;\nmod b;"), ("src/a.rs", "use crate::b::B;"), ("src/b.rs", b)];
        let sources = files.map(|(path, text)| (PathBuf::from(path), text.to_string())).into();
        Imports::read(Path::new("src"), &sources).unwrap_or_else(|broken| panic!("{broken:?}"))
    }

    #[test]
    fn cycle_is_found_for_any_path_form() {
        for b in [
            "use crate::a::A;",
            "use super::{a::{self, A as Other}};",
            "use crate::{c, a};",
            "fn g() { super::a::f() }",
            "fn g() { println!(\"{:?}\", super::a::f()) }",
            "mod inner { use super::super::a::f; }",
            "macro_rules! n { () => { $crate::a::f() } }",
        ] {
            let found = read(b).cycles();
            assert!(matches!(&found[..], [one] if one.contains("src/b.rs -> src/a.rs")), "{b}: {found:?}");
        }
    }

    #[test]
    fn lookalikes_make_no_edge() {
        for b in [
            "use crate::c::a;",
            "// crate::a::f",
            "fn g() { println!(\"crate::a::f\") }",
            "pub(in crate::a) fn g() {}",
            "mod inner { use super::a; }",
            "mod tests { use super::super::a::f; }",
        ] {
            assert!(read(b).cycles().is_empty(), "{b}");
        }
    }

    #[test]
    fn folders_form_a_cycle_without_a_cycle_of_files() {
        let files = [
            ("src/lib.rs", ""),
            ("src/x/mod.rs", "pub use one::One;"),
            ("src/x/one.rs", ""),
            ("src/x/two.rs", "use crate::y::three::Three;"),
            ("src/y/mod.rs", ""),
            ("src/y/three.rs", "use crate::x::one::One;"),
        ];
        let sources = files.map(|(path, text)| (PathBuf::from(path), text.to_string())).into();
        let found = Imports::read(Path::new("src"), &sources).unwrap_or_else(|broken| panic!("{broken:?}")).cycles();
        assert!(matches!(&found[..], [one] if one.starts_with("x, y import one another")), "{found:?}");
    }

    #[test]
    fn runtime_import_of_design_is_found() {
        let files = [("src/step.rs", "use crate::design::Law;"), ("src/design/mod.rs", "use crate::step::Step;")];
        let sources = files.map(|(path, text)| (PathBuf::from(path), text.to_string())).into();
        let imports = Imports::read(Path::new("src"), &sources).unwrap_or_else(|broken| panic!("{broken:?}"));
        let found = imports.runtime_imports_design();
        assert!(matches!(&found[..], [one] if one.contains("src/step.rs -> src/design/mod.rs")), "{found:?}");
    }

    #[test]
    fn broken_source_is_named() {
        let sources = [(PathBuf::from("src/a.rs"), "fn {".to_string())].into();
        assert!(Imports::read(Path::new("src"), &sources).is_err_and(|broken| broken[0].contains("src/a.rs")));
    }
}
