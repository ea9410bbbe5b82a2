//! External impacts that drive the link off its flank.

use host_tests::extent::cases;
use scenario::controller::ControllerName::{MotorPid, NoPreview};

use super::{figures, shipped};

/// Pushing from the wrong flank gave 1.16 of PID's peak, and with seeds 15 and 105 still 1.1 where friction held the wrong flank. At the
/// first impact the gap is not known yet and the link may be anywhere in it: with seed 15 its mesh force is 1.11 of PID's.
#[test]
fn impact_moves_the_link_less_than_pid() {
    let test = shipped("impact");
    for &seed in cases(&[15, 10, 105], 1) {
        let (pid, ours) = (figures(&test, seed, MotorPid), figures(&test, seed, NoPreview));
        assert!(ours.peak < pid.peak, "seed {seed}: {} rad against PID's {}", ours.peak, pid.peak);
        assert!(
            ours.peak_mesh_force < 1.15 * pid.peak_mesh_force,
            "seed {seed}: {} N against PID's {}",
            ours.peak_mesh_force,
            pid.peak_mesh_force
        );
    }
}
