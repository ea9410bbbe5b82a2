//! Effects of real joints in the drive train, tested one at a time: each test adds one effect to an ideal train and
//! checks a figure that follows from it in closed form.

use std::f64::consts::{PI, TAU};

use parameters::{
    AbsoluteEncoder, Drift, Friction, Hysteresis, JointParameters, Payload, PayloadStep, Presliding,
    SubdivisionalError, Surroundings, TorqueErrors, WidthVariation,
};
use reference::drive_train::{Disturbance, DriveTrain, DriveTrainParameters, EffectPhases, Stepping};
use reference::joint::{Observation, Reference, RelativeState, Start};
use reference::scenarios::q1;

/// Control period of ideal surroundings [s].
const PERIOD: f64 = 1e-4;

fn turning(rigid_speed: f64) -> Start {
    Start::Relative(RelativeState { rigid_speed, ..RelativeState::centred(3) })
}

fn train_of(
    joint: &JointParameters,
    rigid_speed: f64,
    parameters: impl Into<DriveTrainParameters>,
    pushes: Vec<Disturbance>,
) -> DriveTrain {
    DriveTrain::new(joint, &turning(rigid_speed), parameters.into(), pushes, 7)
        .expect("a sound drive train")
        .stepped(Stepping::Fixed)
}

fn train(rigid_speed: f64, around: Surroundings) -> DriveTrain {
    train_of(&q1(), rigid_speed, around, Vec::new())
}

fn near(found: f64, expected: f64, part: f64) {
    assert!((found / expected - 1.0).abs() < part, "{found} for {expected}");
}

/// Mean and standard deviation.
fn statistics(values: &[f64]) -> [f64; 2] {
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    [mean, (values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / values.len() as f64).sqrt()]
}

/// Inertia of Q1's link and everything that turns with it while the teeth are free, without the motor [kg m^2].
fn carrier_side(joint: &JointParameters) -> f64 {
    let (cosine, planets) = (joint.geometry.working_pressure_angle.cos(), joint.geometry.planets as f64);
    let lever = joint.geometry.carrier_radius * cosine;
    let carrier = joint.bodies.carrier_inertia_over_radius_squared + planets * joint.bodies.planet_mass;
    carrier / (cosine * cosine) * lever * lever
}

/// Total inertia of Q1 referred to the link [kg m^2].
fn whole(joint: &JointParameters, link_inertia: f64) -> f64 {
    let lever = joint.geometry.carrier_radius * joint.geometry.working_pressure_angle.cos();
    let motor = joint.rotor_inertia + joint.bodies.sun_equivalent_mass * joint.geometry.sun_base_radius.powi(2);
    36.0 * motor + carrier_side(joint) + 3.0 * joint.bodies.planet_equivalent_mass * lever * lever + link_inertia
}

#[test]
fn noise_is_white_with_stated_deviation() {
    let mut around = Surroundings::ideal();
    around.output_encoder = AbsoluteEncoder { noise_counts: 1.5, ..AbsoluteEncoder::ideal(17) };
    let mut train = train(0.0, around);
    let counts: Vec<f64> = (0..20_000)
        .map(|_| {
            train.advance(0.0).expect("it runs");
            train.measure().output_counts as f64
        })
        .collect();
    let [mean, deviation] = statistics(&counts);
    // Rounding down adds the variance 1/12 and half a count; the deviation of 20000 readings is uncertain by 0.5 %.
    near(deviation, (1.5_f64.powi(2) + 1.0 / 12.0).sqrt(), 0.02);
    assert!((mean + 0.5).abs() < 0.05, "{mean}");
    let pairs = counts.windows(2).map(|pair| (pair[0] - mean) * (pair[1] - mean)).sum::<f64>();
    assert!((pairs / 20_000.0 / deviation.powi(2)).abs() < 0.03, "readings are independent");
    assert!(counts.iter().any(|count| *count != counts[0]) && train.measure().motor_counts == 0);
}

#[test]
fn encoder_noises_are_independent() {
    let mut around = Surroundings::ideal();
    around.motor_encoder = AbsoluteEncoder { noise_counts: 3.0, ..AbsoluteEncoder::ideal(14) };
    around.output_encoder = AbsoluteEncoder { noise_counts: 3.0, ..AbsoluteEncoder::ideal(17) };
    let mut train = train(0.0, around);
    let (mut motor, mut output) = (Vec::new(), Vec::new());
    for _ in 0..10_000 {
        train.advance(0.0).expect("it runs");
        motor.push(train.measure().motor_counts as f64);
        output.push(train.measure().output_counts as f64);
    }
    let ([motor_mean, motor_deviation], [output_mean, output_deviation]) = (statistics(&motor), statistics(&output));
    let product = motor.iter().zip(&output).map(|(a, b)| (a - motor_mean) * (b - output_mean)).sum::<f64>() / 10_000.0;
    // The bound is four standard deviations of the correlation of 10,000 independent pairs.
    assert!((product / motor_deviation / output_deviation).abs() < 0.04, "{product}");
}

#[test]
fn scale_period_error_has_its_harmonics() {
    let mut around = Surroundings::ideal();
    let subdivision = SubdivisionalError { periods_per_turn: 4, first: 0.1e-3, second: 0.05e-3 };
    around.output_encoder = AbsoluteEncoder { subdivision, ..AbsoluteEncoder::ideal(22) };
    let effect_phases = EffectPhases { output_subdivision: [0.4, 1.1], ..EffectPhases::default() };
    let mut train = train_of(&q1(), TAU, DriveTrainParameters { effect_phases, ..around.into() }, Vec::new());
    let count = TAU / f64::from(1 << 22);
    // Cosine and sine parts of the error at 1 to 9 periods a turn, over one turn of 10000 readings.
    let mut parts = [[0.0; 2]; 10];
    for _ in 0..10_000 {
        train.advance(0.0).expect("it runs");
        let angle = train.joint().link_angle;
        let error = (train.measure().output_counts as f64 + 0.5) * count - angle;
        for (order, part) in parts.iter_mut().enumerate() {
            let (sine, cosine) = (order as f64 * angle).sin_cos();
            part[0] += error * cosine / 5000.0;
            part[1] += error * sine / 5000.0;
        }
    }
    for (order, [cosine, sine]) in parts.into_iter().enumerate().skip(1) {
        let (amplitude, phase) = (cosine.hypot(sine), cosine.atan2(sine));
        match order {
            4 => assert!((amplitude - 0.1e-3).abs() < 1e-7 && (phase - 0.4).abs() < 1e-2, "{amplitude} {phase}"),
            8 => assert!((amplitude - 0.05e-3).abs() < 1e-7 && (phase - 1.1).abs() < 1e-2, "{amplitude} {phase}"),
            _ => assert!(amplitude < 2e-7, "{amplitude} rad at {order} a turn"),
        }
    }
}

#[test]
fn jittering_age_is_uniform() {
    let mut around = Surroundings::ideal();
    around.output_encoder = AbsoluteEncoder { age_jitter: PERIOD, skew: 50e-6, ..AbsoluteEncoder::ideal(24) };
    let mut train = train(30.0, around);
    (0..10).for_each(|_| train.advance(0.0).expect("it runs"));
    let ages: Vec<f64> = (0..4000)
        .map(|_| {
            train.advance(0.0).expect("it runs");
            let read = (train.measure().output_counts as f64 + 0.5) * TAU / f64::from(1 << 24);
            (train.joint().link_angle - read) / train.joint().link_speed
        })
        .collect();
    let [mean, deviation] = statistics(&ages);
    near(mean, 50e-6 + 0.5 * PERIOD, 0.02);
    near(deviation, PERIOD / 12_f64.sqrt(), 0.04);
    assert!(ages.iter().all(|age| (49e-6..151e-6).contains(age)), "older than its skew, by a period at most");
}

#[test]
fn added_effect_keeps_other_random_numbers() {
    let base = Surroundings {
        torque_noise_ratio: 0.015,
        motor_encoder: AbsoluteEncoder { noise_counts: 2.0, ..AbsoluteEncoder::ideal(14) },
        ..Surroundings::ideal()
    };
    let more = Surroundings {
        output_encoder: AbsoluteEncoder { noise_counts: 1.0, age_jitter: PERIOD, ..AbsoluteEncoder::ideal(17) },
        ..base
    };
    let run = |around: Surroundings| {
        let mut train = train(0.0, around);
        let step = |_| {
            train.advance(0.3).expect("it runs");
            (train.measure().motor_counts, train.torques().air_gap.to_bits())
        };
        (0..300).map(step).collect::<Vec<_>>()
    };
    assert_eq!(run(base), run(more));
}

/// Peak-to-peak gap coordinate while the motor is pushed to and fro and the link is held by its friction [m].
fn free_width(train: &mut DriveTrain) -> f64 {
    let mut ends = [f64::INFINITY, f64::NEG_INFINITY];
    for push in [0.2, -0.2] {
        (0..1500).for_each(|_| train.advance(push).expect("it runs"));
        let gap = train.joint().gap;
        ends = [ends[0].min(gap), ends[1].max(gap)];
    }
    ends[1] - ends[0]
}

/// Q1 with its link held by friction and a motor that comes to rest on a flank.
fn held() -> Surroundings {
    Surroundings {
        load_friction: Friction { coulomb: 5.0, ..Friction::default() },
        motor_friction: Friction { viscous: 2e-2, ..Friction::default() },
        ..Surroundings::ideal()
    }
}

#[test]
fn backlash_varies_with_link_angle() {
    let joint = q1();
    let width = 4.0 * joint.sun_planet.half_backlash[0];
    for (phase, expected) in [(0.5 * PI, 1.3), (-0.5 * PI, 0.7), (0.0, 1.0)] {
        let around = Surroundings { width: WidthVariation { per_link_turn: 0.3, per_motor_turn: 0.0 }, ..held() };
        let effect_phases = EffectPhases { width: [phase, 0.0], ..EffectPhases::default() };
        let mut train = train_of(&joint, 0.0, DriveTrainParameters { effect_phases, ..around.into() }, Vec::new());
        near(free_width(&mut train), expected * width, 0.01);
        near(train.width_scale(), expected, 2e-3);
    }
}

#[test]
fn backlash_varies_with_motor_angle() {
    let around =
        Surroundings { width: WidthVariation { per_link_turn: 0.0, per_motor_turn: 0.2 }, ..Surroundings::ideal() };
    let mut train = train(1.0, around);
    for _ in 0..2000 {
        // The width is constant within a period, at its initial value.
        let expected = 1.0 + 0.2 * train.joint().motor_angle.sin();
        train.advance(0.0).expect("it runs");
        near(train.width_scale(), expected, 1e-12);
    }
}

#[test]
fn backlash_and_friction_drift_linearly() {
    let joint = q1();
    let around = Surroundings { drift: Drift { friction: 0.0, width: 0.1 }, ..held() };
    let mut train = train_of(&joint, 0.0, around, Vec::new());
    (0..20_000).for_each(|_| train.advance(0.0).expect("it runs"));
    // From 2 s on: the first end is reached at 2.15 s, the second at 2.3 s.
    near(free_width(&mut train), 4.0 * joint.sun_planet.half_backlash[0] * 1.2225, 0.01);

    let around = Surroundings {
        load_friction: Friction { coulomb: 0.1, ..Friction::default() },
        drift: Drift { friction: 0.1, width: 0.0 },
        ..Surroundings::ideal()
    };
    let mut train = train_of(&joint, 1.0, around, Vec::new());
    (0..10_000).for_each(|_| train.advance(0.0).expect("it runs"));
    // The speed lost in 1 s is F_c / J (t + drift t^2 / 2).
    near(1.0 - train.joint().rigid_speed, 0.1 / whole(&joint, joint.link_inertia) * 1.05, 2e-3);
}

#[test]
fn presliding_creeps_to_break_away() {
    let friction = Friction { coulomb: 0.3, ..Friction::default() };
    let displacement = 0.2e-3;
    let around = Surroundings {
        load_friction: friction,
        presliding: Presliding { motor: 0.0, load: displacement },
        ..Surroundings::ideal()
    };
    let ramp = |torque| vec![Disturbance::Ramp { start: 0.0, duration: 4.0, torque }];
    let angle = |torque: f64, periods: u32| {
        let mut train = train_of(&q1(), 0.0, around, ramp(torque));
        (0..periods).for_each(|_| train.advance(0.0).expect("it runs"));
        -train.joint().link_angle
    };
    // Pushed slowly, the bristles carry F_c (1 - exp(-x / d)).
    for part in [0.1, 0.5, 0.8] {
        near(angle(part * 0.3, 41_000), -displacement * (1.0_f64 - part).ln(), 0.015);
    }
    // Below the dry friction the link stays, above it the link goes.
    let held = angle(0.95 * 0.3, 44_000);
    assert!((angle(0.95 * 0.3, 50_000) - held).abs() < 1e-6, "{held}");
    let gone = angle(1.1 * 0.3, 44_000);
    assert!(gone > 10.0 * displacement, "{gone}");
}

#[test]
fn presliding_changes_nothing_at_speed() {
    let coasting = |presliding: f64| {
        let around = Surroundings {
            load_friction: Friction { coulomb: 0.3, viscous: 0.1, ..Friction::default() },
            motor_friction: Friction { coulomb: 0.03, ..Friction::default() },
            presliding: Presliding { motor: 10.0 * presliding, load: presliding },
            ..Surroundings::ideal()
        };
        let mut train = train_of(&q1(), 3.0, around, Vec::new());
        (0..5000).for_each(|_| train.advance(0.0).expect("it runs"));
        train.joint().rigid_speed
    };
    near(coasting(0.2e-3), coasting(0.0), 1e-3);
}

/// Frequency [rad/s] and damping ratio of a decaying swing about zero, from its rising zeros and its peaks.
fn swing(values: &[f64], step: f64) -> [f64; 2] {
    let (mut zeros, mut peaks, mut peak) = (Vec::new(), Vec::new(), 0.0_f64);
    for (index, pair) in values.windows(2).enumerate() {
        if pair[0] < 0.0 && pair[1] >= 0.0 {
            zeros.push((index as f64 - pair[0] / (pair[1] - pair[0])) * step);
            peaks.push(peak);
            peak = 0.0;
        }
        peak = peak.max(pair[1]);
    }
    let turns = (zeros.len() - 1) as f64;
    let damped = TAU * turns / (zeros[zeros.len() - 1] - zeros[0]);
    // The first peak is before the first zero.
    let decrement = (peaks[1] / peaks[peaks.len() - 1]).ln() / (peaks.len() - 2) as f64;
    let ratio = decrement / (TAU * TAU + decrement * decrement).sqrt();
    [damped / (1.0 - ratio * ratio).sqrt(), ratio]
}

#[test]
fn payload_swings_like_two_masses() {
    let joint = q1();
    for (share, frequency, damping_ratio) in [(0.2, 40.0, 0.05), (0.5, 8.0, 0.02), (0.65, 25.0, 0.01)] {
        let around = Surroundings {
            payload: Payload { inertia_share: share, frequency, damping_ratio },
            ..Surroundings::ideal()
        };
        // To and fro, so that the link keeps no mean speed and the teeth stay in the gap.
        let push = |start, torque| Disturbance::Pulse { start, duration: 2e-3, torque };
        let mut train = train_of(&joint, 0.0, around, vec![push(0.0, 1.0), push(0.004, -1.0)]);
        let mut speeds = Vec::new();
        for period in 0..10_000 {
            train.advance(0.0).expect("it runs");
            assert!(train.joint().gap.abs() < 2.0 * joint.sun_planet.half_backlash[0], "in the gap");
            if period > 100 {
                speeds.push(train.joint().link_speed);
            }
        }
        // The pushes leave no mean speed.
        let rest = (1.0 - share) * joint.link_inertia + carrier_side(&joint);
        let stiffer = (1.0 + share * joint.link_inertia / rest).sqrt();
        let [found, ratio] = swing(&speeds, PERIOD);
        near(found, TAU * frequency * stiffer, 3e-3);
        near(ratio, damping_ratio * stiffer, 0.03);
    }
}

#[test]
fn payload_step_changes_inertia_and_weight() {
    let joint = q1();
    for ratio in [3.0, 1.0 / 3.0] {
        let step = PayloadStep { time: 0.2, ratio };
        let mut train = train_of(&joint, 0.5, Surroundings { payload_step: step, ..Surroundings::ideal() }, Vec::new());
        let speed_after = |train: &mut DriveTrain, periods: u32| {
            (0..periods).for_each(|_| train.advance(0.5).expect("it runs"));
            train.joint().rigid_speed
        };
        let begin = speed_after(&mut train, 1000);
        let before = speed_after(&mut train, 900) - begin;
        near(before / 0.09, 0.5 * 6.0 / whole(&joint, joint.link_inertia), 5e-3);
        let begin = speed_after(&mut train, 600);
        let after = speed_after(&mut train, 2000) - begin;
        near(after / 0.2, 0.5 * 6.0 / whole(&joint, ratio * joint.link_inertia), 5e-3);
    }
    let step = PayloadStep { time: 0.1, ratio: 3.0 };
    let around = Surroundings { gravity_torque: 2.0, payload_step: step, ..held() };
    let mut train =
        train_of(&joint, 0.0, around, vec![Disturbance::Pulse { start: 0.0, duration: 0.05, torque: -8.0 }]);
    let weight = |train: &mut DriveTrain, periods: u32| {
        (0..periods).for_each(|_| train.advance(0.0).expect("it runs"));
        train.torques().gravity / train.joint().link_angle.sin()
    };
    near(weight(&mut train, 900), 2.0, 1e-3);
    near(weight(&mut train, 500), 6.0, 1e-3);
}

/// Q1 without a gap, wound up slowly to and fro; returns the loss per cycle [J], the largest wind-up [rad], and the
/// largest error of the energy balance [J].
fn wind_up_cycle(hysteresis: Hysteresis, stepping: Stepping) -> [f64; 3] {
    let mut joint = q1();
    for mesh in [&mut joint.sun_planet, &mut joint.ring_planet] {
        mesh.half_backlash.iter_mut().for_each(|value| *value = 0.0);
    }
    let lever = joint.geometry.carrier_radius * joint.geometry.working_pressure_angle.cos();
    let mut reference =
        Reference::new(&joint).expect("sound").with_hysteresis(hysteresis.stiffness_share, hysteresis.torque);
    let energy = |at: &Observation| at.kinetic_energy + at.elastic_energy - at.work.net();
    let begin = energy(&reference.observe());
    let (mut loss, mut most, mut open, mut last) = (0.0, 0.0_f64, 0.0_f64, reference.observe());
    // Two cycles of 4 s with 10000 parts each; the first one leads into the steady loop.
    for part in 1..=20_000_u32 {
        let torque = 6.0 * (TAU * f64::from(part) / 10_000.0).sin();
        let time = f64::from(part) * 4e-4;
        match stepping {
            Stepping::Adaptive => reference.advance(time, torque / 6.0, torque).expect("it runs"),
            Stepping::Fixed => reference.advance_by_fixed_steps(time, torque / 6.0, torque),
        }
        let now = reference.observe();
        if part > 10_000 {
            loss += 0.5 * (now.wind_up_torque + last.wind_up_torque) * (now.wind_up - last.wind_up) / lever;
            most = most.max(now.wind_up.abs() / lever);
        }
        open = open.max((energy(&now) - begin).abs());
        last = now;
    }
    [loss, most, open]
}

#[test]
fn hysteresis_loses_its_loop_energy() {
    let stiffness = q1().compliance.expect("Q1 is compliant").stiffness;
    let [damper, amplitude, _] = wind_up_cycle(Hysteresis::default(), Stepping::Fixed);
    for (stiffness_share, torque) in [(0.2, 0.3), (0.5, 2.0)] {
        let slip = torque / (stiffness_share * stiffness);
        let hysteresis = Hysteresis { stiffness_share, torque };
        let [loss, most, open] = wind_up_cycle(hysteresis, Stepping::Fixed);
        // The damper's loss goes with the square of the amplitude.
        let loss = loss - damper * (most / amplitude).powi(2);
        near(loss, 4.0 * torque * (most - slip * (most / slip).tanh()), 0.01);
        let [adaptive_loss, adaptive_most, books] = wind_up_cycle(hysteresis, Stepping::Adaptive);
        near(adaptive_loss - damper * (adaptive_most / amplitude).powi(2), loss, 0.01);
        assert!(books < 1e-6 * loss, "energy is kept: {books} J of {loss} J, {open} J by fixed steps");
    }
    assert!(damper < 1e-2 * stiffness * amplitude * amplitude, "{damper} J without hysteresis");
}

#[test]
fn torque_ripple_is_proportional() {
    let errors = TorqueErrors { ripple_ratio: 0.02, ripple_periods_per_turn: 6, ..TorqueErrors::default() };
    let around = Surroundings { torque_errors: errors, torque_limit: 3.0, ..held() };
    for command in [0.5, -1.0] {
        let mut parameters = DriveTrainParameters::from(around);
        parameters.parts_per_period = 1;
        parameters.surroundings.load_friction = Friction::default();
        let mut train = train_of(&q1(), 0.2, parameters, Vec::new());
        for _ in 0..3000 {
            let middle = train.joint().motor_angle + 0.5 * PERIOD * train.joint().motor_speed;
            train.advance(command).expect("it runs");
            near(train.torques().air_gap / command, 1.0 + 0.02 * (6.0 * middle).sin(), 1e-9);
        }
        assert!(train.joint().motor_angle.abs() > 1.1, "a whole period of the ripple");
    }
}

#[test]
fn torque_is_quantised_and_saturates() {
    let given = |errors: TorqueErrors, command: f64| {
        let around = Surroundings { torque_errors: errors, torque_limit: 2.0, ..Surroundings::ideal() };
        let mut train = train(0.0, around);
        train.advance(command).expect("it runs");
        train.torques().air_gap
    };
    let steps = TorqueErrors { resolution_ratio: 0.05, ..TorqueErrors::default() };
    for (command, expected) in [(0.04, 0.0), (0.06, 0.1), (-0.149, -0.1), (-0.151, -0.2), (1.23, 1.2), (9.0, 2.0)] {
        assert!((given(steps, command) - expected).abs() < 1e-12, "{command}: {}", given(steps, command));
    }
    let saturation = TorqueErrors { saturation_ratio: 0.1, ..TorqueErrors::default() };
    for (command, expected) in [(2.0, 1.8), (-2.0, -1.8), (1.0, 0.975), (0.2, 0.1998)] {
        near(given(saturation, command), expected, 1e-12);
    }
}

#[test]
fn control_periods_start_within_jitter() {
    let mut train = train(0.0, Surroundings { control_jitter_ratio: 0.05, ..Surroundings::ideal() });
    let mut lateness = Vec::new();
    for period in 1..=4000 {
        train.advance(0.5).expect("it runs");
        let late = train.joint().time - f64::from(period) * PERIOD;
        assert!((late - train.lateness()).abs() < 1e-12, "the joint is where the period begins");
        lateness.push(late / PERIOD);
    }
    let [mean, deviation] = statistics(&lateness);
    near(mean, 0.025, 0.03);
    near(deviation, 0.05 / 12_f64.sqrt(), 0.03);
    assert!(lateness.iter().all(|late| (0.0..0.05).contains(late)));
    near(train.joint().rigid_speed, 0.5 * 6.0 * 0.4 / whole(&q1(), q1().link_inertia), 5e-3);
}

#[test]
fn effects_out_of_range_are_rejected() {
    let refusal = |change: fn(&mut Surroundings)| {
        let mut around = Surroundings::ideal();
        change(&mut around);
        DriveTrain::new(&q1(), &Start::Still, around.into(), Vec::new(), 0).expect_err("refused").to_string()
    };
    for (change, words) in [
        ((|of| of.payload.inertia_share = 1.0) as fn(&mut Surroundings), "share of the payload is 1"),
        (|of| of.payload.inertia_share = 0.5, "frequency of the payload is 0"),
        (|of| of.payload_step.ratio = 0.0, "ratio of the payload step is 0"),
        (|of| of.hysteresis.stiffness_share = 0.5, "torque of the hysteresis is 0"),
        (|of| of.width = WidthVariation { per_link_turn: 0.5, per_motor_turn: 0.5 }, "variation of the backlash is 1"),
        (|of| of.torque_errors.saturation_ratio = 0.1, "motor torque limit is inf"),
        (|of| of.control_jitter_ratio = 0.6, "jitter of the control loop is 0.6"),
        (|of| of.output_encoder.missing_share = 1.5, "share of missing readings is 1.5"),
        (|of| of.motor_encoder.noise_counts = f64::NAN, "noise of an encoder in counts is NaN"),
        (
            |of| {
                of.presliding.load = 1e-9;
                of.load_friction.coulomb = 1.0;
            },
            "presliding of the link is 0.000000001",
        ),
    ] {
        assert!(refusal(change).starts_with(words), "{}", refusal(change));
    }
}

/// A gear with an efficiency below 1/2 is self-locking: a pull at the link crosses the gap, and the motor does not
/// move. Above 1/2 the pull turns the motor, which receives the torque less the losses.
#[test]
fn self_locking_gear_holds_the_link() {
    let joint = q1();
    let lost_motion = 4.0 * 40e-6 / (2.0 * joint.geometry.carrier_radius * joint.geometry.working_pressure_angle.cos());
    let pull = 5.0;
    for (efficiency, holds) in [(0.4, true), (0.49, true), (0.51, false), (0.9, false)] {
        for torque in [pull, -pull] {
            let around = Surroundings { efficiency, ..Surroundings::ideal() };
            let mut train = train_of(&joint, 0.0, around, vec![Disturbance::Step { start: 0.0, torque }]);
            for _ in 0..3000 {
                train.advance(0.0).expect("a step");
            }
            let Observation { motor_angle, link_angle, .. } = *train.joint();
            // Twice the wind-up, since the link overshoots, and half the gap on this side.
            let wind_up = 2.0 * pull / joint.compliance.expect("Q1 is compliant").stiffness;
            let held = link_angle.abs() < lost_motion + wind_up + 1e-3 && motor_angle.abs() < 0.05;
            assert_eq!(held, holds, "{efficiency}, {torque} N m: motor {motor_angle} rad, link {link_angle} rad");
        }
    }
}
