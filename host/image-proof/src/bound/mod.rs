//! Upper bound on the instructions and cycles of a step, from the linked image alone: no state, tried or not, can
//! exceed it (`worst_case` searches for the worst one).
//!
//! From a step's entry, `longest` follows every path through the machine code that the known values allow. Known are
//! constants, the tables of the joint, which lie in the image and are never written, and values computed from them;
//! torques and state are unknown. Loop counters are therefore known in every round, and branches that depend only on
//! the tables go one way. A loop without a provable limit is an error with its place in the source.
//!
//! `operation` decodes, `machine` propagates values through an instruction, `live` finds the registers still used,
//! `graph` is the control flow of a function, `cycles` the table of the Cortex-M4, `source` the debug information.
//!
//! Assumptions: pointers of safe code stay within their objects; the caller's arguments are the joint's model and its
//! torques, the model aligned as its type requires.

mod cycles;
mod graph;
mod live;
mod longest;
mod machine;
mod operation;
mod source;

use std::fmt;
use std::fs;
use std::path::Path;

use longest::{LongestPath, NoBound, PathSearch};
use machine::Machine;
use source::Source;

use crate::tick::functions::{Function, Functions};
use crate::worst_case;
use report::failure::{Failure, Outcome};

/// Step that the search calls: its path, and its name in the debug information without the number of planets.
const STEP: (&str, &str) = ("worst_case::measurement::step", "step");
/// Limit of a bound over the worst state found; a bound above it is too loose to be useful.
const MAX_BOUND_RATIO: f64 = 1.3;
/// Assumed addresses of stack and model, well apart. Only their alignment matters, which is that of their types.
const STACK_TOP: u32 = 0x2001_0000;
const STACK_BOTTOM: u32 = STACK_TOP - 0x4000;
const MODEL_ADDRESS: u32 = STACK_TOP - 0x8000;

/// Bound of a joint's step.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Bound {
    /// Name of the joint.
    pub name: String,
    /// Upper bound on instructions.
    pub instructions: u32,
    /// Upper bound on cycles of a Cortex-M4 without wait states, not necessarily of the path with the most
    /// instructions.
    pub cycles: u32,
    /// Number of functions that the step can reach.
    pub functions: usize,
    /// Loops of these functions by their place in the source, with their largest number of rounds.
    pub loops: Vec<(String, u32)>,
}

/// Bounds of the steps of all joints in the worst-case image, in the order of `searched`.
pub fn bound_steps(elf: &Path, searched: &[worst_case::SearchResult]) -> Outcome<Vec<Bound>> {
    let failed = |why: String| Failure::new(format!("{}: {why}", elf.display()));
    let bytes = fs::read(elf).map_err(|error| failed(error.to_string()))?;
    let functions = Functions::read(&bytes).map_err(failed)?;
    let source = Source::read(&bytes).map_err(failed)?;
    let of_joint = |(index, joint): (usize, &worst_case::SearchResult)| {
        let missing = |what: String| {
            failed(format!("cannot find {what} of joint {}", joint.name))
                .with_help("the image must keep its symbols and its debug information")
        };
        let step = step(&functions, &source, joint.planets).ok_or_else(|| missing("the step".into()))?;
        let place = format!("joint_{index}::TABLES");
        let tables = functions.objects().find(|(name, _)| name.ends_with(&place));
        let (_, tables) = tables.ok_or_else(|| missing(format!("the data {place}")))?;
        let model = format!("Model<f32, {}>", joint.planets);
        let member = source.offset(&model, "tables").ok_or_else(|| missing(format!("member tables of {model}")))?;
        let mut machine = Machine::with_stack(STACK_TOP);
        machine.set(0, Some(MODEL_ADDRESS));
        machine.write(Some(MODEL_ADDRESS + member), 4, Some(tables));
        let longest = PathSearch::new(&functions, STACK_BOTTOM).run(step.address, machine);
        let longest = longest.map_err(|refused| refusal(&joint.name, &functions, &source, refused))?;
        Ok(Bound::new(&joint.name, longest, &source))
    };
    searched.iter().enumerate().map(of_joint).collect()
}

/// Step of a joint with a number of planets.
fn step<'a>(functions: &'a Functions, source: &Source<'_>, planets: u32) -> Option<&'a Function> {
    let (path, name) = STEP;
    let symbols = source.symbols(&format!("{name}<{planets}>"));
    functions.all().find(|function| function.name == path && symbols.contains(&function.symbol))
}

fn refusal(joint: &str, functions: &Functions, source: &Source<'_>, refused: NoBound) -> Failure {
    let at = refused.at();
    let function = functions.all().find(|function| (function.address..function.end).contains(&at));
    let function = function.map_or("no function", |function| function.name.as_str());
    let line = source.line(at).unwrap_or_else(|| "no line".into());
    let (what, help) = match refused {
        NoBound::UnboundedLoop(_) => {
            ("a loop has no provable limit", "make the loop count up to a literal or to a value of the joint's tables")
        }
        NoBound::IrreducibleLoop(_) => ("a loop has more than one entry", "write it as one loop with one head"),
        NoBound::UnknownTarget(_) => {
            ("a jump has an unknown target", "call through a generic parameter instead of a pointer")
        }
        NoBound::UnknownInstruction(_) => {
            ("an instruction is unknown", "add it to host/image-proof/src/bound/operation.rs")
        }
        NoBound::Recursion(_) => ("a function is recursive", "replace the recursion by a bounded loop"),
        NoBound::ReachablePanic(_) => {
            ("a panic or a trap can be reached", "use `get`, `checked_...` and `match` instead of code that can panic")
        }
    };
    Failure::check_failed(format!("joint {joint}: the step has no bound: {what} at {at:#010x}, in {function}, {line}"))
        .with_help(help)
}

/// Fails if a state exceeds its bound, or if a bound is too loose. Returns a line per joint.
pub fn check(bounds: &[Bound], searched: &[worst_case::SearchResult]) -> Outcome<Vec<String>> {
    bounds
        .iter()
        .zip(searched)
        .map(|(bound, search)| {
            let Bound { name, instructions, .. } = bound;
            let most = search.most();
            if most > *instructions {
                return Err(Failure::check_failed(format!(
                    "joint {name}: a step took {most} instructions, more than its bound of {instructions}:\n{}",
                    search.state
                ))
                .with_help("host/image-proof/src/bound models an instruction wrongly: correct it until it allows this step"));
            }
            let times = f64::from(*instructions) / f64::from(most.max(1));
            if times > MAX_BOUND_RATIO {
                return Err(Failure::check_failed(format!(
                    "joint {name}: the bound of a step is {instructions} instructions, {times:.2} times the worst step found"
                ))
                .with_help(format!(
                    "the limit is {MAX_BOUND_RATIO} times: search for worse states, or merge branches that exclude each other"
                )));
            }
            Ok(format!("{bound}; {times:.2} times the worst found, {most}"))
        })
        .collect()
}

impl Bound {
    fn new(name: &str, longest: LongestPath, source: &Source<'_>) -> Self {
        let line = |head: u32| source.line(head).unwrap_or_else(|| format!("{head:#010x}"));
        Self {
            name: name.to_owned(),
            instructions: longest.cost.instructions,
            cycles: longest.cost.cycles,
            functions: longest.functions.len(),
            loops: longest.loops.into_iter().map(|(head, rounds)| (line(head), rounds)).collect(),
        }
    }
}

impl fmt::Display for Bound {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { name, instructions, cycles, functions, loops } = self;
        let rounds = loops.iter().map(|(_, rounds)| *rounds).max().unwrap_or(0);
        write!(
            f,
            "{name}: a step takes at most {instructions} instructions, {cycles} cycles of a Cortex-M4 without wait states \
             ({functions} functions, {} loops of at most {rounds} rounds)",
            loops.len()
        )
    }
}

#[cfg(test)]
mod tests;
