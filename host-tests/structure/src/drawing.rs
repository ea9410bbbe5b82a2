//! Drawing of the crates that ship, from their imports: a crate stands above everything it imports, and an arrow that follows
//! from others is left out. A layered drawing after Sugiyama: levels by the longest path, long arrows split at every level,
//! order and place by the mean of the neighbours.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;

use crate::members::{Kind, Member, Workspace};

/// Size of a box, of the gap beside it and of a level, and the width of an arrow that passes a level [px].
const BOX: (f64, f64) = (136.0, 30.0);
const GAP: f64 = 16.0;
const LEVEL: f64 = 70.0;
const PASSING: f64 = 10.0;
/// Crate that only selects features.
const WITHOUT_CODE: &str = "shared-features";
/// Rounds of ordering and of placing.
const ROUNDS: usize = 60;

const HEAD: &str = r#"<style>
svg{font-family:system-ui,-apple-system,"Segoe UI",sans-serif;background:#fff}
.t{fill:#17202a;font-size:13px;font-weight:600;text-anchor:middle}.s{fill:#4d5965;font-size:12px}
.host{fill:#f4f6f8;stroke:#9aa7b4}.board{fill:#e6f0fa;stroke:#4a86c0}.out{fill:#e6f3e8;stroke:#5a9a66}
.a{fill:none;stroke:#7d8994;stroke-width:1.3}.m{fill:#7d8994}
@media (prefers-color-scheme:dark){svg{background:#12171e}.t{fill:#e8edf2}.s{fill:#a8b3be}.host{fill:#1c242d;stroke:#5b6875}.board{fill:#172a3d;stroke:#4a86c0}.out{fill:#182b1c;stroke:#5a9a66}.a{stroke:#8c99a6}.m{fill:#8c99a6}}
</style>
<defs><marker id="m" viewBox="0 0 8 8" refX="7" refY="4" markerWidth="7" markerHeight="7" orient="auto"><path class="m" d="M0 0 8 4 0 8z"/></marker></defs>
"#;

/// A crate, or a place where a long arrow passes a level.
struct Node {
    name: Option<String>,
    level: usize,
    x: f64,
    above: Vec<usize>,
    below: Vec<usize>,
}

impl Node {
    fn width(&self) -> f64 {
        if self.name.is_some() { BOX.0 + GAP } else { PASSING }
    }
}

/// SVG of the crates that ship; `runs_on_board` knows those without the standard library.
pub fn svg(workspace: &Workspace, runs_on_board: impl Fn(&str) -> bool) -> String {
    let mut nodes = layered(&reduced(workspace));
    let height = nodes.iter().map(|node| node.level).max().unwrap_or(0);
    let mut levels: Vec<Vec<usize>> = vec![vec![]; height + 1];
    (0..nodes.len()).for_each(|at| levels[nodes[at].level].push(at));
    (0..ROUNDS).for_each(|round| order(&mut nodes, &mut levels, round % 2 == 0));
    (0..ROUNDS).for_each(|_| levels.iter().for_each(|level| place(&mut nodes, level)));
    let left = nodes.iter().map(|node| node.x - node.width() / 2.0).fold(f64::INFINITY, f64::min) - 12.0;
    let right = nodes.iter().map(|node| node.x + node.width() / 2.0).fold(f64::NEG_INFINITY, f64::max);
    nodes.iter_mut().for_each(|node| node.x -= left);
    draw(&nodes, right - left + 12.0, height, runs_on_board)
}

/// Imports of each crate that ships, without tests and without those that follow from others.
fn reduced(workspace: &Workspace) -> BTreeMap<String, BTreeSet<String>> {
    let drawn = |member: &&Member| member.ships() && member.name != WITHOUT_CODE;
    let ships: Vec<&Member> = workspace.members.iter().filter(drawn).collect();
    let is_shipped = |name: &String| ships.iter().any(|member| member.name == *name);
    let imports: BTreeMap<String, BTreeSet<String>> = ships
        .iter()
        .map(|member| {
            let normal = member.imports.iter().filter(|(name, kind)| *kind != Kind::Tests && is_shipped(name));
            (member.name.clone(), normal.map(|(name, _)| name.clone()).collect())
        })
        .collect();
    let follows =
        |of: &BTreeSet<String>, name: &String| of.iter().any(|other| other != name && reaches(&imports, other, name));
    let kept = |of: &BTreeSet<String>| of.iter().filter(|name| !follows(of, name)).cloned().collect();
    imports.iter().map(|(name, of)| (name.clone(), kept(of))).collect()
}

fn reaches(imports: &BTreeMap<String, BTreeSet<String>>, from: &str, to: &str) -> bool {
    imports[from].iter().any(|next| next == to || reaches(imports, next, to))
}

fn depth(imports: &BTreeMap<String, BTreeSet<String>>, name: &str) -> usize {
    imports[name].iter().map(|next| depth(imports, next) + 1).max().unwrap_or(0)
}

/// Crates by level, with a node at every level that an arrow passes.
fn layered(imports: &BTreeMap<String, BTreeSet<String>>) -> Vec<Node> {
    let node = |name: Option<String>, level| Node { name, level, x: 0.0, above: vec![], below: vec![] };
    let mut nodes: Vec<Node> = imports.keys().map(|name| node(Some(name.clone()), depth(imports, name))).collect();
    let place: BTreeMap<&String, usize> = imports.keys().enumerate().map(|(at, name)| (name, at)).collect();
    for (name, of) in imports {
        for other in of {
            let (mut upper, lower) = (place[name], place[other]);
            while nodes[upper].level > nodes[lower].level + 1 {
                nodes.push(node(None, nodes[upper].level - 1));
                let passing = nodes.len() - 1;
                connect(&mut nodes, upper, passing);
                upper = passing;
            }
            connect(&mut nodes, upper, lower);
        }
    }
    nodes
}

fn connect(nodes: &mut [Node], upper: usize, lower: usize) {
    nodes[upper].below.push(lower);
    nodes[lower].above.push(upper);
}

/// Orders each level by the mean place of its neighbours in the level passed before.
fn order(nodes: &mut [Node], levels: &mut [Vec<usize>], upwards: bool) {
    let count = levels.len();
    for step in 0..count {
        let level = if upwards { step } else { count - 1 - step };
        let mean = |at: usize| {
            let neighbours = if upwards { &nodes[at].below } else { &nodes[at].above };
            let sum: f64 = neighbours.iter().map(|other| nodes[*other].x).sum();
            if neighbours.is_empty() { nodes[at].x } else { sum / neighbours.len() as f64 }
        };
        let mut keyed: Vec<(f64, usize)> = levels[level].iter().map(|at| (mean(*at), *at)).collect();
        keyed.sort_by(|one, other| one.0.total_cmp(&other.0));
        levels[level] = keyed.into_iter().map(|(_, at)| at).collect();
        let whole: f64 = levels[level].iter().map(|at| nodes[*at].width()).sum();
        let mut x = -whole / 2.0;
        for at in &levels[level] {
            nodes[*at].x = x + nodes[*at].width() / 2.0;
            x += nodes[*at].width();
        }
    }
}

/// Moves the nodes of a level towards the mean of their neighbours and keeps their order and distances.
fn place(nodes: &mut [Node], level: &[usize]) {
    let wanted: Vec<f64> = level
        .iter()
        .map(|at| {
            let node = &nodes[*at];
            let around = node.above.iter().chain(&node.below);
            let (sum, count) = around.fold((0.0, 0.0), |(sum, count), other| (sum + nodes[*other].x, count + 1.0));
            if count == 0.0 { node.x } else { sum / count }
        })
        .collect();
    let apart = |left: usize| (nodes[level[left]].width() + nodes[level[left + 1]].width()) / 2.0;
    let (mut from_left, mut from_right) = (wanted.clone(), wanted);
    for at in 1..level.len() {
        from_left[at] = from_left[at].max(from_left[at - 1] + apart(at - 1));
    }
    for at in (1..level.len()).rev() {
        from_right[at - 1] = from_right[at - 1].min(from_right[at] - apart(at - 1));
    }
    for (at, node) in level.iter().enumerate() {
        nodes[*node].x = (from_left[at] + from_right[at]) / 2.0;
    }
}

fn draw(nodes: &[Node], width: f64, height: usize, runs_on_board: impl Fn(&str) -> bool) -> String {
    let y = |level: usize| 24.0 + LEVEL * (height - level) as f64;
    let total = y(0) + BOX.1 + 48.0;
    let title = "Crates that ship and what they import";
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width:.0} {total:.0}\" width=\"{width:.0}\" height=\"{total:.0}\" \
         role=\"img\" aria-label=\"{title}\">\n<title>{title}</title>\n{HEAD}"
    );
    let mut line = |text: std::fmt::Arguments<'_>| svg.write_fmt(text).unwrap_or_default();
    for (upper, mut lower) in
        nodes.iter().filter(|node| node.name.is_some()).flat_map(|node| node.below.iter().map(move |at| (node, *at)))
    {
        let (mut x, mut from) = (upper.x, y(upper.level) + BOX.1);
        line(format_args!("<path class=\"a\" marker-end=\"url(#m)\" d=\"M{x:.1} {from:.1}"));
        loop {
            let node = &nodes[lower];
            let to = y(node.level);
            let bend = (to - from) / 2.0;
            line(format_args!("C{x:.1} {:.1} {:.1} {:.1} {:.1} {to:.1}", from + bend, node.x, to - bend, node.x));
            if node.name.is_some() {
                break;
            }
            line(format_args!("V{:.1}", to + BOX.1));
            (x, from, lower) = (node.x, to + BOX.1, node.below[0]);
        }
        line(format_args!("\"/>\n"));
    }
    for node in nodes {
        let Some(name) = &node.name else { continue };
        let (left, top) = (node.x - BOX.0 / 2.0, y(node.level));
        let kind = match runs_on_board(name) {
            true => "board",
            false if node.above.is_empty() => "out",
            false => "host",
        };
        line(format_args!(
            "<rect class=\"{kind}\" x=\"{left:.1}\" y=\"{top:.1}\" width=\"{}\" height=\"{}\" rx=\"6\"/>\n",
            BOX.0, BOX.1
        ));
        line(format_args!("<text class=\"t\" x=\"{:.1}\" y=\"{:.1}\">{name}</text>\n", node.x, top + 20.0));
    }
    let key =
        [("board", "without the standard library"), ("host", "on the host"), ("out", "on the host, imported by none")];
    for (at, (kind, text)) in key.iter().enumerate() {
        let left = 12.0 + 230.0 * at as f64;
        line(format_args!(
            "<rect class=\"{kind}\" x=\"{left}\" y=\"{:.1}\" width=\"16\" height=\"12\" rx=\"3\"/>\n",
            total - 24.0
        ));
        line(format_args!("<text class=\"s\" x=\"{:.1}\" y=\"{:.1}\">{text}</text>\n", left + 24.0, total - 14.0));
    }
    svg + "</svg>\n"
}
