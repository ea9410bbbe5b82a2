use std::vec::Vec;

use proptest::prelude::*;

use super::client::Client;
use super::{Answer, Command, Feedback, Flags, Mode, Model, Operation, Parameter, Request, RunMode, Server, Value};
use crate::bus::CanServer;
use crate::drive::{Drive, Fault, Sensors, Settings, State};
use crate::frame::{self, Frame};
use crate::turns::Turns;

/// Host, bus and drive.
struct Bench {
    client: Client,
    server: Server,
    drive: Drive,
    sensors: Sensors,
    /// Torque of the motor in the last period [N m].
    torque: f32,
}

impl Bench {
    /// Rotor at 0.25 turns, output at 0.3 turns.
    fn new(model: Model) -> Self {
        Self::with_settings(model, super::settings(model, Settings { max_voltage: 60.0, ..Settings::default() }))
    }

    fn with_settings(model: Model, settings: Settings) -> Self {
        let counts = |turns: f64, per_turn: u32| Some((turns * f64::from(per_turn)) as u32);
        let sensors =
            Sensors { motor_counts: counts(0.25, 1 << 14), output_counts: counts(0.3, 1 << 17), ..Sensors::default() };
        let client = Client { model, host: 0xFD, drive: 0x7F };
        let (server, drive) = (Server::new(0x7F, model), Drive::new(settings));
        let mut bench = Self { client, server, drive, sensors, torque: 0.0 };
        bench.run(1);
        bench
    }

    /// Answers to a frame.
    fn exchange(&mut self, frame: &Frame) -> Vec<Frame> {
        let mut answers = Vec::new();
        self.server.receive(frame, &mut self.drive, &mut |frame| answers.push(frame));
        answers
    }

    /// Answers to a command.
    fn command(&mut self, command: Command) -> Vec<Answer> {
        let frame = self.client.command(command).unwrap();
        self.exchange(&frame).iter().map(|frame| self.client.answer(frame).unwrap()).collect()
    }

    fn feedback(&mut self, command: Command) -> Feedback {
        match self.command(command)[..] {
            // The operation frame does not name the host.
            [Answer::Feedback { drive: 0x7F, feedback, .. }] => feedback,
            ref other => panic!("{other:?}"),
        }
    }

    fn write(&mut self, parameter: Parameter, value: Value) {
        let frame = self.client.write(parameter, value).unwrap();
        assert_eq!(self.exchange(&frame).len(), 1);
    }

    fn set(&mut self, parameter: Parameter, value: f32) {
        self.write(parameter, Value::F32(value));
    }

    fn value(&mut self, parameter: Parameter) -> Value {
        let frame = self.client.read(parameter).unwrap();
        let answers = self.exchange(&frame);
        let answer = self.client.answer(&answers[0]).unwrap();
        let (name, value) = self.client.value(&answer).unwrap();
        assert_eq!(name, parameter);
        value
    }

    fn read(&mut self, parameter: Parameter) -> f32 {
        self.value(parameter).to_f32()
    }

    /// Runs periods; returns the frames that the drive sends of its own accord.
    fn run(&mut self, periods: u32) -> Vec<Answer> {
        let mut frames = Vec::new();
        for _ in 0..periods {
            self.torque = self.drive.step(&self.sensors, None);
            self.server.tick(&mut self.drive, &mut |frame| frames.push(frame));
        }
        frames.iter().map(|frame| Answer::decode(self.client.model, frame).unwrap()).collect()
    }

    /// Torque at the output in the next period [N m].
    fn output_torque(&mut self) -> f32 {
        self.run(1);
        6.0 * self.torque
    }
}

fn frame(id: u32, data: &[u8]) -> Frame {
    Frame::classic(frame::extended(id), data).unwrap()
}

fn close(value: f32, expected: f32) {
    assert!((value - expected).abs() < 1e-3 * expected.abs().max(1.0), "{value} {expected}");
}

const REST: Operation = Operation { angle: 0.0, speed: 0.0, kp: 0.0, kd: 0.0, torque: 0.0 };

#[test]
fn pycybergear_frames_are_understood() {
    // Sent by pycybergear 1.0.0 over python-can's virtual bus.
    let cases: [(u32, [u8; 8], Command); 8] = [
        (0x0000_FD7F, [0; 8], Command::Identify),
        (0x0300_FD7F, [0; 8], Command::Enable),
        (0x0400_FD7F, [1, 0, 0, 0, 0, 0, 0, 0], Command::Stop(true)),
        (0x0600_FD7F, [1, 0, 0, 0, 0, 0, 0, 0], Command::SetZero),
        (0x0705_FD7F, [1, 0, 0, 0, 0, 0, 0, 0], Command::SetAddress(5)),
        (0x1200_FD7F, [0x05, 0x70, 0, 0, 1, 0, 0, 0], Command::Write(0x7005, [1, 0, 0, 0])),
        (0x1200_FD7F, [0x16, 0x70, 0, 0, 0xC3, 0xF5, 0xC8, 0x3F], Command::Write(0x7016, 1.57_f32.to_le_bytes())),
        (0x1200_FD7F, [0x0C, 0x20, 0, 0, 0x20, 0x4E, 0, 0], Command::Write(0x200C, [0x20, 0x4E, 0, 0])),
    ];
    for (id, data, command) in cases {
        let request = Request { host: Some(0xFD), drive: 0x7F, command };
        assert_eq!(Request::decode(Model::CyberGear, &frame(id, &data)), Some(request));
        assert_eq!(request.encode(Model::CyberGear), Some(frame(id, &data)));
    }
}

#[test]
fn python_operation_frames_are_understood() {
    // (1 rad, -2 rad/s, 3 N m, kp 50, kd 1) by python-cybergear 0.1.2; by robstride-dynamics 0.0.1 for its rs-04. Both
    // round down.
    let cybergear = frame(0x019F_FF7F, &[0x8A, 0x3C, 0x77, 0x77, 0x19, 0x99, 0x33, 0x33]);
    let robstride = frame(0x0183_3201, &[0x8A, 0x2E, 0x6E, 0xEE, 0x02, 0x8F, 0x02, 0x8F]);
    let cases = [(Model::CyberGear, cybergear, 0.01, 1e-3), (Model::RobStride04, robstride, 0.1, 5e-3)];
    for (model, frame, kp_step, step) in cases {
        let Some(Request { host: None, command: Command::Operate(found), .. }) = Request::decode(model, &frame) else {
            panic!("{model:?}");
        };
        let errors = [found.angle - 1.0, found.speed + 2.0, found.torque - 3.0, found.kd - 1.0];
        assert!(errors.iter().all(|error| error.abs() < step), "{found:?}");
        assert!((found.kp - 50.0).abs() < kp_step, "{found:?}");
    }
}

#[test]
fn feedback_is_what_clients_decode() {
    // Both clients decode these bytes to 1.000038 rad, -2.0 rad/s, 2.000092 N m, 25.0 deg C; python-cybergear 0.1.2
    // tells mode 2 and "not calibrated" from the identifier.
    let flags = Flags(Flags::NOT_CALIBRATED);
    let feedback = Feedback { mode: Mode::Run, flags, angle: 1.0, speed: -2.0, torque: 2.0, temperature: 25.0 };
    let answer = Answer::Feedback { drive: 0x7F, host: 0xFD, feedback };
    let sent = answer.encode(Model::CyberGear).unwrap();
    assert_eq!(sent, frame(0x02A0_7FFD, &[0x8A, 0x3D, 0x77, 0x77, 0x95, 0x55, 0x00, 0xFA]));
}

#[test]
fn manual_read_example_is_answered() {
    // RobStride manuals, 4.1.14: loc_kp is 30.
    let mut bench = Bench::new(Model::RobStride04);
    bench.set(Parameter::LocKp, 30.0);
    let answers = bench.exchange(&frame(0x1100_FD7F, &[0x1E, 0x70, 0, 0, 0, 0, 0, 0]));
    assert_eq!(answers, [frame(0x1100_7FFD, &[0x1E, 0x70, 0, 0, 0, 0, 0xF0, 0x41])]);
    assert_eq!(bench.drive.settings().gains.position, 30.0);
}

#[test]
fn identification_names_the_drive() {
    let mut bench = Bench::new(Model::CyberGear);
    bench.server = bench.server.with_unique_id([1, 2, 3, 4, 5, 6, 7, 8]);
    // python-cybergear 0.1.2 asks with a single byte.
    let answers = bench.exchange(&frame(0x0000_FD7F, &[0]));
    assert_eq!(answers, [frame(0x0000_7FFE, &[1, 2, 3, 4, 5, 6, 7, 8])]);
}

#[test]
fn both_encoders_are_read() {
    for model in Model::ALL {
        let mut bench = Bench::new(model);
        assert_eq!(bench.value(Parameter::EncoderRaw), Value::U16(1 << 12), "{model:?}");
        close(bench.read(Parameter::ModPos), 0.25 * core::f32::consts::TAU);
        close(bench.read(Parameter::MechPos), 0.3 * core::f32::consts::TAU);
        // The output moves within the gap, the rotor does not.
        bench.sensors.output_counts = Some((0.31 * f64::from(1 << 17)) as u32);
        bench.run(1);
        close(bench.read(Parameter::MechPos), 0.3 * core::f32::consts::TAU);
        let has_second = model.index(Parameter::ChasuAngleOut).is_some();
        assert_eq!(has_second, !matches!(model, Model::CyberGear | Model::RobStride01));
        if has_second {
            close(bench.read(Parameter::ChasuAngleOut), 0.31 * core::f32::consts::TAU);
        }
        if model.index(Parameter::Encoder2Raw).is_some() {
            assert_eq!(bench.value(Parameter::Encoder2Raw), Value::U16((0.31 * 16_384.0) as u16));
        }
    }
}

#[test]
fn indices_are_those_of_the_manuals() {
    let cases = [
        (Model::CyberGear, Parameter::EncoderRaw, 0x3004),
        (Model::CyberGear, Parameter::ModPos, 0x3015),
        (Model::CyberGear, Parameter::TorqueFdb, 0x302D),
        (Model::CyberGear, Parameter::CanTimeout, 0x200C),
        (Model::RobStride00, Parameter::ChasuAngleOut, 0x3039),
        (Model::RobStride03, Parameter::ChasuAngleOut, 0x3044),
        (Model::RobStride04, Parameter::Encoder2Raw, 0x3007),
        (Model::RobStride04, Parameter::ChasuAngleOut, 0x3034),
        (Model::RobStride04, Parameter::ModPos, 0x3016),
        (Model::RobStride04, Parameter::FaultSta, 0x3023),
        (Model::RobStride04, Parameter::CanTimeout, 0x7028),
        (Model::RobStride06, Parameter::ModPos, 0x3015),
    ];
    for (model, parameter, index) in cases {
        assert_eq!(model.index(parameter), Some(index), "{model:?} {parameter:?}");
        assert_eq!(model.parameter(index), Some(parameter), "{model:?} {parameter:?}");
    }
    assert_eq!(Model::RobStride04.parameter(0x200B), Some(Parameter::CanTimeout));
    assert_eq!(Model::RobStride04.index(Parameter::VbusMillivolts), None);
    assert_eq!(Model::CyberGear.parameter(0x7028), None);
}

#[test]
fn angle_is_made_of_rotor_angle_and_offset() {
    let mut bench = Bench::new(Model::CyberGear);
    for turn in 1..40 {
        bench.sensors.motor_counts = Some(turn * 5000 % (1 << 14));
        bench.run(1);
    }
    let rotor = core::f32::consts::TAU * bench.read(Parameter::Rotation) + bench.read(Parameter::ModPos);
    let (offset, ratio) = (bench.read(Parameter::MechOffset), bench.read(Parameter::GearRatio));
    let angle = bench.read(Parameter::MechPos);
    assert!(bench.read(Parameter::Rotation) > 5.0);
    close((rotor - offset) / ratio, angle);
}

#[test]
fn state_follows_enable_and_stop() {
    let mut bench = Bench::new(Model::CyberGear);
    assert_eq!(bench.feedback(Command::Stop(false)).mode, Mode::Reset);
    assert_eq!(bench.feedback(Command::Enable).mode, Mode::Run);
    assert_eq!(bench.output_torque(), 0.0);
    bench.feedback(Command::Operate(Operation { torque: 3.0, ..REST }));
    close(bench.output_torque(), 3.0);
    assert_eq!(bench.feedback(Command::Stop(false)).mode, Mode::Reset);
    assert_eq!(bench.output_torque(), 0.0);
    // The set-point does not outlive the stop; a disabled drive takes none.
    bench.feedback(Command::Operate(Operation { torque: 3.0, ..REST }));
    bench.feedback(Command::Enable);
    assert_eq!(bench.output_torque(), 0.0);
}

#[test]
fn operation_mode_is_stiffness_and_damping() {
    let mut bench = Bench::new(Model::CyberGear);
    bench.feedback(Command::Enable);
    let angle = 0.3 * core::f32::consts::TAU;
    let operation = Operation { angle: angle + 0.1, speed: 2.0, kp: 20.0, kd: 0.5, torque: -1.0 };
    bench.feedback(Command::Operate(operation));
    assert!((bench.output_torque() - 2.0).abs() < 0.02, "{}", bench.torque);
}

#[test]
fn run_modes_have_their_laws() {
    // Torque per ampere at the output: 0.1 N m/A times 6.
    let mut bench = Bench::new(Model::RobStride00);
    let enable = |bench: &mut Bench, mode: RunMode| {
        bench.feedback(Command::Stop(false));
        bench.write(Parameter::RunMode, Value::U8(mode.number()));
        assert_eq!(bench.server.run_mode(), mode);
        bench.feedback(Command::Enable);
    };
    for (parameter, value) in [(Parameter::LocKp, 10.0), (Parameter::SpdKp, 2.0), (Parameter::SpdKi, 0.0)] {
        bench.set(parameter, value);
        close(bench.read(parameter), value);
    }
    enable(&mut bench, RunMode::Current);
    bench.set(Parameter::IqRef, 5.0);
    close(bench.output_torque(), 3.0);
    enable(&mut bench, RunMode::Speed);
    assert_eq!(bench.output_torque(), 0.0);
    bench.set(Parameter::SpdRef, 1.0);
    bench.set(Parameter::AccRad, 1000.0);
    bench.run(100);
    close(bench.output_torque(), 1.2);
    bench.set(Parameter::LimitCur, 1.0);
    close(bench.output_torque(), 0.6);
    bench.set(Parameter::LimitCur, 16.0);
    enable(&mut bench, RunMode::CyclicPosition);
    let angle = bench.read(Parameter::MechPos);
    bench.set(Parameter::LocRef, angle + 0.1);
    close(bench.output_torque(), 1.2);
    bench.set(Parameter::LimitSpd, 0.5);
    close(bench.output_torque(), 0.6);
    enable(&mut bench, RunMode::Position);
    bench.set(Parameter::AccSet, 100.0);
    bench.set(Parameter::LocRef, angle + 1.0);
    bench.run(10);
    assert!(bench.drive.feedback().target_velocity < 0.11, "{:?}", bench.drive.feedback());
    bench.run(500);
    assert!(bench.drive.feedback().target_velocity > 5.0, "{:?}", bench.drive.feedback());
}

#[test]
fn integral_gain_acts_each_tick() {
    let mut bench = Bench::new(Model::CyberGear);
    bench.write(Parameter::RunMode, Value::U8(2));
    bench.feedback(Command::Enable);
    for (parameter, value) in [(Parameter::SpdKp, 0.0), (Parameter::SpdKi, 0.002), (Parameter::SpdRef, 1.0)] {
        bench.set(parameter, value);
    }
    // 0.1 s are 2000 ticks.
    bench.run(1000);
    close(bench.read(Parameter::CmdIq), 4.0);
}

#[test]
fn run_mode_is_kept_while_enabled() {
    let mut bench = Bench::new(Model::CyberGear);
    bench.feedback(Command::Enable);
    bench.write(Parameter::RunMode, Value::U8(3));
    assert_eq!(bench.value(Parameter::RunMode), Value::U8(0));
    bench.feedback(Command::Stop(false));
    bench.write(Parameter::RunMode, Value::U8(5));
    assert_eq!(bench.value(Parameter::RunMode), Value::U8(0));
    bench.write(Parameter::RunMode, Value::U8(3));
    assert_eq!(bench.value(Parameter::RunMode), Value::U8(3));
}

#[test]
fn position_mode_holds_until_a_reference_comes() {
    let mut bench = Bench::new(Model::CyberGear);
    bench.write(Parameter::RunMode, Value::U8(1));
    bench.feedback(Command::Enable);
    assert!(bench.output_torque().abs() < 1e-3);
    bench.feedback(Command::Stop(false));
    bench.set(Parameter::LocRef, 3.0);
    bench.feedback(Command::Enable);
    assert!(bench.output_torque() > 0.1);
    close(bench.read(Parameter::LocRef), 3.0);
}

#[test]
fn values_are_limited_to_their_range() {
    let mut bench = Bench::new(Model::CyberGear);
    bench.set(Parameter::LimitSpd, 99.0);
    assert_eq!(bench.read(Parameter::LimitSpd), 30.0);
    bench.set(Parameter::IqRef, -99.0);
    assert_eq!(bench.read(Parameter::IqRef), -23.0);
    bench.set(Parameter::IqRef, f32::NAN);
    assert_eq!(bench.read(Parameter::IqRef), -23.0);
    bench.set(Parameter::LimitTorque, 99.0);
    close(bench.drive.settings().torque_limit, 2.0);
    let voltage = bench.read(Parameter::Vbus);
    bench.set(Parameter::Vbus, 1.0);
    assert_eq!(bench.read(Parameter::Vbus), voltage);
}

#[test]
fn watchdog_resets_without_a_fault() {
    for model in [Model::CyberGear, Model::RobStride04] {
        let mut bench = Bench::new(model);
        bench.write(Parameter::CanTimeout, Value::U32(200));
        assert_eq!(bench.value(Parameter::CanTimeout), Value::U32(200));
        bench.feedback(Command::Enable);
        bench.run(90);
        // Any frame feeds the watchdog, also one that reads.
        bench.read(Parameter::MechPos);
        bench.run(90);
        assert_eq!(bench.drive.state(), State::Enabled);
        assert_eq!(bench.run(20), []);
        assert_eq!((bench.drive.state(), bench.drive.fault()), (State::Disabled, None));
        assert_eq!(bench.feedback(Command::Enable).mode, Mode::Run);
        bench.write(Parameter::CanTimeout, Value::U32(0));
        bench.run(1000);
        assert_eq!(bench.drive.state(), State::Enabled);
    }
}

/// Change of settings or sensors that causes a fault.
type Cause = fn(&mut Bench);

#[test]
fn each_fault_has_its_code() {
    let cases: [(Cause, Fault, u8, u32); 6] = [
        (|bench| bench.sensors.bus_voltage = 5.0, Fault::UnderVoltage, 1, 4),
        (|bench| bench.sensors.bus_voltage = 70.0, Fault::OverVoltage, 0, 8),
        (|bench| bench.sensors.motor_temperature = 150.0, Fault::OverTemperature, 4, 1),
        (|bench| bench.sensors.motor_counts = None, Fault::MotorEncoder, 8, 2),
        (|bench| bench.sensors.output_counts = None, Fault::OutputEncoder, 8, 2),
        (|bench| bench.drive.settings_mut().overspeed = -1.0, Fault::Overspeed, 0, 2),
    ];
    for (cause, fault, flags, faults) in cases {
        let mut bench = Bench::new(Model::RobStride00);
        bench.feedback(Command::Enable);
        cause(&mut bench);
        let told = bench.run(150);
        let warnings = u32::from(fault == Fault::OverTemperature);
        assert_eq!(told, [Answer::Fault { drive: 0x7F, host: 0xFD, faults, warnings }], "{fault:?}");
        assert_eq!(bench.drive.fault(), Some(fault));
        assert_eq!(bench.value(Parameter::FaultSta), Value::U32(faults));
        let feedback = bench.feedback(Command::Enable);
        assert_eq!((feedback.mode, feedback.flags), (Mode::Reset, Flags(flags)), "{fault:?}");
        bench.sensors = Bench::new(Model::RobStride00).sensors;
        bench.drive.settings_mut().overspeed = f32::INFINITY;
        bench.run(1);
        assert_eq!(bench.feedback(Command::Stop(false)).flags, Flags(flags));
        assert_eq!(bench.feedback(Command::Stop(true)).flags, Flags(0));
        assert_eq!(bench.feedback(Command::Enable).mode, Mode::Run);
    }
}

#[test]
fn cybergear_tells_faults_and_warnings_its_own_way() {
    let mut bench = Bench::new(Model::CyberGear);
    bench.feedback(Command::Enable);
    bench.sensors.motor_temperature = 76.0;
    bench.run(1);
    assert_eq!((bench.value(Parameter::WarnSta), bench.drive.fault()), (Value::U32(1), None));
    let mut frames = Vec::new();
    bench.sensors.motor_temperature = 81.0;
    bench.drive.step(&bench.sensors, None);
    bench.server.tick(&mut bench.drive, &mut |frame| frames.push(frame));
    assert_eq!(frames, [frame(0x1500_FD7F, &[1, 0, 0, 0, 1, 0, 0, 0])]);
    bench.write(Parameter::MotorOverTemp, Value::I16(900));
    bench.feedback(Command::Stop(true));
    bench.run(1);
    assert_eq!(bench.drive.fault(), None);

    let mut bench = Bench::new(Model::CyberGear);
    bench.feedback(Command::Enable);
    bench.sensors.output_counts = None;
    bench.run(150);
    assert!(bench.feedback(Command::Stop(false)).flags.has(Flags::HALL_OR_STALL));
}

#[test]
fn calibration_clears_the_uncalibrated_fault() {
    let settings = Settings { is_calibrated: false, calibration_time: 0.01, ..Settings::default() };
    let mut bench = Bench::with_settings(Model::CyberGear, super::settings(Model::CyberGear, settings));
    let feedback = bench.feedback(Command::Enable);
    assert_eq!((feedback.mode, feedback.flags), (Mode::Reset, Flags(Flags::NOT_CALIBRATED)));
    assert_eq!(bench.run(1), [Answer::Fault { drive: 0x7F, host: 0xFD, faults: 0x80, warnings: 0 }]);
    bench.feedback(Command::Stop(true));
    assert_eq!(bench.feedback(Command::Calibrate).mode, Mode::Calibration);
    assert_eq!(bench.run(110), [Answer::Calibrated { drive: 0x7F, host: 0xFD, offset: 0.0 }]);
    let feedback = bench.feedback(Command::Enable);
    assert_eq!((feedback.mode, feedback.flags), (Mode::Run, Flags(0)));
}

#[test]
fn zero_keeps_the_drive_in_place() {
    let mut bench = Bench::new(Model::RobStride00);
    bench.write(Parameter::RunMode, Value::U8(5));
    bench.feedback(Command::Enable);
    close(bench.feedback(Command::SetZero).angle, 0.0);
    assert!(bench.output_torque().abs() < 1e-3);
    close(bench.read(Parameter::LocRef), 0.0);
    // Without the 1 in its first byte the frame is ignored.
    assert_eq!(bench.exchange(&frame(0x0600_FD7F, &[0; 8])), []);
    // A profile forbids a new zero.
    bench.feedback(Command::Stop(false));
    bench.write(Parameter::RunMode, Value::U8(1));
    bench.feedback(Command::Enable);
    bench.drive.set_position(Turns::new(0.5));
    assert!(bench.feedback(Command::SetZero).angle > 3.0);
}

#[test]
fn feedback_angle_wraps_or_stops() {
    for (model, expected) in [(Model::RobStride00, -1.5 * core::f32::consts::TAU), (Model::CyberGear, 12.5)] {
        let mut bench = Bench::new(model);
        bench.drive.set_position(Turns::new(2.5));
        close(bench.feedback(Command::Stop(false)).angle, expected);
        close(bench.read(Parameter::MechPos), 2.5 * core::f32::consts::TAU);
    }
}

#[test]
fn address_changes_at_once() {
    let mut bench = Bench::new(Model::CyberGear);
    let answers = bench.exchange(&frame(0x0705_FD7F, &[1, 0, 0, 0, 0, 0, 0, 0]));
    assert_eq!((answers[0].raw_id(), bench.server.id()), (0x0000_05FE, 5));
    assert_eq!(bench.exchange(&frame(0x0300_FD7F, &[0; 8])), []);
    assert_eq!(bench.exchange(&frame(0x0300_FD05, &[0; 8])).len(), 1);
    for address in [0, 128] {
        assert_eq!(bench.exchange(&frame(0x0700_FD05 | address << 16, &[1])), []);
    }
    assert_eq!(bench.server.id(), 5);
}

#[test]
fn reports_come_at_their_interval() {
    let mut bench = Bench::new(Model::RobStride04);
    assert!(matches!(bench.command(Command::Report(true))[..], [Answer::Report { .. }]));
    assert_eq!(bench.run(1010).len(), 10);
    bench.write(Parameter::EpscanTime, Value::U16(3));
    assert_eq!(bench.run(1010).len(), 5);
    bench.command(Command::Report(false));
    assert_eq!(bench.run(1000), []);
    assert_eq!(bench.client.command(Command::Report(true)).unwrap().data(), [1, 2, 3, 4, 5, 6, 1, 0]);
    assert_eq!(bench.exchange(&frame(0x1800_FD7F, &[1, 2, 3, 4, 5, 0, 1, 0])), []);
}

#[test]
fn configuration_frames_are_answered() {
    let mut bench = Bench::new(Model::RobStride04);
    assert!(matches!(bench.command(Command::Save)[..], [Answer::Feedback { .. }]));
    assert!(matches!(bench.command(Command::SetRate(1))[..], [Answer::Device { .. }]));
    assert!(matches!(bench.command(Command::SetProtocol(0))[..], [Answer::Device { .. }]));
    let mut bench = Bench::new(Model::CyberGear);
    let answers = bench.exchange(&frame(0x1600_FD7F, &[1, 0, 0, 0, 0, 0, 0, 0]));
    assert_eq!(answers[0].raw_id(), 0x0000_7FFE);
    assert_eq!(bench.client.command(Command::Save), None);
}

#[test]
fn unknown_index_fails() {
    // LeRobot reads the failure from the byte above the address of the drive.
    let mut bench = Bench::new(Model::RobStride00);
    let answers = bench.exchange(&frame(0x1100_FD7F, &[0x99, 0x70, 0, 0, 0, 0, 0, 0]));
    assert_eq!(answers, [frame(0x1101_7FFD, &[0x99, 0x70, 0, 0, 0, 0, 0, 0])]);
    let mut bench = Bench::new(Model::CyberGear);
    assert_eq!(bench.exchange(&frame(0x1100_FD7F, &[0x99, 0x70, 0, 0, 0, 0, 0, 0])), []);
    // A drive without a second encoder.
    let settings = Settings { output_counts_per_turn: None, ..Settings::default() };
    let mut bench = Bench::with_settings(Model::RobStride04, settings);
    let answer = bench.command(Command::Read(0x3034));
    assert!(matches!(answer[..], [Answer::Parameter { value: None, .. }]));
}

#[test]
fn foreign_frames_are_ignored() {
    let mut bench = Bench::new(Model::RobStride00);
    let foreign = [
        frame(0x0300_FD01, &[0; 8]),
        frame(0x0200_017F, &[0; 8]),
        frame(0x1A00_FD7F, &[0; 8]),
        frame(0x0180_007F, &[0; 7]),
        frame(0x1200_FD7F, &[0x05, 0x70, 0, 0, 1]),
        Frame::classic(frame::standard(0x7F), &[0; 8]).unwrap(),
        Frame::flexible(frame::extended(0x0300_FD7F), &[0; 8], 0).unwrap(),
        Frame::remote(frame::extended(0x0300_FD7F), 8).unwrap(),
    ];
    for frame in foreign {
        assert_eq!(bench.exchange(&frame), [], "{frame:?}");
    }
    assert_eq!(bench.drive.state(), State::Disabled);
}

proptest! {
    #[test]
    fn no_frame_panics(
        model in 0_usize..8,
        frames in prop::collection::vec((0_u32..28, any::<u16>(), prop::collection::vec(any::<u8>(), 0..=8)), 1..40),
        indices in prop::collection::vec(prop::sample::select(std::vec![0x7000_u16, 0x2000, 0x3000]), 40),
    ) {
        let mut bench = Bench::new(Model::ALL[model]);
        for ((kind, data, mut bytes), base) in frames.into_iter().zip(indices) {
            // Reads and writes meet an index of the tables more often.
            if let (17 | 18, [low, high, ..]) = (kind, &mut bytes[..]) {
                (*low, *high) = (*low & 0x3F, (base >> 8) as u8);
            }
            let target = u32::from(bench.server.id());
            let frame = frame(kind << 24 | u32::from(data) << 8 | target, &bytes);
            for answer in bench.exchange(&frame) {
                prop_assert!(Answer::decode(bench.client.model, &answer).is_some());
            }
            bench.run(3);
            prop_assert!(bench.torque.is_finite());
            let _ = Answer::decode(bench.client.model, &frame);
        }
    }

    #[test]
    fn commands_round_trip(model in 0_usize..8, index: u16, value: [u8; 4], host: u8, drive: u8, code: u8) {
        let model = Model::ALL[model];
        let commands = [
            Command::Identify,
            Command::Enable,
            Command::Stop(code & 1 == 0),
            Command::Calibrate,
            Command::SetZero,
            Command::SetAddress(code),
            Command::Read(index),
            Command::Write(index, value),
            Command::Save,
            Command::SetRate(code),
            Command::Report(code & 1 == 0),
            Command::SetProtocol(code),
        ];
        for command in commands {
            let request = Request { host: Some(host), drive, command };
            if let Some(frame) = request.encode(model) {
                prop_assert_eq!(Request::decode(model, &frame), Some(request));
            }
        }
    }

    #[test]
    fn numbers_round_trip(model in 0_usize..8, torque: u16, bytes: [u8; 8], host: u8) {
        let model = Model::ALL[model];
        let sent = frame(0x0100_0005 | u32::from(torque) << 8, &bytes);
        let request = Request::decode(model, &sent).unwrap();
        prop_assert_eq!(request.encode(model), Some(sent));
        let sent = frame(0x0240_0500 | u32::from(host), &bytes);
        let answer = Answer::decode(model, &sent).unwrap();
        prop_assert_eq!(answer.encode(model), Some(sent));
    }
}
