//! Tests: the published schema of test results equals that of the types, and `docs/reference/hil-file.md` explains
//! every key and every figure.

use super::metrics::METRICS;
use super::record::TestsRecord;
use published_schema::{assert_explained, assert_published};

#[test]
fn schema_equals_types() {
    assert_published::<TestsRecord>("hil-tests.schema.json");
}

#[test]
fn every_result_key_is_explained() {
    assert_explained::<TestsRecord>("hil-file.md", METRICS.iter().map(|metric| metric.name()), 60);
}
