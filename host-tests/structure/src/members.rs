//! Crates of the workspace as Cargo knows them, and forbidden dependencies between them. A crate from a registry cannot depend on a member,
//! so the members and their declared dependencies, whatever the features, are complete.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use serde_json::Value;

use crate::cargo;

/// All members.
pub struct Workspace {
    /// Members in Cargo's order.
    pub members: Vec<Member>,
}

/// A crate of the workspace.
#[derive(Clone, Debug, Default)]
pub struct Member {
    /// Name of the package.
    pub name: String,
    /// Folder from the workspace's root.
    pub folder: PathBuf,
    /// Built by a plain `cargo build`.
    pub default: bool,
    /// Members that this crate depends on.
    pub imports: Vec<(String, Kind)>,
    /// Kinds of the targets (`lib`, `bin`, `test`, ...) and their root files.
    pub targets: Vec<(String, PathBuf)>,
}

/// Purpose of a dependency.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    /// For the crate itself.
    Normal,
    /// For its build script.
    Build,
    /// For its tests and examples.
    Tests,
}

impl Member {
    /// Returns true for tests, tolerances and checks: everything under `host-tests/`.
    pub fn is_test(&self) -> bool {
        self.folder.starts_with("host-tests")
    }

    /// Returns true for everything under `research/`.
    pub fn is_research(&self) -> bool {
        self.folder.starts_with("research")
    }

    /// Returns true for crates that users build on; measuring programs serve this project's own figures.
    pub fn ships(&self) -> bool {
        !self.is_test() && !self.is_research() && !self.folder.ends_with("measuring")
    }

    /// Unique label of the target with this kind and root file.
    pub fn label(&self, kind: &str, root: &Path) -> String {
        let stem = root.strip_prefix(&self.folder).unwrap_or(root).with_extension("");
        format!("{} ({kind} {})", self.name, stem.display())
    }
}

impl Workspace {
    /// Queries Cargo offline: the members' own manifests suffice.
    ///
    /// # Panics
    /// If Cargo cannot be run or rejects a manifest.
    pub fn read(root: &Path) -> Self {
        Self::parse(&cargo::metadata(root, &["--no-deps"]))
    }

    fn parse(metadata: &Value) -> Self {
        let list = |value: &Value| value.as_array().cloned().unwrap_or_default();
        let text = |value: &Value| value.as_str().unwrap_or_default().to_string();
        let root = PathBuf::from(text(&metadata["workspace_root"]));
        let relative = |path: &Value| {
            let path = PathBuf::from(text(path));
            path.strip_prefix(&root).map(Path::to_path_buf).unwrap_or(path)
        };
        let defaults = list(&metadata["workspace_default_members"]);
        let packages = list(&metadata["packages"]);
        let names: BTreeSet<String> = packages.iter().map(|package| text(&package["name"])).collect();
        let import = |dependency: &Value| {
            let kind = match dependency["kind"].as_str() {
                Some("dev") => Kind::Tests,
                Some("build") => Kind::Build,
                _ => Kind::Normal,
            };
            let name = text(&dependency["name"]);
            (dependency["path"].is_string() && names.contains(&name)).then_some((name, kind))
        };
        let target = |target: &Value| (text(&target["kind"][0]), relative(&target["src_path"]));
        let member = |package: &Value| Member {
            name: text(&package["name"]),
            folder: relative(&package["manifest_path"]).with_file_name(""),
            default: defaults.contains(&package["id"]),
            // A crate that tests itself with other features depends on itself.
            imports: list(&package["dependencies"])
                .iter()
                .filter_map(import)
                .filter(|(name, _)| *name != text(&package["name"]))
                .collect(),
            targets: list(&package["targets"]).iter().map(target).collect(),
        };
        Self { members: packages.iter().map(member).collect() }
    }

    /// Member of this name.
    pub fn member(&self, name: &str) -> Option<&Member> {
        self.members.iter().find(|member| member.name == name)
    }

    /// Checks that the dependency tree of `name`, with its tests, does not contain `other`; a missing crate is a finding, as it would prove
    /// nothing.
    pub fn independence(&self, name: &str, other: &str) -> Vec<String> {
        if self.member(name).is_none() || self.member(other).is_none() {
            return vec![format!("no crate {name} or no crate {other}; help: use their present names in this test")];
        }
        let mut paths_to_try = vec![vec![name.to_string()]];
        let mut seen = BTreeSet::new();
        while let Some(dependency_path) = paths_to_try.pop() {
            let last = dependency_path.last().expect("a way has a start");
            if last == other {
                return vec![format!("{name} must not depend on {other}, but does: {}", dependency_path.join(" -> "))];
            }
            for (next, kind) in self.member(last).map_or(&[][..], |member| &member.imports) {
                // Tests of a dependency are not in the tree.
                if (*kind != Kind::Tests || last == name) && seen.insert(next.clone()) {
                    paths_to_try.push([dependency_path.clone(), vec![next.clone()]].concat());
                }
            }
        }
        vec![]
    }

    /// Crates that ship and depend on a test crate or on research, except for their own tests.
    pub fn shipped_imports(&self) -> Vec<String> {
        self.forbidden(
            |member, kind| member.ships() && kind != Kind::Tests,
            |other| other.is_test() || other.is_research(),
            "move what both need into a crate that ships",
        )
    }

    /// Crates that depend on the command; even tests use the crates below it instead. `wheel` ships the command itself.
    pub fn command_imports(&self, command: &str, wheel: &str) -> Vec<String> {
        let help = "move the needed code into a crate below the command";
        self.forbidden(|member, kind| member.name != wheel || kind != Kind::Normal, |other| other.name == command, help)
    }

    /// Default members that are research or depend on research.
    pub fn research_by_default(&self) -> Vec<String> {
        let itself = self.members.iter().filter(|member| member.default && member.is_research());
        let mut found: Vec<String> = itself
            .map(|member| format!("{} is a default member; help: leave it out of `default-members`", member.name))
            .collect();
        let help = "move the test that needs it into the research crate";
        found.extend(self.forbidden(|member, _| member.default, Member::is_research, help));
        found
    }

    fn forbidden(
        &self,
        who: impl Fn(&Member, Kind) -> bool,
        whom: impl Fn(&Member) -> bool,
        help: &str,
    ) -> Vec<String> {
        let mut found = vec![];
        for member in &self.members {
            for (name, kind) in &member.imports {
                if who(member, *kind) && self.member(name).is_some_and(&whom) {
                    let manifest = member.folder.join("Cargo.toml");
                    let kind = kind.section();
                    found.push(format!("{}: {name} in [{kind}]\n  help: {help}", manifest.display()));
                }
            }
        }
        found
    }
}

impl Kind {
    /// Section of the manifest.
    pub fn section(self) -> &'static str {
        match self {
            Kind::Normal => "dependencies",
            Kind::Build => "build-dependencies",
            Kind::Tests => "dev-dependencies",
        }
    }
}
