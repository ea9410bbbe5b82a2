//! Checks that the joint can exist. Each value lies within the bounds of its key; here values are checked against each
//! other: masses against sizes, frictions and weight against torques, tooth errors against the module, stiffness
//! against its torque, encoders against the gap. An impossible joint is an error with the likely remedy, an odd one a
//! warning. The file's `coherence = "warn"` turns the errors into warnings.
//!
//! Limits are wide on purpose: rejecting a good file costs more than accepting a slip. The page
//! docs/reference/joint-file.md names the compared values and the undetectable slips.

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

/// Notes every contradiction within the file.
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
