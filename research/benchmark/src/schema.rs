//! The published schema of a comparison is that of its type. Only tests are here.

use report::schema::assert_published;

use crate::BenchmarkRecord;

#[test]
fn the_published_schema_is_that_of_the_type() {
    assert_published::<BenchmarkRecord>("bench.schema.json");
}
