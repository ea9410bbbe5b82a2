//! Proves that the tick cannot panic and bounds its stack, from the linked image: all calls from the tick's handler
//! are followed, so that the result holds for any sources and compiler.
//!
//! `functions` disassembles the image, `thumb` decodes instructions, `frame` analyses one function, `walk` the call
//! graph; this file compares the result with the promised bounds. Code that cannot be followed is an error.

pub(crate) mod frame;
pub(crate) mod functions;
pub(crate) mod thumb;
pub(crate) mod walk;

use std::fs;
use std::path::Path;

use functions::Functions;
pub use walk::{CallPath, Reach};

use report::failure::{Failure, Outcome};

/// Limit of the tick's stack, including the interrupt frame [byte].
pub const STACK_BOUND: u32 = 2048;
/// Interrupt frame: 26 words with the floating-point registers, and one for alignment [byte].
const INTERRUPT_FRAME: u32 = 27 * 4;

/// Exception whose handler a tick begins with.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Exception {
    /// Role `drive`: the handler of SysTick requests the tick by PendSV.
    PendSv = 14,
    /// Other roles.
    SysTick = 15,
}

/// Analyses the tick of a role's image from the handler of an exception on.
pub fn reach(elf: &Path, exception: Exception) -> Outcome<Reach> {
    let failed = |why: String| Failure::new(format!("{}: {why}", elf.display()));
    let bytes = fs::read(elf).map_err(|error| failed(error.to_string()))?;
    let functions = Functions::read(&bytes).map_err(failed)?;
    let handler = functions.handler(exception as u8).ok_or_else(|| {
        failed(format!("its vector table names no function for {exception:?}"))
            .with_help(format!("the image must bind the tick to {exception:?} and keep its symbols"))
    })?;
    Ok(walk::walk(&functions, handler))
}

/// Largest stack of the tick, including the interrupt frame [byte].
pub fn stack(reach: &Reach) -> u32 {
    reach.stack + INTERRUPT_FRAME
}

/// Fails with all violations, each with its call path from the tick and its help.
pub fn check(reach: &Reach) -> Outcome<()> {
    let mut violations = Vec::new();
    let mut helps: Vec<&str> = Vec::new();
    let mut add_violation = |what: String, help: &'static str| {
        violations.push(what);
        if !helps.contains(&help) {
            helps.push(help);
        }
    };
    let found = [
        (
            &reach.panics,
            "the tick can panic, by the call",
            "in the function before the panic, use `get`, `checked_...` and `match` instead of indexing, division and unwrap",
        ),
        (&reach.traps, "the tick can stop the processor", "remove the `unreachable`, abort or breakpoint"),
        (
            &reach.pointers,
            "the tick calls through a pointer",
            "call through a generic parameter instead of `dyn` or a function pointer",
        ),
    ];
    for (paths, what, help) in found {
        for path in paths {
            add_violation(format!("{what} at {:#010x}: {}", path.at, joined_path(&path.names)), help);
        }
    }
    for ring in &reach.rings {
        add_violation(
            format!("the tick can call in a ring: {}", joined_path(ring)),
            "replace the recursion by a bounded loop",
        );
    }
    for path in &reach.unknown {
        add_violation(
            format!("the effect of the code at {:#010x} is unknown: {}", path.at, joined_path(&path.names)),
            "keep hand-written assembly and memory of unknown size out of the tick",
        );
    }
    let stack = stack(reach);
    let parts: Vec<_> = reach.deepest.iter().map(|(name, held)| format!("{name} {held} B")).collect();
    if stack > STACK_BOUND {
        add_violation(
            format!("the tick can use {stack} B of stack, more than {STACK_BOUND} B: {}", joined_path(&parts)),
            "make the arrays on this path smaller, or pass them by reference",
        );
    }
    match violations.is_empty() {
        true => Ok(()),
        false => Err(Failure::check_failed(violations.join("\n")).with_help(helps.join("\n"))),
    }
}

fn joined_path(path: &[String]) -> String {
    path.join(" -> ")
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A tick within its bounds passes; each kind of violation fails by itself.
    #[test]
    fn each_violation_fails_alone() {
        let sound = Reach { functions: 3, stack: 900, deepest: vec![("SysTick".into(), 900)], ..Reach::default() };
        assert!(check(&sound).is_ok());
        let names = vec!["SysTick".to_owned(), "control::tick".to_owned(), "core::panicking::panic".to_owned()];
        let path = CallPath { names: names.clone(), at: 0x0800_1000 };
        let faults = [
            Reach { panics: vec![path.clone()], ..sound.clone() },
            Reach { pointers: vec![path.clone()], ..sound.clone() },
            Reach { traps: vec![path.clone()], ..sound.clone() },
            Reach { unknown: vec![path], ..sound.clone() },
            Reach { rings: vec![names], ..sound.clone() },
            Reach { stack: STACK_BOUND, ..sound },
        ];
        for fault in faults {
            let failure = check(&fault).unwrap_err();
            assert!(failure.message().contains("SysTick") && failure.help().is_some(), "{failure}");
            assert_eq!(failure.exit_code(), 1);
        }
    }

    /// The failure names the file that is no image.
    #[test]
    fn non_image_named() {
        let failure = reach(Path::new("/proc/self/status"), Exception::SysTick).unwrap_err();
        assert!(failure.message().contains("/proc/self/status"), "{failure}");
    }
}
