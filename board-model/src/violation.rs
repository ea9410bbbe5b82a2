//! Violations of the manuals' rules by an image: register, code address, rule. A run with any violation has failed.

use std::fmt;

/// Violation of a rule.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Violation {
    /// Register, or other resource.
    pub register: String,
    /// Start address of the block of instructions.
    pub pc: u32,
    /// Description.
    pub what: String,
    /// Manual and section of the rule.
    pub section: &'static str,
    /// Number of occurrences.
    pub times: u32,
}

impl fmt::Display for Violation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} at {:#010x}: {} ({}, {} times)", self.register, self.pc, self.what, self.section, self.times)
    }
}

/// Violations of a run, each kind once.
#[derive(Debug, Default)]
pub struct Violations(Vec<Violation>);

impl Violations {
    /// Adds a violation, or counts a known one.
    pub fn add(&mut self, register: &str, pc: u32, what: impl Into<String>, section: &'static str) {
        let what = what.into();
        let same = |known: &&mut Violation| known.register == register && known.what == what;
        match self.0.iter_mut().find(same) {
            Some(known) => known.times += 1,
            None => self.0.push(Violation { register: register.to_owned(), pc, what, section, times: 1 }),
        }
    }

    /// Violations so far.
    pub fn all(&self) -> &[Violation] {
        &self.0
    }
}
