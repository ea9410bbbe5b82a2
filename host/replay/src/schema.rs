//! Tests: the published schema of a replay's record matches its type.

use report::schema::{assert_explained, assert_published};

use crate::ReplayRecord;

#[test]
fn the_published_schema_is_that_of_the_type() {
    assert_published::<ReplayRecord>("replay.schema.json");
}

#[test]
fn every_key_of_a_replay_is_explained() {
    assert_explained::<ReplayRecord>("replay.md", [], 30);
}
