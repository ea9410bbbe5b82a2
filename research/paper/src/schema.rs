//! The published schema of a study is that of its types, and `docs/reference/paper-study.md` tells every key. Only
//! tests are here.

use super::record::StudyRecord;
use published_schema::{assert_explained, assert_published};

#[test]
fn published_study_schema_equals_types() {
    assert_published::<StudyRecord>("paper-study.schema.json");
}

#[test]
fn every_study_key_is_explained() {
    assert_explained::<StudyRecord>("paper-study.md", [], 40);
}
