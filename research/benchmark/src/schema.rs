//! Test that the published schema of a comparison equals its type's.

use published_schema::assert_published;

use crate::BenchmarkRecord;

/// The published schema equals the type's.
#[test]
fn published_schema_equals_the_type() {
    assert_published::<BenchmarkRecord>("bench.schema.json");
}
