//! Software bill of materials (CycloneDX 1.5) and licence texts of the third-party packages, from Cargo's metadata and
//! `Cargo.lock`.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

use board::device::cross_build::TARGET;
use board::device::tool;
use report::failure::{Failure, Outcome};
use report::workspace::workspace;
use serde::Deserialize;
use serde_json::{Value, json};

use crate::contents::File;
use crate::source::Source;

/// Name of the bill of materials.
const SBOM: &str = "sbom.cdx.json";
/// Name of the licence texts.
pub const NOTICES: &str = "THIRD-PARTY-LICENSES.txt";
/// Packages that are shipped: the command, the wheel, the C library, the images.
const SHIPPED: [&str; 4] = ["joint", "python-bindings", "c-bindings", "firmware"];
/// Beginnings of the names of files with licence texts, in capital letters.
const LICENCE_FILES: [&str; 6] = ["LICENSE", "LICENCE", "COPYING", "COPYRIGHT", "NOTICE", "UNLICENSE"];

/// Package in Cargo's metadata.
#[derive(Debug, Clone, Deserialize)]
struct Package {
    id: String,
    name: String,
    version: String,
    license: Option<String>,
    /// Registry; `None` for a crate of the workspace.
    source: Option<String>,
    manifest_path: PathBuf,
}

impl Package {
    /// Identifier that is equal on every machine.
    fn reference(&self) -> String {
        match &self.source {
            Some(_) => format!("pkg:cargo/{}@{}", self.name, self.version),
            None => format!("{}@{}", self.name, self.version),
        }
    }

    /// SPDX expression; a slash is an old form of OR.
    fn licence(&self) -> String {
        let stated = self.license.as_deref().unwrap_or("NOASSERTION");
        stated.split('/').map(str::trim).collect::<Vec<_>>().join(" OR ")
    }
}

/// Cargo's metadata, as far as it is used.
#[derive(Debug, Deserialize)]
struct Metadata {
    packages: Vec<Package>,
    resolve: Resolve,
}

#[derive(Debug, Deserialize)]
struct Resolve {
    nodes: Vec<Node>,
}

#[derive(Debug, Deserialize)]
struct Node {
    id: String,
    deps: Vec<Dependency>,
}

#[derive(Debug, Deserialize)]
struct Dependency {
    pkg: String,
    dep_kinds: Vec<Kind>,
}

#[derive(Debug, Deserialize)]
struct Kind {
    /// `None` for a normal dependency, else "dev" or "build".
    kind: Option<String>,
}

/// Checksums of `Cargo.lock` by name and version. Cargo writes a key a line, the checksum after name and version.
fn checksums(lock: &str) -> BTreeMap<(String, String), String> {
    let value =
        |line: &str, key: &str| Some(line.strip_prefix(key)?.strip_prefix(" = \"")?.trim_end_matches('"').to_owned());
    let (mut found, mut name, mut version) = (BTreeMap::new(), String::new(), String::new());
    for line in lock.lines() {
        if let Some(is) = value(line, "name") {
            name = is;
        } else if let Some(is) = value(line, "version") {
            version = is;
        } else if let Some(checksum) = value(line, "checksum") {
            found.insert((name.clone(), version.clone()), checksum);
        }
    }
    found
}

/// Packages that a release consists of, with what each depends on; keys are identifiers that are equal on every machine.
#[derive(Debug, Default)]
pub struct Materials {
    packages: BTreeMap<String, (Package, BTreeSet<String>)>,
    checksums: BTreeMap<(String, String), String>,
}

impl Materials {
    /// Reads the packages that the shipped ones are built from, on this machine and on boards. Dependencies of tests and of
    /// build scripts are left out.
    pub fn read() -> Outcome<Self> {
        let version = tool::capture_output(tool::cargo().arg("-vV").current_dir(workspace()))?;
        let host = version.lines().find_map(|line| line.strip_prefix("host: ")).unwrap_or_default().to_owned();
        let mut materials = Self::default();
        for platform in [&*host, TARGET] {
            let mut command = tool::cargo();
            command.current_dir(workspace()).args(["metadata", "--format-version", "1", "--locked"]);
            let text = tool::capture_output(command.args(["--filter-platform", platform]))?;
            let metadata = serde_json::from_str(&text);
            materials.add(&metadata.map_err(|error| Failure::new(format!("cargo metadata: {error}")))?);
        }
        let lock = workspace().join("Cargo.lock");
        let text = fs::read_to_string(&lock).map_err(|error| Failure::new(format!("{}: {error}", lock.display())))?;
        materials.checksums = checksums(&text);
        Ok(materials)
    }

    fn add(&mut self, metadata: &Metadata) {
        let packages: BTreeMap<&str, &Package> = metadata.packages.iter().map(|it| (&*it.id, it)).collect();
        let nodes: BTreeMap<&str, &Node> = metadata.resolve.nodes.iter().map(|it| (&*it.id, it)).collect();
        let is_shipped = |it: &&Package| it.source.is_none() && SHIPPED.contains(&&*it.name);
        let mut open: Vec<&Package> = metadata.packages.iter().filter(is_shipped).collect();
        let mut seen = BTreeSet::new();
        while let Some(package) = open.pop() {
            if !seen.insert(&package.id) {
                continue;
            }
            let normal = |it: &&Dependency| it.dep_kinds.iter().any(|kind| kind.kind.is_none());
            let deps = nodes.get(&*package.id).into_iter().flat_map(|node| &node.deps).filter(normal);
            let deps: Vec<&Package> = deps.filter_map(|it| packages.get(&*it.pkg).copied()).collect();
            let entry = self.packages.entry(package.reference());
            let (_, into) = entry.or_insert_with(|| (package.clone(), BTreeSet::new()));
            into.extend(deps.iter().map(|it| it.reference()));
            open.extend(deps);
        }
    }

    /// Third-party packages.
    fn foreign(&self) -> impl Iterator<Item = &Package> {
        self.packages.values().map(|(package, _)| package).filter(|it| it.source.is_some())
    }

    /// Bill of materials.
    pub fn sbom(&self, source: &Source) -> Outcome<File> {
        let components: Vec<Value> = self.packages.values().map(|(package, _)| self.component(package)).collect();
        let depends = |on: &BTreeSet<String>, reference: &str| json!({ "ref": reference, "dependsOn": on });
        let roots: BTreeSet<String> = self
            .packages
            .values()
            .filter(|(it, _)| it.source.is_none() && SHIPPED.contains(&&*it.name))
            .map(|(it, _)| it.reference())
            .collect();
        let dependencies = self.packages.iter().map(|(reference, (_, on))| depends(on, reference));
        let dependencies: Vec<Value> = [depends(&roots, "lostmotion")].into_iter().chain(dependencies).collect();
        let licence = json!([{ "expression": "MIT OR Apache-2.0" }]);
        let sbom = json!({
            "bomFormat": "CycloneDX",
            "specVersion": "1.5",
            "version": 1,
            "metadata": {
                "timestamp": source.date,
                "component": {
                    "type": "application", "bom-ref": "lostmotion", "name": "lostmotion",
                    "version": env!("CARGO_PKG_VERSION"), "licenses": licence,
                },
                "properties": [{ "name": "git:commit", "value": source.commit }],
            },
            "components": components,
            "dependencies": dependencies,
        });
        let what = "software bill of materials of command, wheel, C library and images, CycloneDX 1.5";
        Ok(File {
            path: SBOM.to_owned(),
            what: what.to_owned(),
            target: "any".to_owned(),
            bytes: crate::contents::json(&sbom)?,
        })
    }

    fn component(&self, package: &Package) -> Value {
        let mut component = json!({
            "type": "library",
            "bom-ref": package.reference(),
            "name": package.name,
            "version": package.version,
            "licenses": [{ "expression": package.licence() }],
        });
        if package.source.is_some() {
            component["purl"] = package.reference().into();
        }
        if let Some(checksum) = self.checksums.get(&(package.name.clone(), package.version.clone())) {
            component["hashes"] = json!([{ "alg": "SHA-256", "content": checksum }]);
        }
        component
    }

    /// Licence texts of the third-party packages, each text once.
    pub fn notices(&self) -> Outcome<File> {
        let mut list = String::new();
        let mut texts: Vec<String> = Vec::new();
        for package in self.foreign() {
            let mut numbers = Vec::new();
            for text in licence_texts(&package.manifest_path)? {
                let known = texts.iter().position(|it| *it == text);
                numbers.push(known.unwrap_or_else(|| {
                    texts.push(text);
                    texts.len() - 1
                }));
            }
            let numbers: Vec<String> = numbers.iter().map(|number| format!("{}", number + 1)).collect();
            let found = if numbers.is_empty() { "no text in the package".to_owned() } else { numbers.join(", ") };
            list += &format!("{} {}: {}; texts: {found}\n", package.name, package.version, package.licence());
        }
        let texts: String = texts
            .iter()
            .enumerate()
            .map(|(at, text)| format!("\n=== Text {} ===\n\n{}\n", at + 1, text.trim()))
            .collect();
        Ok(File {
            path: NOTICES.to_owned(),
            what: "licences of the third-party packages in command, wheel, C library and images".to_owned(),
            target: "any".to_owned(),
            bytes: format!("Third-party packages, and the licence texts that each contains.\n\n{list}{texts}")
                .into_bytes(),
        })
    }
}

/// Licence texts beside a manifest, in order of the files' names.
fn licence_texts(manifest: &Path) -> Outcome<Vec<String>> {
    let folder = manifest.parent().unwrap_or(manifest);
    let unreadable = |error: std::io::Error| Failure::new(format!("{}: {error}", folder.display()));
    let mut paths: Vec<PathBuf> = Vec::new();
    for entry in fs::read_dir(folder).map_err(unreadable)? {
        let path = entry.map_err(unreadable)?.path();
        let name = path.file_name().unwrap_or_default().to_string_lossy().to_uppercase();
        if path.is_file() && LICENCE_FILES.iter().any(|begin| name.starts_with(begin)) {
            paths.push(path);
        }
    }
    paths.sort();
    let text = |path: &PathBuf| fs::read(path).map(|bytes| String::from_utf8_lossy(&bytes).replace('\r', ""));
    paths.iter().map(|path| text(path).map_err(unreadable)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn source() -> Source {
        Source { commit: "c0".into(), time: 0, date: "1970-01-01T00:00:00Z".into() }
    }

    /// Metadata in which the command depends on one package, its tests on another and its build script on a third.
    fn metadata(folder: &Path) -> Metadata {
        let package = |name: &str, licence: &str, source: Option<&str>| {
            json!({ "id": format!("{}#{name}", folder.display()), "name": name, "version": "1.0.0", "license": licence,
                "source": source, "manifest_path": folder.join(name).join("Cargo.toml") })
        };
        let dependency = |name: &str, kind: Option<&str>| json!({ "pkg": format!("{}#{name}", folder.display()), "dep_kinds": [{ "kind": kind }] });
        let node = |name: &str, deps: &[Value]| json!({ "id": format!("{}#{name}", folder.display()), "deps": deps });
        let deps = [dependency("used", None), dependency("tested", Some("dev")), dependency("built", Some("build"))];
        let registry = Some("registry");
        serde_json::from_value(json!({
            "packages": [
                package("joint", "MIT OR Apache-2.0", None), package("used", "MIT/Apache-2.0", registry),
                package("tested", "MIT", registry), package("built", "MIT", registry), package("paper", "MIT", None),
            ],
            "resolve": { "nodes": [node("joint", &deps), node("used", &[]), node("paper", &[dependency("tested", None)])] },
        }))
        .expect("metadata")
    }

    fn materials(folder: &Path) -> Materials {
        let member = "version = 4\n[[package]]\nname = \"joint\"\nversion = \"1.0.0\"\n";
        let used = "[[package]]\nname = \"used\"\nversion = \"1.0.0\"\nsource = \"registry\"\n";
        let checksums = checksums(&format!("{member}{used}checksum = \"{}\"\n", "ab".repeat(32)));
        assert_eq!(checksums.len(), 1);
        let mut materials = Materials { checksums, ..Materials::default() };
        materials.add(&metadata(folder));
        materials
    }

    /// The bill names what is shipped and nothing else, without a folder of the machine.
    #[test]
    fn sbom_names_shipped_packages_only() {
        let bytes = materials(Path::new("/home/user")).sbom(&source()).expect("JSON").bytes;
        assert_eq!(bytes, materials(Path::new("/other")).sbom(&source()).expect("JSON").bytes);
        let sbom: Value = serde_json::from_slice(&bytes).expect("JSON");
        let components = sbom["components"].as_array().expect("a list");
        let names: Vec<&str> = components.iter().filter_map(|it| it["name"].as_str()).collect();
        assert_eq!(names, ["joint", "used"]);
        assert_eq!(components[1]["licenses"][0]["expression"], "MIT OR Apache-2.0");
        assert_eq!(components[1]["purl"], "pkg:cargo/used@1.0.0");
        assert_eq!(components[1]["hashes"][0]["content"], "ab".repeat(32));
        assert!(components[0].get("purl").is_none(), "the crates of the workspace are in no registry");
        assert_eq!(sbom["dependencies"][1], json!({ "ref": "joint@1.0.0", "dependsOn": ["pkg:cargo/used@1.0.0"] }));
        assert_eq!(sbom["metadata"]["timestamp"], "1970-01-01T00:00:00Z");
    }

    /// A licence text stands once; a package without one is named.
    #[test]
    fn notices_name_every_foreign_package() {
        let folder = tempfile::tempdir().expect("a folder");
        let used = folder.path().join("used");
        fs::create_dir(&used).expect("room");
        let notices = || materials(folder.path()).notices().map(|file| String::from_utf8(file.bytes).expect("text"));
        assert!(notices().expect("a text").contains("used 1.0.0: MIT OR Apache-2.0; texts: no text in the package\n"));
        for (name, text) in [("LICENSE-MIT", "be free\r\n"), ("license.md", "be free\n"), ("README.md", "read me")] {
            fs::write(used.join(name), text).expect("room");
        }
        let text = notices().expect("a text");
        assert!(text.contains("; texts: 1, 1\n") && text.matches("be free").count() == 1, "{text}");
        assert!(!text.contains("read me") && !text.contains("joint 1.0.0"), "{text}");
    }
}
