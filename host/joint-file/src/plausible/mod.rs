//! Can there be such a joint? Every value by itself lies within the bounds of its key; here they are held against each
//! other: masses against sizes, frictions and weight against torques, the teeth's errors against the module, stiffness
//! against the torque that it carries, encoders against the gap. What no joint can be is an error with the likely mend,
//! what is odd but can be is a warning. The file's `coherence = "warn"` makes warnings of the errors.
//!
//! Limits lie far out on purpose, since a good file that is refused costs more than a slip that passes. The page
//! docs/reference/joint-file.md names the values that are compared, and slips that cannot be detected.

mod judge;
mod masses;
mod signals;
mod teeth;
mod torques;
mod units;

use parameters::Coherence;

use crate::contents::JointFile;
use crate::notes::Notes;
use judge::Judge;

/// Notes everything that contradicts the rest of the file.
pub(crate) fn check(file: &JointFile, notes: &Notes<'_>) {
    let judge = Judge { notes, lenient: file.parameters.geometry.coherence == Coherence::Warned };
    if file.parameters.equivalent_gear().is_none() {
        masses::check_gears(file, &judge);
        teeth::check(file, &judge);
    }
    masses::check(file, &judge);
    torques::check(file, &judge);
    signals::check(file, &judge);
}
