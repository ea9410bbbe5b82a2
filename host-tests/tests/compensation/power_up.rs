//! Power-up: encoders whose zeros lie anywhere, a joint that was left anywhere in its gap or turns already, an output encoder that
//! comes late. Encoder zeros and the place in the gap are drawn in every run of every test; here they are looked at by themselves.

use std::path::Path;

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

/// Joints with teeth and gears without, of ratios from 6 to 100.
const JOINTS: [&str; 5] = ["q1", "s1", "c1", "d2", "l1"];

/// A link that stays where it is after a push.
fn hold(joint: &str, faults: &str) -> Test {
    let text = format!(
        "joint = \"{joint}\"\nprofile = \"free_hold\"\nduration_s = 6\nsettle_s = 2\n{faults}\n[controller]\nmode = \"no_preview\"\nrivals = []\n"
    );
    from_text("power-up.toml", &text, Path::new("."), PlantName::Reference).expect("a good test")
}

/// Angle of the link that the teeth leave free [rad].
fn lost_motion(test: &Test, seed: u64) -> f64 {
    let case = test.case(seed).expect("a case of the test");
    2.0 * case.half_backlash() / case.truth.parameters.geometry.carrier_base_radius()
}

/// Encoder zeros that differ by any angle cost no crossing: the same joint with both zeros at the start is the measure.
#[test]
fn any_encoder_zeros_hold_still() {
    for joint in JOINTS {
        let test = hold(joint, "");
        for seed in 700..703 {
            let case = test.case(seed).expect("a case of the test");
            let mut homed = test.case(seed).expect("a case of the test");
            homed.zeros = EncoderZeros::default();
            let [mounted, homed] = [case, homed]
                .map(|case| Figures::of(&run_in(&test, &case, seed, on_reference(NoPreview)).run, test.file.settle));
            assert!(mounted.crossings <= homed.crossings + 2, "{joint}, seed {seed}: {mounted:?} {homed:?}");
            assert!(mounted.peak <= 1.1 * homed.peak + 2e-4, "{joint}, seed {seed}: {mounted:?} {homed:?}");
        }
    }
}

/// A link that turns at 1 rad/s when the controller is switched on is caught as PID catches it.
#[test]
fn a_turning_joint_is_caught() {
    for joint in JOINTS {
        let test = hold(joint, "");
        for seed in 710..712 {
            let [ours, pid] = [NoPreview, MotorPid].map(|controller| turning(&test, seed, controller));
            assert!(ours.peak <= 1.1 * pid.peak, "{joint}, seed {seed}: {ours:?} {pid:?}");
        }
    }
}

/// An output encoder that falls silent while the joint rests leaves the link where it is.
#[test]
fn output_silent_at_rest_holds_still() {
    let lost = "[[fault]]\nkind = \"lost_frames\"\nframes = \"output\"\nshare = 1\nstart_s = 3\nend_s = 5";
    for joint in JOINTS {
        let test = hold(joint, lost);
        for seed in 720..722 {
            let run = run(&test, seed, NoPreview).run;
            let peak = Figures::of(&run, 3.0).peak;
            assert!(peak <= lost_motion(&test, seed) + 1e-3, "{joint}, seed {seed}: {peak} rad");
        }
    }
}

/// Before its first reading nobody knows where the link is against its set-point: no torque is given until then.
#[test]
fn output_late_at_power_up_waits() {
    let late = "[[fault]]\nkind = \"lost_frames\"\nframes = \"output\"\nshare = 1\nstart_s = 0\nend_s = 0.1";
    for joint in JOINTS {
        for seed in 730..732 {
            let history = run(&hold(joint, late), seed, NoPreview);
            let asked = |period: usize| history.run.samples[period].command;
            assert!((0..990).all(|period| asked(period) == 0.0), "{joint}, seed {seed} drives blindly");
            let peak = Figures::of(&history.run, 0.2).peak;
            assert!(peak < 0.05, "{joint}, seed {seed}: {peak} rad");
        }
    }
}

/// Figures of a joint whose link turns at 1 rad/s when its controller is switched on.
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
            Translator::new(designed.ticks, turns, &case.zeros),
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
