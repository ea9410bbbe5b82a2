//! Small crates with one planted fault each, which must be found, and with allowed patterns, which must not.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use structure::links::{Pages, broken, headings, named, unlisted};
use structure::members::{Kind, Member, Workspace};
use structure::{dependencies, features, page, size, unsafe_code};

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
        member("wheel", "bindings/python", &[("joint", Kind::Normal)]),
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
        workspace.command_imports("joint", "wheel"),
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
        (member("reference", "host/reference", &[("joint", Normal)]), "reference/Cargo.toml: joint in [dep"),
        (member("wheel", "bindings/python", &[("joint", Tests)]), "python/Cargo.toml: joint in [dev-dep"),
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
| `wheel` | The command once more | `joint` | `a.rs` |
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
    assert_eq!(page::rows(PAGE).len(), 7);
    assert_eq!(found(PAGE, core(Kind::Tests)), [""; 0]);
    assert!(found(PAGE, core(Kind::Normal))[0].contains("reference in [dependencies] is not allowed"));
    for (old, new, text) in [
        ("| `paper` | The study | `reference` | `a.rs` |\n", "", "no row for `paper`"),
        ("| `paper`", "| `papers`", ":11: `papers` is no crate"),
        ("`reference` | `a.rs` |\n\n", "`reference` | `b.rs` |\n\n", ":11: the file to open first, `b.rs`"),
        ("nothing of ours", "`scales`", ":5: `parameters` may import `scales`, which is no crate"),
        ("| `paper`", "| `joint`", ":11: `joint` has a row already"),
    ] {
        let page = PAGE.replace(old, new);
        let found = found(&page, core(Kind::Tests));
        assert!(page != PAGE && found.iter().any(|finding| finding.contains(text)), "{text}: {found:?}");
    }
}

/// Sizes exclude tests, and a crate above the limit is reported.
#[test]
fn sizes_exclude_tests() {
    let files = [("src/lib.rs", 5), ("src/a/mod.rs", 3), ("tests/b.rs", 7), ("src/a/tests.rs", 9)];
    assert_eq!(size::lines("fn f() {}\n\n#[cfg(test)]\nmod tests {\n    fn g() {}\n}\n"), 1);
    let files = files.map(|(path, lines)| (PathBuf::from(path), lines));
    let sizes =
        |name: &str| size::sizes(&Member { name: name.into(), folder: PathBuf::new(), ..Member::default() }, &files);
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

#[test]
fn package_built_twice_is_found() {
    let tests =
        features::parse("serde v1.0.0\tdefault,std\nserde v1.0.0\tdefault,derive,std\nmemchr v2.0.0\tstd (*)\n");
    let command = |tree: &str| features::unshared(&features::parse(tree), &tests);
    assert_eq!(command("serde v1.0.0\tdefault,std (*)\nmemchr v2.0.0\tstd\nclap v4.0.0\t\n"), [""; 0]);
    assert!(command("serde v1.0.0\tstd\n")[0].starts_with("serde v1.0.0: features [\"std\"]"));
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
