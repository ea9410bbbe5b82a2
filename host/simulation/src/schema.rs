//! Tests: the published schemas of this crate's JSON equal those of its types.

use published_schema::assert_published;

use crate::budget::BudgetSummary;
use crate::check::CheckSummary;
use crate::sim::summary::SimulationSummary;
use crate::sweep::manifest::Manifest;

#[test]
fn published_schemas_match_types() {
    assert_published::<CheckSummary>("check.schema.json");
    assert_published::<BudgetSummary>("budget.schema.json");
    assert_published::<SimulationSummary>("sim.schema.json");
    assert_published::<Manifest>("sweep.schema.json");
}
