//! Tests: the published schema of a run matches its types, and `docs/reference/report-schema.md` explains every key.

use super::RunRecord;
use published_schema::{assert_explained, assert_published};

#[test]
fn schema_matches_types() {
    assert_published::<RunRecord>("run.schema.json");
}

#[test]
fn schema_keys_are_documented() {
    assert_explained::<RunRecord>("report-schema.md", [], 60);
}
