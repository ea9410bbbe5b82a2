//! Wiring check on virtual joints: a joint that is wired rightly is found right, and each miswiring is named, on presets
//! and on joints with parameters drawn at random. In all of them torque and travel stay within what was allowed.

use model_core::gears::{Kinematics, Tables, design::design};
use model_core::numbers::random::splitmix64;
use model_core::observer::design::{ObserverSettings, design_observer, observer_settings};
use model_core::observer::{MAPPED, Observer, Reading, Samples};
use model_core::virtual_joint::{SurroundingsTable, VirtualJoint, design::design_surroundings};
use model_core::wiring::WiringTable;
use model_core::wiring::design::design_wiring;
use model_core::wiring::{Wiring, WiringCheck, WiringItem, WiringJudge, WiringProgress, WiringRefusal, WiringVerdict};
use parameters::{AbsoluteEncoder, JointParameters, Surroundings};

const PRESETS: [&str; 5] = ["q1", "s1", "c1", "d2", "l1"];

/// A joint with what surrounds it.
#[derive(Clone)]
struct Joint {
    parameters: JointParameters,
    around: Surroundings,
}

impl Joint {
    fn preset(name: &str) -> Self {
        Self::read(joint_file::preset(name).expect("a preset"))
    }

    fn read(text: &str) -> Self {
        let file = joint_file::read(text).expect("a joint");
        Self { parameters: file.parameters, around: file.surroundings }
    }

    /// The cycloidal preset or Q1 with other ratio, width, inertia, friction and encoders.
    fn random(seed: u64) -> Self {
        let mut state = seed.wrapping_mul(0x9e37_79b9) + 1;
        let mut share = || (splitmix64(&mut state) >> 40) as f64 / (1_u64 << 24) as f64;
        let mut scale = |most: f64| most.powf(2.0 * share() - 1.0);
        let mut joint = if seed.is_multiple_of(2) {
            let ratio = (25.0 * scale(4.0)).round();
            let text = joint_file::preset("c1").expect("a preset").replace("ratio = 59", &format!("ratio = {ratio}"));
            let text = text.replace("limit_N_m = 4.0", &format!("limit_N_m = {:.3}", 4.0 * 59.0 / ratio));
            Self::read(&text)
        } else {
            Self::preset("q1")
        };
        let wider = scale(2.0);
        joint.parameters.sun_planet.half_backlash.iter_mut().for_each(|half| *half *= wider);
        joint.parameters.ring_planet.half_backlash.iter_mut().for_each(|half| *half *= wider);
        joint.parameters.link_inertia *= scale(3.0);
        joint.parameters.rotor_inertia *= scale(2.0);
        joint.around.motor_friction.coulomb *= scale(2.0);
        joint.around.load_friction.coulomb *= scale(2.0);
        joint.around.gravity_torque *= scale(2.0) * 0.5;
        joint.around.motor_encoder.counts_per_turn = 1 << (16.0 + (scale(7.39).ln()).round()) as u32;
        joint.around.output_encoder.counts_per_turn = 1 << (18.0 + (scale(7.39).ln()).round()) as u32;
        joint
    }
}

/// Wrong signs, scales and connections between joint and check.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Miswiring {
    Nothing,
    MotorReversed,
    OutputReversed,
    TorqueReversed,
    Exchanged,
    MotorBits(i32),
    OutputBits(i32),
    OtherRatio,
    TorqueScale(f32),
    /// Every sample twice.
    TwiceCalled,
    /// At twice the control rate.
    TwiceAsOften,
    /// Ticks of the clock times a half or 2.
    Clock(f64),
    MotorTimeStands,
    OutputStands,
    NoTorque,
}

const MISWIRINGS: [Miswiring; 19] = [
    Miswiring::MotorReversed,
    Miswiring::OutputReversed,
    Miswiring::TorqueReversed,
    Miswiring::Exchanged,
    Miswiring::MotorBits(-2),
    Miswiring::MotorBits(-1),
    Miswiring::MotorBits(1),
    Miswiring::MotorBits(2),
    Miswiring::OutputBits(-2),
    Miswiring::OutputBits(-1),
    Miswiring::OutputBits(1),
    Miswiring::OutputBits(2),
    Miswiring::OtherRatio,
    Miswiring::TorqueScale(0.4),
    Miswiring::TorqueScale(2.5),
    Miswiring::TwiceCalled,
    Miswiring::TwiceAsOften,
    Miswiring::Clock(0.5),
    Miswiring::Clock(2.0),
];

impl Miswiring {
    /// The item that has to be named.
    fn item(self) -> Option<WiringItem> {
        Some(match self {
            Self::Nothing => return None,
            Self::MotorReversed => WiringItem::MotorDirection,
            Self::OutputReversed => WiringItem::OutputDirection,
            Self::TorqueReversed => WiringItem::TorqueDirection,
            Self::Exchanged => WiringItem::Places,
            Self::MotorBits(_) => WiringItem::MotorCounts,
            Self::OutputBits(_) | Self::OutputStands => WiringItem::OutputCounts,
            Self::OtherRatio => WiringItem::Ratio,
            Self::TorqueScale(_) => WiringItem::TorqueScale,
            Self::TwiceCalled => WiringItem::Calls,
            Self::TwiceAsOften => WiringItem::Period,
            Self::Clock(_) => WiringItem::Clock,
            Self::MotorTimeStands => WiringItem::MotorTime,
            Self::NoTorque => WiringItem::Motion,
        })
    }

    /// The joint that is there, where the check is told of another one.
    fn real(self, told: &Joint) -> Joint {
        let mut real = told.clone();
        let counts = |of: AbsoluteEncoder, more: i32| 1 << bits(&of).checked_add_signed(more).expect("bits");
        match self {
            Self::MotorBits(more) => {
                real.around.motor_encoder.counts_per_turn = counts(real.around.motor_encoder, more);
            }
            Self::OutputBits(more) => {
                real.around.output_encoder.counts_per_turn = counts(real.around.output_encoder, more);
            }
            Self::TwiceAsOften => {
                real.around.control_rate *= 2;
                real.around.delay = (2.0 * real.around.delay).min(4.0);
            }
            _ => {}
        }
        real
    }
}

/// Outcome of a check.
struct Outcome {
    wiring: Wiring<f32>,
    refusal: Option<WiringRefusal>,
    /// Largest torque [N m], and travel of the link over the largest travel of the design [-].
    torque: f32,
    travel: f64,
    seconds: f64,
}

struct Bench<'t, const N: usize> {
    gears: &'t Tables<f32, N>,
    around: &'t SurroundingsTable<f32>,
    /// Of joint and of tables.
    bits: [[u32; 2]; 2],
    zeros: [u32; 2],
    rate: f64,
}

fn bits(encoder: &AbsoluteEncoder) -> u32 {
    encoder.bits().expect("a power of two")
}

/// Counts of an encoder whose zero is elsewhere.
fn shifted(counts: u32, zero: u32, bits: u32) -> u32 {
    counts.wrapping_add(zero) & ((1 << bits) - 1)
}

impl<const N: usize> Bench<'_, N> {
    fn samples(&self, joint: &VirtualJoint<'_, f32, N>, is: Miswiring) -> Samples<f32> {
        let mut samples = joint.samples();
        let [real, _] = self.bits;
        let turned = |counts: u32, bits: u32| (1 << bits) - 1 - counts;
        samples.motor.counts = shifted(samples.motor.counts, self.zeros[0], real[0]);
        let output = samples.output.as_mut().expect("an output");
        output.counts = shifted(output.counts, self.zeros[1], real[1]);
        match is {
            Miswiring::MotorReversed => samples.motor.counts = turned(samples.motor.counts, real[0]),
            Miswiring::OutputReversed => output.counts = turned(output.counts, real[1]),
            Miswiring::Exchanged => core::mem::swap(&mut samples.motor.counts, &mut output.counts),
            Miswiring::OutputStands => output.counts = 77,
            Miswiring::TwiceAsOften => {
                samples.time /= 2;
                samples.motor.time /= 2;
                output.time /= 2;
            }
            Miswiring::Clock(factor) => {
                let by = |time: u32| (f64::from(time) * factor) as u32;
                samples.time = by(samples.time);
                samples.motor.time = by(samples.motor.time);
                output.time = by(output.time);
            }
            Miswiring::MotorTimeStands => samples.motor.time = 0,
            _ => {}
        }
        samples
    }

    fn check(&self, is: Miswiring, table: &WiringTable<f32>, allowed: f32) -> Outcome {
        let mut joint = VirtualJoint::new(self.gears, self.around);
        let mut check = WiringCheck::new(table);
        let calls = if is == Miswiring::TwiceCalled { 2 } else { 1 };
        let (mut torque, mut most, mut furthest, mut periods) = (0.0_f32, 0.0_f32, 0_i64, 0_u32);
        let (wiring, refusal) = 'check: loop {
            let mut samples = self.samples(&joint, is);
            samples.torque = torque;
            for _ in 0..calls {
                let progress;
                (torque, progress) = check.step(&samples, allowed);
                match progress {
                    WiringProgress::Running => {}
                    WiringProgress::Done(wiring) => break 'check (wiring, None),
                    WiringProgress::Refused(refusal) => break 'check (check.wiring(), Some(refusal)),
                }
            }
            most = most.max(torque.abs());
            let scale = match is {
                Miswiring::TorqueReversed => -1.0,
                Miswiring::TorqueScale(scale) => scale,
                Miswiring::NoTorque => 0.0,
                _ => 1.0,
            };
            joint.advance(scale * torque, 0.0);
            let outputs = joint.outputs();
            let place = (i64::from(outputs.carrier_turns) << 32) | i64::from(outputs.carrier_fraction);
            furthest = furthest.max(place.abs());
            periods += 1;
        };
        assert_eq!(check.step(&joint.samples(), allowed).0, 0.0, "a check that has ended gives no torque");
        let angle = furthest as f64 / 2_f64.powi(32) * std::f64::consts::TAU;
        let limit = f64::from(table.limit[1]) * f64::from(table.counts.output.angle);
        Outcome { wiring, refusal, torque: most, travel: angle / limit, seconds: f64::from(periods) / self.rate }
    }
}

fn checked<const N: usize>(
    real: &Joint,
    told: &Joint,
    settings: &ObserverSettings,
    is: Miswiring,
    seed: u64,
) -> (Outcome, f32) {
    let gears: Tables<f32, N> = design(&real.parameters, real.around.control_rate).expect("tables");
    let around = design_surroundings(&real.parameters, &real.around, &gears).expect("tables");
    let table: WiringTable<f32> = design_wiring(&told.parameters, settings).expect("a table");
    let mut state = seed;
    let bits = [real, told].map(|joint| [bits(&joint.around.motor_encoder), bits(&joint.around.output_encoder)]);
    let zeros = bits[0].map(|bits| splitmix64(&mut state) as u32 & ((1 << bits) - 1));
    let bench = Bench { gears: &gears, around: &around, bits, zeros, rate: real.around.control_rate.into() };
    (bench.check(is, &table, table.torque), table.torque)
}

/// A check of a joint, of which it is told what the miswiring leaves right.
fn outcome(told: &Joint, is: Miswiring, seed: u64) -> (Outcome, f32) {
    let real = is.real(told);
    let mut told = told.clone();
    if is == Miswiring::OtherRatio {
        // Tables for two more teeth in nine of the ring: another ratio, all else the same.
        let other = if told.parameters.geometry.planets == 1 { "c1" } else { "q1" };
        let more = if other == "c1" {
            let text = joint_file::preset("c1").expect("a preset");
            let ratio = told.parameters.geometry.ratio_by_teeth();
            let text = text.replace("limit_N_m = 4.0", "limit_N_m = 40.0");
            Joint::read(&text.replace("ratio = 59", &format!("ratio = {}", (1.25 * ratio).round())))
        } else {
            Joint::preset(if (told.parameters.geometry.ratio_by_teeth() - 5.0).abs() < 0.1 { "q1" } else { "s1" })
        };
        told.parameters.geometry = more.parameters.geometry;
    }
    let settings = observer_settings(&told.around);
    match real.parameters.geometry.planets {
        1 => checked::<1>(&real, &told, &settings, is, seed),
        _ => checked::<3>(&real, &told, &settings, is, seed),
    }
}

/// Items that are wrong or suspect.
fn named(wiring: &Wiring<f32>) -> Vec<(WiringItem, WiringVerdict<f32>)> {
    wiring.iter().filter(|(_, verdict)| verdict.is_bad()).collect()
}

/// Returns true if exactly the item of the miswiring is named; prints the findings otherwise. Fails if a miswired joint
/// is found right.
fn is_named(told: &Joint, is: Miswiring, seed: u64, label: &str) -> bool {
    let (outcome, allowed) = outcome(told, is, seed);
    assert!(outcome.torque <= allowed, "{label} {is:?}: {} N m of {allowed}", outcome.torque);
    assert!(outcome.travel <= 1.0, "{label} {is:?}: {} of the travel", outcome.travel);
    let found = named(&outcome.wiring);
    assert!(
        is == Miswiring::Nothing || !found.is_empty() || std::env::var_os("WIRING_ALL").is_some(),
        "{label} {is:?} goes unnoticed:\n{}",
        outcome.wiring
    );
    // With exchanged counts the measured travel is too large, so that the check may end early.
    let may_end = outcome.refusal.is_none() || is == Miswiring::Exchanged;
    let right = may_end
        && match is.item() {
            None => {
                let seen = |(_, verdict)| verdict == WiringVerdict::Right;
                outcome.wiring.iter().all(seen)
            }
            Some(item) => matches!(found.as_slice(), [(only, WiringVerdict::Wrong(_))] if *only == item),
        };
    if !right || std::env::var_os("WIRING_PRINTED").is_some() {
        println!(
            "{label} {is:?} {}: {found:?} {:?}, {:.2} of the travel, {:.1} s{}",
            if right { "ok" } else { "NOT NAMED" },
            outcome.refusal,
            outcome.travel,
            outcome.seconds,
            if right { String::new() } else { format!("\n{}", outcome.wiring) },
        );
    }
    right
}

#[test]
fn right_wiring_is_right_on_every_preset() {
    for name in PRESETS {
        for seed in 0..2 {
            assert!(is_named(&Joint::preset(name), Miswiring::Nothing, seed, name), "{name}");
        }
    }
}

#[test]
fn each_miswiring_is_named_on_every_preset() {
    let (mut all, mut right) = (0, 0);
    for name in PRESETS {
        let joint = Joint::preset(name);
        for (is, seed) in MISWIRINGS.into_iter().zip(1..) {
            all += 1;
            right += usize::from(is_named(&joint, is, seed, name));
        }
        for is in [Miswiring::MotorTimeStands, Miswiring::OutputStands, Miswiring::NoTorque] {
            all += 1;
            right += usize::from(is_named(&joint, is, 99, name));
        }
    }
    println!("{right} of {all} miswirings named");
    assert_eq!(right, all);
}

#[test]
fn random_joints_have_their_miswirings_named() {
    let joints: u64 = std::env::var("WIRING_JOINTS").ok().and_then(|number| number.parse().ok()).unwrap_or(2);
    let (mut all, mut right, mut sound) = (0, 0, 0);
    for seed in 0..joints {
        let joint = Joint::random(seed);
        let label = format!("random {seed}");
        sound += usize::from(is_named(&joint, Miswiring::Nothing, seed, &label));
        for is in MISWIRINGS {
            all += 1;
            right += usize::from(is_named(&joint, is, seed + 7, &label));
        }
    }
    println!("{sound} of {joints} sound joints right, {right} of {all} miswirings named");
    assert_eq!(sound, joints as usize);
    // A motor that only crosses its gap while it is read as the output does not tell exchanged encoders from a dead one.
    assert!(right as f64 >= 0.97 * all as f64, "{right} of {all}");
}

#[test]
fn an_observer_called_twice_notices_equal_times_and_not_half_periods() {
    let joint = Joint::preset("q1");
    let tables = design_observer::<f32>(&joint.parameters, &observer_settings(&joint.around)).expect("tables");
    // Of the second call of a period whose samples are half a period, or none, after the first.
    let noticed = |later: u32| {
        let mut observer = Observer::<f32, MAPPED>::new(&tables);
        let mut noticed = 0;
        for period in 0..100_u32 {
            for time in [1000 * period, 1000 * period + later] {
                let reading = Reading { counts: 0, time };
                let samples = Samples { time, motor: reading, output: Some(reading), torque: 0.0 };
                noticed += u32::from(observer.step(&samples).notices.out_of_time);
            }
        }
        noticed
    };
    assert_eq!(noticed(0), 100);
    // Half a period is within the jitter that the observer allows: only the wiring check names it.
    assert_eq!(noticed(500), 0);
}

#[test]
fn a_steady_torque_tells_neither_its_direction_nor_its_scale() {
    let joint = Joint::preset("q1");
    let table: WiringTable<f32> = design_wiring(&joint.parameters, &observer_settings(&joint.around)).expect("a table");
    let mut judge = WiringJudge::new(&table);
    for period in 0..5000_u32 {
        let time = 1000 * period;
        // Q1 turns the motor six times for one turn of the link; its encoders have 14 and 17 bits.
        let [motor, output] = [period, 4 * period / 3].map(|counts| Reading { counts, time });
        judge.step(&Samples { time, motor, output: Some(output), torque: 0.1 });
    }
    let wiring = judge.wiring();
    assert_eq!(wiring.verdict(WiringItem::Ratio), WiringVerdict::Right);
    for item in [WiringItem::TorqueDirection, WiringItem::TorqueScale] {
        assert!(
            matches!(wiring.verdict(item), WiringVerdict::NotSeen | WiringVerdict::Right),
            "{item:?}: {:?}",
            wiring.verdict(item)
        );
    }
}
