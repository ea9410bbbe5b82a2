//! Fixed fine steps of closed loops against adaptive steps.

use host_tests::tolerance::compensation::FIXED_STEPS;
use reference::drive_train::Stepping;
use reference::joint::{RelativeState, Start};
use scenario::controller::ControllerName;
use scenario::execution::setup;
use scenario::rig::{ActiveController, Rig, Setup};
use scenario::set_point_source::SetPointSource;

use super::{on_reference, shipped};

/// Lost motion of Q1 at its link [rad].
const LOST_MOTION: f64 = 3.78e-3;

/// The link moves alike with fixed and adaptive steps.
#[test]
fn fixed_steps_match_adaptive_steps() {
    let (mut test, seed) = (shipped("t2"), 131);
    test.file.duration = 1.5;
    let case = test.case(seed).expect("a case of the test");
    let spec = on_reference(ControllerName::MotorPid);
    let [fixed, adaptive] = [Stepping::Fixed, Stepping::Adaptive].map(|stepping| {
        // Middle of the gap; the bound was measured from there.
        let start = Start::Relative(RelativeState::centred(case.truth.parameters.geometry.planets));
        let setup = Setup { stepping, start, ..setup(&test.file, &case, seed, spec) };
        let mut controller = ActiveController::rival(
            spec.controller,
            case.knowledge(),
            case.bandwidth(&test.file).expect("a bandwidth"),
        );
        let mut set_points = SetPointSource::of_positions(case.motion.clone());
        let mut links = Vec::new();
        let rig = Rig::new(&setup).expect("a sound drive train");
        let run = rig.run(&mut controller, &mut set_points, &mut |period| {
            links.push(period.plant.joint().link_angle);
            Ok(())
        });
        run.expect("it runs");
        links
    });
    let difference = fixed.iter().zip(&adaptive).map(|(fixed, adaptive)| (fixed - adaptive).abs());
    FIXED_STEPS.check(difference.fold(0.0, f64::max) / LOST_MOTION);
}
