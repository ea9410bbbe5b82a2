//! Longest path through the image from an entry: paths that known values exclude are pruned, loops are unrolled round
//! by round, calls are inlined, and at joins the larger count is kept. The result is the longest path over the unrolled
//! control flow, exact for the known values.
//!
//! A place is a sequence of calls, of loops with their rounds, and of an instruction's position in its function.
//! Positions grow along every path (`graph`) and rounds grow too, so that the lexicographic order of the sequences
//! visits every predecessor of a place before the place.

use std::collections::btree_map::Entry;
use std::collections::{BTreeMap, BTreeSet};
use std::rc::Rc;

use super::cycles;
use super::graph::Graph;
use super::live::{Effect, RegisterSet, effect};
use super::machine::{Constants, Machine, condition_holds};
use super::operation::{Operation, Register, operation};
use crate::tick::frame::targets;
use crate::tick::functions::{Function, Functions};
use crate::tick::thumb::Flow;
use crate::tick::walk::is_panic;

/// Limit of separate states at a join; the most similar ones above it are merged.
const MAX_STATES_AT_JOIN: usize = 4;
/// Limit of rounds of a loop; a loop above it counts as unbounded.
const MAX_ROUNDS: u32 = 1024;

/// Reason for which there is no bound.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum NoBound {
    /// Loop without a provable limit.
    UnboundedLoop(u32),
    /// Loop with more than one entry.
    IrreducibleLoop(u32),
    /// Jump to an unknown target.
    UnknownTarget(u32),
    /// Unknown instruction.
    UnknownInstruction(u32),
    /// Recursive function.
    Recursion(u32),
    /// Reachable panic or trap.
    ReachablePanic(u32),
}

impl NoBound {
    /// Address of the instruction.
    pub fn at(&self) -> u32 {
        match *self {
            Self::UnboundedLoop(at)
            | Self::IrreducibleLoop(at)
            | Self::UnknownTarget(at)
            | Self::UnknownInstruction(at)
            | Self::Recursion(at)
            | Self::ReachablePanic(at) => at,
        }
    }
}

/// Costs of a path.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Cost {
    /// Instructions, including those skipped by a condition.
    pub instructions: u32,
    /// Cycles of a Cortex-M4 without wait states.
    pub cycles: u32,
}

impl Cost {
    fn max(self, other: Self) -> Self {
        Self { instructions: self.instructions.max(other.instructions), cycles: self.cycles.max(other.cycles) }
    }
}

/// Result of the search.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct LongestPath {
    /// Largest costs; instructions and cycles may belong to different paths.
    pub cost: Cost,
    /// Loops by their heads, with the largest number of rounds that the known values allow.
    pub loops: BTreeMap<u32, u32>,
    /// Entries of all visited functions.
    pub functions: BTreeSet<u32>,
}

/// Call on the stack of calls.
#[derive(Debug, Clone, PartialEq, Eq)]
struct CallFrame {
    function: u32,
    rounds: Vec<(u32, u32)>,
    /// Address of the call.
    at: u32,
    /// Return address; `None` after a jump into another function.
    back: Option<u32>,
}

/// Place in the unrolled control flow.
#[derive(Debug, Clone, PartialEq, Eq)]
struct Place {
    callers: Rc<Vec<CallFrame>>,
    function: u32,
    rounds: Vec<(u32, u32)>,
    at: u32,
}

/// Key that orders places.
type Key = Vec<u32>;

#[derive(Debug, Clone)]
struct State {
    machine: Machine,
    cost: Cost,
    /// Registers whose values arrive one cycle late for the next instruction.
    late: RegisterSet,
}

/// Search for the longest path.
pub struct PathSearch<'a> {
    functions: &'a Functions,
    graphs: BTreeMap<u32, Graph>,
    queued: BTreeMap<Key, (Place, Vec<State>)>,
    /// States at the head of a loop one round earlier.
    heads: BTreeMap<Key, Vec<Machine>>,
    stack_bottom: u32,
    found: LongestPath,
    end: Option<State>,
}

impl Constants for Functions {
    fn byte(&self, address: u32) -> Option<u8> {
        self.constant_byte(address)
    }
}

impl<'a> PathSearch<'a> {
    /// Search over an image whose stack ends at `lowest_stack`.
    pub fn new(functions: &'a Functions, stack_bottom: u32) -> Self {
        Self {
            functions,
            graphs: BTreeMap::new(),
            queued: BTreeMap::new(),
            heads: BTreeMap::new(),
            stack_bottom,
            found: LongestPath::default(),
            end: None,
        }
    }

    /// Longest path from a function's entry to its return.
    pub fn run(mut self, entry: u32, machine: Machine) -> Result<LongestPath, NoBound> {
        let callers = Rc::new(Vec::new());
        let state = State { machine, cost: Cost::default(), late: RegisterSet::default() };
        self.enter(callers, entry & !1, entry, state)?;
        while let Some((key, (place, states))) = self.queued.pop_first() {
            let states = self.merge_states(&place, states);
            self.check_loop(&key, &place, &states)?;
            for state in states {
                self.follow_path(place.clone(), state)?;
            }
        }
        if let Some(end) = self.end {
            self.found.cost = end.cost;
        }
        Ok(self.found)
    }

    fn graph(&mut self, function: &Function) -> Result<&Graph, NoBound> {
        let functions = self.functions;
        Ok(match self.graphs.entry(function.address) {
            Entry::Occupied(known) => known.into_mut(),
            Entry::Vacant(place) => {
                let returns = |to: u32| functions.at(to).is_none_or(|callee| !is_panic(&callee.name));
                let graph = Graph::new(functions, function, &returns);
                place.insert(graph.map_err(|found| NoBound::IrreducibleLoop(found.at))?)
            }
        })
    }

    fn key(&self, place: &Place) -> Key {
        let mut key = Vec::new();
        let mut add = |function: u32, rounds: &[(u32, u32)], at: u32| {
            let graph = &self.graphs[&function];
            key.push(function);
            for (head, round) in rounds {
                key.extend([graph.place(*head), *round]);
            }
            key.push(graph.place(at));
        };
        for frame in place.callers.iter() {
            add(frame.function, &frame.rounds, frame.at);
        }
        add(place.function, &place.rounds, place.at);
        key
    }

    /// Reduces the states at a join: dead registers are forgotten, and equal states are merged.
    fn merge_states(&self, place: &Place, states: Vec<State>) -> Vec<State> {
        let live = self.graphs[&place.function].live(place.at);
        let mut kept: Vec<State> = Vec::new();
        for mut state in states {
            state.machine.keep_registers(live);
            state.machine.drop_dead_stack(self.stack_bottom);
            match kept.iter_mut().find(|other| other.machine == state.machine) {
                Some(other) => other.take_larger(state),
                None => kept.push(state),
            }
        }
        while kept.len() > MAX_STATES_AT_JOIN {
            let pairs = (0..kept.len()).flat_map(|one| (one + 1..kept.len()).map(move |other| (one, other)));
            let nearest = pairs.min_by_key(|(one, other)| kept[*one].machine.distance(&kept[*other].machine));
            let Some((one, other)) = nearest else { break };
            let removed = kept.swap_remove(other);
            kept[one].machine.join(&removed.machine);
            kept[one].take_larger(removed);
        }
        kept
    }

    /// Counts rounds, and rejects a loop whose state repeats.
    fn check_loop(&mut self, key: &Key, place: &Place, states: &[State]) -> Result<(), NoBound> {
        let Some((_, round)) = place.rounds.last().filter(|(head, _)| *head == place.at) else { return Ok(()) };
        let most = self.found.loops.entry(place.at).or_default();
        *most = (*most).max(round + 1);
        let mut without_round = key.clone();
        let last = without_round.len() - 2;
        without_round[last] = 0;
        let now: Vec<Machine> = states.iter().map(|state| state.machine.clone()).collect();
        let before = self.heads.insert(without_round, now);
        if *round == 0 {
            return Ok(());
        }
        let nothing_new = before.is_some_and(|before| states.iter().all(|state| before.contains(&state.machine)));
        if nothing_new || *round >= MAX_ROUNDS { Err(NoBound::UnboundedLoop(place.at)) } else { Ok(()) }
    }

    /// Moves a state to an instruction; at a join the state is queued until all predecessors are done.
    fn advance(&mut self, place: &Place, to: u32, state: State) -> Option<(Place, State)> {
        let graph = &self.graphs[&place.function];
        let mut rounds = Vec::new();
        let mut is_same = true;
        for (depth, head) in graph.loops(to).iter().enumerate() {
            let before = place.rounds.get(depth).filter(|(old, _)| is_same && old == head);
            match before {
                Some((_, round)) if *head == to => {
                    rounds.push((*head, round + 1));
                    is_same = false;
                }
                Some(same) => rounds.push(*same),
                None => {
                    rounds.push((*head, 0));
                    is_same = false;
                }
            }
        }
        let place = Place { callers: Rc::clone(&place.callers), function: place.function, rounds, at: to };
        if graph.is_join(to) {
            self.queue(place, state);
            return None;
        }
        Some((place, state))
    }

    fn queue(&mut self, place: Place, state: State) {
        let key = self.key(&place);
        self.queued.entry(key).or_insert_with(|| (place, Vec::new())).1.push(state);
    }

    /// Enters a function.
    fn enter(&mut self, callers: Rc<Vec<CallFrame>>, to: u32, from: u32, state: State) -> Result<(), NoBound> {
        let functions = self.functions;
        let function = functions.at(to).ok_or(NoBound::UnknownTarget(from))?;
        if is_panic(&function.name) {
            return Err(NoBound::ReachablePanic(from));
        }
        if callers.iter().any(|frame| frame.function == function.address) {
            return Err(NoBound::Recursion(from));
        }
        self.found.functions.insert(function.address);
        let rounds = self.graph(function)?.loops(function.address).iter().map(|head| (*head, 0)).collect();
        self.queue(Place { callers, function: function.address, rounds, at: function.address }, state);
        Ok(())
    }

    fn call(&mut self, place: &Place, to: u32, back: Option<u32>, state: State) -> Result<(), NoBound> {
        let mut callers = place.callers.as_ref().clone();
        callers.push(CallFrame { function: place.function, rounds: place.rounds.clone(), at: place.at, back });
        self.enter(Rc::new(callers), to & !1, place.at, state)
    }

    /// Returns to the place of the last call.
    fn return_to_caller(&mut self, place: &Place, state: State) {
        let mut callers = place.callers.as_ref().clone();
        while let Some(frame) = callers.pop() {
            let Some(back) = frame.back else { continue };
            let caller =
                Place { callers: Rc::new(callers), function: frame.function, rounds: frame.rounds, at: frame.at };
            // All returns of a callee join behind the call.
            if let Some((place, state)) = self.advance(&caller, back, state) {
                self.queue(place, state);
            }
            return;
        }
        match &mut self.end {
            Some(end) => end.take_larger(state),
            None => self.end = Some(state),
        }
    }

    /// Follows a path until it branches, joins or ends.
    fn follow_path(&mut self, mut place: Place, mut state: State) -> Result<(), NoBound> {
        let functions = self.functions;
        loop {
            let function = functions.at(place.function).ok_or(NoBound::UnknownTarget(place.at))?;
            let instruction = function.code.get(&place.at).ok_or(NoBound::UnknownTarget(place.at))?;
            let (first, second) = functions.halves(place.at);
            let operation = operation(first, second);
            if operation == Operation::Unknown {
                return Err(NoBound::UnknownInstruction(place.at));
            }
            let next = place.at + instruction.size;
            let condition = self.graphs[&place.function].condition(place.at);
            let meets = condition.map_or(Some(true), |condition| condition_holds(condition, state.machine.flags()));
            let is_plain = instruction.flow == Flow::Next;
            if meets == Some(false) || meets.is_none() && !is_plain {
                let mut skipped = state.clone();
                skipped.count(1);
                skipped.late = RegisterSet::default();
                let advanced = self.advance(&place, next, skipped);
                if meets == Some(false) {
                    let Some(advanced) = advanced else { return Ok(()) };
                    (place, state) = advanced;
                    continue;
                }
                if let Some((place, skipped)) = advanced {
                    self.queue(place, skipped);
                }
            }
            let Effect { uses, .. } = effect(&operation);
            state.cost.cycles += u32::from(state.late.intersects(uses));
            if is_plain {
                let before = (meets.is_none()).then(|| state.machine.clone());
                state.machine.execute(&operation, place.at, condition.is_some(), functions);
                if let Some(before) = before {
                    state.machine.join(&before);
                }
                state.count(cycles::of_operation(&operation));
                state.late = cycles::late_registers(&operation);
                let Some(advanced) = self.advance(&place, next, state) else { return Ok(()) };
                (place, state) = advanced;
                continue;
            }
            state.late = RegisterSet::default();
            let jump = cycles::of_jump(instruction.flow, &operation);
            match instruction.flow {
                Flow::Next => {}
                Flow::Branch(to) => {
                    let zero = (first & 0xf500 == 0xb100).then_some((first & 7) as Register);
                    let taken = match zero {
                        Some(register) => {
                            state.machine.register(register).map(|value| (value == 0) == (first & 0x800 == 0))
                        }
                        None => {
                            let condition = if first >> 11 >= 0b11101 { first >> 6 & 15 } else { first >> 8 & 15 };
                            condition_holds(condition as u8, state.machine.flags())
                        }
                    };
                    let mut goes_on = Vec::new();
                    for (is_taken, to, cycles) in [(true, to, jump), (false, next, 1)] {
                        if taken.is_some_and(|taken| taken != is_taken) {
                            continue;
                        }
                        let mut state = state.clone();
                        if let Some(register) = zero.filter(|_| is_taken == (first & 0x800 == 0)) {
                            state.machine.set(register, Some(0));
                        }
                        state.count(cycles);
                        if function.code.contains_key(&to) {
                            goes_on.extend(self.advance(&place, to, state));
                        } else {
                            self.call(&place, to, None, state)?;
                        }
                    }
                    let last = goes_on.pop();
                    for (place, state) in goes_on {
                        self.queue(place, state);
                    }
                    let Some(last) = last else { return Ok(()) };
                    (place, state) = last;
                    continue;
                }
                Flow::Jump(to) => {
                    state.count(jump);
                    if !function.code.contains_key(&to) {
                        return self.call(&place, to, None, state);
                    }
                    let Some(advanced) = self.advance(&place, to, state) else { return Ok(()) };
                    (place, state) = advanced;
                    continue;
                }
                Flow::Call(to) => {
                    state.count(jump);
                    state.machine.set(14, None);
                    return self.call(&place, to, Some(next), state);
                }
                Flow::CallRegister | Flow::JumpRegister => {
                    let register = (first >> 3 & 15) as Register;
                    let is_branch = first & 0xff00 == 0x4700;
                    let to = state
                        .machine
                        .register(register)
                        .filter(|_| is_branch)
                        .ok_or(NoBound::UnknownTarget(place.at))?;
                    state.count(jump);
                    let back = (instruction.flow == Flow::CallRegister).then_some(next);
                    return self.call(&place, to, back, state);
                }
                Flow::Table { width, base } => {
                    state.count(jump);
                    let index = state.machine.register((second & 15) as Register);
                    let all = targets(functions, function, next, width, base);
                    let to = match index {
                        Some(index) if base == 15 => all.get(index as usize..=index as usize).unwrap_or_default(),
                        _ => &all[..],
                    };
                    if to.is_empty() {
                        return Err(NoBound::UnknownTarget(place.at));
                    }
                    for to in to {
                        if let Some((place, state)) = self.advance(&place, *to, state.clone()) {
                            self.queue(place, state);
                        }
                    }
                    return Ok(());
                }
                Flow::Return => {
                    state.machine.execute(&operation, place.at, condition.is_some(), functions);
                    state.count(jump);
                    self.return_to_caller(&place, state);
                    return Ok(());
                }
                Flow::Trap => return Err(NoBound::ReachablePanic(place.at)),
            }
        }
    }
}

impl State {
    /// Counts an instruction and its cycles.
    fn count(&mut self, cycles: u32) {
        self.cost.instructions += 1;
        self.cost.cycles += cycles;
    }

    /// Takes the larger costs of an equal or merged state.
    fn take_larger(&mut self, other: Self) {
        self.cost = self.cost.max(other.cost);
        self.late = self.late.union(other.late);
    }
}
