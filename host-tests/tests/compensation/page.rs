//! The table of transitions in docs/theory/compensation.md equals the table that the control runs.

use model_core::compensation::Stage;
use model_core::compensation::transitions::transitions;

const PAGE: &str = include_str!("../../../docs/theory/compensation.md");
const TABLE_START: &str = "<!-- transitions -->";
const TABLE_END: &str = "<!-- /transitions -->";

/// Transitions of all stages with transitions, as Markdown.
fn table() -> String {
    let mut table = "| stage | # | event | action | next stage |\n|---|---|---|---|---|\n".to_owned();
    for stage in [Stage::Touching, Stage::Crossing, Stage::Landing] {
        for (index, line) in transitions(stage).iter().enumerate() {
            let (number, event, action) = (index + 1, line.when, line.action);
            let (when, then, next) = (event.meaning(), action.meaning(), action.stage());
            table += &format!("| {stage:?} | {number} | `{event:?}`: {when} | `{action:?}`: {then} | {next:?} |\n");
        }
    }
    table
}

/// The page shows the transition table of the code.
#[test]
fn page_shows_the_transitions() {
    let (_, rest) = PAGE.split_once(TABLE_START).expect("a beginning of the table");
    let (shown, _) = rest.split_once(TABLE_END).expect("an end of the table");
    let table = table();
    assert!(
        shown.trim() == table.trim(),
        "docs/theory/compensation.md does not show the transitions of model-core/src/compensation/transitions.rs\n  \
         help: put this between {TABLE_START} and {TABLE_END}:\n\n{table}"
    );
}

/// Stages without compensation are left by no transition.
#[test]
fn plain_stages_have_no_transitions() {
    assert!([Stage::Plain, Stage::Off, Stage::Reversed].map(transitions).iter().all(|lines| lines.is_empty()));
}
