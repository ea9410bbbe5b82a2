//! Holds published schemas to the types that are written: `docs/reference/*.schema.json` are made from them, and a page
//! of docs/reference must tell every key. Only tests use it.

use std::collections::BTreeSet;
use std::fs;
use std::path::PathBuf;

use schemars::JsonSchema;
use serde_json::Value;

use crate::workspace::workspace;

fn document(name: &str) -> PathBuf {
    workspace().join("docs/reference").join(name)
}

/// Fails unless docs/reference/`name` is the schema of `T`; `UPDATE_SCHEMA` makes it so.
pub fn assert_published<T: JsonSchema>(name: &str) {
    let path = document(name);
    let schema = serde_json::to_string_pretty(&schemars::schema_for!(T)).expect("a schema is JSON") + "\n";
    if std::env::var_os("UPDATE_SCHEMA").is_some() {
        fs::write(&path, &schema).expect("docs/reference is writable");
    }
    let published = fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    assert!(published == schema, "run `UPDATE_SCHEMA=1 cargo test schema` and review the change");
}

/// Fails unless docs/reference/`page` tells every key of `T` and all of `others`, more than `least` words in all.
pub fn assert_explained<T: JsonSchema>(page: &str, others: impl IntoIterator<Item = String>, least: usize) {
    let text = fs::read_to_string(document(page)).unwrap_or_else(|error| panic!("docs/reference/{page}: {error}"));
    let mut wanted: BTreeSet<String> = others.into_iter().collect();
    keys(&serde_json::to_value(schemars::schema_for!(T)).expect("a schema is JSON"), &mut wanted);
    let missing: Vec<_> = wanted.iter().filter(|key| !text.contains(&format!("`{key}`"))).collect();
    assert!(wanted.len() > least && missing.is_empty(), "not explained: {missing:?}");
}

/// Keys of objects, everywhere in a schema.
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
