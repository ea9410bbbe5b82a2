//! XML such as JUnit's: every element, attribute and text, with its path, in the document's order.

use crate::ignored::{Place, rule};
use crate::listing::{Listing, Row};
use crate::markup::{Piece, pieces};

/// Reads a document; fails if it cannot be parsed.
pub fn read(document: &str) -> Result<Listing, String> {
    let (mut way, mut listing) = (Vec::new(), Listing::default());
    let say = |listing: &mut Listing, place: String, value: String| {
        let mut row = Row::default();
        row.say(place, value);
        listing.rows.push(row);
    };
    for piece in pieces(document)? {
        match piece {
            Piece::Open { name, attributes } => {
                let own = attributes.iter().find(|(key, _)| key == "name");
                way.push(own.map_or(name.clone(), |(_, own)| format!("{name} `{own}`")));
                let place = way.join("/");
                say(&mut listing, place.clone(), String::new());
                for (key, value) in attributes {
                    match rule(|place| matches!(place, Place::Attribute(name) if *name == key)) {
                        Some(rule) => listing.hidden.push((rule, value)),
                        None => say(&mut listing, format!("{place} @{key}"), value),
                    }
                }
            }
            Piece::Close(_) => drop(way.pop()),
            Piece::Text(text) => {
                let text = listing.masked(&text);
                if !text.is_empty() {
                    say(&mut listing, way.join("/"), text);
                }
            }
        }
    }
    Ok(listing)
}
