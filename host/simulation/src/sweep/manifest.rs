//! Manifest of a sweep, `sweep.json` in its folder. Sweeps with equal digests compute equal points; paths, threads,
//! engines and dates are not part of the digest.

use std::fmt::Display;
use std::path::Path;

use serde::{Deserialize, Serialize};

use super::grid::Grid;
use super::metrics::Metric;
use report::digest::sha256;
use report::failure::{Failure, Outcome};
use report::input;
use report::output;

/// Name and version of the schema; the version rises when a field changes its meaning or is removed.
const SCHEMA: &str = "joint-sweep/1";

/// A sweep.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Manifest {
    /// `joint-sweep/1`.
    pub schema: String,
    /// SHA-256 over all other fields.
    pub digest: String,
    /// Version of the command.
    pub version: String,
    /// Name of the joint.
    pub joint: String,
    /// Axes, each as `key=from:to:step`.
    pub vary: Vec<String>,
    /// Number of points.
    pub points: u64,
    /// Columns.
    pub metrics: Vec<Metric>,
    /// Name of the scheme.
    pub scheme: String,
    /// Options of the motion.
    pub motion: String,
    /// SHA-256 of the torque profile, if it is a file.
    pub profile_sha256: Option<String>,
    /// Joint file with the changes of the command line.
    pub joint_file: String,
}

impl Manifest {
    /// Sets schema, version and digest.
    pub fn sealed(mut self) -> Self {
        self.schema = SCHEMA.to_owned();
        self.version = env!("CARGO_PKG_VERSION").to_owned();
        self.digest = self.computed_digest();
        self
    }

    /// Digest of all other fields.
    fn computed_digest(&self) -> String {
        let bare = Self { digest: String::new(), ..self.clone() };
        // A structure of texts and numbers can always be written as JSON.
        sha256(serde_json::to_string(&bare).unwrap_or_default().as_bytes())
    }

    /// Text of the file.
    pub fn text(&self) -> Outcome<String> {
        output::json("sweep", self)
    }

    /// Reads `sweep.json` and checks its schema and digest.
    pub fn read(path: &Path) -> Outcome<Self> {
        let text = input::text(path, input::LARGEST_RECORDED).map_err(|why| {
            Failure::new(format!("cannot read {}: {why}", path.display()))
                .with_help("see that the folder and its files may be read")
        })?;
        Self::parse(&path.display(), &text)
    }

    /// Reads a manifest and checks its schema and digest.
    pub fn parse(place: &dyn Display, text: &str) -> Outcome<Self> {
        let spoilt = |why: String| {
            Failure::new(format!("{place} is not a sweep's manifest: {why}"))
                .with_help("name another folder by --out DIR; this one is left as it is")
        };
        let manifest: Self = serde_json::from_str(text).map_err(|error| spoilt(error.to_string()))?;
        if manifest.schema != SCHEMA {
            return Err(spoilt(format!("its schema is `{}`, not `{SCHEMA}`", manifest.schema)));
        }
        if manifest.digest != manifest.computed_digest() {
            return Err(spoilt("its digest does not belong to it".to_owned()));
        }
        Ok(manifest)
    }

    /// Grid of the sweep.
    pub fn grid(&self) -> Outcome<Grid> {
        Grid::parse(&self.vary, None)
    }

    /// First difference between two sweeps, as text; `None` if they are equal.
    pub fn difference(&self, other: &Self) -> Option<String> {
        if self.digest == other.digest {
            return None;
        }
        let names: Vec<String> = self.metrics.iter().map(|metric| metric.name()).collect();
        let other_names: Vec<String> = other.metrics.iter().map(|metric| metric.name()).collect();
        let pairs = [
            ("grid", self.vary.join(" "), other.vary.join(" ")),
            ("joint", self.joint.clone(), other.joint.clone()),
            ("scheme", self.scheme.clone(), other.scheme.clone()),
            ("motion", self.motion.clone(), other.motion.clone()),
            ("metrics", names.join(" "), other_names.join(" ")),
            ("version of the command", self.version.clone(), other.version.clone()),
        ];
        let different = pairs.into_iter().find(|(_, one, other)| one != other);
        Some(different.map_or_else(
            || "its joint file or its torque profile is another".to_owned(),
            |(what, one, other)| format!("its {what} is `{}`, not `{}`", other.trim(), one.trim()),
        ))
    }
}
