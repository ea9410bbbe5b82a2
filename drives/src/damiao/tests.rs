use std::vec::Vec;

use super::*;
use crate::bus::CanServer;
use crate::drive::{Drive, Fault, Sensors, SetPoint, Settings, State};
use crate::frame::{Frame, Kind, extended, standard};
use crate::turns::Turns;
use proptest::prelude::*;

const RANGES: mit::Ranges = mit::Ranges::new(12.5, 10.0, 28.0);
const CLIENT: Client = Client { id: 1, feedback_id: 0x11, ranges: RANGES };

/// Drive on a bus, with its client.
struct Bus {
    drive: Drive,
    server: Server,
    sensors: Sensors,
}

impl Bus {
    fn new() -> Self {
        Self::with(Settings::default())
    }

    fn with(options: Settings) -> Self {
        let sensors = Sensors { motor_counts: Some(1000), output_counts: Some(2000), ..Sensors::default() };
        let mut bus = Self { drive: Drive::new(settings(options)), server: Server::new(1, 0x11, RANGES), sensors };
        bus.step(2);
        bus
    }

    /// Runs periods; returns the torque of the last one.
    fn step(&mut self, periods: u32) -> f32 {
        let mut torque = 0.0;
        for _ in 0..periods {
            torque = self.drive.step(&self.sensors, None);
            self.server.tick(&mut self.drive, &mut |frame| panic!("unasked: {frame:?}"));
        }
        torque
    }

    /// Sends a frame; returns the frames that the drive answers.
    fn send(&mut self, frame: &Frame) -> Vec<Frame> {
        let mut answers = Vec::new();
        self.server.receive(frame, &mut self.drive, &mut |frame| answers.push(frame));
        answers
    }

    /// Sends a frame of the client; returns the answer as the client reads it.
    fn ask(&mut self, frame: Option<Frame>) -> Option<Answer> {
        let answers = self.send(&frame.unwrap());
        assert!(answers.len() <= 1);
        answers.first().map(|answer| CLIENT.decode(answer).unwrap())
    }

    fn feedback(&mut self, frame: Option<Frame>) -> Feedback {
        match self.ask(frame) {
            Some(Answer::Feedback(feedback)) => feedback,
            other => panic!("{other:?}"),
        }
    }

    fn order(&mut self, order: Order) -> Status {
        self.feedback(CLIENT.order(order)).status
    }

    fn status(&mut self) -> Status {
        self.feedback(CLIENT.refresh()).status
    }

    fn read(&mut self, register: Register) -> Option<Value> {
        self.ask(CLIENT.read(register)).map(|answer| match answer {
            Answer::Read(answered, value) if answered == register => value,
            other => panic!("{other:?}"),
        })
    }

    fn read_float(&mut self, register: Register) -> f32 {
        match self.read(register) {
            Some(Value::F32(value)) => value,
            other => panic!("{other:?}"),
        }
    }

    /// Writes a register; returns true if the drive confirms it.
    fn write(&mut self, register: Register, value: Value) -> bool {
        let answer = self.ask(CLIENT.write(register, value));
        assert!(answer.is_none_or(|answer| answer == Answer::Written(register, value)));
        answer.is_some()
    }

    fn change_mode(&mut self, mode: Mode) {
        assert!(self.write(Register::ControlMode, Value::U32(mode.code())));
    }
}

fn impedance(position: f32, velocity: f32, torque: f32, stiffness: f32, damping: f32) -> Motion {
    Motion::Impedance(mit::Command { position, velocity, stiffness, damping, torque })
}

/// Frames of damiao-motor 1.0.6, `DaMiaoMotor` with motor type 4340 and identifier 1.
#[test]
fn commands_equal_those_of_the_client_package() {
    let position = 0.62832;
    let motions = [
        (impedance(0.0, 0.0, 0.0, 0.0, 0.0), 1, [0x7F, 0xFF, 0x7F, 0xF0, 0x00, 0x00, 0x07, 0xFF]),
        (impedance(1.0, -2.0, 3.0, 100.0, 1.5), 1, [0x8A, 0x3C, 0x66, 0x63, 0x33, 0x4C, 0xC8, 0xDA]),
        (impedance(-12.5, 10.0, -28.0, 500.0, 5.0), 1, [0x00, 0x00, 0xFF, 0xFF, 0xFF, 0xFF, 0xF0, 0x00]),
        (impedance(13.0, -11.0, 99.0, -1.0, 6.0), 1, [0xFF, 0xFF, 0x00, 0x00, 0x00, 0xFF, 0xFF, 0xFF]),
        (impedance(position, 0.5, -0.7, 20.0, 0.8), 1, [0x86, 0x6E, 0x86, 0x50, 0xA3, 0x28, 0xF7, 0xCC]),
        (
            Motion::PositionVelocity { position, max_velocity: 2.0 },
            0x101,
            [0x94, 0xD9, 0x20, 0x3F, 0x00, 0x00, 0x00, 0x40],
        ),
        (Motion::Velocity(-1.5), 0x201, [0x00, 0x00, 0xC0, 0xBF, 0x00, 0x00, 0x00, 0x00]),
        (
            Motion::ForcePosition { position, max_velocity: 3.0, torque_share: 0.25 },
            0x301,
            [0x94, 0xD9, 0x20, 0x3F, 0x2C, 0x01, 0xC4, 0x09],
        ),
        (
            Motion::ForcePosition { position: 1.0, max_velocity: 200.0, torque_share: 2.0 },
            0x301,
            [0x00, 0x00, 0x80, 0x3F, 0x10, 0x27, 0x10, 0x27],
        ),
    ];
    for (motion, id, data) in motions {
        let frame = CLIENT.motion(&motion).unwrap();
        assert_eq!((frame.raw_id(), frame.data()), (id, &data[..]), "{motion:?}");
    }
    let parameters = [
        (CLIENT.read(Register::OutputPosition), [0x01, 0x00, 0x33, 0x51, 0x00, 0x00, 0x00, 0x00]),
        (CLIENT.write(Register::Timeout, Value::U32(2000)), [0x01, 0x00, 0x55, 0x09, 0xD0, 0x07, 0x00, 0x00]),
        (CLIENT.write(Register::VelocityGain, Value::F32(0.01)), [0x01, 0x00, 0x55, 0x19, 0x0A, 0xD7, 0x23, 0x3C]),
        (CLIENT.store(), [0x01, 0x00, 0xAA, 0x01, 0x00, 0x00, 0x00, 0x00]),
        (CLIENT.refresh(), [0x01, 0x00, 0xCC, 0x00, 0x00, 0x00, 0x00, 0x00]),
    ];
    for (frame, data) in parameters {
        let frame = frame.unwrap();
        assert_eq!((frame.raw_id(), frame.data()), (0x7FF, &data[..]));
    }
    for (order, code) in Order::ALL.into_iter().zip([0xFC, 0xFD, 0xFE, 0xFB]) {
        let frame = CLIENT.order(order).unwrap();
        assert_eq!((frame.raw_id(), frame.data()), (1, &[0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, code][..]));
    }
}

/// Frames and values of damiao-motor 1.0.6, `decode_sensor_feedback` with motor type 4340.
#[test]
fn feedback_equals_that_of_the_client_package() {
    let cases = [
        (
            [0x11, 0x85, 0xC0, 0x8C, 0xC7, 0x9A, 0x1E, 0x28],
            (Status::Enabled, 0.561_722_74, 0.998_779, -1.388_034_2, 30, 40),
        ),
        (
            [0xD1, 0x7F, 0xFF, 0x7F, 0xF7, 0xFF, 0x32, 0x50],
            (Status::CommunicationLost, -0.000_190_737_77, -0.002_442_002_4, -0.006_837_607, 50, 80),
        ),
    ];
    for (data, (status, position, velocity, torque, board, motor)) in cases {
        let feedback = Feedback::decode(data, &RANGES);
        assert_eq!((feedback.id, feedback.status), (1, status));
        assert_eq!((feedback.board_temperature, feedback.motor_temperature), (board, motor));
        let state = feedback.state;
        for (found, expected) in [(state.position, position), (state.velocity, velocity), (state.torque, torque)] {
            assert!((found - expected).abs() < 2e-6, "{found} {expected}");
        }
        assert_eq!(feedback.encode(&RANGES), data);
    }
}

/// Addresses, names, access and types of damiao-motor 1.0.6, `REGISTER_TABLE`.
#[test]
fn registers_equal_those_of_the_client_package() {
    let table = "0:UV_Value:RW:f 1:KT_Value:RW:f 2:OT_Value:RW:f 3:OC_Value:RW:f 4:ACC:RW:f 5:DEC:RW:f 6:MAX_SPD:RW:f \
        7:MST_ID:RW:u 8:ESC_ID:RW:u 9:TIMEOUT:RW:u 10:CTRL_MODE:RW:u 11:Damp:RO:f 12:Inertia:RO:f 13:hw_ver:RO:u \
        14:sw_ver:RO:u 15:SN:RO:u 16:NPP:RO:u 17:Rs:RO:f 18:Ls:RO:f 19:Flux:RO:f 20:Gr:RO:f 21:PMAX:RW:f 22:VMAX:RW:f \
        23:TMAX:RW:f 24:I_BW:RW:f 25:KP_ASR:RW:f 26:KI_ASR:RW:f 27:KP_APR:RW:f 28:KI_APR:RW:f 29:OV_Value:RW:f \
        30:GREF:RW:f 31:Deta:RW:f 32:V_BW:RW:f 33:IQ_c1:RW:f 34:VL_c1:RW:f 35:can_br:RW:u 36:sub_ver:RO:u \
        50:u_off:RO:f 51:v_off:RO:f 52:k1:RO:f 53:k2:RO:f 54:m_off:RO:f 55:dir:RO:f 56:m_off:RO:f 59:Imax:RO:f \
        60:VBus:RO:f 61:Tpcb:RO:f 62:Tmtr:RO:f 63:Iu_off:RO:f 64:Iv_off:RO:f 65:Iw_off:RO:f 80:p_m:RO:f 81:xout:RO:f";
    let ours: Vec<_> = Register::ALL
        .iter()
        .map(|register| {
            let access = if register.is_writable() { "RW" } else { "RO" };
            let form = if matches!(register.form(), Form::Float(_)) { "f" } else { "u" };
            std::format!("{}:{}:{access}:{form}", register.address(), register.name())
        })
        .collect();
    assert_eq!(ours, table.split_whitespace().collect::<Vec<_>>());
}

#[test]
fn drive_is_enabled_and_disabled_by_order() {
    let mut bus = Bus::new();
    assert_eq!(bus.status(), Status::Disabled);
    let push = CLIENT.motion(&impedance(0.0, 0.0, 6.0, 0.0, 0.0));
    assert_eq!(bus.feedback(push.clone()).status, Status::Disabled);
    assert_eq!(bus.order(Order::Enable), Status::Enabled);
    // The command before the order is forgotten.
    assert!(bus.step(1).abs() < 1e-2);
    assert_eq!(bus.feedback(push).status, Status::Enabled);
    assert!((bus.step(1) - 1.0).abs() < 1e-2);
    // A second order leaves the command.
    assert_eq!(bus.order(Order::Enable), Status::Enabled);
    assert!((bus.step(1) - 1.0).abs() < 1e-2);
    assert_eq!(bus.order(Order::Disable), Status::Disabled);
    assert_eq!(bus.step(1), 0.0);
}

#[test]
fn disabled_drive_brakes() {
    let mut bus = Bus::new();
    for count in 0..500 {
        bus.sensors.motor_counts = Some(1000 + 10 * count);
        bus.step(1);
    }
    assert!(bus.step(1) < 0.0);
}

#[test]
fn impedance_command_becomes_an_impedance() {
    let mut bus = Bus::new();
    bus.order(Order::Enable);
    bus.feedback(CLIENT.motion(&impedance(1.0, 0.5, 2.0, 20.0, 1.0)));
    match bus.drive.set_point() {
        Some(SetPoint::Impedance { position, velocity, stiffness, damping, torque }) => {
            let pairs =
                [(position.to_rad(), 1.0), (*velocity, 0.5), (*stiffness, 20.0), (*damping, 1.0), (*torque, 2.0)];
            // Steps of the fields: 0.0004 rad, 0.005 rad/s, 0.12 N m/rad, 0.0012 N m s/rad, 0.014 N m.
            for ((found, expected), step) in pairs.into_iter().zip([0.0004, 0.005, 0.123, 0.0013, 0.014]) {
                assert!(found <= expected + 1e-5 && expected - found < step, "{found} {expected}");
            }
        }
        other => panic!("{other:?}"),
    }
}

#[test]
fn other_modes_become_their_set_points() {
    let mut bus = Bus::new();
    assert!(bus.write(Register::Acceleration, Value::F32(20.0)));
    assert!(bus.write(Register::Deceleration, Value::F32(-8.0)));
    bus.order(Order::Enable);
    bus.change_mode(Mode::PositionVelocity);
    bus.feedback(CLIENT.motion(&Motion::PositionVelocity { position: -2.0, max_velocity: 3.0 }));
    let Some(SetPoint::Position(target)) = bus.drive.set_point().copied() else { panic!() };
    assert_eq!((target.position, target.limits.velocity), (Turns::from_rad(-2.0), 3.0));
    assert_eq!((target.limits.acceleration, target.max_torque), (8.0, f32::INFINITY));

    bus.change_mode(Mode::Velocity);
    bus.feedback(CLIENT.motion(&Motion::Velocity(-1.5)));
    assert!(matches!(
        bus.drive.set_point(),
        Some(SetPoint::Velocity { velocity: -1.5, max_acceleration: 8.0, torque: 0.0, .. })
    ));

    bus.change_mode(Mode::ForcePosition);
    bus.feedback(CLIENT.motion(&Motion::ForcePosition { position: 1.0, max_velocity: 2.0, torque_share: 0.5 }));
    let Some(SetPoint::Position(target)) = bus.drive.set_point().copied() else { panic!() };
    // Half of 2.5 N m at the motor, times the ratio of 6.
    assert!((target.max_torque - 7.5).abs() < 1e-5 && (target.limits.velocity - 2.0).abs() < 1e-5);
}

#[test]
fn velocity_frame_may_have_four_bytes() {
    let mut bus = Bus::new();
    bus.change_mode(Mode::Velocity);
    bus.order(Order::Enable);
    let short = Frame::classic(standard(0x201), &2.0_f32.to_le_bytes()).unwrap();
    assert_eq!(bus.send(&short).len(), 1);
    assert!(matches!(bus.drive.set_point(), Some(SetPoint::Velocity { velocity: 2.0, .. })));
}

#[test]
fn mode_change_sets_commands_to_zero() {
    let mut bus = Bus::new();
    bus.order(Order::Enable);
    bus.feedback(CLIENT.motion(&impedance(0.0, 0.0, 10.0, 0.0, 0.0)));
    for mode in [Mode::ForcePosition, Mode::PositionVelocity, Mode::Velocity, Mode::Impedance] {
        bus.change_mode(mode);
        assert_eq!(bus.drive.state(), State::Enabled);
        assert_eq!(bus.read(Register::ControlMode), Some(Value::U32(mode.code())));
        assert!(bus.step(1).abs() < 1e-3, "{mode:?}");
    }
}

#[test]
fn command_of_another_mode_is_ignored() {
    let mut bus = Bus::new();
    bus.order(Order::Enable);
    let before = bus.drive.set_point().copied();
    assert_eq!(bus.ask(CLIENT.motion(&Motion::Velocity(1.0))), None);
    assert_eq!(bus.drive.set_point().copied(), before);
    bus.change_mode(Mode::Velocity);
    assert_eq!(bus.ask(CLIENT.motion(&impedance(0.0, 0.0, 1.0, 0.0, 0.0))), None);
    // Orders come under the drive's own identifier and that of the mode.
    assert_eq!(bus.order(Order::Disable), Status::Disabled);
    let enable = Frame::classic(standard(0x201), &Order::Enable.encode()).unwrap();
    assert_eq!(bus.send(&enable).len(), 1);
    assert_eq!(bus.drive.state(), State::Enabled);
    let other = Frame::classic(standard(0x101), &Order::Disable.encode()).unwrap();
    assert_eq!(bus.send(&other).len(), 0);
    assert_eq!(bus.drive.state(), State::Enabled);
}

#[test]
fn watchdog_reports_communication_lost() {
    let mut bus = Bus::new();
    assert_eq!(bus.read(Register::Timeout), Some(Value::U32(0)));
    // 200 units of 50 us are 100 periods of 0.1 ms.
    assert!(bus.write(Register::Timeout, Value::U32(200)));
    assert_eq!(bus.read(Register::Timeout), Some(Value::U32(200)));
    bus.step(150);
    assert_eq!(bus.status(), Status::Disabled);
    bus.order(Order::Enable);
    for _ in 0..5 {
        bus.step(90);
        assert_eq!(bus.status(), Status::Enabled);
    }
    for frame in [CLIENT.order(Order::Enable), CLIENT.motion(&impedance(0.0, 0.0, 0.0, 0.0, 0.0))] {
        bus.step(90);
        assert_eq!(bus.feedback(frame).status, Status::Enabled);
    }
    bus.step(110);
    assert_eq!(bus.status(), Status::CommunicationLost);
    assert_eq!(bus.drive.state(), State::Disabled);
    assert_eq!(bus.order(Order::Enable), Status::CommunicationLost);
    assert_eq!(bus.order(Order::ClearError), Status::Disabled);
    assert_eq!(bus.order(Order::Enable), Status::Enabled);
    assert!(bus.write(Register::Timeout, Value::U32(0)));
    bus.step(1000);
    assert_eq!(bus.status(), Status::Enabled);
}

#[test]
fn each_fault_has_its_status() {
    let readings = Bus::new().sensors;
    let cases = [
        (Sensors { bus_voltage: 60.0, ..readings }, Status::OverVoltage),
        (Sensors { bus_voltage: 9.0, ..readings }, Status::UnderVoltage),
        (Sensors { motor_torque: 2.0, ..readings }, Status::OverCurrent),
        (Sensors { board_temperature: 121.0, ..readings }, Status::BoardOverTemperature),
        (Sensors { motor_temperature: 121.0, ..readings }, Status::MotorOverTemperature),
        (Sensors { motor_counts: None, ..readings }, Status::MotorEncoder),
        (Sensors { output_counts: None, ..readings }, Status::OutputEncoder),
    ];
    for (sensors, status) in cases {
        let mut bus = Bus::with(Settings { max_silent_periods: 1, ..Settings::default() });
        assert!(bus.write(Register::OverCurrent, Value::F32(0.5)));
        bus.order(Order::Enable);
        bus.sensors = sensors;
        bus.step(2);
        assert_eq!(bus.status(), status);
        // Equal temperatures afterwards leave the cause.
        bus.sensors = readings;
        bus.step(2);
        assert_eq!(bus.status(), status);
        assert_eq!(bus.order(Order::ClearError), Status::Disabled);
    }
    for (fault, status) in [
        (Fault::NotCalibrated, Status::NotCalibrated),
        (Fault::Overspeed, Status::Overload),
        (Fault::OutsideTravel, Status::Overload),
        (Fault::EmergencyStop, Status::Overload),
    ] {
        let mut bus = Bus::new();
        bus.drive.declare(fault);
        assert_eq!(bus.status(), status);
    }
}

#[test]
fn status_codes_survive_a_round_trip() {
    for code in 0..16 {
        assert_eq!(Status::from_code(code).code(), code);
    }
}

#[test]
fn both_encoders_are_read() {
    let mut bus = Bus::new();
    let output = 2000.5 / 131_072.0 * core::f32::consts::TAU;
    assert!((bus.read_float(Register::OutputPosition) - output).abs() < 1e-5);
    assert!((bus.read_float(Register::MotorPosition) - output).abs() < 1e-5);
    // A rotor that turns a sixth of a turn alone: 2730.7 counts, 1/36 turn at the output.
    for count in 0..274 {
        bus.sensors.motor_counts = Some(1000 + 10 * count);
        bus.step(1);
    }
    assert!((bus.read_float(Register::OutputPosition) - output).abs() < 1e-5);
    let moved = bus.read_float(Register::MotorPosition) - output;
    assert!((moved - core::f32::consts::TAU / 36.0).abs() < 1e-3, "{moved}");
    let feedback = bus.feedback(CLIENT.refresh());
    assert!((feedback.state.position - output - moved).abs() < 5e-4);
}

#[test]
fn zero_is_set_for_both_encoders() {
    let mut bus = Bus::new();
    bus.order(Order::Enable);
    bus.feedback(CLIENT.motion(&impedance(2.0, 0.0, 0.0, 10.0, 1.0)));
    let feedback = bus.feedback(CLIENT.order(Order::SetZero));
    assert!(feedback.state.position.abs() < 4e-4);
    bus.step(1);
    assert!(bus.read_float(Register::OutputPosition).abs() < 1e-6);
    assert!(bus.read_float(Register::MotorPosition).abs() < 1e-6);
    // The commanded position is zero as well.
    assert!(matches!(bus.drive.set_point(), Some(SetPoint::Impedance { position: Turns::ZERO, .. })));
    bus.sensors.output_counts = Some(2000 + 1311);
    bus.step(1);
    assert!((bus.read_float(Register::OutputPosition) - 1311.0 / 131_072.0 * core::f32::consts::TAU).abs() < 1e-5);
}

#[test]
fn output_position_without_its_encoder_has_no_answer() {
    let mut bus = Bus::with(Settings { output_counts_per_turn: None, ..Settings::default() });
    assert_eq!(bus.read(Register::OutputPosition), None);
    assert!(bus.read(Register::MotorPosition).is_some());
}

#[test]
fn registers_act_on_the_drive() {
    let mut bus = Bus::new();
    let writes = [
        (Register::UnderVoltage, 18.0),
        (Register::OverVoltage, 30.0),
        (Register::OverTemperature, 90.0),
        (Register::OverCurrent, 0.5),
        (Register::MaxSpeed, 7.0),
        (Register::VelocityGain, 0.02),
        (Register::VelocityIntegral, 0.1),
        (Register::PositionGain, 12.0),
        (Register::DampingFactor, 3.0),
    ];
    for (register, value) in writes {
        assert!(bus.write(register, Value::F32(value)), "{register:?}");
        assert!((bus.read_float(register) - value).abs() < 1e-6 * value, "{register:?}");
    }
    let settings = bus.drive.settings();
    assert_eq!((settings.min_voltage, settings.max_voltage, settings.max_velocity), (18.0, 30.0, 7.0));
    assert_eq!((settings.max_temperature, settings.derating_temperature), (90.0, 90.0));
    // 2.5 N m at 0.1 N m/A are 25 A.
    assert!((settings.max_current - 12.5).abs() < 1e-5);
    // A share of 0.02 of 2.5 N m, times the ratio of 6 squared.
    assert!((settings.gains.velocity - 1.8).abs() < 1e-5 && settings.gains.position == 12.0);
    assert_eq!(bus.read(Register::PolePairs), Some(Value::U32(14)));
    assert_eq!(bus.read_float(Register::GearRatio), 6.0);
}

#[test]
fn value_out_of_range_is_not_written() {
    let mut bus = Bus::new();
    let refused = [
        (Register::UnderVoltage, Value::F32(10.0)),
        (Register::OverTemperature, Value::F32(200.0)),
        (Register::OverCurrent, Value::F32(1.0)),
        (Register::Acceleration, Value::F32(f32::NAN)),
        (Register::Deceleration, Value::F32(5.0)),
        (Register::MaxSpeed, Value::F32(f32::INFINITY)),
        (Register::Id, Value::U32(0x800)),
        (Register::ControlMode, Value::U32(5)),
        (Register::GearRatio, Value::F32(1.0)),
        (Register::MotorPosition, Value::F32(1.0)),
    ];
    for (register, value) in refused {
        let before = bus.read(register);
        assert!(!bus.write(register, value), "{register:?}");
        assert_eq!(bus.read(register), before, "{register:?}");
    }
}

#[test]
fn ranges_hold_for_frames() {
    let mut bus = Bus::new();
    assert!(bus.write(Register::PositionRange, Value::F32(25.0)));
    assert_eq!(bus.server.ranges().position, 25.0);
    bus.order(Order::Enable);
    bus.send(&CLIENT.motion(&impedance(1.0, 0.0, 0.0, 1.0, 0.0)).unwrap());
    let Some(SetPoint::Impedance { position, .. }) = bus.drive.set_point() else { panic!() };
    assert!((position.to_rad() - 2.0).abs() < 1e-3);
}

#[test]
fn identifiers_change_after_the_answer() {
    let mut bus = Bus::new();
    assert!(bus.write(Register::FeedbackId, Value::U32(0x12)));
    let client = Client { feedback_id: 0x12, ..CLIENT };
    let answers = bus.send(&client.write(Register::Id, Value::U32(2)).unwrap());
    assert_eq!(client.decode(&answers[0]), Some(Answer::Written(Register::Id, Value::U32(2))));
    assert_eq!((bus.server.id(), bus.server.feedback_id()), (2, 0x12));
    assert!(bus.send(&client.refresh().unwrap()).is_empty());
    assert_eq!(bus.send(&Client { id: 2, ..client }.refresh().unwrap()).len(), 1);
}

#[test]
fn store_needs_a_disabled_drive() {
    let mut bus = Bus::new();
    assert_eq!(bus.ask(CLIENT.store()), Some(Answer::Stored));
    bus.order(Order::Enable);
    assert_eq!(bus.ask(CLIENT.store()), None);
}

#[test]
fn requests_may_leave_out_the_value() {
    let mut bus = Bus::new();
    for data in [[1, 0, 0x33, 80], [1, 0, 0xCC, 0], [1, 0, 0xAA, 1]] {
        assert_eq!(bus.send(&Frame::classic(standard(0x7FF), &data).unwrap()).len(), 1, "{data:?}");
    }
    let write = [1, 0, 0x55, 9, 0, 0, 0];
    assert!(bus.send(&Frame::classic(standard(0x7FF), &write).unwrap()).is_empty());
}

#[test]
fn foreign_frames_have_no_answer() {
    let mut bus = Bus::new();
    let enable = Order::Enable.encode();
    let frames = [
        Frame::classic(standard(2), &enable),
        Frame::classic(extended(1), &enable),
        Frame::with_kind(standard(1), Kind::Flexible(true), &enable),
        Frame::remote(standard(1), 8),
        Frame::classic(standard(1), &enable[..7]),
        Frame::classic(standard(0x7FF), &[2, 0, 0xCC, 0, 0, 0, 0, 0]),
        Frame::classic(standard(0x7FF), &[1, 1, 0xCC, 0, 0, 0, 0, 0]),
        Frame::classic(standard(0x7FF), &[1, 0, 0x33, 40, 0, 0, 0, 0]),
        Frame::classic(standard(0x7FF), &[1, 0, 0x34, 1, 0, 0, 0, 0]),
    ];
    for frame in frames {
        assert!(bus.send(&frame.unwrap()).is_empty());
    }
    assert_eq!(bus.drive.state(), State::Disabled);
}

#[test]
fn number_that_is_not_finite_is_no_command() {
    let mut bus = Bus::new();
    bus.change_mode(Mode::PositionVelocity);
    bus.order(Order::Enable);
    let before = bus.drive.set_point().copied();
    for position in [f32::NAN, f32::INFINITY] {
        assert_eq!(bus.ask(CLIENT.motion(&Motion::PositionVelocity { position, max_velocity: 1.0 })), None);
    }
    assert_eq!(bus.drive.set_point().copied(), before);
}

#[test]
fn torque_and_temperatures_are_reported() {
    let mut bus = Bus::new();
    bus.sensors = Sensors { motor_torque: 1.5, board_temperature: 41.9, motor_temperature: -3.0, ..bus.sensors };
    bus.step(1);
    let feedback = bus.feedback(CLIENT.refresh());
    assert!((feedback.state.torque - 9.0).abs() < 0.014);
    assert_eq!((feedback.board_temperature, feedback.motor_temperature), (41, 0));
}

proptest! {
    #[test]
    fn random_frames_do_not_panic(
        frames in proptest::collection::vec((0_u16..0x800, proptest::collection::vec(any::<u8>(), 0..=8)), 1..50),
    ) {
        let mut bus = Bus::new();
        for (id, data) in frames {
            // Half of the frames reach the drive.
            let id = if id & 1 == 0 { [1, 0x101, 0x201, 0x301, 0x7FF][usize::from(id) % 5] } else { id };
            let frame = Frame::classic(standard(id), &data).unwrap();
            bus.send(&frame);
            bus.step(1);
            let _ = CLIENT.decode(&frame);
            let _ = CLIENT.decode(&Frame::classic(standard(0x11), &data).unwrap());
        }
    }

    #[test]
    fn random_parameters_do_not_panic(writes in proptest::collection::vec((0_u8..90, any::<u32>()), 1..50)) {
        let mut bus = Bus::new();
        for (address, value) in writes {
            let (id, value) = (bus.server.id(), value.to_le_bytes());
            let parameter = Parameter { id, purpose: Purpose::Write, address, value };
            bus.send(&Frame::classic(standard(PARAMETER_ID), &parameter.encode()).unwrap());
            bus.send(&Frame::classic(standard(id), &Order::Enable.encode()).unwrap());
            prop_assert!(bus.step(1).is_finite());
        }
    }

    #[test]
    fn impedance_frame_survives_a_round_trip(data: [u8; 8]) {
        prop_assert_eq!(mit::Command::decode(data, &RANGES).encode(&RANGES), data);
    }
}
