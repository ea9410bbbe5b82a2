//! Control flow within a function: its instructions in topological order, its loops, and the joins of its paths.
//! Dominators and order come from `petgraph`.

use std::collections::{BTreeMap, BTreeSet};

use petgraph::algo::{dominators, toposort};
use petgraph::graph::{DiGraph, NodeIndex};
use petgraph::visit::EdgeRef;

use super::live::{self, RegisterSet};
use super::operation::{Operation, operation};
use crate::tick::frame::targets;
use crate::tick::functions::{Function, Functions};
use crate::tick::thumb::Flow;

/// Control flow of a function.
#[derive(Debug)]
pub struct Graph {
    /// Position of every instruction in the order.
    order: BTreeMap<u32, u32>,
    /// Heads of the loops around an instruction, outermost first.
    loops: BTreeMap<u32, Vec<u32>>,
    /// Instructions with more than one predecessor.
    joins: BTreeSet<u32>,
    /// Conditions of the instructions in an `it` block.
    conditions: BTreeMap<u32, u8>,
    /// Registers that are live before an instruction.
    live: BTreeMap<u32, RegisterSet>,
}

/// Loop with more than one entry.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Irreducible {
    /// Address of an instruction in the loop.
    pub at: u32,
}

impl Graph {
    /// Builds the graph of a function. `returns` tells which callees return.
    pub fn new(functions: &Functions, function: &Function, returns: &dyn Fn(u32) -> bool) -> Result<Self, Irreducible> {
        let conditions = conditions(functions, function);
        let mut graph = DiGraph::<u32, ()>::new();
        let mut nodes: BTreeMap<u32, NodeIndex> = BTreeMap::new();
        let mut open = vec![function.address];
        let root = graph.add_node(function.address);
        nodes.insert(function.address, root);
        while let Some(address) = open.pop() {
            for to in successors(functions, function, address, &conditions, returns) {
                let node = *nodes.entry(to).or_insert_with(|| {
                    open.push(to);
                    graph.add_node(to)
                });
                graph.update_edge(nodes[&address], node, ());
            }
        }
        let dominators = dominators::simple_fast(&graph, root);
        let is_back_edge = |from: NodeIndex, to: NodeIndex| {
            dominators.dominators(from).is_some_and(|mut above| above.any(|node| node == to))
        };
        let back: Vec<_> = graph
            .edge_references()
            .filter(|edge| is_back_edge(edge.source(), edge.target()))
            .map(|edge| (edge.source(), edge.target()))
            .collect();
        let forward = graph.filter_map(
            |_, address| Some(*address),
            |edge, ()| graph.edge_endpoints(edge).filter(|ends| !back.contains(ends)).map(|_| ()),
        );
        let order = toposort(&forward, None).map_err(|cycle| Irreducible { at: forward[cycle.node_id()] })?;
        let order: BTreeMap<u32, u32> = order.iter().zip(0..).map(|(node, place)| (forward[*node], place)).collect();
        let mut loops: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
        for (from, head) in &back {
            for node in body(&graph, *from, *head) {
                loops.entry(graph[node]).or_default().push(graph[*head]);
            }
        }
        for heads in loops.values_mut() {
            heads.sort_by_key(|head| order[head]);
            heads.dedup();
        }
        let mut joins: BTreeSet<u32> = graph
            .node_indices()
            .filter(|node| graph.neighbors_directed(*node, petgraph::Direction::Incoming).count() > 1)
            .map(|node| graph[node])
            .collect();
        joins.extend(back.iter().map(|(_, head)| graph[*head]));
        let live = live::registers(functions, function, &graph, &nodes, &conditions);
        Ok(Self { order, loops, joins, conditions, live })
    }

    /// Position of an instruction in the order.
    pub fn place(&self, address: u32) -> u32 {
        self.order.get(&address).copied().unwrap_or(u32::MAX)
    }

    /// Heads of the loops around an instruction, outermost first.
    pub fn loops(&self, address: u32) -> &[u32] {
        self.loops.get(&address).map_or(&[], Vec::as_slice)
    }

    /// Returns whether paths join at an instruction.
    pub fn is_join(&self, address: u32) -> bool {
        self.joins.contains(&address)
    }

    /// Condition of an instruction in an `it` block.
    pub fn condition(&self, address: u32) -> Option<u8> {
        self.conditions.get(&address).copied()
    }

    /// Registers that are live before an instruction.
    pub fn live(&self, address: u32) -> RegisterSet {
        self.live.get(&address).copied().unwrap_or(RegisterSet::ALL)
    }
}

/// Nodes of a loop: all that reach its end without passing its head.
fn body(graph: &DiGraph<u32, ()>, from: NodeIndex, head: NodeIndex) -> BTreeSet<NodeIndex> {
    let mut found = BTreeSet::from([head]);
    let mut open = vec![from];
    while let Some(node) = open.pop() {
        if found.insert(node) {
            open.extend(graph.neighbors_directed(node, petgraph::Direction::Incoming));
        }
    }
    found
}

fn conditions(functions: &Functions, function: &Function) -> BTreeMap<u32, u8> {
    let (mut found, mut state) = (BTreeMap::new(), 0u8);
    for address in function.code.keys() {
        let (first, second) = functions.halves(*address);
        if state != 0 {
            found.insert(*address, state >> 4);
            // ITAdvance of the manual.
            state = if state & 7 == 0 { 0 } else { state & 0xe0 | state << 1 & 0x1f };
        }
        if let Operation::If(condition, mask) = operation(first, second) {
            state = condition << 4 | mask;
        }
    }
    found
}

/// Successors of an instruction within its function.
fn successors(
    functions: &Functions,
    function: &Function,
    address: u32,
    conditions: &BTreeMap<u32, u8>,
    returns: &dyn Fn(u32) -> bool,
) -> Vec<u32> {
    let Some(instruction) = function.code.get(&address) else { return Vec::new() };
    let next = address + instruction.size;
    let (mut found, goes_on) = match instruction.flow {
        Flow::Next | Flow::CallRegister => (Vec::new(), true),
        Flow::Branch(to) => (vec![to], true),
        Flow::Jump(to) => (vec![to], false),
        Flow::Call(to) => (Vec::new(), returns(to)),
        Flow::Table { width, base } => (targets(functions, function, next, width, base), false),
        Flow::JumpRegister | Flow::Return | Flow::Trap => (Vec::new(), false),
    };
    if goes_on || conditions.contains_key(&address) {
        found.push(next);
    }
    found.retain(|to| function.code.contains_key(to));
    found
}
