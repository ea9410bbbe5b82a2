//! Tests: the published schema of a replay's record matches its type.

use published_schema::{assert_explained, assert_published};

use crate::ReplayRecord;

#[test]
fn schema_matches_type() {
    assert_published::<ReplayRecord>("replay.schema.json");
}

#[test]
fn schema_keys_are_documented() {
    assert_explained::<ReplayRecord>("replay.md", [], 30);
}
