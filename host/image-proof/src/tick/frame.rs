//! Analysis of one function: its largest stack depth, its calls with the depth at each, and every instruction that
//! cannot be followed. All paths through its instructions are visited.

use std::collections::{BTreeMap, BTreeSet};

use super::functions::{Function, Functions};
use super::thumb::{Flow, StackEffect};

/// Limit of a function's own stack; a larger one grows in a loop [byte].
const MAX_FRAME_BYTES: u32 = 64 * 1024;

/// Call, or jump into another function.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Call {
    /// Address of the call.
    pub from: u32,
    /// Address of the callee.
    pub to: u32,
    /// Stack held by the caller at the call [byte].
    pub depth: u32,
}

/// Instruction that cannot be followed or must not be reached.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Obstacle {
    /// Call or jump through a pointer.
    Pointer(u32),
    /// The stack pointer is set to an unknown value, or moved in a loop.
    StackEffect(u32),
    /// Instruction that stops the processor.
    Trap(u32),
    /// Address without an instruction.
    NoInstruction(u32),
}

impl Obstacle {
    /// Address of the instruction.
    pub fn at(self) -> u32 {
        match self {
            Self::Pointer(at) | Self::StackEffect(at) | Self::Trap(at) | Self::NoInstruction(at) => at,
        }
    }
}

/// Result of the analysis of one function.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct StackFrame {
    /// Largest stack of the function itself [byte].
    pub depth: u32,
    /// Calls of the function.
    pub calls: Vec<Call>,
    /// Instructions that prevent an answer.
    pub obstacles: Vec<Obstacle>,
}

/// Visits every path through a function. `returns` tells which callees return.
pub fn frame(functions: &Functions, function: &Function, returns: &dyn Fn(u32) -> bool) -> StackFrame {
    let conditional = conditional(function);
    let mut frame = StackFrame::default();
    let mut depths: BTreeMap<u32, u32> = BTreeMap::new();
    let mut open = vec![(function.address, 0)];
    let mut calls = BTreeMap::new();
    while let Some((address, depth)) = open.pop() {
        if depths.get(&address).is_some_and(|known| *known >= depth) {
            continue;
        }
        depths.insert(address, depth);
        let Some(instruction) = function.code.get(&address) else {
            frame.obstacles.push(Obstacle::NoInstruction(address));
            continue;
        };
        let may_be_skipped = conditional.contains(&address);
        let after = match instruction.stack {
            StackEffect::Same => depth,
            StackEffect::Grow(bytes) => depth + bytes,
            StackEffect::Shrink(_) if may_be_skipped => depth,
            StackEffect::Shrink(bytes) => depth.saturating_sub(bytes),
            StackEffect::Unknown => {
                frame.obstacles.push(Obstacle::StackEffect(address));
                continue;
            }
        };
        if after > MAX_FRAME_BYTES {
            frame.obstacles.push(Obstacle::StackEffect(address));
            continue;
        }
        frame.depth = frame.depth.max(after);
        let mut call = |to: u32| {
            calls.insert((address, to), after.max(calls.get(&(address, to)).copied().unwrap_or(0)));
        };
        let next = address + instruction.size;
        let inside = |to: u32| (function.address..function.end).contains(&to);
        let mut goes_on = may_be_skipped;
        match instruction.flow {
            Flow::Next => goes_on = true,
            Flow::Branch(to) | Flow::Jump(to) => {
                if inside(to) {
                    open.push((to, after))
                } else {
                    call(to)
                }
                goes_on |= matches!(instruction.flow, Flow::Branch(_));
            }
            Flow::Call(to) => {
                call(to);
                goes_on |= returns(to);
            }
            Flow::Table { width, base } => {
                let targets = targets(functions, function, next, width, base);
                if targets.is_empty() {
                    frame.obstacles.push(Obstacle::Pointer(address));
                }
                open.extend(targets.into_iter().map(|to| (to, after)));
            }
            Flow::CallRegister | Flow::JumpRegister => frame.obstacles.push(Obstacle::Pointer(address)),
            Flow::Return => {}
            Flow::Trap => frame.obstacles.push(Obstacle::Trap(address)),
        }
        if goes_on {
            open.push((next, after));
        }
    }
    frame.calls = calls.into_iter().map(|((from, to), depth)| Call { from, to, depth }).collect();
    frame.obstacles.sort_by_key(|obstacle| obstacle.at());
    frame.obstacles.dedup();
    frame
}

/// Instructions in `it` blocks.
fn conditional(function: &Function) -> BTreeSet<u32> {
    let (mut found, mut left) = (BTreeSet::new(), 0);
    for (address, instruction) in &function.code {
        if left > 0 {
            found.insert(*address);
            left -= 1;
        }
        left = left.max(instruction.conditional_next);
    }
    found
}

/// Targets of a `tbb` or `tbh`, from distances to the instruction after it. The table follows the instruction, or its
/// address is loaded into the register somewhere in the function; every such address is considered. A table ends with
/// the last entry that leads to an instruction, or where instructions begin again.
pub fn targets(functions: &Functions, function: &Function, next: u32, width: u32, base: u16) -> Vec<u32> {
    let loaded = function.code.values().filter_map(|instruction| instruction.address_of);
    let tables = match base {
        15 => vec![next],
        _ => loaded.filter(|(register, _)| *register == base).map(|(_, table)| table).collect(),
    };
    let entries = |table: u32| {
        let constants = (table..function.end).step_by(width as usize);
        constants.take_while(|entry| !function.code.contains_key(entry)).map_while(|entry| {
            let distance = if width == 1 { functions.byte(entry)?.into() } else { functions.half(entry)? };
            let to = next + 2 * u32::from(distance);
            function.code.contains_key(&to).then_some(to)
        })
    };
    tables.into_iter().flat_map(entries).collect()
}
