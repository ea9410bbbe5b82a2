//! JSON by value, key by key. Whole numbers are compared as such, all others by the bits of the f64 that they stand for;
//! the order of keys and the form of a number do not count.

use std::fmt;

use serde_json::{Number, Value};

use crate::findings::Findings;
use crate::ignored::{ignored_by_name, ignored_key};
use crate::mask::masked;

/// A step down from the top of a document.
enum Part<'a> {
    Key(&'a str),
    Index(usize),
}

/// Way from the top of a document.
struct Way<'a>(Vec<Part<'a>>);

impl fmt::Display for Way<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (depth, part) in self.0.iter().enumerate() {
            match part {
                Part::Key(key) if depth == 0 => write!(f, "{key}")?,
                Part::Key(key) => write!(f, ".{key}")?,
                Part::Index(index) => write!(f, "[{index}]")?,
            }
        }
        Ok(())
    }
}

impl Way<'_> {
    /// Its keys, without places in lists.
    fn keys(&self) -> Vec<&str> {
        self.0
            .iter()
            .filter_map(|part| match part {
                Part::Key(key) => Some(*key),
                Part::Index(_) => None,
            })
            .collect()
    }
}

/// Compares two documents.
pub fn compare(old: &Value, new: &Value, findings: &mut Findings) {
    walk(old, new, &mut Way(Vec::new()), findings);
}

fn walk<'a>(old: &'a Value, new: &'a Value, way: &mut Way<'a>, findings: &mut Findings) {
    match (old, new) {
        (Value::Object(a), Value::Object(b)) => {
            let name = a.get("name").filter(|name| b.get("name") == Some(name)).and_then(Value::as_str);
            for (key, old) in a {
                match name.and_then(|name| ignored_by_name(name, key)) {
                    Some(rule) => findings.leave_out(rule, b.get(key) != Some(old)),
                    None => step(Part::Key(key), Some(old), b.get(key), way, findings),
                }
            }
            for (key, new) in b.iter().filter(|(key, _)| !a.contains_key(*key)) {
                step(Part::Key(key), None, Some(new), way, findings);
            }
        }
        (Value::Array(a), Value::Array(b)) => {
            for place in 0..a.len().max(b.len()) {
                step(Part::Index(place), a.get(place), b.get(place), way, findings);
            }
        }
        _ => leaf(old, new, way, findings),
    }
}

fn step<'a>(
    part: Part<'a>,
    old: Option<&'a Value>,
    new: Option<&'a Value>,
    way: &mut Way<'a>,
    findings: &mut Findings,
) {
    let is_key = matches!(part, Part::Key(_));
    way.0.push(part);
    let rule = if is_key { ignored_key(&way.keys()) } else { None };
    match (old, new) {
        (Some(old), Some(new)) if rule.is_none() => walk(old, new, way, findings),
        (old, new) => match rule {
            Some(rule) => findings.leave_out(rule, old != new),
            None => findings.differs(way.to_string(), old.map(Value::to_string), new.map(Value::to_string)),
        },
    }
    way.0.pop();
}

fn leaf(old: &Value, new: &Value, way: &Way<'_>, findings: &mut Findings) {
    let same = match (old, new) {
        (Value::Number(a), Value::Number(b)) => same_number(a, b),
        (Value::String(a), Value::String(b)) => a == b || same_text(a, b, findings),
        _ => old == new,
    };
    match same {
        true => findings.same(1),
        false => findings.differs(way.to_string(), Some(old.to_string()), Some(new.to_string())),
    }
}

fn same_number(a: &Number, b: &Number) -> bool {
    let is_whole = |number: &Number| number.is_i64() || number.is_u64();
    match is_whole(a) && is_whole(b) {
        true => a == b,
        false => a.as_f64().map(f64::to_bits) == b.as_f64().map(f64::to_bits),
    }
}

/// Texts that are the same but for what is masked.
fn same_text(a: &str, b: &str, findings: &mut Findings) -> bool {
    let (a, b) = (masked(a), masked(b));
    let same = a.words == b.words;
    if same {
        crate::text::leave_out(a.hidden.iter(), b.hidden.iter(), findings);
    }
    same
}
