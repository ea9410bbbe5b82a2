//! Tests of published schemas: `docs/reference/*.schema.json` are generated from the types, and a page of
//! docs/reference must explain every key.

use std::collections::BTreeSet;
use std::fs;
use std::path::PathBuf;

use schemars::JsonSchema;
use serde_json::Value;

use report::workspace::workspace;

fn document(name: &str) -> PathBuf {
    workspace().join("docs/reference").join(name)
}

/// Fails unless docs/reference/`name` is the schema of `T`; with `UPDATE_SCHEMA` it updates the file.
pub fn assert_published<T: JsonSchema>(name: &str) {
    let path = document(name);
    let schema = serde_json::to_string_pretty(&schemars::schema_for!(T)).expect("a schema is JSON") + "\n";
    if std::env::var_os("UPDATE_SCHEMA").is_some() {
        fs::write(&path, &schema).expect("docs/reference is writable");
    }
    let published = fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    assert!(published == schema, "run `UPDATE_SCHEMA=1 cargo test schema` and review the change");
}

/// Fails unless docs/reference/`page` explains every key of `T` and all of `others`, more than `least` words in total.
pub fn assert_explained<T: JsonSchema>(page: &str, others: impl IntoIterator<Item = String>, least: usize) {
    let text = fs::read_to_string(document(page)).unwrap_or_else(|error| panic!("docs/reference/{page}: {error}"));
    let mut wanted: BTreeSet<String> = others.into_iter().collect();
    keys(&serde_json::to_value(schemars::schema_for!(T)).expect("a schema is JSON"), &mut wanted);
    let missing: Vec<_> = wanted.iter().filter(|key| !text.contains(&format!("`{key}`"))).collect();
    assert!(wanted.len() > least && missing.is_empty(), "not explained: {missing:?}");
}

/// Fails unless a value is valid by the published schema docs/reference/`name`, without unknown keys.
pub fn assert_valid(name: &str, value: &Value) {
    let path = document(name);
    let text = fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    let schema: Value = serde_json::from_str(&text).expect("a schema is JSON");
    let violations = violations(&schema, &schema, value, "");
    assert!(violations.is_empty(), "{name}: {}", violations.join("; "));
}

/// Violations of a schema by a value, for the rules that generated schemas use.
fn violations(root: &Value, schema: &Value, value: &Value, place: &str) -> Vec<String> {
    let mut found = Vec::new();
    let Value::Object(rules) = schema else { return found };
    for (rule, wanted) in rules {
        match (rule.as_str(), wanted, value) {
            ("$ref", Value::String(to), _) => match root.pointer(to.trim_start_matches('#')) {
                Some(schema) => found.extend(violations(root, schema, value, place)),
                None => found.push(format!("{to} is not in the schema")),
            },
            ("type", wanted, _) => {
                let wanted = wanted.as_array().cloned().unwrap_or_else(|| vec![wanted.clone()]);
                if !wanted.iter().filter_map(Value::as_str).any(|wanted| has_type(wanted, value)) {
                    found.push(format!("{place} is {value}, not {wanted:?}"));
                }
            }
            ("anyOf" | "oneOf", Value::Array(ways), _)
                if ways.iter().all(|way| !violations(root, way, value, place).is_empty()) =>
            {
                found.push(format!("{place} is {value}, which is none of {} ways", ways.len()));
            }
            ("enum", Value::Array(words), _) if !words.contains(value) => found.push(format!("{place} is {value}")),
            ("const", wanted, _) if wanted != value => found.push(format!("{place} is {value}, not {wanted}")),
            ("required", Value::Array(names), Value::Object(map)) => {
                let missing = names.iter().filter_map(Value::as_str).filter(|name| !map.contains_key(*name));
                found.extend(missing.map(|name| format!("{place}/{name} is missing")));
            }
            ("properties", Value::Object(known), Value::Object(map)) => {
                for (name, value) in map {
                    match known.get(name) {
                        Some(schema) => found.extend(violations(root, schema, value, &format!("{place}/{name}"))),
                        None => found.push(format!("{place}/{name} is not in the schema")),
                    }
                }
            }
            ("additionalProperties", schema, Value::Object(map)) if !rules.contains_key("properties") => {
                found.extend(
                    map.iter().flat_map(|(name, value)| violations(root, schema, value, &format!("{place}/{name}"))),
                );
            }
            ("items", schema, Value::Array(values)) => {
                let each = values.iter().enumerate();
                found.extend(each.flat_map(|(at, value)| violations(root, schema, value, &format!("{place}/{at}"))));
            }
            ("minItems", wanted, Value::Array(values)) if wanted.as_u64() > Some(values.len() as u64) => {
                found.push(format!("{place} has {} entries", values.len()));
            }
            ("maxItems", wanted, Value::Array(values)) if wanted.as_u64() < Some(values.len() as u64) => {
                found.push(format!("{place} has {} entries", values.len()));
            }
            ("minimum", wanted, Value::Number(number)) if number.as_f64() < wanted.as_f64() => {
                found.push(format!("{place} is {number}"));
            }
            _ => {}
        }
    }
    found
}

fn has_type(kind: &str, value: &Value) -> bool {
    match kind {
        "null" => value.is_null(),
        "boolean" => value.is_boolean(),
        "integer" => value.is_i64() || value.is_u64(),
        "number" => value.is_number(),
        "string" => value.is_string(),
        "array" => value.is_array(),
        "object" => value.is_object(),
        _ => false,
    }
}

/// Collects the keys of all objects in a schema.
fn keys(schema: &Value, found: &mut BTreeSet<String>) {
    match schema {
        Value::Object(map) => {
            for (name, value) in map {
                if let ("properties", Value::Object(properties)) = (name.as_str(), value) {
                    found.extend(properties.keys().cloned());
                }
                keys(value, found);
            }
        }
        Value::Array(values) => values.iter().for_each(|value| keys(value, found)),
        _ => {}
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn schema_violations_are_found() {
        let schema = json!({
            "$defs": {"Part": {"type": "object", "properties": {"one": {"type": "number"}}, "required": ["one"]}},
            "type": "object",
            "properties": {
                "kind": {"enum": ["a", "b"]},
                "parts": {"type": "array", "items": {"$ref": "#/$defs/Part"}, "maxItems": 2},
                "maybe": {"anyOf": [{"$ref": "#/$defs/Part"}, {"type": "null"}]},
                "counts": {"type": "object", "additionalProperties": {"type": "integer", "minimum": 0}},
            },
            "required": ["kind"],
        });
        let good = json!({"kind": "a", "parts": [{"one": 1.5}], "maybe": null, "counts": {"x": 3}});
        assert_eq!(violations(&schema, &schema, &good, ""), Vec::<String>::new());
        for (bad, why) in [
            (json!({}), "/kind is missing"),
            (json!({"kind": "c"}), "/kind is"),
            (json!({"kind": "a", "other": 1}), "/other is not in the schema"),
            (json!({"kind": "a", "parts": [{"one": "1"}]}), "/parts/0/one is"),
            (json!({"kind": "a", "parts": [{}]}), "/parts/0/one is missing"),
            (json!({"kind": "a", "parts": [{"one": 1}, {"one": 1}, {"one": 1}]}), "/parts has 3 entries"),
            (json!({"kind": "a", "maybe": 3}), "/maybe is 3"),
            (json!({"kind": "a", "counts": {"x": -1}}), "/counts/x is -1"),
        ] {
            let found = violations(&schema, &schema, &bad, "");
            assert!(found.len() == 1 && found[0].starts_with(why), "{bad}: {found:?}");
        }
    }
}
