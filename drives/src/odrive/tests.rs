//! Tests of server and client against each other and against vectors of the maker's DBC files.
//!
//! Vectors: encoded by cantools 45.1.0 with tools/odrive-cansimple.dbc (firmware 0.5) and odrive-cansimple-0.6.10.dbc.

use std::vec::Vec;

use proptest::prelude::*;

use super::codes::*;
use super::parameters::{Value, endpoint_of};
use super::payload::*;
use super::*;
use crate::bus::CanServer;
use crate::drive::{Drive, Fault, Sensors};
use crate::frame::{Frame, Kind, extended, standard};
use crate::turns::{Ratio, Turns};

const NODE: u8 = 1;
const RATIO: f32 = 6.0;
const COUNTS: u32 = 1 << 14;
const LINES: [Firmware; 2] = [Firmware::V0_5, Firmware::V0_6];

/// Drive on a bus with a client. The rotor stands still unless the test moves it.
struct Bench {
    server: Server,
    drive: Drive,
    sensors: Sensors,
    sent: Vec<Frame>,
    torque: f32,
}

impl Bench {
    fn new(firmware: Firmware) -> Self {
        Self::with(firmware, super::settings(Settings { period: 1e-3, max_velocity: 60.0, ..Settings::default() }))
    }

    fn with(firmware: Firmware, settings: Settings) -> Self {
        let sensors = Sensors { motor_counts: Some(0), output_counts: Some(0), ..Sensors::default() };
        let mut bench = Self {
            server: Server::new(NODE, firmware),
            drive: Drive::new(settings),
            sensors,
            sent: Vec::new(),
            torque: 0.0,
        };
        bench.run(2);
        bench
    }

    fn run(&mut self, periods: usize) {
        for _ in 0..periods {
            self.torque = self.drive.step(&self.sensors, None);
            self.server.tick(&mut self.drive, &mut |frame| self.sent.push(frame));
        }
    }

    fn frame(&mut self, frame: &Frame) {
        self.server.receive(frame, &mut self.drive, &mut |frame| self.sent.push(frame));
    }

    fn command(&mut self, command: Command) {
        let frame = client::command(self.server.firmware(), self.server.node_id(), &command).unwrap();
        self.frame(&frame);
    }

    fn state(&mut self, state: u8) {
        self.command(Command::SetState(RequestedState { state: state.into() }));
    }

    fn modes(&mut self, control: u32, input: u32) {
        self.command(Command::SetControllerMode(ControllerMode { control, input }));
    }

    fn input_position(&mut self, position: f32) {
        self.command(Command::SetInputPosition(InputPosition { position, ..InputPosition::default() }));
    }

    fn enabled(firmware: Firmware, control: u32, input: u32) -> Self {
        let mut bench = Self::new(firmware);
        bench.modes(control, input);
        bench.state(axis_state::CLOSED_LOOP_CONTROL);
        bench
    }

    fn ask_node(&mut self, node_id: u8, command: u8) -> Option<Report> {
        self.sent.clear();
        self.frame(&client::request(node_id, command).unwrap());
        let (from, report) = client::decode(self.server.firmware(), self.sent.first()?)?;
        assert_eq!((from, self.sent.len()), (node_id, 1));
        Some(report)
    }

    fn ask(&mut self, command: u8) -> Option<Report> {
        self.ask_node(self.server.node_id(), command)
    }

    fn parameter(&mut self, path: &str, like: Value) -> Option<Value> {
        self.sent.clear();
        self.command(client::read_parameter(endpoint_of(path)?.id));
        match client::decode(Firmware::V0_6, self.sent.first()?)?.1 {
            Report::Parameter(answer) => Some(Value::from_bytes(like.kind(), answer.value)),
            _ => None,
        }
    }

    fn float(&mut self, path: &str) -> f32 {
        match self.parameter(path, Value::F32(0.0)) {
            Some(Value::F32(value)) => value,
            other => panic!("{path}: {other:?}"),
        }
    }

    fn write(&mut self, path: &str, value: Value) {
        self.command(client::write_parameter(endpoint_of(path).unwrap().id, value));
    }

    /// State and, with firmware 0.6, procedure result of a heartbeat.
    fn heartbeat(&mut self) -> (u32, u8, u8) {
        self.sent.clear();
        self.run(101);
        self.sent
            .iter()
            .rev()
            .find_map(|frame| match client::decode(self.server.firmware(), frame) {
                Some((NODE, Report::LegacyHeartbeat(beat))) => Some((beat.axis_error, beat.state, 0)),
                Some((NODE, Report::Heartbeat(beat))) => Some((beat.axis_error, beat.state, beat.procedure_result)),
                _ => None,
            })
            .unwrap()
    }

    fn legacy_errors(&mut self) -> (u32, u64, u32, u32) {
        let axis = self.heartbeat().0;
        let motor = match self.ask(0x03) {
            Some(Report::MotorError(error)) => error.errors,
            other => panic!("{other:?}"),
        };
        let part = |report| match report {
            Some(Report::EncoderError(error) | Report::ControllerError(error)) => error.errors,
            other => panic!("{other:?}"),
        };
        (axis, motor, part(self.ask(0x04)), part(self.ask(0x1d)))
    }

    fn errors(&mut self) -> (u32, u32) {
        match self.ask(0x03) {
            Some(Report::Errors(errors)) => (errors.active, errors.disarm_reason),
            other => panic!("{other:?}"),
        }
    }

    fn estimates(&mut self, node_id: u8) -> Estimates {
        match self.ask_node(node_id, 0x09) {
            Some(Report::EncoderEstimates(estimates)) => estimates,
            other => panic!("{other:?}"),
        }
    }

    fn count(&mut self, node_id: u8) -> (i32, i32) {
        match self.ask_node(node_id, 0x0a) {
            Some(Report::EncoderCount(count)) => (count.shadow, count.in_turn),
            other => panic!("{other:?}"),
        }
    }
}

fn assert_near(found: f32, expected: f32) {
    assert!((found - expected).abs() <= 1e-4 * expected.abs().max(1.0), "{found} instead of {expected}");
}

#[test]
fn commands_have_the_bytes_of_the_dbc() {
    use Firmware::{V0_5, V0_6};
    let position = InputPosition { position: 0.6, velocity: Milli(-1.234), torque: Milli(0.25) };
    let serial_number = [0xbc, 0x9a, 0x78, 0x56, 0x34, 0x12];
    let cases: [(Firmware, Command, u32, &[u8]); 15] = [
        (V0_5, Command::SetInputPosition(position), 0x2c, &[0x9a, 0x99, 0x19, 0x3f, 0x2e, 0xfb, 0xfa, 0]),
        (
            V0_5,
            Command::SetInputVelocity(InputVelocity { velocity: -2.5, torque: 0.125 }),
            0x2d,
            &[0, 0, 0x20, 0xc0, 0, 0, 0, 0x3e],
        ),
        (V0_5, Command::SetControllerMode(ControllerMode { control: 3, input: 5 }), 0x2b, &[3, 0, 0, 0, 5, 0, 0, 0]),
        (V0_5, Command::SetLinearCount(LinearCount { position: -4096 }), 0x39, &[0, 0xf0, 0xff, 0xff, 0, 0, 0, 0]),
        (V0_5, Command::SetNodeId(NodeId { node_id: 9 }), 0x26, &[9, 0, 0, 0, 0, 0, 0, 0]),
        (
            V0_5,
            Command::SetLimits(Limits { velocity: 20.0, current: 15.5 }),
            0x2f,
            &[0, 0, 0xa0, 0x41, 0, 0, 0x78, 0x41],
        ),
        (
            V0_5,
            Command::SetVelocityGains(VelocityGains { gain: 0.5, integrator: 1.5 }),
            0x3b,
            &[0, 0, 0, 0x3f, 0, 0, 0xc0, 0x3f],
        ),
        (V0_6, Command::SetState(RequestedState { state: 8 }), 0x27, &[8, 0, 0, 0, 0, 0, 0, 0]),
        (V0_6, client::write_parameter(388, Value::F32(10.0)), 0x24, &[1, 0x84, 1, 0, 0, 0, 0x20, 0x41]),
        (
            V0_6,
            Command::SetAddress(Address { node_id: 7, serial_number, connection: 0 }),
            0x26,
            &[7, 0xbc, 0x9a, 0x78, 0x56, 0x34, 0x12, 0],
        ),
        (V0_6, Command::ClearErrors(ClearErrors { identify: 1 }), 0x38, &[1]),
        (V0_6, Command::Reboot(payload::Reboot { action: reboot::SAVE_CONFIGURATION }), 0x36, &[1]),
        (V0_6, Command::SetAbsolutePosition(AbsolutePosition { position: 1.5 }), 0x39, &[0, 0, 0xc0, 0x3f, 0, 0, 0, 0]),
        (V0_6, Command::Estop(Empty {}), 0x22, &[]),
        (V0_6, Command::SetInputPosition(position), 0x2c, &[0x9a, 0x99, 0x19, 0x3f, 0x2e, 0xfb, 0xfa, 0]),
    ];
    for (firmware, command, id, bytes) in cases {
        let frame = client::command(firmware, NODE, &command).unwrap();
        assert_eq!((frame.raw_id(), frame.data()), (id, bytes), "{command:?}");
        assert_eq!(Command::decode(firmware, &frame), Some((NODE, command)));
    }
}

#[test]
fn reports_are_read_as_the_dbc_reads_them() {
    use Firmware::{V0_5, V0_6};
    let version = Version { protocol: 2, hardware: [5, 2, 0], firmware: [0, 6, 10], unreleased: 0 };
    let cases = [
        (V0_5, Report::EncoderCount(EncoderCount { shadow: 70_000, in_turn: 4464 }), "7011010070110000", 0x2a),
        (
            V0_5,
            Report::LegacyHeartbeat(LegacyHeartbeat {
                axis_error: axis_error::WATCHDOG_TIMER_EXPIRED,
                state: 1,
                motor_error: 0,
                encoder_error: 1,
                controller_flags: 0x81,
            }),
            "0008000001000181",
            0x21,
        ),
        (
            V0_6,
            Report::Heartbeat(Heartbeat {
                axis_error: error::WATCHDOG_TIMER_EXPIRED,
                state: 1,
                procedure_result: procedure_result::DISARMED,
                trajectory_done: 1,
            }),
            "0000000101030100",
            0x21,
        ),
        (
            V0_6,
            Report::Errors(Errors { active: error::DC_BUS_UNDER_VOLTAGE, disarm_reason: error::ESTOP_REQUESTED }),
            "0002000000000002",
            0x23,
        ),
        (V0_6, Report::Torques(Torques { target: 0.5, estimate: -0.25 }), "0000003f000080be", 0x3c),
        (V0_6, Report::Version(version), "0205020000060a00", 0x20),
    ];
    for (firmware, report, hex, id) in cases {
        let bytes: Vec<u8> = (0..8).map(|at| u8::from_str_radix(&hex[2 * at..2 * at + 2], 16).unwrap()).collect();
        let frame = Frame::classic(standard(id), &bytes).unwrap();
        assert_eq!(client::decode(firmware, &frame), Some((NODE, report)));
        assert_eq!(report.encode(firmware, NODE), Some(frame));
    }
}

#[test]
fn line_without_a_message_refuses_it() {
    let linear = Command::SetLinearCount(LinearCount::default());
    assert_eq!(client::command(Firmware::V0_6, NODE, &linear), None);
    assert_eq!(client::command(Firmware::V0_5, NODE, &Command::EnterDfuMode(Empty {})), None);
    for (firmware, missing) in
        [(Firmware::V0_5, &[0x00, 0x01, 0x06, 0x1c][..]), (Firmware::V0_6, &[0x04, 0x05, 0x0a, 0x10])]
    {
        for command in missing {
            assert_eq!(Bench::new(firmware).ask(*command), None, "{firmware:?} {command:#x}");
        }
    }
}

#[test]
fn every_report_of_a_line_is_answered() {
    let legacy: &[u8] = &[0x03, 0x04, 0x05, 0x09, 0x0a, 0x14, 0x15, 0x17, 0x1d];
    let present: &[u8] = &[0x00, 0x01, 0x03, 0x06, 0x09, 0x14, 0x15, 0x17, 0x1c, 0x1d];
    for (firmware, commands) in [(Firmware::V0_5, legacy), (Firmware::V0_6, present)] {
        let mut bench = Bench::new(firmware);
        for command in commands {
            let remote = bench.ask(*command);
            assert!(remote.is_some(), "{firmware:?} {command:#x}");
            bench.sent.clear();
            bench.frame(&Frame::classic(standard(identifier(NODE, *command)), &[]).unwrap());
            assert_eq!(client::decode(firmware, &bench.sent[0]).map(|(_, report)| report), remote);
        }
    }
}

#[test]
fn cyclic_messages_keep_their_periods() {
    for firmware in LINES {
        let mut bench = Bench::new(firmware);
        bench.server.set_output_node(None);
        let count = |bench: &mut Bench, command: u8| {
            bench.sent.clear();
            bench.run(1000);
            bench.sent.iter().filter(|frame| frame.raw_id() == u32::from(identifier(NODE, command))).count()
        };
        assert_eq!((count(&mut bench, 0x01), count(&mut bench, 0x09), count(&mut bench, 0x14)), (10, 100, 0));
        bench.server.set_rate(0x14, 20);
        bench.server.set_rate(0x01, 0);
        assert_eq!((count(&mut bench, 0x01), count(&mut bench, 0x14)), (0, 50));
        assert_eq!((bench.server.rate(0x14), bench.server.rate(0x0c)), (Some(20), None));
    }
}

#[test]
fn states_follow_requests() {
    for firmware in LINES {
        let mut bench = Bench::new(firmware);
        assert_eq!(bench.heartbeat(), (0, axis_state::IDLE, 0));
        bench.state(axis_state::CLOSED_LOOP_CONTROL);
        assert_eq!(bench.heartbeat().1, axis_state::CLOSED_LOOP_CONTROL);
        bench.state(axis_state::UNDEFINED);
        assert_eq!(bench.heartbeat().1, axis_state::CLOSED_LOOP_CONTROL);
        bench.state(axis_state::IDLE);
        assert_eq!(bench.heartbeat().1, axis_state::IDLE);
        bench.state(axis_state::STARTUP_SEQUENCE);
        assert_eq!(bench.heartbeat(), (0, axis_state::IDLE, 0));
    }
}

#[test]
fn calibration_leads_to_closed_loop_control() {
    for firmware in LINES {
        let settings = Settings { period: 1e-3, is_calibrated: false, ..Settings::default() };
        let mut bench = Bench::with(firmware, super::settings(settings));
        bench.state(axis_state::CLOSED_LOOP_CONTROL);
        let refused = if firmware == Firmware::V0_5 {
            (axis_error::INVALID_STATE, axis_state::IDLE, 0)
        } else {
            (0, axis_state::IDLE, procedure_result::NOT_CALIBRATED)
        };
        assert_eq!(bench.heartbeat(), refused);
        bench.state(axis_state::ENCODER_OFFSET_CALIBRATION);
        assert_eq!(bench.heartbeat(), refused);
        bench.state(axis_state::FULL_CALIBRATION_SEQUENCE);
        let busy = if firmware == Firmware::V0_5 { 0 } else { procedure_result::BUSY };
        assert_eq!(bench.heartbeat(), (0, axis_state::MOTOR_CALIBRATION, busy));
        bench.run(1000);
        assert_eq!(bench.heartbeat(), (0, axis_state::ENCODER_OFFSET_CALIBRATION, busy));
        bench.run(1000);
        assert_eq!(bench.heartbeat(), (0, axis_state::IDLE, 0));
        bench.state(axis_state::CLOSED_LOOP_CONTROL);
        assert_eq!(bench.heartbeat().1, axis_state::CLOSED_LOOP_CONTROL);
    }
}

#[test]
fn parts_of_the_calibration_run_alone() {
    let settings = Settings { period: 1e-3, is_calibrated: false, ..Settings::default() };
    let mut bench = Bench::with(Firmware::V0_6, super::settings(settings));
    bench.state(axis_state::MOTOR_CALIBRATION);
    assert_eq!(bench.heartbeat().1, axis_state::MOTOR_CALIBRATION);
    bench.run(1000);
    assert_eq!(bench.heartbeat(), (0, axis_state::IDLE, procedure_result::SUCCESS));
    bench.state(axis_state::CLOSED_LOOP_CONTROL);
    assert_eq!(bench.heartbeat().2, procedure_result::NOT_CALIBRATED);
    bench.state(axis_state::ENCODER_OFFSET_CALIBRATION);
    bench.run(10);
    bench.state(axis_state::IDLE);
    assert_eq!(bench.heartbeat(), (0, axis_state::IDLE, procedure_result::CANCELLED));
    bench.state(axis_state::ENCODER_OFFSET_CALIBRATION);
    bench.run(2000);
    assert_eq!(bench.heartbeat().2, procedure_result::SUCCESS);
    assert!(bench.drive.is_calibrated());
}

#[test]
fn unsupported_states_are_refused() {
    let mut bench = Bench::new(Firmware::V0_5);
    bench.state(9);
    assert_eq!(bench.heartbeat(), (axis_error::INVALID_STATE, axis_state::IDLE, 0));
    bench.state(axis_state::HOMING);
    assert_eq!(bench.heartbeat().0, axis_error::HOMING_WITHOUT_ENDSTOP);
    bench.state(axis_state::CLOSED_LOOP_CONTROL);
    assert_eq!(bench.heartbeat().1, axis_state::IDLE);
    bench.command(Command::ClearErrors(ClearErrors::default()));
    bench.state(axis_state::CLOSED_LOOP_CONTROL);
    assert_eq!(bench.heartbeat(), (0, axis_state::CLOSED_LOOP_CONTROL, 0));
    let mut bench = Bench::new(Firmware::V0_6);
    bench.state(200);
    assert_eq!(bench.heartbeat(), (0, axis_state::IDLE, procedure_result::INVALID_STATE));
    bench.state(axis_state::HOMING);
    assert_eq!(bench.heartbeat().2, procedure_result::HOMING_WITHOUT_ENDSTOP);
}

#[test]
fn position_is_in_turns_of_the_motor() {
    for firmware in LINES {
        let mut bench = Bench::enabled(firmware, control_mode::POSITION_CONTROL, input_mode::PASSTHROUGH);
        bench.command(Command::SetPositionGain(PositionGain { gain: 4.0 }));
        bench.command(Command::SetVelocityGains(VelocityGains { gain: 0.5, integrator: 0.0 }));
        // Half a count is the rest of the encoder's resolution.
        bench.input_position(0.25 + 0.5 / COUNTS as f32);
        bench.run(1);
        assert_near(bench.torque, 4.0 * 0.5 * 0.25);
        let input = InputPosition { position: 0.5 / COUNTS as f32, velocity: Milli(0.5), torque: Milli(0.125) };
        bench.command(Command::SetInputPosition(input));
        bench.run(1);
        assert_near(bench.torque, 0.5 * 0.5 + 0.125);
    }
}

#[test]
fn velocity_and_torque_control_are_those_of_the_motor() {
    for firmware in LINES {
        let mut bench = Bench::enabled(firmware, control_mode::VELOCITY_CONTROL, input_mode::PASSTHROUGH);
        bench.command(Command::SetVelocityGains(VelocityGains { gain: 0.5, integrator: 2.0 }));
        bench.command(Command::SetInputVelocity(InputVelocity { velocity: 1.5, torque: 0.1 }));
        bench.run(1);
        assert_near(bench.torque, 0.5 * 1.5 + 0.1 + 2.0 * 1.5 * 1e-3);
        bench.run(99);
        assert_near(bench.torque, 0.5 * 1.5 + 0.1 + 2.0 * 1.5 * 0.1);
        bench.modes(control_mode::TORQUE_CONTROL, input_mode::PASSTHROUGH);
        bench.command(Command::SetInputTorque(InputTorque { torque: -0.7 }));
        bench.run(1);
        assert_near(bench.torque, -0.7);
    }
}

#[test]
fn torque_control_keeps_the_speed_limit() {
    let mut bench = Bench::enabled(Firmware::V0_6, control_mode::TORQUE_CONTROL, input_mode::PASSTHROUGH);
    bench.command(Command::SetLimits(Limits { velocity: 2.0, current: 20.0 }));
    bench.command(Command::SetVelocityGains(VelocityGains { gain: 0.1, integrator: 0.0 }));
    bench.command(Command::SetInputTorque(InputTorque { torque: 1.5 }));
    bench.run(1);
    assert_near(bench.torque, 0.1 * 2.0);
    bench.command(Command::SetLimits(Limits { velocity: 100.0, current: 10.0 }));
    bench.run(2);
    // The torque constant is 0.1 N m/A.
    assert_near(bench.torque, 1.0);
}

#[test]
fn velocity_is_limited() {
    let mut bench = Bench::enabled(Firmware::V0_5, control_mode::POSITION_CONTROL, input_mode::PASSTHROUGH);
    bench.command(Command::SetPositionGain(PositionGain { gain: 20.0 }));
    bench.command(Command::SetVelocityGains(VelocityGains { gain: 0.25, integrator: 0.0 }));
    bench.command(Command::SetLimits(Limits { velocity: 2.0, current: 20.0 }));
    bench.input_position(50.0);
    bench.run(1);
    assert_near(bench.torque, 0.5);
    for (velocity, current) in [(f32::NAN, 1.0), (-1.0, 1.0), (1.0, f32::INFINITY), (1.0, -1.0)] {
        bench.command(Command::SetLimits(Limits { velocity, current }));
    }
    bench.run(1);
    assert_near(bench.torque, 0.5);
}

#[test]
fn ramps_have_the_rates_of_the_configuration() {
    let mut bench = Bench::enabled(Firmware::V0_6, control_mode::VELOCITY_CONTROL, input_mode::VEL_RAMP);
    bench.write("axis0.controller.config.vel_ramp_rate", Value::F32(5.0));
    bench.command(Command::SetInertia(Inertia { inertia: 0.02 }));
    bench.command(Command::SetVelocityGains(VelocityGains { gain: 0.1, integrator: 0.0 }));
    bench.command(Command::SetInputVelocity(InputVelocity { velocity: 3.0, torque: 0.0 }));
    bench.run(101);
    assert_near(bench.float("axis0.controller.vel_setpoint"), 0.505);
    assert_near(bench.torque, 0.1 * 0.5 + 0.02 * 5.0);
    bench.run(1000);
    assert_near(bench.float("axis0.controller.vel_setpoint"), 3.0);
    bench.modes(control_mode::TORQUE_CONTROL, input_mode::TORQUE_RAMP);
    bench.write("axis0.controller.config.torque_ramp_rate", Value::F32(2.0));
    bench.command(Command::SetInputTorque(InputTorque { torque: 0.5 }));
    bench.run(101);
    assert_near(bench.float("axis0.controller.torque_setpoint"), 0.202);
    bench.run(1000);
    assert_near(bench.torque, 0.5);
}

#[test]
fn position_filter_is_critically_damped() {
    let mut bench = Bench::enabled(Firmware::V0_6, control_mode::POSITION_CONTROL, input_mode::POS_FILTER);
    bench.write("axis0.controller.config.input_filter_bandwidth", Value::F32(10.0));
    let start = bench.float("axis0.controller.pos_setpoint");
    bench.input_position(start + 1.0);
    bench.run(100);
    // 1 - (1 + b t) exp(-b t) at b t = 1.
    let reached = bench.float("axis0.controller.pos_setpoint") - start;
    assert!((reached - 0.264).abs() < 0.01, "{reached}");
    bench.run(1900);
    let end = bench.float("axis0.controller.pos_setpoint") - start;
    assert!((end - 1.0).abs() < 1e-4, "{end}");
}

#[test]
fn trajectory_ends_in_its_time() {
    for period in [1e-3, 1e-4] {
        let settings = super::settings(Settings { period, ..Settings::default() });
        let mut bench = Bench::with(Firmware::V0_6, settings);
        bench.modes(control_mode::POSITION_CONTROL, input_mode::TRAP_TRAJ);
        bench.state(axis_state::CLOSED_LOOP_CONTROL);
        bench.command(Command::SetTrajectoryVelocity(TrajectoryVelocity { velocity: 2.0 }));
        let acceleration = TrajectoryAcceleration { acceleration: 10.0, deceleration: 8.0 };
        bench.command(Command::SetTrajectoryAcceleration(acceleration));
        let start = bench.float("axis0.pos_estimate");
        bench.input_position(start + 1.5);
        let periods = |seconds: f32| (seconds / period) as usize;
        bench.run(periods(0.5));
        assert_near(bench.float("axis0.controller.vel_setpoint"), 2.0);
        assert_eq!(bench.parameter("axis0.controller.trajectory_done", Value::Bool(true)), Some(Value::Bool(false)));
        // 1.5 turns at 2 turns/s and a ramp of 0.25 s: 1 s.
        bench.run(periods(0.55));
        assert_eq!(bench.parameter("axis0.controller.trajectory_done", Value::Bool(false)), Some(Value::Bool(true)));
        assert_near(bench.float("axis0.controller.pos_setpoint"), start + 1.5);
        assert_eq!(bench.float("axis0.controller.vel_setpoint"), 0.0);
    }
}

#[test]
fn closed_loop_control_begins_where_the_motor_is() {
    let mut bench = Bench::new(Firmware::V0_5);
    bench.input_position(40.0);
    bench.command(Command::SetVelocityGains(VelocityGains { gain: 0.5, integrator: 0.0 }));
    bench.sensors.motor_counts = Some(300);
    bench.run(300);
    bench.state(axis_state::CLOSED_LOOP_CONTROL);
    bench.run(1);
    assert!(bench.torque.abs() < 1e-3, "{}", bench.torque);
}

#[test]
fn both_encoders_are_read() {
    let mut bench = Bench::new(Firmware::V0_5);
    // 1.25 turns of the motor, in steps below half a turn; the output lags within the gap.
    for eighth in 1..=10 {
        bench.sensors.motor_counts = Some(eighth * COUNTS / 8 % COUNTS);
        bench.run(1);
    }
    bench.sensors.output_counts = Some(1 << 14);
    bench.run(500);
    assert_eq!(bench.server.output_node(), Some(NODE + 1));
    assert_near(bench.estimates(NODE).position, 1.25);
    assert_eq!(bench.count(NODE), ((5 * COUNTS / 4) as i32, (COUNTS / 4) as i32));
    assert_near(bench.estimates(NODE + 1).position, 0.125);
    assert_eq!(bench.count(NODE + 1), (1 << 14, 1 << 14));

    bench.command(Command::SetLinearCount(LinearCount { position: -1000 }));
    bench.frame(
        &client::command(Firmware::V0_5, NODE + 1, &Command::SetLinearCount(LinearCount { position: 77 })).unwrap(),
    );
    bench.run(1);
    assert_eq!(bench.count(NODE), (-1000, (COUNTS / 4) as i32));
    assert_eq!(bench.count(NODE + 1), (77, 1 << 14));

    let sensors = bench.sensors;
    let mut bench = Bench::with(Firmware::V0_6, super::settings(Settings::default()));
    bench.sensors = sensors;
    bench.run(10);
    assert_near(bench.float("onboard_encoder0.raw"), 0.25);
    assert_near(bench.float("spi_encoder0.raw"), 0.125);
    bench.command(Command::SetAbsolutePosition(AbsolutePosition { position: -3.5 }));
    bench.run(1);
    assert_near(bench.estimates(NODE).position, -3.5);
    assert_near(bench.float("axis0.commutation_mapper.pos_rel"), -3.5);
    assert_near(bench.float("onboard_encoder0.raw"), 0.25);
}

#[test]
fn second_axis_has_no_motor() {
    let mut bench = Bench::new(Firmware::V0_5);
    let state = |state: u8| {
        let request = Command::SetState(RequestedState { state: state.into() });
        client::command(Firmware::V0_5, NODE + 1, &request).unwrap()
    };
    let error = |bench: &mut Bench| {
        bench.sent.clear();
        bench.run(101);
        let found = bench.sent.iter().find_map(|frame| match client::decode(Firmware::V0_5, frame) {
            Some((node, Report::LegacyHeartbeat(beat))) if node == NODE + 1 => Some((beat.axis_error, beat.state)),
            _ => None,
        });
        found.unwrap()
    };
    bench.frame(&state(axis_state::CLOSED_LOOP_CONTROL));
    assert_eq!(error(&mut bench), (axis_error::INVALID_STATE, axis_state::IDLE));
    bench.frame(&state(axis_state::IDLE));
    assert_eq!(error(&mut bench), (0, axis_state::IDLE));
    assert_eq!(bench.heartbeat().0, 0);
}

#[test]
fn readings_are_reported() {
    let mut bench = Bench::enabled(Firmware::V0_6, control_mode::TORQUE_CONTROL, input_mode::PASSTHROUGH);
    bench.command(Command::SetInputTorque(InputTorque { torque: 0.5 }));
    bench.sensors.motor_torque = 0.25;
    (bench.sensors.bus_current, bench.sensors.motor_temperature, bench.sensors.board_temperature) = (2.0, 45.0, 35.0);
    bench.run(1);
    assert_eq!(bench.ask(0x14), Some(Report::Currents(Currents { setpoint: 5.0, measured: 2.5 })));
    assert_eq!(bench.ask(0x15), Some(Report::Temperatures(Temperatures { inverter: 35.0, motor: 45.0 })));
    assert_eq!(bench.ask(0x17), Some(Report::Bus(Bus { voltage: 48.0, current: 2.0 })));
    assert_eq!(bench.ask(0x1c), Some(Report::Torques(Torques { target: 0.5, estimate: 0.25 })));
    assert_eq!(bench.ask(0x1d), Some(Report::Powers(Powers { electrical: 96.0, mechanical: 0.0 })));
    bench.state(axis_state::IDLE);
    bench.run(1);
    assert_eq!(bench.ask(0x1c), Some(Report::Torques(Torques { target: 0.0, estimate: 0.25 })));
}

/// Fault, its cause, and the codes of firmware 0.5 (axis, motor, encoder, controller) and 0.6.
type FaultCase = (Fault, fn(&mut Bench), (u32, u64, u32, u32), u32);

/// Faults with the readings that cause them.
fn faults() -> [FaultCase; 10] {
    let controller = axis_error::CONTROLLER_FAILED;
    [
        (
            Fault::MotorEncoder,
            |bench| (bench.drive.settings_mut().max_silent_periods, bench.sensors.motor_counts) = (0, None),
            (axis_error::ENCODER_FAILED, 0, encoder_error::ABS_SPI_COM_FAIL, 0),
            error::MISSING_ESTIMATE,
        ),
        (
            Fault::OutputEncoder,
            |bench| (bench.drive.settings_mut().max_silent_periods, bench.sensors.output_counts) = (0, None),
            (controller, 0, 0, controller_error::INVALID_ESTIMATE),
            error::MISSING_ESTIMATE,
        ),
        (
            Fault::UnderVoltage,
            |bench| bench.sensors.bus_voltage = 3.0,
            (axis_error::MOTOR_FAILED, motor_error::SYSTEM_LEVEL, 0, 0),
            error::DC_BUS_UNDER_VOLTAGE,
        ),
        (
            Fault::OverVoltage,
            |bench| bench.sensors.bus_voltage = 90.0,
            (axis_error::MOTOR_FAILED, motor_error::SYSTEM_LEVEL, 0, 0),
            error::DC_BUS_OVER_VOLTAGE,
        ),
        (
            Fault::OverTemperature,
            |bench| bench.sensors.motor_temperature = 150.0,
            (axis_error::MOTOR_FAILED, motor_error::MOTOR_THERMISTOR_OVER_TEMP, 0, 0),
            error::MOTOR_OVER_TEMP,
        ),
        (
            Fault::OverTemperature,
            |bench| bench.sensors.board_temperature = 150.0,
            (axis_error::MOTOR_FAILED, motor_error::FET_THERMISTOR_OVER_TEMP, 0, 0),
            error::INVERTER_OVER_TEMP,
        ),
        (
            Fault::Overspeed,
            |bench| {
                bench.command(Command::SetLimits(Limits { velocity: 0.5, current: 10.0 }));
                for step in 1..50 {
                    bench.sensors.motor_counts = Some(step * 40);
                    bench.run(1);
                }
            },
            (controller, 0, 0, controller_error::OVERSPEED),
            error::VELOCITY_LIMIT_VIOLATION,
        ),
        (
            Fault::OutsideTravel,
            |bench| bench.drive.settings_mut().travel = (Some(Turns::new(1.0)), None),
            (axis_error::MIN_ENDSTOP_PRESSED, 0, 0, 0),
            error::POSITION_LIMIT_VIOLATION,
        ),
        (
            Fault::OutsideTravel,
            |bench| bench.drive.settings_mut().travel = (None, Some(Turns::new(-1.0))),
            (axis_error::MAX_ENDSTOP_PRESSED, 0, 0, 0),
            error::POSITION_LIMIT_VIOLATION,
        ),
        (
            Fault::EmergencyStop,
            |bench| bench.command(Command::Estop(Empty {})),
            (axis_error::ESTOP_REQUESTED, 0, 0, 0),
            error::ESTOP_REQUESTED,
        ),
    ]
}

#[test]
fn each_fault_has_the_codes_of_both_lines() {
    for (fault, cause, legacy, code) in faults() {
        let mut bench = Bench::enabled(Firmware::V0_5, control_mode::TORQUE_CONTROL, input_mode::PASSTHROUGH);
        cause(&mut bench);
        bench.run(2);
        assert_eq!(bench.drive.fault(), Some(fault));
        assert_eq!(bench.legacy_errors(), legacy, "{fault:?}");
        let mut bench = Bench::enabled(Firmware::V0_6, control_mode::TORQUE_CONTROL, input_mode::PASSTHROUGH);
        cause(&mut bench);
        bench.run(2);
        assert_eq!(bench.errors(), (code, code), "{fault:?}");
        assert_eq!(bench.heartbeat(), (code, axis_state::IDLE, procedure_result::DISARMED));
        assert_eq!(bench.torque, 0.0);
    }
}

#[test]
fn output_encoder_fails_at_the_second_axis() {
    let mut bench = Bench::enabled(Firmware::V0_5, control_mode::TORQUE_CONTROL, input_mode::PASSTHROUGH);
    (bench.drive.settings_mut().max_silent_periods, bench.sensors.output_counts) = (0, None);
    bench.run(2);
    let found = bench.ask_node(NODE + 1, 0x04);
    assert_eq!(found, Some(Report::EncoderError(PartError { errors: encoder_error::ABS_SPI_COM_FAIL })));
}

#[test]
fn modes_that_are_missing_are_errors() {
    for (mode, code) in [
        (input_mode::MIRROR, controller_error::INVALID_MIRROR_AXIS),
        (input_mode::MIX_CHANNELS, controller_error::INVALID_INPUT_MODE),
        (77, controller_error::INVALID_INPUT_MODE),
    ] {
        let mut bench = Bench::enabled(Firmware::V0_5, control_mode::POSITION_CONTROL, mode);
        assert_eq!(bench.legacy_errors(), (axis_error::CONTROLLER_FAILED, 0, 0, code));
        let mut bench = Bench::enabled(Firmware::V0_6, control_mode::POSITION_CONTROL, mode);
        assert_eq!(bench.errors(), (error::BAD_CONFIG, error::BAD_CONFIG));
    }
}

#[test]
fn errors_are_cleared_and_keep_the_drive_off_until_then() {
    for firmware in LINES {
        let mut bench = Bench::enabled(firmware, control_mode::TORQUE_CONTROL, input_mode::PASSTHROUGH);
        bench.command(Command::Estop(Empty {}));
        bench.state(axis_state::CLOSED_LOOP_CONTROL);
        assert_eq!(bench.heartbeat().1, axis_state::IDLE);
        bench.command(Command::ClearErrors(ClearErrors { identify: 1 }));
        assert!(bench.server.is_identifying());
        assert_eq!(bench.heartbeat(), (0, axis_state::IDLE, 0));
        bench.state(axis_state::CLOSED_LOOP_CONTROL);
        assert_eq!(bench.heartbeat().1, axis_state::CLOSED_LOOP_CONTROL);
    }
}

#[test]
fn error_while_idle_is_no_disarm_reason() {
    let mut bench = Bench::new(Firmware::V0_6);
    bench.sensors.bus_voltage = 90.0;
    bench.run(1);
    assert_eq!(bench.errors(), (error::DC_BUS_OVER_VOLTAGE, 0));
    bench.sensors.bus_voltage = 48.0;
    bench.command(Command::ClearErrors(ClearErrors::default()));
    bench.run(1);
    assert_eq!(bench.errors(), (0, 0));
}

#[test]
fn watchdog_is_fed_by_each_frame() {
    for firmware in LINES {
        let mut bench = Bench::enabled(firmware, control_mode::TORQUE_CONTROL, input_mode::PASSTHROUGH);
        bench.drive.set_watchdog(Some(0.05));
        for _ in 0..4 {
            bench.run(40);
            assert!(bench.ask(0x09).is_some());
            assert_eq!(bench.drive.fault(), None);
        }
        bench.run(60);
        assert_eq!(bench.heartbeat().1, axis_state::IDLE);
        let code = match firmware {
            Firmware::V0_5 => axis_error::WATCHDOG_TIMER_EXPIRED,
            Firmware::V0_6 => error::WATCHDOG_TIMER_EXPIRED,
        };
        assert_eq!(bench.heartbeat().0, code);
    }
}

#[test]
fn watchdog_of_an_idle_axis_expires_with_firmware_0_5_only() {
    for (firmware, fault) in [(Firmware::V0_5, Some(Fault::Watchdog)), (Firmware::V0_6, None)] {
        let mut bench = Bench::new(firmware);
        bench.drive.set_watchdog(Some(0.05));
        bench.run(100);
        assert_eq!(bench.drive.fault(), fault);
    }
}

#[test]
fn watchdog_is_set_by_parameters() {
    let mut bench = Bench::enabled(Firmware::V0_6, control_mode::TORQUE_CONTROL, input_mode::PASSTHROUGH);
    bench.write("axis0.config.watchdog_timeout", Value::F32(0.03));
    bench.run(100);
    assert_eq!(bench.drive.fault(), None);
    bench.write("axis0.config.enable_watchdog", Value::Bool(true));
    assert_near(bench.float("axis0.config.watchdog_timeout"), 0.03);
    bench.run(40);
    assert_eq!(bench.errors(), (error::WATCHDOG_TIMER_EXPIRED, error::WATCHDOG_TIMER_EXPIRED));
    bench.write("axis0.config.enable_watchdog", Value::Bool(false));
    assert_near(bench.float("axis0.config.watchdog_timeout"), 0.03);
}

#[test]
fn parameters_keep_what_is_written() {
    let mut bench = Bench::new(Firmware::V0_6);
    for endpoint in parameters::ENDPOINTS {
        assert!(bench.parameter(endpoint.path, Value::U32(0)).is_some(), "{}", endpoint.path);
        assert_eq!(endpoint_of(endpoint.path).map(|found| found.id), Some(endpoint.id));
    }
    assert!(parameters::ENDPOINTS.windows(2).all(|pair| pair[0].id < pair[1].id));
    let floats = ["pos_gain", "vel_gain", "vel_integrator_gain", "vel_integrator_limit", "vel_limit", "inertia"];
    for name in floats {
        let path = std::format!("axis0.controller.config.{name}");
        bench.write(&path, Value::F32(1.234));
        assert_near(bench.float(&path), 1.234);
    }
    bench.write("axis0.config.motor.current_soft_max", Value::F32(7.0));
    assert_near(bench.drive.settings().torque_limit, 0.7);
    assert_near(bench.float("axis0.controller.config.vel_limit"), 1.234);
    bench.write("axis0.config.can.iq_msg_rate_ms", Value::U32(25));
    assert_eq!(bench.server.rate(0x14), Some(25));
    bench.write("axis0.pos_estimate", Value::F32(9.0));
    assert_near(bench.float("axis0.pos_estimate"), 0.0);
    bench.write("axis0.requested_state", Value::U8(axis_state::CLOSED_LOOP_CONTROL));
    assert_eq!(bench.parameter("axis0.is_armed", Value::Bool(false)), Some(Value::Bool(true)));
    bench.sent.clear();
    bench.command(client::read_parameter(9999));
    assert!(bench.sent.is_empty());
}

#[test]
fn drive_is_found_and_addressed() {
    let mut bench = Bench::new(Firmware::V0_6);
    bench.server.set_serial_number(0x1234_5678_9abc);
    bench.frame(&client::request(BROADCAST, 0x06).unwrap());
    let address = match client::decode(Firmware::V0_6, &bench.sent[0]) {
        Some((NODE, Report::Address(address))) => address,
        other => panic!("{other:?}"),
    };
    let give = |bench: &mut Bench, node_id: u8, serial_number| {
        let command = Command::SetAddress(Address { node_id, serial_number, connection: 0 });
        // The maker's example leaves out the connection.
        let frame = client::command(Firmware::V0_6, BROADCAST, &command).unwrap();
        bench.frame(&Frame::classic(frame.id, &frame.data()[..7]).unwrap());
    };
    give(&mut bench, 7, address.serial_number);
    assert_eq!(bench.server.node_id(), 7);
    give(&mut bench, 9, [9; 6]);
    assert_eq!(bench.server.node_id(), 7);
    give(&mut bench, 7, [9; 6]);
    assert_eq!(bench.server.node_id(), BROADCAST);
    let mut bench = Bench::new(Firmware::V0_5);
    bench.command(Command::SetNodeId(NodeId { node_id: 12 }));
    assert_eq!(bench.server.node_id(), 12);
    bench.command(Command::SetNodeId(NodeId { node_id: 64 }));
    assert_eq!(bench.server.node_id(), 12);
}

#[test]
fn reboot_leaves_closed_loop_control() {
    for firmware in LINES {
        let mut bench = Bench::enabled(firmware, control_mode::VELOCITY_CONTROL, input_mode::PASSTHROUGH);
        bench.command(Command::SetInputVelocity(InputVelocity { velocity: 3.0, torque: 0.0 }));
        if firmware == Firmware::V0_6 {
            bench.command(Command::Reboot(payload::Reboot { action: reboot::ENTER_DFU_MODE }));
            bench.command(Command::EnterDfuMode(Empty {}));
            assert_eq!(bench.heartbeat().1, axis_state::CLOSED_LOOP_CONTROL);
        }
        bench.command(Command::Reboot(payload::Reboot::default()));
        assert_eq!(bench.heartbeat(), (0, axis_state::IDLE, 0));
    }
}

#[test]
fn pin_voltage_is_answered_for_pins_of_the_board() {
    let mut bench = Bench::new(Firmware::V0_5);
    for (pin, answers) in [(3, 1), (17, 0)] {
        bench.sent.clear();
        bench.command(Command::RequestAdcVoltage(AdcRequest { pin }));
        assert_eq!(bench.sent.len(), answers);
    }
}

#[test]
fn foreign_and_malformed_frames_are_ignored() {
    let mut bench = Bench::enabled(Firmware::V0_6, control_mode::TORQUE_CONTROL, input_mode::PASSTHROUGH);
    bench.sent.clear();
    let set = bench.drive.set_point().copied();
    let estimates = identifier(NODE, 0x09);
    let frames = [
        client::request(NODE + 5, 0x09).unwrap(),
        Frame::remote(extended(estimates.into()), 8).unwrap(),
        Frame::with_kind(standard(estimates), Kind::Flexible(false), &[]).unwrap(),
        Frame::classic(standard(identifier(NODE, 0x07)), &[1, 0]).unwrap(),
        Frame::remote(standard(identifier(NODE, 0x02)), 0).unwrap(),
        Frame::classic(standard(identifier(NODE, 0x0e)), &[0, 0, 0xc0, 0x7f]).unwrap(),
    ];
    for frame in frames {
        bench.frame(&frame);
    }
    assert!(bench.sent.is_empty());
    assert_eq!(bench.drive.set_point().copied(), set);
    // The maker's example sends a requested state of 4 bytes.
    bench.frame(&Frame::classic(standard(identifier(NODE, 0x07)), &[1, 0, 0, 0]).unwrap());
    assert_eq!(bench.drive.set_point(), None);
}

proptest! {
    #[test]
    fn no_frame_panics(
        frames in proptest::collection::vec(
            (0_u8..32, any::<[u8; 8]>(), 0_usize..=8, 0_u8..4, any::<Option<f32>>()), 1..60,
        ),
        is_new: bool,
    ) {
        let firmware = if is_new { Firmware::V0_6 } else { Firmware::V0_5 };
        let mut bench = Bench::enabled(firmware, control_mode::POSITION_CONTROL, input_mode::PASSTHROUGH);
        for (command, mut data, length, node, number) in frames {
            if let Some(number) = number {
                data[..4].copy_from_slice(&number.to_le_bytes());
            }
            // Small numbers find modes, states and endpoints.
            if node == 2 {
                data = [data[0] % 9, 0, 0, 0, data[4] % 9, 0, 0, 0];
            }
            let node_id = [NODE, NODE, NODE, if is_new { BROADCAST } else { NODE + 1 }][usize::from(node)];
            let frame = Frame::classic(standard(identifier(node_id, command)), &data[..length]).unwrap();
            bench.frame(&frame);
            let _ = (client::decode(firmware, &frame), Command::decode(firmware, &frame));
            bench.run(3);
            prop_assert!(bench.torque.is_finite());
        }
    }

    #[test]
    fn no_write_of_a_parameter_panics(
        writes in proptest::collection::vec((0_usize..100, any::<u32>(), any::<bool>()), 1..60),
        mode in 0_u32..9,
    ) {
        let mut bench = Bench::enabled(Firmware::V0_6, control_mode::POSITION_CONTROL, mode);
        for (at, value, is_small) in writes {
            let endpoint = &parameters::ENDPOINTS[at % parameters::ENDPOINTS.len()];
            let value = Value::U32(if is_small { value % 9 } else { value });
            bench.command(client::write_parameter(endpoint.id, value));
            bench.command(client::read_parameter(endpoint.id));
            bench.run(3);
            prop_assert!(bench.torque.is_finite());
        }
    }

    #[test]
    fn commands_come_back(position: f32, velocity in -32.7_f32..32.7, torque in -32.7_f32..32.7) {
        let input = InputPosition { position, velocity: Milli(velocity), torque: Milli(torque) };
        let frame = client::command(Firmware::V0_6, NODE, &Command::SetInputPosition(input)).unwrap();
        let Some((NODE, Command::SetInputPosition(found))) = Command::decode(Firmware::V0_6, &frame) else {
            return Err(TestCaseError::fail("another command"));
        };
        prop_assert_eq!(found.position.to_bits(), position.to_bits());
        prop_assert!((found.velocity.0 - velocity).abs() < 0.00051 && (found.torque.0 - torque).abs() < 0.00051);
    }
}

#[test]
fn settings_are_the_makers() {
    let found = super::settings(Settings { max_velocity: 10.0, watchdog: Some(1.0), ..Settings::default() });
    assert_eq!((found.law, found.expiry, found.watchdog), (Law::Cascade, Expiry::Disable, None));
    assert_near(found.overspeed, 12.0);
    assert_eq!(found.ratio, Ratio::new(RATIO.into()));
}
