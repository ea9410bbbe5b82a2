//! Power-up: encoders with arbitrary zeros, a joint anywhere in its gap or already turning, a late output encoder.
//! Every closed-loop test draws encoder zeros and a place in the gap at random; the tests of this file check their
//! effect alone.

use std::path::Path;

use host_tests::extent::{cases, short_or_long};
use model_core::gears::Kinematics;
use reference::closed_loop::{Figures, Run, Sample};
use reference::joint::{RelativeState, Start};
use scenario::controller::ControllerName::{self, MotorPid, NoPreview};
use scenario::encoder_zeros::EncoderZeros;
use scenario::execution::setup;
use scenario::plant::PlantName;
use scenario::port::{HostPort, Translator};
use scenario::rig::{ActiveController, Rig};
use scenario::set_point_source::SetPointSource;
use scenario::suite::{Test, from_text};

use super::{on_reference, run, run_in};

/// Joints with teeth and equivalent gears, ratios from 6 to 100.
const JOINTS: [&str; 5] = ["q1", "l1", "c1", "s1", "d2"];

/// Joints of the short form: a compliant joint, a large stiff joint, an equivalent gear.
const SHORT_JOINTS: usize = 3;

/// Joints and seeds of a test: `long` seeds from the first one on, one in the short form.
fn joints_and_seeds(first: u64, long: u64) -> impl Iterator<Item = (&'static str, u64)> {
    let seeds = first..first + short_or_long(1, long);
    cases(&JOINTS, SHORT_JOINTS).iter().flat_map(move |joint| seeds.clone().map(|seed| (*joint, seed)))
}

/// Hold after a push.
fn hold(joint: &str, faults: &str) -> Test {
    let text = format!(
        "joint = \"{joint}\"\nprofile = \"free_hold\"\nduration_s = 6\nsettle_s = 2\n{faults}\n[controller]\nmode = \"no_preview\"\nrivals = []\n"
    );
    from_text("power-up.toml", &text, Path::new("."), PlantName::Reference).expect("a good test")
}

/// Lost motion at the link [rad].
fn lost_motion(test: &Test, seed: u64) -> f64 {
    let case = test.case(seed).expect("a case of the test");
    2.0 * case.half_backlash() / case.truth.parameters.geometry.carrier_base_radius()
}

/// Encoder zeros at any angle cost no crossing, compared with the same joint whose zeros are at the start.
#[test]
fn any_encoder_zeros_hold_still() {
    for (joint, seed) in joints_and_seeds(700, 3) {
        let test = hold(joint, "");
        let case = test.case(seed).expect("a case of the test");
        let mut homed = test.case(seed).expect("a case of the test");
        homed.zeros = EncoderZeros::default();
        let [mounted, homed] = [case, homed]
            .map(|case| Figures::of(&run_in(&test, &case, seed, on_reference(NoPreview)).run, test.file.settle));
        assert!(mounted.crossings <= homed.crossings + 2, "{joint}, seed {seed}: {mounted:?} {homed:?}");
        assert!(mounted.peak <= 1.1 * homed.peak + 2e-4, "{joint}, seed {seed}: {mounted:?} {homed:?}");
    }
}

/// A link that turns at 1 rad/s at power-up is caught with at most 1.1 times PID's peak.
#[test]
fn turning_joint_is_caught() {
    for (joint, seed) in joints_and_seeds(710, 2) {
        let test = hold(joint, "");
        let [ours, pid] = [NoPreview, MotorPid].map(|controller| turning(&test, seed, controller));
        assert!(ours.peak <= 1.1 * pid.peak, "{joint}, seed {seed}: {ours:?} {pid:?}");
    }
}

/// An output encoder that falls silent while the joint rests leaves the link in place.
#[test]
fn silent_output_at_rest_holds_still() {
    let lost = "[[fault]]\nkind = \"lost_frames\"\nframes = \"output\"\nshare = 1\nstart_s = 3\nend_s = 5";
    for (joint, seed) in joints_and_seeds(720, 2) {
        let test = hold(joint, lost);
        let run = run(&test, seed, NoPreview).run;
        let peak = Figures::of(&run, 3.0).peak;
        assert!(peak <= lost_motion(&test, seed) + 1e-3, "{joint}, seed {seed}: {peak} rad");
    }
}

/// Before its first reading the angle of the link is unknown, so the torque is zero.
#[test]
fn late_output_at_power_up_waits() {
    let late = "[[fault]]\nkind = \"lost_frames\"\nframes = \"output\"\nshare = 1\nstart_s = 0\nend_s = 0.1";
    for (joint, seed) in joints_and_seeds(730, 2) {
        let history = run(&hold(joint, late), seed, NoPreview);
        let asked = |period: usize| history.run.samples[period].command;
        assert!((0..990).all(|period| asked(period) == 0.0), "{joint}, seed {seed} drives blindly");
        let peak = Figures::of(&history.run, 0.2).peak;
        assert!(peak < 0.05, "{joint}, seed {seed}: {peak} rad");
    }
}

/// Figures of a joint whose link turns at 1 rad/s at power-up.
fn turning(test: &Test, seed: u64, controller: ControllerName) -> Figures {
    let case = test.case(seed).expect("a case of the test");
    let mut setup = setup(&test.file, &case, seed, on_reference(controller));
    let planets = setup.joint.geometry.planets;
    setup.start = Start::Relative(RelativeState { rigid_speed: 1.0, ..RelativeState::centred(planets) });
    let rig = Rig::new(&setup).expect("a rig");
    let designed = case.design(&test.file).expect("tables");
    let around = &case.nominal_surroundings;
    let turns = [around.motor_encoder, around.output_encoder].map(|encoder| encoder.counts_per_turn);
    let mut loop_controller = match controller {
        NoPreview => ActiveController::Compensation(
            Box::new(HostPort::new(&designed)),
            Translator::new(designed.ticks, turns, &case.zeros, true),
        ),
        rival => ActiveController::rival(rival, case.knowledge(), case.bandwidth(&test.file).expect("a bandwidth")),
    };
    let mut set_points = SetPointSource::new(&test.file, &case, controller, Some(&designed));
    let (mut samples, period) = (Vec::new(), rig.period());
    rig.run(&mut loop_controller, &mut set_points, &mut |now| {
        samples.push(Sample::of(now.plant.joint(), now.wanted, now.half_backlash, now.command));
        Ok(())
    })
    .expect("the test runs");
    Figures::of(&Run { samples, period }, 0.0)
}
