use std::vec::Vec;

use proptest::prelude::*;

use super::client::{Answer, Client, DEFAULT_QUERY, ENCODER_QUERY, PositionCommand, Request, WithinCommand};
use super::command::Mode;
use super::register as r;
use super::value::{Content, Resolution, Scale, Value};
use super::{Server, settings};
use crate::bus::CanServer;
use crate::drive::{Drive, Expiry, Fault, Sensors, SetPoint, Settings, State};
use crate::frame::{Frame, Kind, extended, standard};
use crate::turns::Turns;

/// Drive with its server and a client; readings of the encoders are fixed.
struct Bench {
    drive: Drive,
    server: Server,
    client: Client,
    sensors: Sensors,
}

impl Bench {
    /// Rotor at 1/8 turn, output at 5/8 turn.
    fn new() -> Self {
        Self::with(Settings::default())
    }

    fn with(base: Settings) -> Self {
        let sensors = Sensors { motor_counts: Some(1 << 11), output_counts: Some(5 << 14), ..Sensors::default() };
        let drive = Drive::new(settings(base));
        let mut bench = Self { drive, server: Server::new(1), client: Client::new(1), sensors };
        bench.run(2);
        bench
    }

    fn run(&mut self, periods: u32) {
        for _ in 0..periods {
            self.drive.step(&self.sensors, None);
            self.server.tick(&mut self.drive, &mut |_| panic!("no cyclic frames"));
        }
    }

    fn exchange(&mut self, frame: &Frame) -> Vec<Frame> {
        let mut frames = Vec::new();
        self.server.receive(frame, &mut self.drive, &mut |frame| frames.push(frame));
        frames
    }

    fn command(&mut self, request: &Request) {
        let frame = self.client.frame(request, false).unwrap();
        assert_eq!(self.exchange(&frame), []);
    }

    fn answers(&mut self, request: &Request) -> Vec<Answer<'static>> {
        let frame = self.client.frame(request, true).unwrap();
        let reply = self.exchange(&frame).pop().unwrap();
        let answers = self.client.answers(&reply).unwrap();
        answers
            .map(|answer| match answer {
                Answer::Value(register, value) => Answer::Value(register, value),
                Answer::WriteError(register, error) => Answer::WriteError(register, error),
                Answer::ReadError(register, error) => Answer::ReadError(register, error),
                Answer::Diagnostic(channel, _) => Answer::Diagnostic(channel, &[]),
            })
            .collect()
    }

    fn number(&mut self, register: u32) -> f32 {
        let request = read(register, Resolution::Float);
        let reply = self.exchange(&self.client.frame(&request, true).unwrap()).pop().unwrap();
        self.client.answers(&reply).unwrap().number(register).unwrap()
    }

    fn integer(&mut self, register: u32) -> i32 {
        let reply = self.exchange(&self.client.frame(&read(register, Resolution::Int32), true).unwrap()).pop().unwrap();
        self.client.answers(&reply).unwrap().integer(register).unwrap()
    }

    fn mode(&mut self) -> i32 {
        self.integer(r::MODE)
    }
}

fn read(register: u32, resolution: Resolution) -> Request {
    static BY_RESOLUTION: [[Option<Resolution>; 1]; 4] =
        [[Some(Resolution::Int8)], [Some(Resolution::Int16)], [Some(Resolution::Int32)], [Some(Resolution::Float)]];
    Request::default().query(&[(register, &BY_RESOLUTION[resolution as usize])])
}

fn hex(text: &str) -> Vec<u8> {
    (0..text.len()).step_by(2).map(|at| u8::from_str_radix(&text[at..at + 2], 16).unwrap()).collect()
}

fn position(position: f32) -> PositionCommand {
    PositionCommand { position: Some(position), ..PositionCommand::default() }
}

/// Bytes of the Python client moteus 1.1.1.
#[test]
fn requests_are_those_of_the_python_client() {
    let all = PositionCommand {
        position: Some(f32::NAN),
        velocity: Some(-0.25),
        torque: Some(0.5),
        kp_scale: Some(0.5),
        kd_scale: Some(0.25),
        max_torque: Some(1.5),
        stop_position: Some(1.0),
        timeout: Some(f32::NAN),
        velocity_limit: Some(2.0),
        accel_limit: Some(3.0),
        ilimit_scale: Some(0.0),
        ignores_bounds: Some(true),
    };
    let some = PositionCommand { velocity: Some(0.1), max_torque: Some(2.0), ..position(0.5) };
    let within = WithinCommand {
        low: Some(-0.1),
        high: Some(0.2),
        kp_scale: Some(0.5),
        timeout: Some(1.0),
        ..WithinCommand::default()
    };
    let cases = [
        (Request::default().query(DEFAULT_QUERY), "11001f01130d"),
        (Request::default().query(ENCODER_QUERY), "1c04501158"),
        (Request::stop().query(DEFAULT_QUERY), "01000011001f01130d"),
        (Request::position(&some).query(DEFAULT_QUERY), "01000a0e200000003fcdcccc3d0d250000004011001f01130d"),
        (
            Request::position(&all),
            "01000a0c0a200000c07f000080be0000003f0000003f0000803e0000c03f0000803f0000c07f00000040000040400d2b00000000\
             0d2d0000803f",
        ),
        (Request::stay_within(&within), "01000d0e40cdccccbdcdcc4c3e0d430000003f0d460000803f"),
        (Request::zero_velocity(Some(0.5)), "01000c0d240000003f"),
        (Request::zero_velocity(None), "01000c"),
        (Request::brake(), "01000f"),
        (Request::current(1.5, 0.0), "0100090e1c0000c03f00000000"),
        (Request::set_output_nearest(0.25), "0db0020000803e"),
        (Request::set_output_exact(-1.5), "0db1020000c0bf"),
        (Request::require_reindex(), "01b20201"),
        (Request::recapture(), "01b30201"),
        (Request::default().write(r::CLOCK_TRIM, Content::Integer(2), Resolution::Int32), "097102000000"),
    ];
    for (request, expected) in cases {
        assert_eq!(request.data(), hex(expected), "{expected}");
    }
}

/// Bytes of the Python client moteus 1.1.1: 0.3, -1.234, 1e9 and NaN at 8, 16 and 32 bits.
#[test]
fn scales_are_those_of_the_python_client() {
    let limits = ["7f", "ff7f", "ffffff7f"];
    let nan = ["80", "0080", "00000080"];
    let cases = [
        (Scale::Position, ["1e", "b70b", "2f750000"], ["85", "cccf", "f91dfeff"]),
        (Scale::Velocity, ["02", "b004", "2f750000"], ["f4", "b8ec", "f91dfeff"]),
        (Scale::Acceleration, ["05", "2c01", "2f750000"], ["e8", "2efb", "f91dfeff"]),
        (Scale::Torque, ["00", "1e00", "2c010000"], ["fe", "85ff", "2efbffff"]),
        (Scale::Share, ["26", "6626", "66666626"], ["81", "0180", "01000080"]),
        (Scale::Voltage, ["00", "0200", "2c010000"], ["fe", "f4ff", "2efbffff"]),
        (Scale::Temperature, ["00", "0200", "2c010000"], ["ff", "f4ff", "2efbffff"]),
        (Scale::Time, ["1e", "2c01", "e0930400"], ["85", "2efb", "b02bedff"]),
        (Scale::Current, ["00", "0200", "2c010000"], ["ff", "f4ff", "2efbffff"]),
        (Scale::Power, ["00", "0500", "b70b0000"], ["00", "e8ff", "cccfffff"]),
    ];
    for (scale, small, negative) in cases {
        for (number, texts) in [(0.3, small), (-1.234, negative), (1e9, limits), (f32::NAN, nan)] {
            let resolutions = [Resolution::Int8, Resolution::Int16, Resolution::Int32];
            for (resolution, text) in resolutions.into_iter().zip(texts) {
                let expected = hex(text).into_iter().rev().fold(0_i64, |all, byte| all << 8 | i64::from(byte));
                let bits = 8 << resolution as u32;
                let expected = expected << (64 - bits) >> (64 - bits);
                let found = i64::from(Value::new(Content::Number(number), scale, resolution).integer());
                // The client computes in f64 and cuts: f32 may fall on the other side of a whole number.
                let tolerance = if number.abs() < 2.0 { 1 + expected.abs() / 10_000_000 } else { 0 };
                assert!((found - expected).abs() <= tolerance, "{scale:?} {number} {resolution:?}: {found} {expected}");
            }
        }
    }
}

#[test]
fn integers_come_back_as_numbers() {
    let value = |number| Value::new(Content::Number(number), Scale::Velocity, Resolution::Int16);
    assert_eq!(value(-1.25), Value::Int16(-5000));
    assert_eq!(value(-1.25).number(Scale::Velocity), -1.25);
    assert!(value(f32::INFINITY).number(Scale::Velocity).is_nan());
    assert_eq!(value(-1e9), Value::Int16(-32_767));
}

#[test]
fn int16_command_of_the_python_client_is_understood() {
    let mut bench = Bench::new();
    bench.server = Server::new(5).with_prefix(0x12);
    // position=-0.5, velocity=nan, feedforward_torque=-1.76, kp_scale=1, maximum_torque=99, watchdog_timeout=0.25,
    // accel_limit=1.5 at int16 from source 2 with prefix 0x12.
    let data = hex("01000a04042078ec008050ffff7f0525ac260527fa000529dc05");
    let frame = Frame::flexible(extended(0x12_0205), &data, 0x50).unwrap();
    assert_eq!(bench.exchange(&frame), []);
    let Some(SetPoint::Position(target)) = bench.drive.set_point() else { panic!("{:?}", bench.drive.state()) };
    assert!((target.position.to_f32() + 0.5).abs() < 1e-6 && !target.moves, "{target:?}");
    assert!((target.torque + 1.76).abs() < 1e-5 && (target.max_torque - 99.0).abs() < 1e-3, "{target:?}");
    assert!((target.stiffness_scale, target.damping_scale) == (1.0, 1.0), "{target:?}");
    assert!((target.limits.acceleration / std::f32::consts::TAU - 1.5).abs() < 1e-5, "{target:?}");
    assert!((bench.drive.settings().watchdog.unwrap() - 0.25).abs() < 1e-6);
}

#[test]
fn document_example_is_answered() {
    let mut bench = Bench::new();
    let frame = Frame::flexible(extended(0x8001), &hex("01000a07206000200150ff140400130d"), 0x50).unwrap();
    let reply = bench.exchange(&frame).pop().unwrap();
    assert_eq!((reply.id, reply.kind), (standard(0x100), Kind::Flexible(true)));
    // Answers before the command: mode 0.
    assert_eq!(reply.data()[..4], hex("24040000"));
    // Three int8: 48 V, 25 deg C, no fault.
    assert_eq!(reply.data()[11..16], hex("230d601900"));
    assert_eq!(bench.mode(), 10);
}

#[test]
fn frames_for_others_are_ignored() {
    let mut bench = Bench::new();
    let stop = Request::stop().query(DEFAULT_QUERY);
    for (id, answers) in [(0x8001, 1), (0x8002, 0), (0x807f, 1), (0x8081, 0), (0x1_8001, 0), (0x0001, 0)] {
        let frame = Frame::flexible(extended(id), stop.data(), 0x50).unwrap();
        assert_eq!(bench.exchange(&frame).len(), answers, "{id:x}");
    }
    assert_eq!(bench.exchange(&Frame::remote(standard(1), 8).unwrap()), []);
}

#[test]
fn answer_has_the_kind_of_the_request() {
    let mut bench = Bench::new();
    let classic = Frame::classic(extended(0x8001), &hex("11001f01130d")).unwrap();
    // 21 bytes do not fit a classical frame.
    assert_eq!(bench.exchange(&classic).pop().unwrap().kind, Kind::Flexible(false));
    let classic = Frame::classic(extended(0x8001), &hex("1100")).unwrap();
    assert_eq!(bench.exchange(&classic).pop().unwrap().kind, Kind::Classic);
    let empty = bench.exchange(&bench.client.frame(&Request::stop(), true).unwrap()).pop().unwrap();
    assert_eq!(empty.length(), 0);
}

#[test]
fn answer_is_padded_with_no_operation() {
    let mut bench = Bench::new();
    let reply = bench.exchange(&bench.client.frame(&Request::default().query(DEFAULT_QUERY), true).unwrap());
    // 3 + 2 + 12 + 5 = 22 bytes.
    assert_eq!((reply[0].length(), &reply[0].data()[22..]), (24, &[0x50, 0x50][..]));
}

#[test]
fn both_encoders_are_read() {
    let mut bench = Bench::new();
    let near = |found: f32, expected: f32| assert!((found - expected).abs() < 1e-4, "{found} {expected}");
    near(bench.number(r::ENCODER_0_POSITION), 0.125);
    near(bench.number(r::ENCODER_1_POSITION), 0.625);
    near(bench.number(r::ABS_POSITION), 0.625);
    // Position within half a turn.
    near(bench.number(r::POSITION), -0.375);
    assert_eq!((bench.integer(r::HOME_STATE), bench.integer(r::ENCODER_VALIDITY)), (2, 0b1111));
    assert_eq!(bench.number(r::ENCODER_2_POSITION), 0.0);
    // Rotor forward by 1/64 turn, output by 1/512 turn.
    bench.sensors.motor_counts = Some((1 << 11) + (1 << 8));
    bench.sensors.output_counts = Some((5 << 14) + (1 << 8));
    bench.run(1);
    near(bench.number(r::POSITION), -0.375 + 1.0 / 64.0 / 6.0);
    near(bench.number(r::ENCODER_1_POSITION), 0.625 + 1.0 / 512.0);
    assert!(bench.number(r::ENCODER_0_VELOCITY) > 0.0 && bench.number(r::ENCODER_1_VELOCITY) > 0.0);
    assert!(bench.number(r::VELOCITY) > 0.0);
}

#[test]
fn rotor_alone_refers_the_position_to_the_rotor() {
    let mut bench = Bench::with(Settings { output_counts_per_turn: None, ..Settings::default() });
    assert_eq!((bench.integer(r::HOME_STATE), bench.integer(r::ENCODER_VALIDITY)), (1, 0b11));
    assert!((bench.number(r::POSITION) - 0.125 / 6.0).abs() < 1e-4);
    // Next to 1 turn in steps of 1/6 turn.
    bench.command(&Request::set_output_nearest(1.0));
    assert!((bench.number(r::POSITION) - (1.0 + 0.125 / 6.0)).abs() < 1e-4);
    assert_eq!(bench.integer(r::HOME_STATE), 2);
}

#[test]
fn output_is_set_to_the_nearest_turn_or_exactly() {
    let mut bench = Bench::new();
    bench.command(&Request::set_output_nearest(2.9));
    assert!((bench.number(r::POSITION) - 2.625).abs() < 1e-4);
    bench.command(&Request::set_output_exact(-7.25));
    assert!((bench.number(r::POSITION) + 7.25).abs() < 1e-4);
    bench.command(&Request::require_reindex());
    assert!((bench.number(r::POSITION) + 0.375).abs() < 1e-4);
}

#[test]
fn target_moves_with_the_position() {
    let mut bench = Bench::new();
    bench.command(&Request::position(&position(-0.25)));
    bench.command(&Request::set_output_exact(10.0));
    let Some(SetPoint::Position(target)) = bench.drive.set_point() else { panic!("{:?}", bench.drive.state()) };
    assert!((target.position.to_f32() - 10.125).abs() < 1e-4, "{target:?}");
}

#[test]
fn modes_follow_the_commands() {
    let mut bench = Bench::new();
    let within = Request::stay_within(&WithinCommand { low: Some(-0.5), ..WithinCommand::default() });
    let cases = [
        (Request::position(&position(f32::NAN)), 10),
        (Request::brake(), 15),
        (Request::zero_velocity(None), 12),
        (Request::current(1.0, 0.0), 9),
        (within, 13),
        (Request::mode(Mode::Calibrating), 13),
        (Request::stop(), 0),
        (Request::mode(Mode::Timeout), 11),
    ];
    for (request, mode) in cases {
        bench.command(&request);
        assert_eq!(bench.mode(), mode);
        bench.run(1);
        assert_eq!(bench.mode(), mode);
    }
}

#[test]
fn current_becomes_torque() {
    let mut bench = Bench::new();
    bench.command(&Request::current(1.5, 0.0));
    assert!((bench.drive.step(&bench.sensors, None) - 0.15).abs() < 1e-6);
    assert_eq!(bench.number(r::COMMAND_Q_CURRENT), 1.5);
}

#[test]
fn watchdog_ends_in_mode_11_until_stopped() {
    let mut bench = Bench::new();
    bench.command(&Request::position(&position(f32::NAN)));
    bench.run(950);
    assert_eq!(bench.mode(), 10);
    // A query is no command.
    bench.run(100);
    assert_eq!((bench.mode(), bench.integer(r::FAULT)), (11, 0));
    for request in [Request::position(&position(0.0)), Request::brake()] {
        bench.command(&request);
        bench.run(1);
        assert_eq!(bench.mode(), 11);
    }
    bench.command(&Request::stop());
    bench.command(&Request::position(&position(f32::NAN)));
    assert_eq!(bench.mode(), 10);
}

#[test]
fn timeout_of_the_command_counts() {
    let cases =
        [(Some(0.01), 11), (Some(f32::NAN), 10), (Some(-1.0), 11), (Some(0.5), 10), (Some(0.0), 10), (None, 10)];
    for (timeout, mode) in cases {
        let mut bench = Bench::new();
        bench.command(&Request::position(&PositionCommand { timeout, ..position(f32::NAN) }));
        bench.run(500);
        assert_eq!(bench.mode(), mode, "{timeout:?}");
    }
    // Brake and zero velocity have no watchdog.
    for request in [Request::brake(), Request::zero_velocity(None), Request::current(0.0, 0.0)] {
        let mut bench = Bench::new();
        bench.command(&request);
        bench.run(2000);
        assert_ne!(bench.mode(), 11);
    }
}

#[test]
fn expiry_without_damping_is_mode_11_too() {
    let mut bench = Bench::new();
    bench.drive.settings_mut().expiry = Expiry::Disable;
    bench.command(&Request::position(&position(f32::NAN)));
    bench.run(1100);
    assert_eq!((bench.mode(), bench.integer(r::FAULT), bench.drive.state()), (11, 0, State::Disabled));
}

#[test]
fn each_fault_has_its_code() {
    let cases = [
        (Fault::OverVoltage, 34),
        (Fault::MotorEncoder, 35),
        (Fault::NotCalibrated, 36),
        (Fault::OverTemperature, 38),
        (Fault::OutsideTravel, 39),
        (Fault::UnderVoltage, 40),
        (Fault::OutputEncoder, 43),
        (Fault::InvalidCommand, 45),
        (Fault::Overspeed, 50),
        (Fault::EmergencyStop, 33),
    ];
    for (fault, code) in cases {
        let mut bench = Bench::new();
        bench.command(&Request::position(&position(f32::NAN)));
        bench.drive.declare(fault);
        assert_eq!((bench.mode(), bench.integer(r::FAULT)), (1, code));
        bench.command(&Request::position(&position(f32::NAN)));
        assert_eq!(bench.mode(), 1);
        bench.command(&Request::stop());
        assert_eq!((bench.mode(), bench.integer(r::FAULT)), (0, 0));
    }
}

#[test]
fn faults_come_from_the_sensors() {
    type Change = fn(&mut Sensors);
    let changes: [(Change, i32); 5] = [
        (|sensors| sensors.bus_voltage = 3.9, 40),
        (|sensors| sensors.bus_voltage = 80.0, 34),
        (|sensors| sensors.board_temperature = 150.0, 38),
        (|sensors| sensors.motor_counts = None, 35),
        (|sensors| sensors.output_counts = None, 43),
    ];
    for (change, code) in changes {
        let mut bench = Bench::new();
        let good = bench.sensors;
        change(&mut bench.sensors);
        // A stopped drive declares no fault.
        bench.run(200);
        assert_eq!(bench.mode(), 0);
        bench.sensors = good;
        bench.run(2);
        bench.command(&Request::position(&position(f32::NAN)));
        change(&mut bench.sensors);
        bench.run(150);
        assert_eq!((bench.mode(), bench.integer(r::FAULT)), (1, code));
    }
}

#[test]
fn start_needs_a_calibrated_motor() {
    let mut bench = Bench::with(Settings { is_calibrated: false, ..Settings::default() });
    bench.command(&Request::brake());
    assert_eq!((bench.mode(), bench.integer(r::FAULT)), (1, 36));
}

#[test]
fn start_outside_of_the_bounds_is_a_fault() {
    let base = Settings { travel: (Some(Turns::new(-0.2)), Some(Turns::new(0.2))), ..Settings::default() };
    let mut bench = Bench::with(base);
    bench.command(&Request::position(&position(0.0)));
    assert_eq!((bench.mode(), bench.integer(r::FAULT)), (1, 39));
    bench.command(&Request::stop());
    let free = PositionCommand { ignores_bounds: Some(true), ..position(0.0) };
    bench.command(&Request::position(&free));
    bench.run(5);
    assert_eq!((bench.mode(), bench.integer(r::COMMAND_IGNORE_BOUNDS)), (10, 1));
    // Modes without a position start anywhere.
    bench.command(&Request::stop());
    bench.command(&Request::zero_velocity(None));
    assert_eq!(bench.mode(), 12);
}

#[test]
fn bounds_hold_the_target() {
    let base = Settings { travel: (Some(Turns::new(-0.5)), Some(Turns::new(0.2))), ..Settings::default() };
    let mut bench = Bench::with(base);
    let moving = PositionCommand { velocity: Some(1.0), ..position(0.1) };
    bench.command(&Request::position(&moving));
    let Some(SetPoint::Position(target)) = bench.drive.set_point() else { panic!("{:?}", bench.drive.state()) };
    assert_eq!((target.stop, target.moves), (Some(Turns::new(0.2)), true));
    bench.command(&Request::position(&position(3.0)));
    let Some(SetPoint::Position(target)) = bench.drive.set_point() else { panic!("{:?}", bench.drive.state()) };
    assert_eq!(target.position, Turns::new(0.2));
}

#[test]
fn stop_position_excludes_limits() {
    let mut bench = Bench::new();
    let stop = PositionCommand { velocity: Some(-1.0), stop_position: Some(0.5), ..position(f32::NAN) };
    bench.command(&Request::position(&stop));
    assert_eq!((bench.mode(), bench.integer(r::FAULT)), (1, 45));
    bench.command(&Request::stop());
    // Without limits the speed turns toward the stop position.
    bench.command(&Request::position(&PositionCommand { accel_limit: Some(-1.0), ..stop }));
    let Some(SetPoint::Position(target)) = bench.drive.set_point() else { panic!("{:?}", bench.drive.state()) };
    assert!(target.velocity > 0.0 && target.stop == Some(Turns::new(0.5)), "{target:?}");
}

#[test]
fn speed_ramps_from_the_present_position_without_overshoot() {
    let mut bench = Bench::new();
    let forever = Some(f32::NAN);
    let run = PositionCommand { velocity: Some(0.5), accel_limit: Some(1.0), timeout: forever, ..position(f32::NAN) };
    bench.command(&Request::position(&run));
    let start = bench.number(r::CONTROL_POSITION);
    let mut fastest = 0.0_f32;
    for _ in 0..60 {
        bench.run(100);
        fastest = fastest.max(bench.number(r::CONTROL_VELOCITY));
        bench.command(&Request::position(&run));
    }
    // Ramp of 0.5 s over 1/8 turn, then 0.1 s at 0.5 turns/s.
    assert!((fastest - 0.5).abs() < 2e-3, "{fastest}");
    let travelled = bench.number(r::CONTROL_POSITION) - start;
    assert!((travelled - 0.175).abs() < 2e-3, "{travelled}");
    assert_eq!(bench.integer(r::TRAJECTORY_COMPLETE), 1);
    let stop = PositionCommand { velocity: Some(0.0), ..run };
    bench.command(&Request::position(&stop));
    bench.run(5100);
    let stopped = bench.number(r::CONTROL_POSITION) - start;
    assert!((stopped - 0.3).abs() < 2e-3 && bench.number(r::CONTROL_VELOCITY) == 0.0, "{stopped}");
}

#[test]
fn recapture_begins_at_the_sensed_position() {
    let mut bench = Bench::new();
    let now = PositionCommand { accel_limit: Some(-1.0), timeout: Some(f32::NAN), ..position(1.0) };
    bench.command(&Request::position(&now));
    bench.run(2);
    assert!((bench.number(r::POSITION_ERROR) + 1.375).abs() < 1e-3);
    assert!(bench.number(r::PROPORTIONAL_TORQUE) < 0.0 && bench.number(r::CONTROL_TORQUE) > 0.0);
    bench.command(&Request::recapture());
    bench.run(2);
    assert!(bench.number(r::POSITION_ERROR).abs() < 1e-6);
    assert_eq!(bench.mode(), 10);
}

#[test]
fn limited_torque_has_its_code() {
    let mut bench = Bench::new();
    let now = PositionCommand { accel_limit: Some(-1.0), timeout: Some(f32::NAN), ..position(10.0) };
    bench.command(&Request::position(&now));
    bench.run(1);
    assert_eq!(bench.integer(r::FAULT), 99);
    bench.command(&Request::position(&PositionCommand { max_torque: Some(1.0), ..now }));
    bench.run(1);
    assert_eq!((bench.integer(r::FAULT), bench.number(r::CONTROL_TORQUE)), (102, 1.0));
    bench.command(&Request::stop());
    bench.run(1);
    assert_eq!(bench.integer(r::FAULT), 0);
}

#[test]
fn damping_after_a_timeout_keeps_its_torque() {
    let mut bench = Bench::new();
    bench.command(&Request::position(&PositionCommand { timeout: Some(-1.0), ..position(f32::NAN) }));
    // 40 counts a period are 24 turns/s of the rotor.
    for period in 0..200 {
        bench.sensors.motor_counts = Some((1 << 11) + 40 * period);
        bench.run(1);
    }
    assert_eq!((bench.mode(), bench.integer(r::FAULT)), (11, 102));
    assert!((bench.drive.step(&bench.sensors, None) + 5.0 / 6.0).abs() < 1e-6);
}

#[test]
fn stay_within_is_free_inside() {
    let mut bench = Bench::new();
    let inside = WithinCommand { low: Some(-0.5), high: Some(f32::NAN), ..WithinCommand::default() };
    bench.command(&Request::stay_within(&inside));
    assert_eq!(bench.drive.step(&bench.sensors, None), 0.0);
    bench.command(&Request::stay_within(&WithinCommand { low: Some(-0.25), max_torque: Some(0.6), ..inside }));
    assert_eq!(bench.drive.step(&bench.sensors, None), 0.6 / 6.0);
    assert_eq!(bench.number(r::WITHIN_LOW), -0.25);
    assert_eq!(bench.number(r::COMMAND_MAX_TORQUE), 0.6);
}

#[test]
fn unknown_and_read_only_registers_have_errors() {
    let mut bench = Bench::new();
    let write = |register: u8| {
        let data = [0x01, register, 0];
        Frame::flexible(extended(0x8001), &data, 0x50).unwrap()
    };
    // Unknown, read only, mode out of range.
    for (data, reply) in [(write(0x08), "300801"), (write(0x01), "300102")] {
        assert_eq!(bench.exchange(&data).pop().unwrap().data(), hex(reply));
    }
    let mode = Frame::flexible(extended(0x8001), &hex("010010"), 0x50).unwrap();
    assert_eq!(bench.exchange(&mode).pop().unwrap().data(), hex("300001"));
    assert_eq!(bench.answers(&read(0x08, Resolution::Int8)), [Answer::ReadError(8, 1)]);
    assert_eq!(bench.answers(&read(r::SET_OUTPUT_EXACT, Resolution::Int8)), [Answer::ReadError(0x131, 1)]);
    assert_eq!(bench.answers(&read(r::MULTIPLEX_ID, Resolution::Int32)), [Answer::ReadError(0x110, 1)]);
    // Words have 32 bits only.
    assert_eq!(bench.answers(&read(r::FIRMWARE_VERSION, Resolution::Int16)), [Answer::ReadError(0x101, 1)]);
    // An error takes the place of its whole subframe, and ends the answers.
    let query = Request::default().query(&[(r::MODE, &[Some(Resolution::Int8)]), (0x7, &[Some(Resolution::Int8); 2])]);
    let values = bench.answers(&query.query(DEFAULT_QUERY));
    assert_eq!(values, [Answer::Value(0, Value::Int8(0)), Answer::ReadError(8, 1)]);
}

#[test]
fn identity_is_read() {
    let mut bench = Bench::new();
    assert_eq!((bench.integer(r::REGISTER_MAP_VERSION), bench.integer(r::FIRMWARE_VERSION)), (5, 0x01_0100));
    assert_eq!((bench.integer(r::SERIAL_NUMBER_1), bench.integer(r::UUID_MASK_CAPABLE)), (1, 1));
    assert_eq!((bench.integer(r::DRIVER_FAULT_1), bench.integer(r::MODEL_NUMBER)), (0, 0));
    bench.run(9998);
    assert!((999..=1001).contains(&bench.integer(r::MILLISECOND_COUNTER)));
    assert!((bench.number(r::MILLISECOND_COUNTER)).is_nan());
}

#[test]
fn uuid_mask_of_another_drive_discards_the_frame() {
    let mut bench = Bench::new();
    bench.command(&Request::brake());
    let masked = |word| Request::default().write(r::UUID_MASK_1, Content::Integer(word), Resolution::Int32);
    let stop = |word| {
        let mut data = masked(word).data().to_vec();
        data.extend_from_slice(Request::stop().query(DEFAULT_QUERY).data());
        Frame::flexible(extended(0x807f), &data, 0x50).unwrap()
    };
    assert_eq!(bench.exchange(&stop(2)), []);
    assert_eq!(bench.mode(), 15);
    assert_eq!(bench.exchange(&stop(1)).len(), 1);
    assert_eq!(bench.mode(), 0);
}

#[test]
fn answer_ends_where_the_frame_is_full() {
    let mut bench = Bench::new();
    // 14 floats take 59 bytes of 64: a mode fits behind them, a further float does not.
    let frame = Frame::flexible(extended(0x8001), &hex("1c0e2011001d20"), 0x50).unwrap();
    let reply = bench.exchange(&frame).pop().unwrap();
    assert_eq!((reply.length(), &reply.data()[59..]), (64, &hex("2100005050")[..]));
}

/// Text on the diagnostic channel and its answer.
fn say(bench: &mut Bench, text: &str) -> std::string::String {
    say_to(bench, 1, text)
}

fn say_to(bench: &mut Bench, id: u32, text: &str) -> std::string::String {
    let mut data = std::vec![0x40, 0x01, text.len() as u8];
    data.extend_from_slice(text.as_bytes());
    assert_eq!(bench.exchange(&Frame::flexible(extended(id), &data, 0x50).unwrap()), []);
    let poll = Frame::flexible(extended(0x8000 | id), &hex("420130"), 0x50).unwrap();
    let reply = bench.exchange(&poll).pop().unwrap();
    let Some(Answer::Diagnostic(1, bytes)) = bench.client.answers(&reply).unwrap().next() else { panic!("{reply:?}") };
    std::string::String::from_utf8(bytes.to_vec()).unwrap()
}

#[test]
fn configuration_is_read_and_set() {
    let mut bench = Bench::new();
    assert_eq!(say(&mut bench, ""), "");
    assert_eq!(say(&mut bench, "conf get servo.default_timeout_s\n"), "0.1\r\n");
    assert_eq!(say(&mut bench, "conf set servo.pid_position.kp 12.5\n"), "OK\r\n");
    assert!((bench.drive.settings().gains.stiffness * std::f32::consts::TAU - 12.5).abs() < 1e-4);
    assert_eq!(say(&mut bench, "conf set servo.max_current_A 10\n"), "OK\r\n");
    assert!((bench.drive.settings().torque_limit - 1.0).abs() < 1e-6);
    assert_eq!(say(&mut bench, "conf set servopos.position_max 0.2\n"), "OK\r\n");
    assert_eq!(say(&mut bench, "conf get servopos.position_max\n"), "0.2\r\n");
    assert_eq!(say(&mut bench, "conf get servopos.position_min\n"), "NaN\r\n");
    assert_eq!(say(&mut bench, "conf set servo.timeout_mode 15\n"), "ERR error setting\r\n");
    assert_eq!(say(&mut bench, "conf set servo.timeout_mode 0\n"), "OK\r\n");
    assert_eq!(bench.drive.settings().expiry, Expiry::Disable);
    assert_eq!(say(&mut bench, "conf get nothing\n"), "ERR error reading\r\n");
    assert_eq!(say(&mut bench, "hello\n"), "ERR unknown command\r\n");
}

#[test]
fn identifier_can_be_changed() {
    let mut bench = Bench::new();
    let line = b"\x40\x01\x10conf set id.id 3\x40\x01\x01\n";
    assert_eq!(bench.exchange(&Frame::flexible(extended(1), line, 0x50).unwrap()), []);
    assert_eq!(bench.server.id(), 3);
    bench.client = Client::new(3);
    assert_eq!(say_to(&mut bench, 3, "conf get id.id\n"), "OK\r\n3\r\n");
}

#[test]
fn configuration_acts_on_commands() {
    let mut bench = Bench::new();
    say(&mut bench, "conf set servo.default_timeout_s nan\n");
    say(&mut bench, "conf set servo.default_accel_limit nan\n");
    bench.command(&Request::position(&PositionCommand { stop_position: Some(0.0), ..position(f32::NAN) }));
    bench.run(2000);
    assert_eq!(bench.mode(), 10);
    assert_eq!(say(&mut bench, "d stop\n"), "OK\r\n");
    assert_eq!(bench.mode(), 0);
}

#[test]
fn overvoltage_is_no_fault_of_a_stopped_drive() {
    let mut bench = Bench::new();
    bench.sensors.bus_voltage = 80.0;
    bench.run(10);
    assert_eq!(bench.mode(), 0);
    bench.command(&Request::brake());
    bench.run(10);
    assert_eq!((bench.mode(), bench.integer(r::FAULT)), (1, 34));
}

#[test]
fn int32_client_sees_what_the_drive_holds() {
    let mut bench = Bench::new();
    for (register, number) in [(r::VOLTAGE, 48.0), (r::TEMPERATURE, 25.0), (r::POSITION, -0.375)] {
        let Some(Answer::Value(found, value)) = bench.answers(&read(register, Resolution::Int32)).pop() else {
            panic!("{register:x}");
        };
        let scale = r::describe(register).unwrap().scale;
        assert_eq!(found, register);
        assert!((value.number(scale) - number).abs() < 1e-3, "{register:x} {value:?}");
    }
}

proptest! {
    #[test]
    fn no_frame_panics(
        frames in prop::collection::vec((any::<bool>(), prop::collection::vec(any::<u8>(), 0..64)), 1..8)
    ) {
        let mut bench = Bench::new();
        for (wants_reply, data) in frames {
            let frame = Frame::flexible(extended(if wants_reply { 0x8001 } else { 1 }), &data, 0x50).unwrap();
            for reply in bench.exchange(&frame) {
                let answers = bench.client.answers(&reply).unwrap();
                prop_assert!(answers.count() <= 64);
            }
            let own = Frame::flexible(standard(0x100), &data, 0x50).unwrap();
            prop_assert!(bench.client.answers(&own).unwrap().count() <= 64);
            bench.run(2);
            prop_assert!(bench.drive.step(&bench.sensors, None).is_finite());
        }
    }

    #[test]
    fn no_text_panics(texts in prop::collection::vec("(conf (get|set) )?[ -~\\r\\n]{0,40}\\n?", 1..6)) {
        let mut bench = Bench::new();
        for text in texts {
            say(&mut bench, &text);
        }
    }

    #[test]
    fn no_configuration_panics(
        name in prop::sample::select(&[
            "servo.pid_position.kp", "servo.pid_position.ki", "servo.pid_position.kd", "servo.pid_position.ilimit",
            "servo.max_current_A", "servo.max_voltage", "servo.fault_temperature", "servo.timeout_max_torque_Nm",
            "servo.default_timeout_s", "servo.default_velocity_limit", "servo.default_accel_limit",
            "servo.max_velocity", "servopos.position_min", "servopos.position_max", "servo.timeout_mode",
        ][..]),
        value in prop::sample::select(&["nan", "inf", "-inf", "-1", "0", "1e38", "1e-38"][..]),
    ) {
        let mut bench = Bench::new();
        say(&mut bench, &std::format!("conf set {name} {value}\n"));
        bench.command(&Request::position(&PositionCommand { velocity: Some(1.0), ..position(1.0) }));
        bench.run(3);
        for register in 0..0x60 {
            bench.answers(&read(register, Resolution::Int16));
        }
        prop_assert!(bench.drive.step(&bench.sensors, None).is_finite());
    }

    /// Random numbers in all command registers.
    #[test]
    fn no_command_panics(
        mode in 0_i8..16,
        numbers in prop::collection::vec(any::<f32>(), 14),
        within in prop::collection::vec(any::<f32>(), 9),
    ) {
        let mut bench = Bench::with(Settings { travel: (Some(Turns::new(-0.5)), None), ..Settings::default() });
        for (first, numbers) in [(0x20, numbers), (0x40, within)] {
            let mut data = std::vec![0x01, 0x00, mode.cast_unsigned(), 0x0c, numbers.len() as u8, first];
            numbers.iter().for_each(|number| data.extend_from_slice(&number.to_le_bytes()));
            bench.exchange(&Frame::flexible(extended(1), &data, 0x50).unwrap());
            bench.run(3);
            prop_assert!(bench.drive.step(&bench.sensors, None).is_finite());
            for register in 0..0x60 {
                bench.answers(&read(register, Resolution::Int16));
            }
        }
    }

    #[test]
    fn numbers_come_back(number in -3.0_f32..3.0) {
        for scale in [Scale::Position, Scale::Velocity, Scale::Torque, Scale::Time, Scale::Voltage, Scale::Power] {
            for resolution in [Resolution::Int16, Resolution::Int32, Resolution::Float] {
                let back = Value::new(Content::Number(number), scale, resolution).number(scale);
                let unit = if resolution == Resolution::Float { 0.0 } else { scale.unit(resolution) };
                // Cut by up to a unit, and rounded to f32 twice.
                let unit = unit + 4.0 * f32::EPSILON * number.abs();
                prop_assert!((back - number).abs() <= unit, "{number} {back} {scale:?} {resolution:?}");
            }
        }
    }
}
