//! Test: the published schemas of this crate's JSON match its types.

use published_schema::assert_published;

use crate::findings::Record;
use crate::memory::Content;
use crate::quasi_static::SlowRecord;

#[test]
fn schemas_match_types() {
    assert_published::<Record<'_>>("identify.schema.json");
    assert_published::<SlowRecord<'_>>("identify-quasi-static.schema.json");
    assert_published::<Content>("memory.schema.json");
}
