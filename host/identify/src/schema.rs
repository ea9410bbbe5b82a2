//! The published schemas of what the commands of this crate write as JSON are those of their types. Only tests are here.

use report::schema::{assert_explained, assert_published};

use crate::replay::ReplayRecord;

#[test]
fn the_published_schemas_are_those_of_the_types() {
    assert_published::<ReplayRecord>("replay.schema.json");
}

#[test]
fn every_key_of_a_replay_is_explained() {
    assert_explained::<ReplayRecord>("replay.md", [], 30);
}
