//! What an image did against a rule of the manual: which register, from where, which rule. Nothing is tolerated: a run with
//! any of these has failed.

use std::fmt;

/// A rule that was broken.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Violation {
    /// The register, or what else was touched.
    pub register: String,
    /// Where the block of instructions begins that did it.
    pub pc: u32,
    /// What is wrong.
    pub what: String,
    /// Manual and section of the rule.
    pub section: &'static str,
    /// How often.
    pub times: u32,
}

impl fmt::Display for Violation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} at {:#010x}: {} ({}, {} times)", self.register, self.pc, self.what, self.section, self.times)
    }
}

/// All of a run, each kind once.
#[derive(Debug, Default)]
pub struct Violations(Vec<Violation>);

impl Violations {
    /// Notes one.
    pub fn add(&mut self, register: &str, pc: u32, what: impl Into<String>, section: &'static str) {
        let what = what.into();
        let same = |known: &&mut Violation| known.register == register && known.what == what;
        match self.0.iter_mut().find(same) {
            Some(known) => known.times += 1,
            None => self.0.push(Violation { register: register.to_owned(), pc, what, section, times: 1 }),
        }
    }

    /// All so far.
    pub fn all(&self) -> &[Violation] {
        &self.0
    }
}
