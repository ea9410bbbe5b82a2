//! Thresholds multiplied by a factor at process start, for a study of their sensitivity. Only with the feature
//! `sensitivity`, never on a board.
//!
//! `JOINT_THRESHOLD=CONTACT.persistence=0.5` halves one threshold. Each process has at most one factor.

use std::format;
use std::string::String;
use std::sync::LazyLock;
use std::vec::Vec;

/// Name of the environment variable.
pub const VARIABLE: &str = "JOINT_THRESHOLD";

/// Threshold of the core.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Threshold {
    /// Folder of the declaration in the crate's sources, such as `observer/contact`.
    pub folder: String,
    /// Instance or type, and field.
    pub name: &'static str,
    /// Tuned value.
    pub value: String,
    /// Meaning, unit and origin.
    pub doc: String,
    /// Values under the factors 0.5 and 1.5. Integers are rounded, so that 1 stays 1 under 0.5.
    pub scaled: [String; 2],
}

/// Factors of the study.
pub const FACTORS: [f64; 2] = [0.5, 1.5];

impl Threshold {
    /// Describes a threshold.
    pub fn new<S: Scale>(module: &str, name: &'static str, value: S, doc: &str) -> Self {
        let module = module.split_once("::").map_or("", |(_, module)| module);
        Self {
            folder: module.trim_end_matches("::thresholds").replace("::", "/"),
            name,
            value: value.text(),
            doc: String::from(doc.trim()),
            scaled: FACTORS.map(|factor| value.scaled(factor).text()),
        }
    }
}

/// Value that a factor multiplies.
pub trait Scale: Copy {
    /// Value times a factor; integers are rounded and saturate.
    fn scaled(self, factor: f64) -> Self;
    /// Value as text.
    fn text(self) -> String;
}

macro_rules! scale {
    ($($kind:ty: $round:expr),*) => { $(
        impl Scale for $kind {
            fn scaled(self, factor: f64) -> Self {
                ($round)(self as f64 * factor) as Self
            }

            fn text(self) -> String {
                format!("{self}")
            }
        }
    )* };
}

// Integers are rounded half away from zero.
scale!(f32: core::convert::identity, f64: core::convert::identity);
scale!(i8: libm::round, i32: libm::round, i64: libm::round);
scale!(u8: libm::round, u16: libm::round, u32: libm::round, u64: libm::round, usize: libm::round);

impl<S: Scale, const N: usize> Scale for [S; N] {
    fn scaled(self, factor: f64) -> Self {
        self.map(|value| value.scaled(factor))
    }

    fn text(self) -> String {
        self.map(Scale::text).join(" to ")
    }
}

/// Name and factor of the environment variable.
static OVERRIDE: LazyLock<Option<(String, f64)>> = LazyLock::new(|| {
    let text = std::env::var(VARIABLE).ok()?;
    let parsed = text.rsplit_once('=').and_then(|(name, factor)| Some((String::from(name), factor.parse().ok()?)));
    let Some((name, factor)) = parsed else { panic!("{VARIABLE} is `NAME=FACTOR`, not `{text}`") };
    let names: Vec<&str> = crate::thresholds().iter().map(|threshold| threshold.name).collect();
    assert!(names.contains(&name.as_str()), "{VARIABLE} names no threshold: `{name}`");
    Some((name, factor))
});

/// Value of a threshold under the factor of the environment variable.
pub fn overridden<S: Scale>(value: S, name: &str) -> S {
    match &*OVERRIDE {
        Some((overridden, factor)) if overridden == name => value.scaled(*factor),
        _ => value,
    }
}
