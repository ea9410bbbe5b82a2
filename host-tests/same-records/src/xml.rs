//! XML such as JUnit's: every attribute and every text, with the way to its element, in the document's order.

use crate::align::{Step, steps};
use crate::findings::Findings;
use crate::ignored::ignored_attribute;
use crate::markup::{Piece, pieces};
use crate::mask::masked;

/// Where something stands, and what: an element itself has an empty value.
type Entry = (String, String);

/// What a rule has left out.
type Hidden = (&'static str, String);

/// Compares two documents.
pub fn compare(old: &str, new: &str, findings: &mut Findings) {
    let ((old, old_hidden), (new, new_hidden)) = (entries(old), entries(new));
    let steps = steps(&old, &new);
    let value = |(_, value): &Entry| Some(value.clone());
    let lost = steps.iter().filter(|step| !matches!(step, Step::OnlyNew(_))).count();
    findings.same((old.len() - lost) as u64);
    for step in steps {
        match step {
            Step::Pair(a, b) if old[a].0 == new[b].0 => findings.differs(&old[a].0, value(&old[a]), value(&new[b])),
            Step::Pair(a, b) => {
                findings.differs(&old[a].0, value(&old[a]), None);
                findings.differs(&new[b].0, None, value(&new[b]));
            }
            Step::OnlyOld(a) => findings.differs(&old[a].0, value(&old[a]), None),
            Step::OnlyNew(b) => findings.differs(&new[b].0, None, value(&new[b])),
        }
    }
    crate::text::leave_out(old_hidden.iter(), new_hidden.iter(), findings);
}

fn entries(document: &str) -> (Vec<Entry>, Vec<Hidden>) {
    let mut way: Vec<String> = Vec::new();
    let (mut entries, mut hidden) = (Vec::new(), Vec::new());
    for piece in pieces(document) {
        match piece {
            Piece::Open { name, attributes, empty } => {
                let own = attributes.get("name").map_or(name.clone(), |own| format!("{name} `{own}`"));
                way.push(own);
                let place = way.join("/");
                entries.push((place.clone(), String::new()));
                for (key, value) in attributes {
                    match ignored_attribute(&key) {
                        Some(rule) => hidden.push((rule, value)),
                        None => entries.push((format!("{place} @{key}"), value)),
                    }
                }
                if empty {
                    way.pop();
                }
            }
            Piece::Close(_) => {
                way.pop();
            }
            Piece::Text(text) => {
                let masked = masked(&text);
                hidden.extend(masked.hidden);
                if !masked.words.is_empty() {
                    entries.push((way.join("/"), masked.words.join(" ")));
                }
            }
        }
    }
    (entries, hidden)
}
