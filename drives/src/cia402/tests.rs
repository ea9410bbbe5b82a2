//! Server and client against each other on one joint.

use super::client::{self, Answer};
use super::dictionary::{self as object, Address, Direction};
use super::nmt::{Nmt, NmtCommand};
use super::sdo::{Abort, Sdo};
use super::state::{State, control, status};
use super::{Mode, Server, settings};
use crate::bus::CanServer;
use crate::drive::{Drive, Fault, Law, Sensors, Settings};
use crate::frame::{Frame, extended, standard};
use crate::turns::Turns;
use proptest::prelude::*;
use std::vec::Vec;

const NODE: u8 = 5;
const MASTER: u8 = 100;

/// Server, drive and a rigid joint with an inertia at the output.
struct Bench {
    server: Server,
    drive: Drive,
    sensors: Sensors,
    /// Angle of the output encoder beside the motor's [turns].
    gap: f64,
    turns: f64,
    speed: f64,
    sent: Vec<Frame>,
}

/// Control periods until the boot-up frame.
const BOOT_PERIODS: u32 = 50;

impl Bench {
    fn new(node_is_operational: bool) -> Self {
        let settings = settings(Settings { period: 1e-3, encoder_bandwidth: 200.0, ..Settings::default() });
        let mut bench = Self {
            server: Server::new(NODE),
            drive: Drive::new(settings),
            sensors: Sensors { motor_counts: Some(0), output_counts: Some(0), ..Sensors::default() },
            gap: 0.0,
            turns: 0.3,
            speed: 0.0,
            sent: Vec::new(),
        };
        bench.run(BOOT_PERIODS + 2);
        if node_is_operational {
            bench.frame(client::manage(NmtCommand::Start, NODE));
        }
        bench
    }

    /// Drive that is enabled in a mode.
    fn enabled(mode: Mode) -> Self {
        let mut bench = Self::new(true);
        bench.write(object::MODE, mode as i8 as u32);
        bench.command(&[6, 7, 15]);
        assert_eq!(bench.server.state(), State::OperationEnabled);
        bench
    }

    fn run(&mut self, periods: u32) {
        for _ in 0..periods {
            let counts = |turns: f64, per_turn: f64| (turns.rem_euclid(1.0) * per_turn) as u32;
            let sensors = Sensors {
                motor_counts: self.sensors.motor_counts.map(|_| counts(6.0 * self.turns, 16_384.0)),
                output_counts: self.sensors.output_counts.map(|_| counts(self.turns + self.gap, 131_072.0)),
                ..self.sensors
            };
            let torque = 6.0 * f64::from(self.drive.step(&sensors, None));
            self.speed += torque / 0.17 * 1e-3;
            self.turns += self.speed * 1e-3 / std::f64::consts::TAU;
            let Self { server, drive, sent, .. } = self;
            server.tick(drive, &mut |frame| sent.push(frame));
        }
    }

    fn frame(&mut self, frame: Option<Frame>) {
        let Self { server, drive, sent, .. } = self;
        server.receive(&frame.unwrap(), drive, &mut |frame| sent.push(frame));
    }

    /// Answers since the last call.
    fn answers(&mut self) -> Vec<Answer> {
        self.sent.drain(..).filter_map(|frame| client::decode(NODE, &frame)).collect()
    }

    fn request(&mut self, frame: Option<Frame>) -> Answer {
        self.sent.clear();
        self.frame(frame);
        self.answers().into_iter().find(|answer| matches!(answer, Answer::Sdo(_))).unwrap()
    }

    fn write(&mut self, address: Address, raw: u32) {
        let answer = self.request(client::download(NODE, address, raw));
        assert_eq!(answer, Answer::Sdo(Sdo::Empty { address }));
    }

    fn refuse(&mut self, address: Address, raw: u32, reason: Abort) {
        let answer = self.request(client::download(NODE, address, raw));
        assert_eq!(answer, Answer::Sdo(Sdo::Abort { address, code: reason as u32 }), "{address:?}");
    }

    fn read(&mut self, address: Address) -> i64 {
        let answer = self.request(client::upload(NODE, address));
        client::uploaded(address, &answer).unwrap_or_else(|| panic!("{address:?} {answer:?}"))
    }

    fn command(&mut self, words: &[u16]) {
        for word in words {
            self.write(object::CONTROLWORD, (*word).into());
        }
    }

    fn status(&mut self) -> u16 {
        self.read(object::STATUSWORD) as u16
    }

    /// Emergencies among the answers.
    fn emergencies(&mut self) -> Vec<(u16, u8)> {
        let code = |answer| match answer {
            Answer::Emergency { code, register } => Some((code, register)),
            _ => None,
        };
        self.answers().into_iter().filter_map(code).collect()
    }

    /// Transmit PDOs with a number among the answers.
    fn pdos(&mut self, wanted: u8) -> Vec<super::pdo::Data> {
        let data = |answer| match answer {
            Answer::Pdo(number, data) if number == wanted => Some(data),
            _ => None,
        };
        self.answers().into_iter().filter_map(data).collect()
    }
}

fn mapping_of(direction: Direction, number: usize, sub: u8) -> Address {
    Address::new(direction.mapping(number), sub)
}

fn parameter_of(direction: Direction, number: usize, sub: u8) -> Address {
    Address::new(direction.parameters(number), sub)
}

#[test]
fn boot_up_is_the_first_frame() {
    let mut bench = Bench::new(false);
    assert_eq!(bench.answers(), [Answer::State(Nmt::Initialising)]);
    assert_eq!(bench.server.state(), State::SwitchOnDisabled);
    bench.frame(client::manage(NmtCommand::Start, 0));
    assert_eq!(bench.server.nmt(), Nmt::Operational);
    bench.frame(client::manage(NmtCommand::Stop, NODE + 1));
    assert_eq!(bench.server.nmt(), Nmt::Operational);
    for command in [NmtCommand::ResetNode, NmtCommand::ResetCommunication] {
        bench.sent.clear();
        bench.frame(client::manage(command, NODE));
        bench.run(BOOT_PERIODS - 1);
        assert_eq!(bench.answers(), []);
        bench.run(1);
        assert_eq!(bench.answers(), [Answer::State(Nmt::Initialising)]);
    }
}

#[test]
fn heartbeat_and_guarding_tell_the_state() {
    let mut bench = Bench::new(false);
    bench.sent.clear();
    bench.frame(client::guard(NODE));
    bench.frame(client::guard(NODE));
    let toggles: Vec<_> = bench.sent.iter().map(|frame| frame.data()[0]).collect();
    assert_eq!(toggles, [0x7F, 0xFF]);
    bench.write(object::PRODUCER_HEARTBEAT, 10);
    bench.run(1);
    bench.sent.clear();
    bench.run(100);
    assert_eq!(bench.answers(), std::vec![Answer::State(Nmt::PreOperational); 10]);
    bench.frame(client::manage(NmtCommand::Stop, NODE));
    bench.frame(client::upload(NODE, object::STATUSWORD));
    assert_eq!(bench.answers(), []);
}

#[test]
fn frames_are_those_of_canopen() {
    // rpdo[2][0x607A].raw = -36000, [0x60B1].raw = 12345; rpdo[1]: 15, 8; nmt.state = 'OPERATIONAL', of canopen 2.4.1.
    let mapping = client::mapping(Direction::Receive, 2);
    let frame = client::receive_pdo(NODE, 2, &mapping, &[-36_000_i32 as u32, 12_345]);
    assert_eq!(frame, Frame::classic(standard(0x305), &[0x60, 0x73, 0xFF, 0xFF, 0x39, 0x30, 0, 0]));
    let frame = client::receive_pdo(NODE, 1, &client::mapping(Direction::Receive, 1), &[15, 8]);
    assert_eq!(frame, Frame::classic(standard(0x205), &[0x0F, 0, 8]));
    assert_eq!(client::manage(NmtCommand::Start, NODE), Frame::classic(standard(0), &[1, 5]));
    // tpdo[2].on_message gave -36000 and 36000; emcy.on_emcy gave 0x8130 and register 17.
    let mapping = client::mapping(Direction::Transmit, 2);
    let data = [0x60, 0x73, 0xFF, 0xFF, 0xA0, 0x8C, 0, 0];
    assert_eq!(client::value(object::POSITION_ACTUAL, &mapping, &data), Some(-36_000));
    assert_eq!(client::value(object::OUTPUT_POSITION, &mapping, &data), Some(36_000));
    let emergency = Frame::classic(standard(0x85), &[0x30, 0x81, 0x11, 0, 0, 0, 0, 0]).unwrap();
    assert_eq!(client::decode(NODE, &emergency), Some(Answer::Emergency { code: 0x8130, register: 17 }));
}

#[test]
fn both_encoders_are_read_in_the_same_units() {
    let mut bench = Bench::new(true);
    bench.gap = 0.01;
    bench.run(2);
    // 0.3 turns at power-up by the output encoder, by which the motor's turn is known.
    assert!((bench.read(object::POSITION_ACTUAL) - 108_000).abs() < 10);
    assert!((bench.read(object::OUTPUT_POSITION) - 111_600).abs() < 10);
    assert!((bench.read(object::POSITION_INTERNAL) - (0.8 * 16_384.0) as i64).abs() < 10);
    assert_eq!(bench.read(object::ENCODER_INCREMENTS), 16_384);
    assert_eq!(bench.read(object::OUTPUT_INCREMENTS), 131_072);
    assert_eq!((bench.read(object::GEAR_MOTOR), bench.read(object::GEAR_SHAFT)), (6, 1));
    bench.sent.clear();
    bench.frame(client::sync());
    let data = bench.pdos(2).pop().unwrap();
    let mapping = client::mapping(Direction::Transmit, 2);
    assert!((client::value(object::POSITION_ACTUAL, &mapping, &data).unwrap() - 108_000).abs() < 10);
    assert!((client::value(object::OUTPUT_POSITION, &mapping, &data).unwrap() - 111_600).abs() < 10);
}

#[test]
fn drive_without_output_encoder_has_no_value() {
    let mut bench = Bench::new(false);
    bench.drive.settings_mut().output_counts_per_turn = None;
    bench.drive.restart();
    bench.run(2);
    for address in [object::OUTPUT_POSITION, object::OUTPUT_VELOCITY, object::OUTPUT_INCREMENTS] {
        let answer = bench.request(client::upload(NODE, address));
        assert_eq!(answer, Answer::Sdo(Sdo::Abort { address, code: Abort::NoData as u32 }));
    }
}

#[test]
fn every_object_reads_by_sdo() {
    let mut bench = Bench::new(false);
    for entry in &object::ENTRIES {
        let answer = bench.request(client::upload(NODE, entry.address));
        let is_empty_error = entry.address.index == 0x1003 && entry.address.sub > 0;
        assert_eq!(matches!(answer, Answer::Sdo(Sdo::Abort { .. })), is_empty_error, "{:?}", entry.address);
    }
    assert!(object::ENTRIES.is_sorted_by(|before, after| before.address < after.address));
}

#[test]
fn transfers_are_refused_with_their_reason() {
    let mut bench = Bench::new(false);
    bench.refuse(object::STATUSWORD, 0, Abort::ReadOnly);
    bench.refuse(object::MODE, 6, Abort::Range);
    bench.refuse(object::PROFILE_ACCELERATION, 0, Abort::TooLow);
    bench.refuse(object::COMMUNICATION_ERROR_BEHAVIOUR, 3, Abort::TooHigh);
    bench.refuse(object::STIFFNESS, f32::NAN.to_bits(), Abort::Range);
    bench.refuse(object::QUICK_STOP_OPTION, 3, Abort::Range);
    let cases = [
        (Sdo::Empty { address: Address::new(0x5000, 0) }, Abort::NoObject),
        (Sdo::Empty { address: Address::new(0x6091, 3) }, Abort::NoSubIndex),
        (Sdo::expedited(object::CONTROLWORD, 0, 4), Abort::TooLong),
        (Sdo::expedited(object::CONTROLWORD, 0, 1), Abort::TooShort),
        (Sdo::Next { toggle: false }, Abort::Command),
    ];
    for (sdo, reason) in cases {
        let answer = bench.request(client::request(NODE, &sdo));
        assert!(matches!(answer, Answer::Sdo(Sdo::Abort { code, .. }) if code == reason as u32), "{sdo:?} {answer:?}");
    }
    let block = Frame::classic(standard(0x605), &[0xA4, 8, 0x10, 0, 0, 0, 0, 0]);
    let answer = bench.request(block);
    assert!(matches!(answer, Answer::Sdo(Sdo::Abort { code: 0x0504_0001, .. })), "{answer:?}");
}

#[test]
fn text_is_uploaded_in_segments() {
    let mut bench = Bench::new(false);
    let address = object::DEVICE_NAME;
    let begin = bench.request(client::upload(NODE, address));
    assert_eq!(begin, Answer::Sdo(Sdo::Long { address, size: Some(18) }));
    let (mut text, mut toggle) = (Vec::new(), false);
    loop {
        let answer = bench.request(client::request(NODE, &Sdo::Next { toggle }));
        let Answer::Sdo(Sdo::Segment { toggle: same, data, is_last }) = answer else { panic!("{answer:?}") };
        assert_eq!(same, toggle);
        text.extend_from_slice(&data);
        toggle = !toggle;
        if is_last {
            break;
        }
    }
    assert_eq!(text, b"Geared joint drive");
    bench.request(client::upload(NODE, address));
    let answer = bench.request(client::request(NODE, &Sdo::Next { toggle: true }));
    assert_eq!(answer, Answer::Sdo(Sdo::Abort { address, code: Abort::Toggle as u32 }));
}

#[test]
fn number_is_downloaded_in_segments() {
    let mut bench = Bench::new(false);
    let address = object::PROFILE_VELOCITY;
    let begin = bench.request(client::request(NODE, &Sdo::Long { address, size: Some(4) }));
    assert_eq!(begin, Answer::Sdo(Sdo::Empty { address }));
    for (toggle, byte, is_last) in [(false, &[1, 2][..], false), (true, &[3, 0][..], true)] {
        let data = heapless::Vec::from_slice(byte).unwrap();
        let answer = bench.request(client::request(NODE, &Sdo::Segment { toggle, data, is_last }));
        assert_eq!(answer, Answer::Sdo(Sdo::Next { toggle }));
    }
    assert_eq!(bench.read(address), 0x03_0201);
    let answer = bench.request(client::request(NODE, &Sdo::Long { address, size: Some(5) }));
    assert_eq!(answer, Answer::Sdo(Sdo::Abort { address, code: Abort::TooLong as u32 }));
}

#[test]
fn state_machine_enables_and_disables() {
    let mut bench = Bench::new(true);
    bench.write(object::MODE, 8);
    let steps =
        [(15, 0x0270), (6, 0x0231), (7, 0x0233), (15, 0x1237), (7, 0x0233), (15, 0x1237), (6, 0x0231), (0, 0x0270)];
    for (word, expected) in steps {
        bench.command(&[word]);
        assert_eq!(bench.status(), expected, "{word:#x}");
    }
    assert!(bench.drive.set_point().is_none());
}

#[test]
fn enabled_drive_holds_its_angle_without_a_target() {
    for mode in [Mode::CyclicPosition, Mode::ProfilePosition, Mode::CyclicVelocity, Mode::CyclicTorque, Mode::None] {
        let mut bench = Bench::enabled(mode);
        bench.run(300);
        assert!((bench.turns - 0.3).abs() < 1e-3, "{mode:?}: {}", bench.turns);
        assert_eq!(bench.server.state(), State::OperationEnabled);
    }
}

#[test]
fn cyclic_position_moves_on_a_line() {
    let mut bench = Bench::enabled(Mode::CyclicPosition);
    bench.write(object::INTERPOLATION_TIME, 100);
    let mapping = client::mapping(Direction::Receive, 2);
    bench.frame(client::receive_pdo(NODE, 2, &mapping, &[144_000, 0]));
    bench.run(50);
    assert!((bench.drive.feedback().target.to_f32() - 0.35).abs() < 2e-3, "{:?}", bench.drive.feedback().target);
    bench.run(52);
    assert_eq!(bench.read(object::POSITION_DEMAND), 144_000);
    bench.run(2000);
    assert!((bench.turns - 0.4).abs() < 1e-3, "{}", bench.turns);
}

#[test]
fn target_written_before_the_operation_counts() {
    let mut bench = Bench::new(true);
    bench.write(object::MODE, 8);
    bench.write(object::TARGET_POSITION, 126_000);
    bench.command(&[6, 7, 15]);
    bench.run(3000);
    assert!((bench.turns - 0.35).abs() < 1e-3, "{}", bench.turns);
    bench.command(&[0]);
    bench.speed = 0.0;
    bench.turns = 0.3;
    bench.run(50);
    bench.command(&[6, 7, 15]);
    bench.run(500);
    assert!((bench.turns - 0.3).abs() < 1e-3, "an old target moved the joint: {}", bench.turns);
}

#[test]
fn line_begins_at_the_angle_of_the_enabling() {
    let mut bench = Bench::enabled(Mode::CyclicPosition);
    bench.write(object::INTERPOLATION_TIME, 100);
    bench.write(object::FOLLOWING_WINDOW, 1000);
    bench.command(&[0]);
    for _ in 0..100 {
        bench.turns += 0.002;
        bench.run(1);
    }
    bench.run(50);
    bench.command(&[6, 7, 15]);
    bench.run(10);
    assert_eq!(bench.server.state(), State::OperationEnabled);
    assert!((bench.drive.feedback().target.to_f32() - 0.5).abs() < 1e-3, "{:?}", bench.drive.feedback().target);
}

#[test]
fn offsets_add_to_the_targets() {
    let mut bench = Bench::enabled(Mode::CyclicPosition);
    bench.write(object::POSITION_OFFSET, 3600);
    bench.run(2000);
    assert!((bench.turns - 0.31).abs() < 1e-3, "{}", bench.turns);
    bench.write(object::MODE, 10);
    bench.write(object::TARGET_TORQUE, 100);
    bench.write(object::TORQUE_OFFSET, -40_i32 as u32);
    bench.run(1);
    // 60 thousandths of 2.5 N m times 6.
    assert!((bench.drive.feedback().demand - 0.9).abs() < 1e-4, "{}", bench.drive.feedback().demand);
    assert_eq!(bench.read(object::TORQUE_DEMAND), 60);
}

#[test]
fn velocity_modes_reach_the_target() {
    for mode in [Mode::CyclicVelocity, Mode::ProfileVelocity] {
        let mut bench = Bench::enabled(mode);
        bench.write(object::TARGET_VELOCITY, 72_000);
        bench.write(object::VELOCITY_OFFSET, 18_000);
        bench.run(3000);
        assert!((bench.read(object::VELOCITY_ACTUAL) - 90_000).abs() < 1000, "{mode:?}");
        assert!((bench.read(object::OUTPUT_VELOCITY) - 90_000).abs() < 2000);
    }
}

#[test]
fn profile_position_acknowledges_and_reaches() {
    let mut bench = Bench::enabled(Mode::ProfilePosition);
    bench.write(object::TARGET_POSITION, 36_000);
    bench.run(100);
    assert!((bench.turns - 0.3).abs() < 1e-3, "moved without a new set-point");
    bench.command(&[0x0F | control::NEW_SET_POINT | control::RELATIVE]);
    bench.run(10);
    assert_eq!(bench.status() & (status::MODE_BIT_12 | status::TARGET_REACHED), status::MODE_BIT_12);
    bench.command(&[0x0F]);
    assert_eq!(bench.status() & status::MODE_BIT_12, 0);
    bench.run(100);
    bench.command(&[0x0F | control::HALT]);
    bench.run(1500);
    assert!(bench.turns < 0.38 && bench.speed.abs() < 0.02, "{} {}", bench.turns, bench.speed);
    bench.command(&[0x0F]);
    bench.run(4000);
    assert!((bench.turns - 0.4).abs() < 1e-3, "{}", bench.turns);
    assert_ne!(bench.status() & status::TARGET_REACHED, 0);
}

#[test]
fn control_word_and_target_in_one_sync_belong_together() {
    let mut bench = Bench::enabled(Mode::ProfilePosition);
    for number in 0..2 {
        bench.write(parameter_of(Direction::Receive, number, 2), 1);
    }
    let first = client::mapping(Direction::Receive, 1);
    bench.frame(client::receive_pdo(NODE, 1, &first, &[0x1F, 1]));
    bench.frame(client::receive_pdo(NODE, 2, &client::mapping(Direction::Receive, 2), &[144_000, 0]));
    bench.run(10);
    assert_eq!(bench.status() & status::MODE_BIT_12, 0, "RPDO acted before the SYNC");
    bench.frame(client::sync());
    bench.run(4000);
    assert!((bench.turns - 0.4).abs() < 1e-3, "{}", bench.turns);
}

#[test]
fn quick_stop_follows_its_option() {
    let cases = [(0, 1, State::SwitchOnDisabled), (2, 400, State::SwitchOnDisabled), (6, 400, State::QuickStopActive)];
    for (option, periods, end) in cases {
        let mut bench = Bench::enabled(Mode::CyclicVelocity);
        bench.write(object::QUICK_STOP_OPTION, option);
        bench.write(object::TARGET_VELOCITY, 360_000);
        bench.run(2000);
        bench.command(&[2]);
        if option > 0 {
            assert_eq!(bench.status() & 0x6F, 0x07);
            bench.run(50);
            assert_eq!(bench.server.state(), State::QuickStopActive);
        }
        bench.run(periods);
        assert_eq!(bench.server.state(), end, "{option}");
        assert_eq!(bench.drive.set_point().is_some(), end.is_powered());
        if option == 6 {
            bench.command(&[15]);
            bench.run(500);
            assert!(bench.speed.abs() < 0.1, "old target after a quick stop: {}", bench.speed);
        }
    }
}

#[test]
fn each_fault_has_its_code() {
    let cases = [
        (Fault::Watchdog, 0x8130, 0x11),
        (Fault::MotorEncoder, 0x7305, 0x21),
        (Fault::OutputEncoder, 0x7306, 0x21),
        (Fault::UnderVoltage, 0x3220, 0x05),
        (Fault::OverVoltage, 0x3210, 0x05),
        (Fault::OverTemperature, 0x4310, 0x09),
        (Fault::Overspeed, 0x8400, 0x21),
        (Fault::OutsideTravel, 0x8612, 0x21),
        (Fault::NotCalibrated, 0x7122, 0x21),
        (Fault::EmergencyStop, 0x9000, 0x01),
        (Fault::InvalidCommand, 0x6320, 0x01),
    ];
    for (fault, code, register) in cases {
        let mut bench = Bench::enabled(Mode::CyclicPosition);
        bench.drive.declare(fault);
        bench.sent.clear();
        bench.run(2);
        assert_eq!(bench.emergencies(), [(code, register)], "{fault:?}");
        assert_eq!(bench.status() & 0x4F, 0x08);
        assert_eq!(bench.read(object::ERROR_CODE), code.into());
        assert_eq!(bench.read(object::ERROR_REGISTER), register.into());
        assert_eq!((bench.read(object::ERROR_COUNT), bench.read(object::ERROR_1)), (1, code.into()));
        bench.command(&[15]);
        assert_eq!(bench.server.state(), State::Fault);
        bench.sent.clear();
        bench.frame(client::download(NODE, object::CONTROLWORD, control::FAULT_RESET.into()));
        assert_eq!(bench.emergencies(), [(0, 0)]);
        assert_eq!((bench.server.state(), bench.drive.fault()), (State::SwitchOnDisabled, None));
        bench.write(object::ERROR_COUNT, 0);
        assert_eq!(bench.read(object::ERROR_COUNT), 0);
    }
}

#[test]
fn lasting_fault_returns_after_a_reset() {
    let mut bench = Bench::enabled(Mode::CyclicPosition);
    bench.sensors.bus_voltage = 60.0;
    bench.run(2);
    bench.command(&[0, control::FAULT_RESET]);
    bench.run(2);
    assert_eq!(bench.server.state(), State::Fault);
    // The bit has to rise anew.
    bench.sensors.bus_voltage = 48.0;
    bench.command(&[control::FAULT_RESET]);
    assert_eq!(bench.server.state(), State::Fault);
    bench.command(&[0, control::FAULT_RESET]);
    bench.run(2);
    assert_eq!((bench.server.state(), bench.server.error_code()), (State::SwitchOnDisabled, 0));
}

#[test]
fn following_error_is_a_fault() {
    let mut bench = Bench::enabled(Mode::CyclicPosition);
    bench.write(object::FOLLOWING_WINDOW, 1000);
    bench.write(object::FOLLOWING_TIMEOUT, 5);
    bench.run(20);
    bench.write(object::TARGET_POSITION, 200_000);
    bench.run(3);
    assert_ne!(bench.status() & status::FOLLOWING_ERROR, 0);
    assert_eq!(bench.server.state(), State::OperationEnabled);
    bench.run(10);
    assert_eq!((bench.server.state(), bench.server.error_code()), (State::Fault, 0x8611));
}

/// Bench under a heartbeat of 20 ms that has begun.
fn monitored(option: u32) -> Bench {
    let mut bench = Bench::enabled(Mode::CyclicPosition);
    bench.write(object::ABORT_CONNECTION_OPTION, option);
    bench.write(object::CONSUMER_HEARTBEAT, client::consumer_heartbeat(MASTER, 20));
    bench.run(100);
    assert_eq!(bench.server.state(), State::OperationEnabled, "expired before the first heartbeat");
    for _ in 0..5 {
        bench.frame(client::heartbeat(MASTER, Nmt::Operational));
        bench.run(15);
    }
    assert_eq!(bench.server.state(), State::OperationEnabled);
    bench.sent.clear();
    bench.run(3);
    bench
}

#[test]
fn lost_heartbeat_acts_by_the_option() {
    let ends = [State::OperationEnabled, State::Fault, State::SwitchOnDisabled, State::SwitchOnDisabled];
    for (option, end) in (0..).zip(ends) {
        let mut bench = monitored(option);
        bench.run(10);
        assert_eq!(bench.server.state(), end, "{option}");
        assert_eq!(bench.server.nmt(), Nmt::PreOperational);
        assert_eq!(bench.emergencies(), [(0x8130, 0x11)], "{option}");
        bench.frame(client::heartbeat(MASTER, Nmt::Operational));
        let expected: &[(u16, u8)] = if end == State::Fault { &[] } else { &[(0, 0)] };
        assert_eq!(bench.emergencies(), expected, "{option}");
    }
}

#[test]
fn bus_off_acts_by_the_option() {
    let ends = [State::OperationEnabled, State::Fault, State::SwitchOnDisabled, State::SwitchOnDisabled];
    for (option, end) in (0..).zip(ends) {
        let mut bench = Bench::enabled(Mode::CyclicPosition);
        bench.write(object::ABORT_CONNECTION_OPTION, option);
        bench.sent.clear();
        let Bench { server, drive, sent, .. } = &mut bench;
        server.bus_off(true, drive, &mut |frame| sent.push(frame));
        bench.run(10);
        assert_eq!((bench.server.state(), bench.server.nmt()), (end, Nmt::PreOperational), "{option}");
        assert_eq!(bench.emergencies(), [(0x8140, 0x11)], "{option}");
        let Bench { server, drive, sent, .. } = &mut bench;
        server.bus_off(false, drive, &mut |frame| sent.push(frame));
        let expected: &[(u16, u8)] = if end == State::Fault { &[] } else { &[(0, 0)] };
        assert_eq!(bench.emergencies(), expected, "{option}");
    }
}

#[test]
fn error_behaviour_decides_over_the_network_state() {
    for (behaviour, end) in [(0, Nmt::PreOperational), (1, Nmt::Operational), (2, Nmt::Stopped)] {
        let mut bench = monitored(1);
        bench.write(object::COMMUNICATION_ERROR_BEHAVIOUR, behaviour);
        bench.run(30);
        assert_eq!((bench.server.nmt(), bench.server.state()), (end, State::Fault));
    }
}

#[test]
fn lost_guarding_is_a_fault() {
    let mut bench = Bench::enabled(Mode::CyclicPosition);
    bench.write(object::GUARD_TIME, 10);
    bench.write(object::LIFE_TIME_FACTOR, 3);
    bench.run(100);
    for _ in 0..5 {
        bench.frame(client::guard(NODE));
        bench.run(25);
    }
    assert_eq!(bench.server.state(), State::OperationEnabled);
    bench.run(10);
    assert_eq!((bench.server.state(), bench.server.error_code()), (State::Fault, 0x8130));
}

#[test]
fn missing_rpdo_is_a_fault() {
    let mut bench = Bench::enabled(Mode::CyclicVelocity);
    bench.write(parameter_of(Direction::Receive, 2, 5), 20);
    let mapping = client::mapping(Direction::Receive, 3);
    for _ in 0..5 {
        bench.frame(client::receive_pdo(NODE, 3, &mapping, &[1000, 0]));
        bench.run(15);
    }
    assert_eq!(bench.server.state(), State::OperationEnabled);
    bench.run(10);
    assert_eq!((bench.server.state(), bench.server.error_code()), (State::Fault, 0x8250));
}

#[test]
fn errors_of_a_disabled_drive_end_with_their_cause() {
    let mut bench = Bench::new(true);
    bench.write(parameter_of(Direction::Receive, 2, 5), 20);
    let mapping = client::mapping(Direction::Receive, 3);
    let command = || client::receive_pdo(NODE, 3, &mapping, &[0, 0]);
    bench.frame(command());
    bench.run(30);
    assert_eq!((bench.server.state(), bench.server.error_code()), (State::SwitchOnDisabled, 0x8250));
    bench.frame(command());
    assert_eq!(bench.server.error_code(), 0);
    let lost = client::consumer_heartbeat(MASTER, 20);
    for end in
        [client::manage(NmtCommand::ResetCommunication, NODE), client::download(NODE, object::CONSUMER_HEARTBEAT, 0)]
    {
        bench.write(object::CONSUMER_HEARTBEAT, lost);
        bench.frame(client::heartbeat(MASTER, Nmt::Operational));
        bench.run(30);
        assert_eq!((bench.server.state(), bench.server.error_code()), (State::SwitchOnDisabled, 0x8130));
        bench.frame(end);
        bench.run(BOOT_PERIODS);
        assert_eq!(bench.server.error_code(), 0);
    }
}

#[test]
fn stop_and_reset_take_the_torque_off() {
    for command in [NmtCommand::Stop, NmtCommand::ResetNode, NmtCommand::ResetCommunication] {
        let mut bench = Bench::enabled(Mode::CyclicPosition);
        bench.frame(client::manage(command, NODE));
        bench.run(2);
        assert!(bench.drive.set_point().is_none(), "{command:?}");
        assert_eq!(bench.server.state() == State::Fault, command != NmtCommand::ResetNode, "{command:?}");
    }
}

#[test]
fn short_rpdo_is_reported_and_ignored() {
    let mut bench = Bench::enabled(Mode::CyclicPosition);
    bench.sent.clear();
    bench.frame(Frame::classic(standard(0x205), &[0, 0]));
    assert_eq!(bench.emergencies(), [(0x8210, 0)]);
    assert_eq!(bench.server.state(), State::OperationEnabled);
}

#[test]
fn status_is_sent_at_changes_and_by_the_timer() {
    let mut bench = Bench::new(true);
    bench.run(300);
    let count = bench.pdos(1).len();
    assert!((3..=4).contains(&count), "{count}");
    bench.frame(client::download(NODE, object::CONTROLWORD, 6));
    bench.run(2);
    let data = bench.pdos(1);
    assert_eq!(data.len(), 1);
    assert_eq!(client::value(object::STATUSWORD, &client::mapping(Direction::Transmit, 1), &data[0]), Some(0x0231));
    bench.write(parameter_of(Direction::Transmit, 0, 3), 500);
    bench.frame(client::download(NODE, object::CONTROLWORD, 7));
    bench.run(10);
    assert_eq!(bench.pdos(1).len(), 0, "inhibit time");
    bench.run(50);
    assert_eq!(bench.pdos(1).len(), 1);
}

#[test]
fn synchronous_pdo_waits_for_its_sync() {
    let mut bench = Bench::new(true);
    bench.write(parameter_of(Direction::Transmit, 1, 2), 3);
    bench.refuse(parameter_of(Direction::Transmit, 1, 2), 241, Abort::Range);
    bench.sent.clear();
    for _ in 0..9 {
        bench.frame(client::sync());
    }
    assert_eq!(bench.pdos(2).len(), 3);
    bench.write(parameter_of(Direction::Transmit, 2, 2), 0);
    bench.sensors.motor_torque = 1.0;
    bench.run(1);
    bench.frame(client::sync());
    bench.frame(client::sync());
    assert_eq!(bench.pdos(3).len(), 1);
    bench.frame(Frame::remote(standard(0x385), 6));
    assert_eq!(bench.pdos(3).len(), 1);
}

#[test]
fn mapping_changes_by_sdo() {
    let mut bench = Bench::new(true);
    let (id, count) = (parameter_of(Direction::Transmit, 2, 1), mapping_of(Direction::Transmit, 2, 0));
    let first = mapping_of(Direction::Transmit, 2, 1);
    bench.refuse(count, 0, Abort::Unsupported);
    bench.refuse(id, 0x222, Abort::Range);
    bench.write(id, 0x8000_0385);
    bench.refuse(first, 0x60E5_0120, Abort::Unsupported);
    bench.write(count, 0);
    bench.write(first, 0x60E5_0120);
    bench.refuse(first, 0x60E5_0110, Abort::NotMappable);
    bench.refuse(first, 0x1018_0120, Abort::NotMappable);
    bench.refuse(first, 0x5000_0020, Abort::NoObject);
    bench.write(mapping_of(Direction::Transmit, 2, 2), 0x606C_0020);
    bench.write(mapping_of(Direction::Transmit, 2, 3), 0x6077_0010);
    bench.refuse(count, 3, Abort::MappingTooLong);
    bench.write(count, 2);
    bench.frame(client::sync());
    assert_eq!(bench.pdos(3).len(), 0, "PDO is off");
    bench.write(id, 0x385);
    bench.frame(client::sync());
    assert_eq!(bench.pdos(3).pop().unwrap().len(), 8);
    // An RPDO takes objects that a client writes.
    bench.write(parameter_of(Direction::Receive, 3, 1), 0x8000_0505);
    bench.write(mapping_of(Direction::Receive, 3, 0), 0);
    bench.refuse(mapping_of(Direction::Receive, 3, 1), 0x6041_0010, Abort::NotMappable);
    bench.frame(client::manage(NmtCommand::ResetCommunication, NODE));
    bench.run(BOOT_PERIODS);
    assert_eq!(bench.read(first), 0x606C_0020);
}

#[test]
fn configuration_acts_on_the_settings() {
    let mut bench = Bench::new(false);
    assert_eq!(bench.drive.settings().law, Law::Cascade);
    bench.write(object::VELOCITY_GAIN, 2.5_f32.to_bits());
    bench.write(object::LAW, 0);
    bench.write(object::MAX_TORQUE, 400);
    bench.write(object::MAX_MOTOR_SPEED, 600);
    bench.write(object::MIN_POSITION, -90_000_i32 as u32);
    bench.write(object::MAX_VOLTAGE, 52_000);
    let settings = *bench.drive.settings();
    assert_eq!((settings.gains.velocity, settings.law), (2.5, Law::Parallel));
    assert!((settings.torque_limit - 1.0).abs() < 1e-6 && (settings.max_velocity - 10.471_976).abs() < 1e-4);
    assert_eq!((settings.travel, settings.max_voltage), ((Some(Turns::new(-0.25)), None), 52.0));
    assert_eq!(bench.read(object::VELOCITY_GAIN), 2.5_f32.to_bits().into());
    assert_eq!((bench.read(object::MAX_TORQUE), bench.read(object::RATED_TORQUE)), (400, 2500));
    assert_eq!((bench.read(object::MAX_MOTOR_SPEED), bench.read(object::MIN_POSITION)), (600, -90_000));
    assert_eq!((bench.read(object::RATED_CURRENT), bench.read(object::DC_LINK_VOLTAGE)), (25_000, 48_000));
    assert_eq!((bench.read(object::MOTOR_TEMPERATURE), bench.read(object::MAX_POSITION)), (250, i32::MAX.into()));
}

#[test]
fn calibration_ends_in_switch_on_disabled() {
    let mut bench = Bench::new(false);
    bench.drive.settings_mut().is_calibrated = false;
    bench.drive.restart();
    bench.run(2);
    assert_eq!(bench.read(object::CALIBRATION), 0);
    bench.command(&[6, 7, 15]);
    bench.run(1);
    assert_eq!(bench.server.error_code(), 0x7122);
    bench.command(&[control::FAULT_RESET]);
    bench.write(object::CALIBRATION, 1);
    bench.run(10);
    assert_eq!(bench.status() & 0x4F, 0);
    bench.run(2000);
    assert_eq!((bench.read(object::CALIBRATION), bench.server.state()), (1, State::SwitchOnDisabled));
}

#[test]
fn foreign_frames_get_no_answer() {
    let mut bench = Bench::new(true);
    bench.run(2);
    bench.sent.clear();
    for frame in [
        Frame::classic(standard(0x606), &[0x40, 0, 0x10, 0, 0, 0, 0, 0]),
        Frame::classic(extended(0x605), &[0x40, 0, 0x10, 0, 0, 0, 0, 0]),
        Frame::classic(standard(0x605), &[0x40, 0, 0x10, 0]),
        Frame::classic(standard(0), &[1]),
        Frame::flexible(standard(0x605), &[0x40, 0, 0x10, 0, 0, 0, 0, 0], 0),
        Frame::classic(standard(0x705), &[5]),
    ] {
        bench.frame(frame);
    }
    assert_eq!(bench.sent, []);
}

proptest! {
    #[test]
    fn random_frames_do_no_harm(frames in proptest::collection::vec(
        (prop_oneof![Just(0_u16), Just(0x80), Just(0x605), Just(0x205), Just(0x305), Just(0x405), 0..0x800_u16],
         proptest::collection::vec(any::<u8>(), 0..9), 0..4_u8), 1..60)) {
        let mut bench = Bench::new(true);
        for (id, data, kind) in frames {
            let frame = if kind == 0 { Frame::remote(standard(id), 8) } else { Frame::classic(standard(id), &data) };
            if let Some(frame) = &frame {
                client::decode(NODE, frame);
            }
            bench.frame(frame);
            bench.run(1);
            prop_assert!(bench.turns.is_finite());
        }
    }

    #[test]
    fn random_writes_do_no_harm(writes in proptest::collection::vec(
        (0..object::COUNT, any::<u32>()), 1..40)) {
        let mut bench = Bench::enabled(Mode::CyclicPosition);
        for (position, raw) in writes {
            bench.frame(client::download(NODE, object::ENTRIES[position].address, raw));
            bench.run(2);
            prop_assert!(bench.turns.is_finite());
        }
    }
}
