//! The cases of the comparison.

use host_tests::scenarios::{CASE_A_OMEGA, CASE_Q_OMEGA, case, case_r, paper_natural_frequency};

use crate::case::Case;

/// Dimensionless time from which cases at the paper's joint count: what the start stirred up has died down.
const SETTLED: f64 = 100.0;

/// All cases.
pub fn cases() -> Vec<Case> {
    let settled = SETTLED / paper_natural_frequency();
    let robot = case_r::case_r();
    vec![
        Case::of_scenario(
            "A",
            "meshes part and hit eleven times a mesh period",
            case("A", CASE_A_OMEGA),
            40_000,
            settled,
        ),
        Case::of_scenario("Q", "contact holds", case("Q", CASE_Q_OMEGA), 40_000, settled),
        Case::of_robot_joint("R", "what a robot joint does", robot),
    ]
}
