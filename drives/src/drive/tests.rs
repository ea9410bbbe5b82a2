use super::*;
use crate::turns::Ratio;

/// Rigid joint with an inertia at the output, for tests of the drive's logic.
struct RigidJoint {
    inertia: f32,
    speed: f32,
    turns: f64,
}

impl RigidJoint {
    fn new() -> Self {
        Self { inertia: 0.17, speed: 0.0, turns: 0.3 }
    }

    fn advance(&mut self, drive: &mut Drive, sensors: Sensors, periods: u32) {
        let settings = *drive.settings();
        let ratio = f64::from(settings.ratio.to_f32());
        for _ in 0..periods {
            let counts = |turns: f64, per_turn: u32| (turns.rem_euclid(1.0) * f64::from(per_turn)) as u32;
            let sensors = Sensors {
                motor_counts: sensors.motor_counts.map(|_| counts(ratio * self.turns, settings.motor_counts_per_turn)),
                output_counts: sensors.output_counts.map(|_| counts(self.turns, 1 << 17)),
                ..sensors
            };
            let torque = drive.step(&sensors, None) * settings.ratio.to_f32();
            self.speed += torque / self.inertia * settings.period;
            self.turns += f64::from(self.speed * settings.period) / std::f64::consts::TAU;
        }
    }
}

fn readings() -> Sensors {
    Sensors { motor_counts: Some(0), output_counts: Some(0), ..Sensors::default() }
}

fn started(settings: Settings) -> (Drive, RigidJoint) {
    let (mut drive, mut joint) = (Drive::new(settings), RigidJoint::new());
    joint.advance(&mut drive, readings(), 10);
    (drive, joint)
}

fn position(drive: &Drive) -> f32 {
    drive.feedback().position.to_f32()
}

#[test]
fn output_encoder_sets_the_turn_at_power_up() {
    let (drive, _) = started(Settings::default());
    assert!((position(&drive) - 0.3).abs() < 1e-4, "{}", position(&drive));
    let (drive, _) = started(Settings { output_counts_per_turn: None, ..Settings::default() });
    // Rotor at 1.8 turns: without an output encoder, 0.8 turns over 6.
    assert!((position(&drive) - 0.8 / 6.0).abs() < 1e-4, "{}", position(&drive));
}

#[test]
fn both_laws_reach_the_target() {
    for law in [Law::Parallel, Law::Cascade] {
        let (mut drive, mut joint) = started(Settings { law, ..Settings::default() });
        drive.enable(SetPoint::Position(Target::hold(Turns::new(0.4))));
        joint.advance(&mut drive, readings(), 20_000);
        assert!((position(&drive) - 0.4).abs() < 1e-3, "{law:?}: {}", position(&drive));
    }
}

#[test]
fn velocity_is_reached_under_an_acceleration_limit() {
    let (mut drive, mut joint) = started(Settings { law: Law::Cascade, ..Settings::default() });
    let velocity = SetPoint::Velocity { velocity: 2.0, torque: 0.0, max_acceleration: 4.0, max_torque: f32::INFINITY };
    drive.enable(velocity);
    joint.advance(&mut drive, readings(), 2500);
    assert!((drive.feedback().target_velocity - 1.0).abs() < 1e-2, "{:?}", drive.feedback());
    joint.advance(&mut drive, readings(), 20_000);
    assert!((drive.feedback().velocity - 2.0).abs() < 0.02, "{:?}", drive.feedback());
}

#[test]
fn set_point_limits_the_torque() {
    let (mut drive, _) = started(Settings::default());
    let target = Target { max_torque: 0.6, ..Target::hold(Turns::new(5.0)) };
    drive.enable(SetPoint::Position(target));
    assert_eq!(drive.step(&readings(), None), 0.6 / 6.0);
    assert!(drive.feedback().is_limited);
}

#[test]
fn error_in_dead_zone_gives_no_torque() {
    let (mut drive, _) = started(Settings { dead_zone: (0.02, 0.04), ..Settings::default() });
    let sensors = Sensors { motor_counts: None, output_counts: None, ..Sensors::default() };
    let mut torque = |error: f32| {
        let position = drive.feedback().position.plus(Turns::from_rad(error));
        drive.enable(SetPoint::Position(Target::hold(position)));
        drive.step(&sensors, None)
    };
    assert_eq!((torque(-0.019), torque(0.039)), (0.0, 0.0));
    assert!(torque(-0.021) < 0.0 && torque(0.041) > 0.0);
}

#[test]
fn within_is_free_inside_its_bounds() {
    let (mut drive, _) = started(Settings::default());
    let within = |low: f32, high: f32| SetPoint::Within {
        low: Some(Turns::new(low)),
        high: Some(Turns::new(high)),
        target: Target::hold(Turns::ZERO),
    };
    drive.enable(within(0.2, 0.4));
    let sensors = Sensors { motor_counts: None, output_counts: None, ..Sensors::default() };
    assert_eq!(drive.step(&sensors, None), 0.0);
    drive.enable(within(0.35, 0.4));
    assert!(drive.step(&sensors, None) > 0.0);
    drive.enable(within(0.1, 0.2));
    assert!(drive.step(&sensors, None) < 0.0);
}

#[test]
fn watchdog_disables_or_damps() {
    let settings = Settings { watchdog: Some(0.01), ..Settings::default() };
    let (mut drive, mut joint) = started(settings);
    drive.enable(SetPoint::Position(Target::hold(Turns::new(0.3))));
    joint.advance(&mut drive, readings(), 90);
    assert_eq!(drive.state(), State::Enabled);
    drive.feed();
    joint.advance(&mut drive, readings(), 90);
    assert_eq!(drive.state(), State::Enabled);
    joint.advance(&mut drive, readings(), 20);
    assert_eq!((drive.state(), drive.fault()), (State::Disabled, Some(Fault::Watchdog)));

    let (mut drive, mut joint) = started(Settings { expiry: Expiry::Damp, ..settings });
    drive.enable(SetPoint::Position(Target::hold(Turns::new(0.3))));
    joint.advance(&mut drive, readings(), 120);
    assert_eq!((drive.state(), drive.fault()), (State::TimedOut, None));
    drive.enable(SetPoint::Brake);
    assert_eq!(drive.state(), State::Enabled);
}

#[test]
fn fault_keeps_the_drive_disabled_until_cleared() {
    let (mut drive, _) = started(Settings::default());
    drive.enable(SetPoint::Torque { torque: 1.0, max_velocity: f32::INFINITY });
    drive.step(&Sensors { bus_voltage: 5.0, ..readings() }, None);
    assert_eq!(drive.fault(), Some(Fault::UnderVoltage));
    drive.enable(SetPoint::Torque { torque: 1.0, max_velocity: f32::INFINITY });
    assert_eq!(drive.step(&readings(), None), 0.0);
    drive.clear_fault();
    drive.enable(SetPoint::Torque { torque: 1.2, max_velocity: f32::INFINITY });
    assert_eq!(drive.step(&readings(), None), 1.2 / 6.0);
}

#[test]
fn each_protection_has_its_fault() {
    let hot = Sensors { motor_temperature: 120.0, ..readings() };
    let cases = [
        (Settings::default(), Sensors { bus_voltage: 70.0, ..readings() }, Fault::OverVoltage),
        (Settings::default(), hot, Fault::OverTemperature),
        (Settings { travel: (Some(Turns::new(0.5)), None), ..Settings::default() }, readings(), Fault::OutsideTravel),
        (
            Settings { max_silent_periods: 0, ..Settings::default() },
            Sensors { motor_counts: None, ..readings() },
            Fault::MotorEncoder,
        ),
        (
            Settings { max_silent_periods: 0, ..Settings::default() },
            Sensors { output_counts: None, ..readings() },
            Fault::OutputEncoder,
        ),
    ];
    for (settings, sensors, fault) in cases {
        let (mut drive, _) = started(Settings { travel: (None, None), ..settings });
        drive.settings_mut().travel = settings.travel;
        drive.enable(SetPoint::Torque { torque: 1.0, max_velocity: f32::INFINITY });
        assert_eq!(drive.step(&sensors, None), 0.0, "{fault:?}");
        assert_eq!(drive.fault(), Some(fault));
    }
}

#[test]
fn excess_current_is_a_fault() {
    let (mut drive, _) = started(Settings { max_current: 8.0, torque_constant: 0.1, ..Settings::default() });
    drive.enable(SetPoint::Brake);
    drive.step(&Sensors { motor_torque: -0.79, ..readings() }, None);
    assert_eq!(drive.fault(), None);
    drive.step(&Sensors { motor_torque: -0.81, ..readings() }, None);
    assert_eq!(drive.fault(), Some(Fault::OverCurrent));
}

#[test]
fn disabled_drive_brakes_if_it_shorts_the_winding() {
    for brakes_while_disabled in [false, true] {
        let (mut drive, mut joint) = started(Settings { brakes_while_disabled, ..Settings::default() });
        joint.speed = 1.0;
        joint.advance(&mut drive, readings(), 2000);
        // Damping of 6^2 0.1^2 / 0.2 = 1.8 N m s/rad at 0.17 kg m^2: a time constant of 0.1 s.
        let slow = if brakes_while_disabled { 0.2 } else { 1.0 };
        assert!((joint.speed - slow).abs() < 0.1, "{}", joint.speed);
    }
}

#[test]
fn hot_winding_reduces_the_torque() {
    let (mut drive, _) = started(Settings::default());
    drive.enable(SetPoint::Torque { torque: 100.0, max_velocity: f32::INFINITY });
    let torque = drive.step(&Sensors { motor_temperature: 90.0, ..readings() }, None);
    assert!((torque - 1.25).abs() < 1e-6, "{torque}");
}

#[test]
fn drive_needs_its_calibration() {
    let (mut drive, mut joint) = started(Settings { is_calibrated: false, ..Settings::default() });
    drive.enable(SetPoint::Brake);
    assert_eq!(drive.fault(), Some(Fault::NotCalibrated));
    drive.clear_fault();
    drive.calibrate();
    joint.advance(&mut drive, readings(), 19_990);
    assert!(matches!(drive.state(), State::Calibrating(_)));
    joint.advance(&mut drive, readings(), 20);
    assert!(drive.is_calibrated());
    drive.enable(SetPoint::Brake);
    assert_eq!(drive.state(), State::Enabled);
}

#[test]
fn controller_replaces_the_law() {
    let (mut drive, _) = started(Settings::default());
    drive.enable(SetPoint::Position(Target::hold(Turns::new(0.3))));
    assert_eq!(drive.step(&readings(), Some(&mut |_, _| Some(3.0))), 0.5);
    assert_eq!(drive.step(&readings(), Some(&mut |_, _| Some(f32::NAN))), 0.0);
}

#[test]
fn position_can_be_set() {
    let (mut drive, mut joint) = started(Settings { ratio: Ratio::new(6.0), ..Settings::default() });
    drive.set_position(Turns::new(-2.0));
    joint.advance(&mut drive, readings(), 1);
    assert!((position(&drive) + 2.0).abs() < 1e-5, "{}", position(&drive));
}

#[test]
fn damping_after_the_watchdog_keeps_its_torque_limit() {
    let (mut drive, mut joint) = started(Settings { expiry: Expiry::Damp, expiry_torque: 0.6, ..Settings::default() });
    joint.speed = 3.0;
    joint.advance(&mut drive, readings(), 100);
    drive.expire();
    assert_eq!(drive.state(), State::TimedOut);
    let silent = Sensors { motor_counts: None, output_counts: None, ..Sensors::default() };
    assert_eq!(drive.step(&silent, None), -0.6 / 6.0);
}

#[test]
fn expiry_leaves_a_fault_alone() {
    let (mut drive, _) = started(Settings { expiry: Expiry::Damp, ..Settings::default() });
    drive.declare(Fault::EmergencyStop);
    drive.expire();
    assert_eq!((drive.state(), drive.fault()), (State::Disabled, Some(Fault::EmergencyStop)));
}

#[test]
fn integral_limit_is_scaled() {
    let gains = Gains { stiffness: 0.0, damping: 0.0, integral: 1e6, ..Gains::for_inertia(0.17, 30.0) };
    let (mut drive, _) = started(Settings { gains, integral_limit: 1.2, ..Settings::default() });
    drive.enable(SetPoint::Position(Target { integral_scale: 0.5, ..Target::hold(Turns::new(5.0)) }));
    assert_eq!(drive.step(&readings(), None), 0.6 / 6.0);
}

#[test]
fn target_is_the_position_once_enabled() {
    let (mut drive, _) = started(Settings::default());
    drive.set_position(Turns::new(2.0));
    drive.enable(SetPoint::Position(Target::hold(Turns::new(3.0))));
    assert_eq!(drive.feedback().target, drive.feedback().position);
}

#[test]
fn changed_set_point_does_not_feed_the_watchdog() {
    let (mut drive, mut joint) = started(Settings { watchdog: Some(0.01), ..Settings::default() });
    drive.change_set_point(SetPoint::Brake);
    assert_eq!(drive.state(), State::Disabled);
    drive.enable(SetPoint::Brake);
    for _ in 0..12 {
        let torque = SetPoint::Torque { torque: 0.6, max_velocity: f32::INFINITY };
        drive.change_set_point(torque);
        joint.advance(&mut drive, readings(), 9);
        assert!(drive.state() == State::Disabled || drive.set_point() == Some(&torque));
    }
    assert_eq!(drive.fault(), Some(Fault::Watchdog));
}

#[test]
fn integral_of_the_speed_loop_is_limited() {
    let mut settings = Settings { law: Law::Cascade, velocity_integral_limit: 0.3, ..Settings::default() };
    (settings.gains.velocity, settings.gains.velocity_integral) = (0.0, 100.0);
    let (mut drive, _) = started(settings);
    let velocity = SetPoint::Velocity { velocity: 5.0, torque: 0.0, max_acceleration: 1e6, max_torque: 3.0 };
    drive.enable(velocity);
    let still = Sensors { motor_counts: None, output_counts: None, ..Sensors::default() };
    let torque = (0..50).map(|_| drive.step(&still, None)).last().unwrap();
    assert!((torque - 0.05).abs() < 1e-6, "{torque}");
}

proptest::proptest! {
    /// Set-points, settings and readings of any bits, NaN and infinities among them, neither panic nor give a torque that
    /// is no number.
    #[test]
    fn no_number_panics(
        numbers in proptest::collection::vec(proptest::prelude::any::<f32>(), 24),
        counts in proptest::collection::vec(proptest::prelude::any::<u32>(), 4),
        kind in 0_usize..6,
        cascade: bool,
    ) {
        let [a, b, c, d, e, f] = [numbers[0], numbers[1], numbers[2], numbers[3], numbers[4], numbers[5]];
        let settings = Settings {
            law: if cascade { Law::Cascade } else { Law::Parallel },
            ratio: Ratio::new(numbers[6].into()),
            period: numbers[7],
            torque_constant: numbers[8],
            torque_limit: numbers[9],
            max_velocity: numbers[10],
            max_temperature: numbers[11],
            derating_temperature: numbers[12],
            integral_limit: numbers[13],
            velocity_integral_limit: numbers[14],
            encoder_bandwidth: numbers[15],
            gains: Gains::for_inertia(numbers[16], numbers[17]),
            motor_counts_per_turn: counts[0],
            output_counts_per_turn: Some(counts[1]),
            min_voltage: f32::NEG_INFINITY,
            max_voltage: f32::INFINITY,
            max_current: f32::INFINITY,
            ..Settings::default()
        };
        let limits = ProfileLimits { velocity: numbers[18], acceleration: numbers[19] };
        let target = Target {
            velocity: a,
            torque: b,
            moves: true,
            stop: Some(Turns::new(c)),
            limits,
            stiffness_scale: d,
            damping_scale: e,
            integral_scale: f,
            max_torque: numbers[20],
            ..Target::hold(Turns::new(numbers[21]))
        };
        let position = Turns::new(numbers[22]);
        let set_point = match kind {
            0 => SetPoint::Brake,
            1 => SetPoint::Torque { torque: a, max_velocity: b },
            2 => SetPoint::Velocity { velocity: a, torque: b, max_acceleration: c, max_torque: d },
            3 => SetPoint::Position(target),
            4 => SetPoint::Impedance { position, velocity: a, stiffness: b, damping: c, torque: d },
            _ => SetPoint::Within { low: Some(position), high: None, target },
        };
        let mut drive = Drive::new(settings);
        for period in 0..4_u32 {
            let sensors = Sensors {
                motor_counts: Some(counts[2].wrapping_mul(period)),
                output_counts: Some(counts[3]),
                ..Sensors::default()
            };
            let torque = drive.step(&sensors, None);
            proptest::prop_assert!(!torque.is_nan());
            drive.enable(set_point);
        }
    }
}
