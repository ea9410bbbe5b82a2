//! Content of a joint file.

use parameters::{JointParameters, PlantParameters, Surroundings};

use crate::motion::Profile;
use crate::notes::Source;
use crate::problem::Problem;

/// A valid joint file.
#[derive(Debug, Clone, PartialEq)]
pub struct JointFile {
    /// Joint, in SI.
    pub parameters: JointParameters,
    /// Description for reports; may be empty.
    pub description: String,
    /// Torques for motion profiles.
    pub profile: Profile,
    /// Drive train around the gears; effects without a key are ideal.
    pub surroundings: Surroundings,
    /// Warnings: odd values that are usable.
    pub warnings: Vec<Problem>,
    /// Source of each number, from the comment behind it.
    pub sources: Vec<Source>,
}

impl<'f> From<&'f JointFile> for PlantParameters<'f> {
    fn from(file: &'f JointFile) -> Self {
        Self { joint: &file.parameters, surroundings: &file.surroundings }
    }
}
