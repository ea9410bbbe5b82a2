//! JSON by value, key by key, in one row. Whole numbers are compared as such, all others by their f64; the order of keys and the notation
//! of a number do not count.

use serde_json::Value;

use crate::ignored::{Place, ignored_key, rule};
use crate::listing::{Listing, Row};

/// Reads a document.
pub fn read(document: &Value) -> Listing {
    let mut listing = Listing::from_row(Row::default());
    walk(document, ["", ""], &mut listing);
    listing
}

/// `keys` is the path from the top of the document without list indices.
fn walk(value: &Value, [place, keys]: [&str; 2], listing: &mut Listing) {
    let text = match value {
        Value::Object(object) if !object.is_empty() => {
            let own_name = object.get("name").and_then(Value::as_str);
            for (key, value) in object {
                let [place, keys] =
                    [place, keys].map(|path| if path.is_empty() { key.clone() } else { format!("{path}.{key}") });
                let by_name =
                    rule(|place| matches!(place, Place::Named(name, at) if Some(*name) == own_name && at == key));
                match by_name.or_else(|| ignored_key(&keys)) {
                    Some(rule) => listing.hidden.push((rule, value.to_string())),
                    None => walk(value, [&place, &keys], listing),
                }
            }
            return;
        }
        Value::Array(list) if !list.is_empty() => {
            for (index, value) in list.iter().enumerate() {
                walk(value, [&format!("{place}[{index}]"), keys], listing);
            }
            return;
        }
        Value::String(text) => Value::String(listing.masked(text)).to_string(),
        // Writes 1.0 as 1.
        Value::Number(number) => {
            number.as_f64().filter(|_| number.is_f64()).map_or(number.to_string(), |it| it.to_string())
        }
        other => other.to_string(),
    };
    listing.rows[0].push(place, text);
}
