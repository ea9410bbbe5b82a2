//! Tests: the published schema of a run matches its types, and `docs/reference/report-schema.md` explains every key.

use super::RunRecord;
use report::schema::{assert_explained, assert_published};

#[test]
fn the_published_schema_is_that_of_the_types() {
    assert_published::<RunRecord>("run.schema.json");
}

#[test]
fn every_key_of_the_schema_is_explained() {
    assert_explained::<RunRecord>("report-schema.md", [], 60);
}
