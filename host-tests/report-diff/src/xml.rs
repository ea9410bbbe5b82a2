//! XML such as JUnit's: every element, attribute and text, with its path, in the document's order.

use crate::ignored::{Place, rule};
use crate::listing::{Listing, Row};
use crate::markup::{Piece, pieces};

/// Reads a document; fails if it cannot be parsed.
pub fn read(document: &str) -> Result<Listing, String> {
    let (mut path, mut listing) = (Vec::new(), Listing::default());
    let say = |listing: &mut Listing, place: String, value: String| {
        let mut row = Row::default();
        row.push(place, value);
        listing.rows.push(row);
    };
    for piece in pieces(document)? {
        match piece {
            Piece::Open { name, attributes } => {
                let own_name = attributes.iter().find(|(key, _)| key == "name");
                path.push(own_name.map_or(name.clone(), |(_, own_name)| format!("{name} `{own_name}`")));
                let place = path.join("/");
                say(&mut listing, place.clone(), String::new());
                for (key, value) in attributes {
                    match rule(|place| matches!(place, Place::Attribute(name) if *name == key)) {
                        Some(rule) => listing.hidden.push((rule, value)),
                        None => say(&mut listing, format!("{place} @{key}"), value),
                    }
                }
            }
            Piece::Close(_) => drop(path.pop()),
            Piece::Text(text) => {
                let text = listing.masked(&text);
                if !text.is_empty() {
                    say(&mut listing, path.join("/"), text);
                }
            }
        }
    }
    Ok(listing)
}
