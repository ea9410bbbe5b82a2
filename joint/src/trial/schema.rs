//! Holds the published schema to the types that are written: `docs/hil-tests.schema.json` is made from them, and
//! `docs/hil-file.md` must tell every key and every figure. Only tests are here.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use super::figures::FIGURES;
use super::record::TestsRecord;

fn document(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs").join(name)
}

#[test]
fn the_published_schema_of_tests_is_that_of_the_types() {
    let path = document("hil-tests.schema.json");
    let schema = serde_json::to_string_pretty(&schemars::schema_for!(TestsRecord)).expect("a schema is JSON") + "\n";
    if std::env::var_os("UPDATE_SCHEMA").is_some() {
        fs::write(&path, &schema).expect("docs is writable");
    }
    let published = fs::read_to_string(&path).expect("docs/hil-tests.schema.json is there");
    assert!(published == schema, "run `UPDATE_SCHEMA=1 cargo test -p joint schema` and review the change");
}

#[test]
fn every_key_of_the_results_and_every_figure_is_explained() {
    let text = fs::read_to_string(document("hil-file.md")).expect("docs/hil-file.md is there");
    let schema = serde_json::to_value(schemars::schema_for!(TestsRecord)).expect("a schema is JSON");
    let mut wanted = BTreeSet::new();
    crate::record::keys(&schema, &mut wanted);
    wanted.extend(FIGURES.iter().map(|figure| figure.name()));
    let missing: Vec<_> = wanted.iter().filter(|key| !text.contains(&format!("`{key}`"))).collect();
    assert!(wanted.len() > 60 && missing.is_empty(), "not explained: {missing:?}");
}
