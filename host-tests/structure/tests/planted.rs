//! Small crates with one planted fault each, which must be found, and with allowed patterns, which must not.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use structure::graph::Graph;
use structure::links::{Pages, broken, headings, named, unlisted};
use structure::members::{Kind, Member, Workspace};
use structure::rules::{file_cycles, folder_cycles, runtime_imports_design};
use structure::sources::Sources;
use structure::{dependencies, page, size, unsafe_code};

fn graph(files: &[(&str, &str)]) -> Graph {
    let files: BTreeMap<&str, &str> = files.iter().copied().collect();
    let reader = |path: &Path| files.get(path.to_str()?).map(|text| text.to_string());
    Graph::new(Sources::read(Path::new("src/lib.rs"), &reader))
}

/// Every edge, as `from -> to: names`.
fn edges(graph: &Graph) -> Vec<String> {
    assert!(graph.unresolved.is_empty(), "{:?}", graph.unresolved);
    let file = |at: usize| graph.sources.files[at].path.strip_prefix("src").unwrap().display().to_string();
    let names = |names: &BTreeMap<String, usize>| names.keys().cloned().collect::<Vec<_>>().join(", ");
    graph.edges.iter().map(|((from, to), it)| format!("{} -> {}: {}", file(*from), file(*to), names(it))).collect()
}

/// `a.rs` and `b.rs` with an item each; `a` imports from `b` in the usual way, `b` from `a` as given.
fn a_and_b(b: &str) -> Graph {
    let a = "use crate::b::B;\npub struct A(B);\npub fn f() {}\npub trait Does {}\n\
             #[macro_export]\nmacro_rules! m {() => {}}";
    graph(&[("src/lib.rs", "mod a;\nmod b;"), ("src/a.rs", a), ("src/b.rs", &format!("pub struct B;\n{b}"))])
}

/// A cycle of two files is found for every way to write a path.
#[test]
fn file_cycle_is_found_for_any_path_form() {
    let forms = [
        ("use crate::a::A;", "A"),
        ("use super::{a::{self, A as Other}};", "A"),
        ("use crate::a; fn g() { a::f() }", "f"),
        ("use crate::a as other; fn g() { other::f() }", "f"),
        ("fn g() { use super::a::f; f() }", "f"),
        ("fn g() { crate::a::f() }", "f"),
        ("fn g(a: &crate::a::A) {}", "A"),
        ("fn g() -> bool { matches!(1, x if { crate::a::f(); x > 0 }) }", "f"),
        ("fn g() { println!(\"{:?}\", super::a::f()) }", "f"),
        ("fn g() { vec![{ use crate::a::{A, f}; f() }]; }", "A"),
        ("impl crate::a::Does for B {}", "Does"),
        ("#[derive(crate::a::A)] struct C;", "A"),
        ("use super::a::*; fn g() { f() }", "A"),
        ("fn g() { crate::m!() }", "m"),
        ("#[cfg(test)] mod tests { use super::super::a::f; }", "f"),
        ("macro_rules! n { () => { $crate::a::f() } }", "f"),
    ];
    for (form, name) in forms {
        let graph = a_and_b(form);
        let found = file_cycles(&graph);
        assert_eq!(found.len(), 1, "{form}: {:?}", edges(&graph));
        assert!(found[0].contains("src/a.rs -> src/b.rs: B (line 1)"), "{form}: {found:?}");
        let edge_line = found[0].lines().find(|line| line.contains("src/b.rs -> src/a.rs: ")).expect(form);
        assert!(edge_line.contains(&format!("{name} (line 2)")), "{form}: {edge_line}");
        assert!(found[0].contains("help: move "), "{form}: {found:?}");
    }
}

/// Text that only looks like an import makes no edge.
#[test]
fn lookalikes_make_no_edge() {
    let forms = [
        "/// See [`crate::a::A`].\nstruct C;",
        "pub(in crate::b) struct C;",
        "fn g(a: i32) -> i32 { a }",
        "fn g() { println!(\"crate::a::f\") }",
        "use crate::b::B as A; fn g(_: A) {}",
        "mod a { pub fn f() {} } fn g() { a::f() }",
        "use ::a::A; fn g(x: X) { x.f() }",
        "fn a() {} fn g() { a(); ::a::f() }",
    ];
    for form in forms {
        let graph = a_and_b(form);
        assert_eq!(edges(&graph), ["a.rs -> b.rs: B"], "{form}");
    }
}

/// A parent may name and re-export its descendants.
#[test]
fn parent_may_reexport_descendants() {
    let root = "pub mod foo;\npub use foo::{Foo, deep::Deep as Renamed};\npub(crate) use foo::*;\n\
                #[cfg(x)]\npub use foo::deep;";
    let foo = "pub(super) mod deep;\nmod inner;\npub use inner::Foo;\npub(in crate::foo) use deep::*;";
    let inner = "pub struct Foo(super::deep::Deep);\nmod tests { use super::*; fn f(_: Foo) {} }";
    let files = [("src/lib.rs", root), ("src/foo/mod.rs", foo), ("src/foo/inner.rs", inner)];
    let graph = graph(&[&files[..], &[("src/foo/deep.rs", "pub struct Deep;")]].concat());
    assert_eq!(edges(&graph), ["foo/inner.rs -> foo/deep.rs: Deep"]);
}

/// A parent that uses its child, and is used by it, forms a cycle.
#[test]
fn parent_and_child_can_form_a_cycle() {
    let child = "use super::Shared;\npub struct Child(Shared);";
    for parent in [
        "use child::Child;\npub struct Owner(Child);",
        "pub use child::Child;\npub struct Owner(Child);",
        "pub struct Owner(child::Child);",
    ] {
        let parent = format!("mod child;\npub struct Shared;\n{parent}");
        for file in ["src/foo.rs", "src/foo/mod.rs"] {
            let graph = graph(&[("src/lib.rs", "mod foo;"), (file, &parent), ("src/foo/child.rs", child)]);
            let found = edges(&graph).join("; ").replace("foo/mod.rs", "foo.rs");
            let there_and_back = ["foo.rs -> foo/child.rs: Child", "foo/child.rs -> foo.rs: Shared"];
            assert!(there_and_back.iter().all(|edge| found.contains(edge)), "{found}");
            assert_eq!((file_cycles(&graph).len(), folder_cycles(&graph).len()), (1, 0));
            assert!(file_cycles(&graph)[0].contains("help: move Shared from src/foo"));
        }
    }
}

/// A path leads to the defining file, whatever re-exports it.
#[test]
fn path_leads_to_defining_file() {
    let files = [
        ("src/lib.rs", "mod facade;\nmod user;\nmod far;"),
        (
            "src/facade/mod.rs",
            "mod one;\nmod two;\npub use one::One;\npub use two::*;\npub use crate::far::Far as Near;",
        ),
        ("src/facade/one.rs", "pub struct One;"),
        ("src/facade/two.rs", "pub enum Two { Half }\npub trait Does {}\npub use Two::*;"),
        ("src/far.rs", "pub struct Far;"),
    ];
    let with = |user| graph(&[&files[..], &[("src/user.rs", user)]].concat());
    let far = "facade/mod.rs -> far.rs: Far";
    for (user, edge) in [
        ("use crate::facade::One;", "user.rs -> facade/one.rs: One"),
        ("use crate::facade; fn f(_: facade::One) {}", "user.rs -> facade/one.rs: One"),
        ("fn f() { crate::facade::Two::Half }", "user.rs -> facade/two.rs: Two"),
        ("use crate::facade::Half;", "user.rs -> facade/two.rs: Two"),
        ("use crate::facade::Near;", "user.rs -> far.rs: Far"),
        ("use crate::facade::*;", "user.rs -> facade/two.rs: Does"),
        ("use crate::facade::*; fn f(_: One) {}", "user.rs -> facade/one.rs: One"),
        ("use crate::facade::*; fn f() { assert!(One == x) }", "user.rs -> facade/one.rs: One"),
    ] {
        let found = edges(&with(user));
        assert!(found.contains(&far.to_string()) && found.contains(&edge.to_string()), "{user}: {found:?}");
        assert!(!found.iter().any(|edge| edge.contains("user.rs -> facade/mod.rs")), "{user}: {found:?}");
    }
}

/// A cycle through a re-export is found.
#[test]
fn cycle_through_reexport_is_found() {
    let files = [
        ("src/lib.rs", "mod facade;\nmod user;"),
        ("src/facade.rs", "mod one;\npub use one::One;"),
        ("src/facade/one.rs", "use crate::user::User;\npub struct One(User);"),
        ("src/user.rs", "use crate::facade::One;\npub struct User(One);"),
    ];
    let found = file_cycles(&graph(&files));
    assert_eq!(found.len(), 1);
    assert!(found[0].contains("src/user.rs -> src/facade/one.rs: One (line 1)"), "{found:?}");
    assert!(found[0].contains("src/facade/one.rs -> src/user.rs: User (line 1)"), "{found:?}");
}

/// Folders can form a cycle where files do not.
#[test]
fn folder_cycle_without_file_cycle_is_found() {
    let files = [
        ("src/lib.rs", "mod x;"),
        ("src/x/mod.rs", "mod a;\nmod b;"),
        ("src/x/a.rs", "pub mod one;\nuse super::b::B;"),
        ("src/x/a/one.rs", "pub struct One;"),
        ("src/x/b/mod.rs", "mod two;\npub struct B;"),
        ("src/x/b/two.rs", "use crate::x::a::one::One;"),
    ];
    let graph = graph(&files);
    assert!(file_cycles(&graph).is_empty());
    let found = folder_cycles(&graph);
    assert_eq!(found.len(), 1, "{found:?}");
    assert!(found[0].starts_with("in src/x/, a, b import one another"), "{found:?}");
    assert!(found[0].contains("src/x/b/two.rs -> src/x/a/one.rs: One (line 1)"), "{found:?}");
}

/// An import of design by the runtime is found, also through a re-export.
#[test]
fn runtime_import_of_design_is_found() {
    let files = |step| {
        graph(&[
            ("src/lib.rs", "mod gears;"),
            (
                "src/gears/mod.rs",
                "mod design;\nmod step;\nmod tables;\n#[cfg(feature = \"design\")]\npub use design::Design;",
            ),
            ("src/gears/design/mod.rs", "mod law;\npub use law::Law;\npub struct Design(super::tables::Tables);"),
            ("src/gears/design/law.rs", "pub struct Law;"),
            ("src/gears/step.rs", step),
            ("src/gears/tables.rs", "pub struct Tables;"),
        ])
    };
    assert!(runtime_imports_design(&files("use super::tables::Tables;")).is_empty());
    for (step, file) in [
        ("use super::Design;", "src/gears/design/mod.rs: Design (line 1)"),
        ("fn f(_: crate::gears::design::Law) {}", "src/gears/design/law.rs: Law (line 1)"),
    ] {
        let found = runtime_imports_design(&files(step));
        assert_eq!(found.len(), 1);
        assert!(found[0].contains(&format!("src/gears/step.rs -> {file}")), "{found:?}");
    }
}

/// An unresolved path is reported with its line.
#[test]
fn unresolved_path_is_reported_with_line() {
    for (b, path) in [
        ("use crate::a::Missing;", "`crate::a::Missing`"),
        ("fn g() { super::missing::f() }", "`super::missing::f`"),
        ("fn g() { assert!(crate::a::missing()) }", "`crate::a::missing`"),
        ("use crate::a; fn g() { a::missing() }", "`a::missing`"),
        ("use super::super::A;", "`super::super::A`"),
        ("mod lost;", "asks for src/b/lost.rs"),
        ("fn {", "does not parse"),
    ] {
        let found = a_and_b(b).unresolved;
        assert!(found.len() == 1 || b.contains("fn {"), "{b}: {found:?}");
        assert!(found[0].starts_with("src/b.rs:2") && found[0].contains(path), "{b}: {found:?}");
    }
}

/// Files are looked up where the compiler looks them up.
#[test]
fn files_are_found_as_by_the_compiler() {
    let root = "#[path = \"odd/place.rs\"]\nmod named;\nmod inline { pub mod file; }\ninclude!(\"../shared.rs\");\n\
                mod foo;\nmod generated { include!(concat!(env!(\"OUT_DIR\"), \"/x.rs\")); }\n\
                macro_rules! m {() => {}}\nmod last;";
    let graph = graph(&[
        ("src/lib.rs", root),
        ("src/odd/place.rs", "mod beside;\nuse crate::inline::file::File;"),
        ("src/odd/beside.rs", "use crate::foo::Foo;\nuse crate::generated::TABLE;"),
        ("src/inline/file.rs", "pub struct File;"),
        ("shared.rs", "pub struct Shared(foo::Foo);"),
        ("src/foo.rs", "pub struct Foo;"),
        ("src/last.rs", "use crate::Shared;\nm!();"),
    ]);
    assert!(graph.unresolved.is_empty(), "{:?}", graph.unresolved);
    let file = |at: usize| graph.sources.files[at].path.display().to_string();
    let found: Vec<_> = graph.edges.keys().map(|(from, to)| format!("{} -> {}", file(*from), file(*to))).collect();
    for edge in [
        "src/odd/place.rs -> src/inline/file.rs",
        "src/odd/beside.rs -> src/foo.rs",
        "src/odd/beside.rs -> src/lib.rs",
        "shared.rs -> src/foo.rs",
        "src/last.rs -> shared.rs",
        "src/last.rs -> src/lib.rs",
    ] {
        assert!(found.contains(&edge.to_string()), "{edge} is not among {found:?}");
    }
}

fn member(name: &str, folder: &str, imports: &[(&str, Kind)]) -> Member {
    let imports = imports.iter().map(|(name, kind)| (name.to_string(), *kind)).collect();
    Member { name: name.into(), folder: folder.into(), default: true, imports, ..Member::default() }
}

fn workspace(changed: Member) -> Workspace {
    let mut members = vec![
        member("parameters", "parameters", &[]),
        member("model-core", "model-core", &[("parameters", Kind::Normal)]),
        member("reference", "host/reference", &[("parameters", Kind::Normal)]),
        member("joint", "host/joint", &[("model-core", Kind::Normal)]),
        member("host-tests", "host-tests", &[("reference", Kind::Normal), ("model-core", Kind::Normal)]),
        Member { default: false, ..member("paper", "research/paper", &[("reference", Kind::Normal)]) },
    ];
    let place = members.iter().position(|it| it.name == changed.name).expect("a member is changed");
    members[place] = changed;
    Workspace { members }
}

fn all_rules(workspace: &Workspace) -> Vec<String> {
    let found = [
        workspace.independence("reference", "model-core"),
        workspace.shipped_imports(),
        workspace.command_imports("joint"),
        workspace.research_by_default(),
    ];
    found.concat()
}

/// Every forbidden dependency between crates is found.
#[test]
fn forbidden_dependency_is_found() {
    use Kind::{Build, Normal, Tests};
    let allowed = member("parameters", "parameters", &[("host-tests", Tests)]);
    assert_eq!(all_rules(&workspace(allowed)), [""; 0]);
    for (changed, text) in [
        (member("reference", "host/reference", &[("model-core", Normal)]), "reference -> model-core"),
        (member("reference", "host/reference", &[("model-core", Build)]), "reference -> model-core"),
        (member("reference", "host/reference", &[("host-tests", Tests)]), "reference -> host-tests -> model-core"),
        (member("model-core", "model-core", &[("host-tests", Normal)]), "model-core/Cargo.toml: host-tests in [dep"),
        (member("model-core", "model-core", &[("paper", Build)]), "model-core/Cargo.toml: paper in [build-dep"),
        (member("host-tests", "host-tests", &[("joint", Tests)]), "host-tests/Cargo.toml: joint in [dev-dep"),
        (member("host-tests", "host-tests", &[("paper", Tests)]), "host-tests/Cargo.toml: paper in [dev-dep"),
        (member("paper", "research/paper", &[]), "paper is a default member"),
    ] {
        let found = all_rules(&workspace(changed));
        assert!(found.iter().any(|finding| finding.contains(text)), "{text}: {found:?}");
    }
    assert!(
        workspace(member("joint", "joint", &[])).independence("referee", "model-core")[0].contains("no crate referee")
    );
}

const PAGE: &str = "# The house

| crate | what it is | may import | open first |
|---|---|---|---|
| `parameters` | Joint parameters | nothing of ours | `a.rs` |
| `model-core` | Code of a board | `parameters`, `reference` (tests) | [`a.rs`](a.rs) |
| `reference` | Independent model | `parameters` | `a.rs` |
| `joint` | The command | `model-core` | `a.rs` |
| `host-tests` | Tests | `reference`, `model-core` | `a.rs` |
| `paper` | The study | `reference` | `a.rs` |

| another | table |
|---|---|
| `no` | crate |
";

/// Table and Cargo must agree.
#[test]
fn page_must_agree_with_cargo() {
    let found = |page: &str, changed| page::differences(page, &workspace(changed), |path| path == Path::new("a.rs"));
    let core = |kind| member("model-core", "model-core", &[("parameters", Kind::Normal), ("reference", kind)]);
    assert_eq!(page::rows(PAGE).len(), 6);
    assert_eq!(found(PAGE, core(Kind::Tests)), [""; 0]);
    assert!(found(PAGE, core(Kind::Normal))[0].contains("reference in [dependencies] is not allowed"));
    for (old, new, text) in [
        ("| `paper` | The study | `reference` | `a.rs` |\n", "", "no row for `paper`"),
        ("| `paper`", "| `papers`", ":10: `papers` is no crate"),
        ("`reference` | `a.rs` |\n\n", "`reference` | `b.rs` |\n\n", ":10: the file to open first, `b.rs`"),
        ("nothing of ours", "`scales`", ":5: `parameters` may import `scales`, which is no crate"),
        ("| `paper`", "| `joint`", ":10: `joint` has a row already"),
    ] {
        let page = PAGE.replace(old, new);
        let found = found(&page, core(Kind::Tests));
        assert!(page != PAGE && found.iter().any(|finding| finding.contains(text)), "{text}: {found:?}");
    }
}

/// Sizes exclude tests, and a crate above the limit is reported.
#[test]
fn sizes_exclude_tests() {
    let root = "mod a;\nfn f() {}\n#[cfg(test)]\nmod tests;\n#[cfg(test)]\nmod more {\n    mod deep;\n}\n";
    let files = [("src/lib.rs", root), ("src/a/mod.rs", "\n\n\n"), ("src/tests.rs", "\n"), ("src/more/deep.rs", "\n")];
    let graphs = [("lib".to_string(), graph(&files)), ("test".to_string(), graph(&[("src/lib.rs", "\n\n")]))];
    let sizes =
        |name: &str| size::sizes(&Member { name: name.into(), folder: PathBuf::new(), ..Member::default() }, &graphs);
    assert_eq!(sizes("link"), BTreeMap::from([("link".to_string(), 5 + 3)]));
    assert_eq!(sizes("model-core")["src/a"], 3);
    assert!(size::too_large(&sizes("link")).is_empty());
    let large = BTreeMap::from([("link".to_string(), size::LIMIT + 1)]);
    assert!(size::too_large(&large)[0].starts_with("link has 8501 lines"));
}

/// A missing path on a page is found; other words in backquotes are not paths.
#[test]
fn missing_path_on_page_is_found() {
    let page =
        "open `a/b.rs`, then `a/gone.rs`; `cargo joint hil hil/t2.toml`, `+ - *` and `Model::step` are no places";
    let found = page::missing(page, |path| path == Path::new("a/b.rs"));
    assert!(matches!(&found[..], [one] if one.contains("`a/gone.rs`")), "{found:?}");
}

fn pages(pages: &[(&str, &str)]) -> Pages {
    pages.iter().map(|(path, text)| (PathBuf::from(path), text.to_string())).collect()
}

/// Anchors follow from the words of a heading.
#[test]
fn heading_anchor_follows_its_words() {
    let page = "# Error, against `cost`\n## Error, against `cost`\n```\n# a comment\n```\n### [On](x.md#y) a_b-c\n#no";
    assert_eq!(headings(page), ["error-against-cost", "error-against-cost-1", "on-a_b-c"]);
}

/// Broken links are found; code contains no links.
#[test]
fn broken_link_is_found_outside_code() {
    let there = ["docs/b.md", "docs/deep/c.md", "docs/d.svg", "README.md", "docs"].map(Path::new);
    let found = |text: &str| {
        let others =
            [("docs/b.md", "# Here\n"), ("docs/deep/c.md", ""), ("README.md", "# Root\n"), ("docs/a.md", text)];
        broken(&pages(&others), |path| there.contains(&path) || path == Path::new("docs/a.md"))
    };
    for good in [
        "[b](b.md#here) ![d](d.svg) [c](deep/c.md) [b](deep/../b.md \"title\") [self](#up)\n# Up",
        "[far](https://gone.example/x.md) `[code](gone.md)` [chapter]()",
        "```\n[code](gone.md)\n```",
        "over two\nlines [of\ntext](b.md)",
    ] {
        assert_eq!(found(good), [""; 0], "{good}");
    }
    for (bad, text) in [
        ("\n[b](gone.md)", "docs/a.md:2: broken link to `gone.md`"),
        ("![d](gone.svg)", "docs/a.md:1: broken link to `gone.svg`"),
        ("[b](b.md#there)", "docs/b.md has no heading `there`\n  help: use one of here"),
        ("# Up\n\nsee [it](#down)", "docs/a.md:3: docs/a.md has no heading `down`"),
        ("[d](d.svg#part)", "docs/d.svg has no heading `part`"),
        ("[up](../../x.md)", "broken link to `../../x.md`"),
        ("[up](/b.md)", "broken link to `/b.md`"),
        ("[root](../README.md)", "leaves the book"),
        ("`one` [b](gone.md) `two`", "broken link to `gone.md`"),
    ] {
        let found = found(bad);
        assert!(matches!(&found[..], [one] if one.contains(text)), "{bad}: {found:?}");
    }
}

/// A page missing in the book's list is found.
#[test]
fn unlisted_page_is_found() {
    let found = |summary: &str| {
        unlisted(&pages(&[("docs/SUMMARY.md", summary), ("docs/deep/a.md", ""), ("docs/b.md", ""), ("README.md", "")]))
    };
    assert_eq!(found("- [a](deep/a.md)\n- [none]()\n- [b](b.md)"), [""; 0]);
    assert_eq!(found("- [b](b.md)"), ["docs/deep/a.md is not in docs/SUMMARY.md\n  help: add a line there"]);
}

/// Pages named in a source are found with their lines.
#[test]
fn pages_named_in_sources_are_found() {
    let source = "//! Told in `docs/a-b.md`.\nhelp: \"see docs/deep/c.md.\"; include_str!(\"../docs/d.json\")\n\
                  // docs/ holds pages; https://far.example/docs/e.md is none of them";
    let found: Vec<String> = named(source).iter().map(|(line, page)| format!("{line} {}", page.display())).collect();
    assert_eq!(found, ["1 docs/a-b.md", "2 docs/deep/c.md", "2 docs/d.json"]);
}

/// An unlisted `unsafe` is found; comments and strings do not count.
#[test]
fn unlisted_unsafe_is_found() {
    let source = "// unsafe\nfn f() { let text = \"unsafe\"; unsafe { g() } }\n#[unsafe(no_mangle)]\nunsafe fn h() {}";
    assert_eq!(unsafe_code::count(source), Ok(3));
    let list = "| `a/src/x.rs` | 3 | Hardware demands it. |\n";
    let found = |file: &str, count| unsafe_code::differences(list, &BTreeMap::from([(PathBuf::from(file), count)]));
    assert_eq!(found("a/src/x.rs", 3), [""; 0]);
    assert!(found("a/src/x.rs", 4)[0].contains("4 times, docs/reference/unsafe.md says 3"));
    let other = found("b/src/y.rs", 1);
    assert!(other[0].starts_with("b/src/y.rs: `unsafe` 1 times") && other[1].contains("a/src/x.rs has no `unsafe`"));
    assert!(
        unsafe_code::differences("| `a.rs` | 1 |  |", &BTreeMap::from([(PathBuf::from("a.rs"), 1)]))[0]
            .contains("no reason")
    );
    let crates = |a: &str, b: &str| {
        let manifests = [("a", a), ("b", b)].map(|(folder, text)| (PathBuf::from(folder), text.to_string()));
        unsafe_code::unforbidden(list, &manifests)
    };
    let forbids = "[lints]\nworkspace = true\n";
    assert_eq!(crates("", forbids), [""; 0]);
    assert!(crates("", "")[0].starts_with("b/Cargo.toml: `unsafe` is not forbidden"));
    assert!(crates(forbids, forbids)[0].starts_with("a/Cargo.toml forbids what"));
}

/// A dependency from another source or with another licence is found.
#[test]
fn foreign_source_or_licence_is_found() {
    let lock = "[[package]]\nname = \"a\"\n[[package]]\nsource = \"registry+https://example.org/index\"\n";
    assert_eq!(dependencies::foreign(lock), [""; 0]);
    let git = format!("{lock}source = \"git+https://example.com/x?rev=1#1\"\n");
    assert!(dependencies::foreign(&git)[0].contains("git+https://example.com/x"));
    let other = format!("{lock}source = \"registry+https://example.com/other\"\n");
    assert!(dependencies::foreign(&other)[0].contains("example.com/other"));
    for good in ["MIT", "MIT/GPL-3.0", "GPL-3.0-only OR (MIT AND Zlib)", "Apache-2.0 WITH LLVM-exception OR MIT"] {
        assert!(dependencies::is_allowed(good), "{good}");
    }
    for bad in ["GPL-3.0-only", "MIT AND GPL-3.0-only", "(MIT", "", "MIT GPL-3.0", "Apache-2.0 WITH Other-exception"] {
        assert!(!dependencies::is_allowed(bad), "{bad}");
    }
    let packages =
        serde_json::json!({ "packages": [{ "name": "a", "license": "MIT" }, { "name": "b", "license": null }] });
    assert_eq!(dependencies::unlicensed(&packages).len(), 1);
}
