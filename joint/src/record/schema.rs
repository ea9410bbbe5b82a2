//! Holds the published schema to the types that are written: `docs/run.schema.json` is made from them, and
//! `docs/report-schema.md` must tell every key. Only tests are here.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use serde_json::Value;

use super::RunRecord;

fn document(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs").join(name)
}

/// The schema of the types, as published.
fn generated() -> String {
    let schema = schemars::schema_for!(RunRecord);
    serde_json::to_string_pretty(&schema).expect("a schema is JSON") + "\n"
}

/// Keys of objects, everywhere in a schema.
pub(crate) fn keys(schema: &Value, found: &mut BTreeSet<String>) {
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

#[test]
fn the_published_schema_is_that_of_the_types() {
    let path = document("run.schema.json");
    if std::env::var_os("UPDATE_SCHEMA").is_some() {
        fs::write(&path, generated()).expect("docs is writable");
    }
    let published = fs::read_to_string(&path).expect("docs/run.schema.json is there");
    assert!(published == generated(), "run `UPDATE_SCHEMA=1 cargo test -p joint schema` and review the change");
}

#[test]
fn every_key_of_the_schema_is_explained() {
    let text = fs::read_to_string(document("report-schema.md")).expect("docs/report-schema.md is there");
    let mut found = BTreeSet::new();
    keys(&serde_json::from_str(&generated()).expect("a schema is JSON"), &mut found);
    let missing: Vec<_> = found.iter().filter(|key| !text.contains(&format!("`{key}`"))).collect();
    assert!(found.len() > 60 && missing.is_empty(), "not explained: {missing:?}");
}
