//! Call graph of the tick: the shortest call path to every panic, code that cannot be followed, recursion, and the
//! deepest stack. `tick::judge` decides about them.

use std::collections::{BTreeMap, VecDeque};

use super::frame::{Obstacle, StackFrame, frame};
use super::functions::{Function, Functions};

/// Parts of the names of functions that panic or only lead to a panic. All of them end in the first two; the others
/// give a better name, since a path ends at the first match.
const PANICS: [&str; 8] = [
    "core::panicking::",
    "rust_begin_unwind",
    "unwrap_failed",
    "expect_failed",
    "core::slice::index::",
    "core::str::slice_error",
    "core::cell::panic_already",
    "_defmt_panic",
];

/// Call path from the handler to an address.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct CallPath {
    /// Names of the functions, the handler first.
    pub names: Vec<String>,
    /// Address in the last function, or in the last but one if the last must not be called.
    pub at: u32,
}

/// Reach of the tick.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Reach {
    /// Number of reachable functions, including the handler.
    pub functions: usize,
    /// Call path to each panic.
    pub panics: Vec<CallPath>,
    /// Call path to each call through a pointer.
    pub pointers: Vec<CallPath>,
    /// Call path to each instruction that stops the processor.
    pub traps: Vec<CallPath>,
    /// Call path to each address where the stack or the next instruction is unknown.
    pub unknown: Vec<CallPath>,
    /// Rings of recursive calls, in order of the calls.
    pub rings: Vec<Vec<String>>,
    /// Largest stack of the handler and its callees, without the interrupt frame [byte]. Meaningless if there are
    /// rings, pointers or unknown addresses.
    pub stack: u32,
    /// Calls on the deepest path, each with the stack held at the next call.
    pub deepest: Vec<(String, u32)>,
}

/// Returns whether a name is that of a panic.
pub fn is_panic(name: &str) -> bool {
    PANICS.iter().any(|panic| name.contains(panic))
}

/// Walks the call graph from a handler.
pub fn walk(functions: &Functions, handler: &Function) -> Reach {
    let returns = |to: u32| functions.at(to).is_none_or(|callee| !is_panic(&callee.name));
    let mut frames: BTreeMap<u32, StackFrame> = BTreeMap::new();
    // Caller and call address of every function.
    let mut came_from: BTreeMap<u32, (u32, u32)> = BTreeMap::new();
    let mut open = VecDeque::from([handler.address]);
    let mut reach = Reach::default();
    let path = |to: u32, at: u32, came_from: &BTreeMap<u32, (u32, u32)>| {
        let mut path = vec![to];
        while let Some((caller, _)) = path.last().and_then(|last| came_from.get(last)) {
            path.push(*caller);
        }
        CallPath { names: path.iter().rev().map(|address| name_of(functions, *address)).collect(), at }
    };
    while let Some(address) = open.pop_front() {
        if frames.contains_key(&address) {
            continue;
        }
        let Some(function) = functions.at(address) else {
            reach.unknown.push(path(address, address, &came_from));
            frames.insert(address, StackFrame::default());
            continue;
        };
        if is_panic(&function.name) {
            let at = came_from.get(&address).map_or(address, |(_, at)| *at);
            reach.panics.push(path(address, at, &came_from));
            frames.insert(address, StackFrame::default());
            continue;
        }
        let own = frame(functions, function, &returns);
        for obstacle in &own.obstacles {
            let list = match obstacle {
                Obstacle::Pointer(_) => &mut reach.pointers,
                Obstacle::Trap(_) => &mut reach.traps,
                Obstacle::StackEffect(_) | Obstacle::NoInstruction(_) => &mut reach.unknown,
            };
            list.push(path(address, obstacle.at(), &came_from));
        }
        for call in &own.calls {
            let callee = call.to & !1;
            if callee != handler.address {
                came_from.entry(callee).or_insert((address, call.from));
            }
            open.push_back(callee);
        }
        frames.insert(address, own);
    }
    reach.functions = frames.len();
    let mut depths = Depths { functions, frames: &frames, known: BTreeMap::new(), path: Vec::new(), rings: Vec::new() };
    reach.stack = depths.depth_of(handler.address).0;
    reach.deepest = depths.deepest(handler.address);
    reach.rings = depths.rings;
    reach
}

fn name_of(functions: &Functions, address: u32) -> String {
    functions.at(address).map_or_else(|| format!("{address:#010x}"), |function| function.name.clone())
}

/// Deepest stack of every function with its callees.
struct Depths<'a> {
    functions: &'a Functions,
    frames: &'a BTreeMap<u32, StackFrame>,
    /// Depth, and the callee that causes it with the stack held at its call.
    known: BTreeMap<u32, (u32, Option<(u32, u32)>)>,
    path: Vec<u32>,
    rings: Vec<Vec<String>>,
}

impl Depths<'_> {
    fn depth_of(&mut self, address: u32) -> (u32, Option<(u32, u32)>) {
        if let Some(known) = self.known.get(&address) {
            return *known;
        }
        if let Some(start) = self.path.iter().position(|earlier| *earlier == address) {
            let ring = self.path[start..].iter().chain([&address]);
            self.rings.push(ring.map(|address| name_of(self.functions, *address)).collect());
            return (0, None);
        }
        self.path.push(address);
        let frame = &self.frames[&address];
        let mut deepest = (frame.depth, None);
        for call in &frame.calls {
            let callee = call.to & !1;
            let depth = call.depth + self.depth_of(callee).0;
            if depth > deepest.0 {
                deepest = (depth, Some((callee, call.depth)));
            }
        }
        self.path.pop();
        self.known.insert(address, deepest);
        deepest
    }

    fn deepest(&self, from: u32) -> Vec<(String, u32)> {
        let (mut steps, mut address) = (Vec::new(), from);
        while let Some((depth, next)) = self.known.get(&address) {
            steps.push((name_of(self.functions, address), next.map_or(*depth, |(_, held)| held)));
            match next {
                // A ring would never end.
                Some((callee, _)) if steps.len() <= self.known.len() => address = *callee,
                _ => break,
            }
        }
        steps
    }
}
