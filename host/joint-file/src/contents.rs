//! What a joint file says, once it has been read.

use parameters::{JointParameters, PlantParameters, Surroundings};

use crate::motion::Profile;
use crate::notes::Source;
use crate::problem::Problem;

/// A valid joint file.
#[derive(Debug, Clone, PartialEq)]
pub struct JointFile {
    /// The joint, in SI.
    pub parameters: JointParameters,
    /// A sentence for reports; may be empty.
    pub description: String,
    /// Torques for motion profiles.
    pub profile: Profile,
    /// What surrounds the gears; what the file says nothing of is ideal.
    pub surroundings: Surroundings,
    /// What is odd but can be used.
    pub warnings: Vec<Problem>,
    /// Where each number comes from, by the comment behind it.
    pub sources: Vec<Source>,
}

impl<'f> From<&'f JointFile> for PlantParameters<'f> {
    fn from(file: &'f JointFile) -> Self {
        Self { joint: &file.parameters, surroundings: &file.surroundings }
    }
}
