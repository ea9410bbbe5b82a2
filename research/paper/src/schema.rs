//! The published schema of a study is that of its types, and `docs/reference/paper-study.md` tells every key. Only
//! tests are here.

use super::record::StudyRecord;
use report::schema::{assert_explained, assert_published};

#[test]
fn the_published_schema_of_a_study_is_that_of_the_types() {
    assert_published::<StudyRecord>("paper-study.schema.json");
}

#[test]
fn every_key_of_a_study_is_explained() {
    assert_explained::<StudyRecord>("paper-study.md", [], 40);
}
