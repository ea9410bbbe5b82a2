use std::vec;
use std::vec::Vec;

use proptest::prelude::*;

use super::client::{Answers, Status};
use super::table::Field;
use super::*;
use crate::bus::SerialServer;
use crate::drive::{Drive, Sensors, SetPoint, State};
use crate::turns::Ratio;

const PERIOD: f32 = 1e-3;

/// Servo on a rigid joint without a gap.
struct Servo {
    server: Server,
    drive: Drive,
    sensors: Sensors,
    /// Angle of the output [turns].
    turns: f64,
    /// Speed of the output [rad/s].
    speed: f32,
    is_free: bool,
}

impl Servo {
    fn new(id: u8) -> Self {
        let joint =
            Settings { period: PERIOD, encoder_bandwidth: 200.0, ratio: Ratio::new(6.0), ..Settings::default() };
        let settings = super::settings(joint);
        let sensors =
            Sensors { motor_counts: Some(0), output_counts: Some(0), bus_voltage: 12.0, ..Sensors::default() };
        let (server, drive) = (Server::new(id, &settings), Drive::new(settings));
        let mut servo = Self { server, drive, sensors, turns: 0.3, speed: 0.0, is_free: true };
        servo.step(&mut |_| panic!("no answer without an instruction"));
        servo
    }

    /// Runs one control period.
    fn step(&mut self, send: &mut dyn FnMut(&[u8])) {
        let counts = |turns: f64, per_turn: u32| (turns.rem_euclid(1.0) * f64::from(per_turn)) as u32;
        let sensors = Sensors {
            motor_counts: self.sensors.motor_counts.map(|_| counts(6.0 * self.turns, 1 << 14)),
            output_counts: self.sensors.output_counts.map(|_| counts(self.turns, 1 << 17)),
            ..self.sensors
        };
        let torque = 6.0 * self.drive.step(&sensors, None);
        if self.is_free {
            self.speed += torque / 0.17 * PERIOD;
            self.turns += f64::from(self.speed * PERIOD) / std::f64::consts::TAU;
        }
        self.server.tick(&mut self.drive, send);
    }

    fn run(&mut self, periods: u32) -> Vec<u8> {
        let mut answers = Vec::new();
        (0..periods).for_each(|_| self.step(&mut |bytes| answers.extend_from_slice(bytes)));
        answers
    }

    /// Bytes that answer bytes at once.
    fn receive(&mut self, bytes: &[u8]) -> Vec<u8> {
        let mut answers = Vec::new();
        let Self { server, drive, .. } = self;
        bytes.iter().for_each(|byte| server.receive(*byte, drive, &mut |bytes| answers.extend_from_slice(bytes)));
        answers
    }

    /// Answer at once, or in the next period.
    fn ask(&mut self, instruction: Option<Bytes>) -> Option<Status> {
        let at_once = self.receive(&instruction.unwrap());
        statuses(&if at_once.is_empty() { self.run(1) } else { at_once }).pop()
    }

    fn set(&mut self, field: Field, value: i32) -> Status {
        self.ask(client::set(self.server.id(), &field, value)).unwrap()
    }

    fn get(&mut self, field: Field) -> i32 {
        let status = self.ask(client::read(self.server.id(), field.address, field.width)).unwrap();
        status.value(field.address, &field).unwrap()
    }
}

fn statuses(bytes: &[u8]) -> Vec<Status> {
    let mut answers = Answers::default();
    bytes.iter().filter_map(|byte| answers.receive(*byte)).collect()
}

/// Packets by feetech-servo-sdk 1.0.0: readTx, writeTxOnly, regWriteTxOnly, syncReadTx, syncWriteTxOnly, SCS_TOSCS.
#[test]
fn packets_are_those_of_the_python_client() {
    let position = table::PRESENT_POSITION.address;
    let cases = [
        (client::read(1, position, 2), vec![0xFF, 0xFF, 1, 4, 2, 0x38, 2, 0xBE]),
        (
            client::write(1, table::ACCELERATION.address, &[50, 0, 8, 0, 0, 0xE8, 3]),
            vec![0xFF, 0xFF, 1, 0x0A, 3, 0x29, 0x32, 0, 8, 0, 0, 0xE8, 3, 0xA3],
        ),
        (client::set(2, &table::GOAL_SPEED, -1000), vec![0xFF, 0xFF, 2, 5, 3, 0x2E, 0xE8, 0x83, 0x5C]),
        (
            client::register_write(3, table::GOAL_POSITION.address, &[0x10, 2]),
            vec![0xFF, 0xFF, 3, 5, 4, 0x2A, 0x10, 2, 0xB7],
        ),
        (client::sync_read(position, 4, &[1, 2, 3]), vec![0xFF, 0xFF, 0xFE, 7, 0x82, 0x38, 4, 1, 2, 3, 0x36]),
        (
            client::sync_set(&table::GOAL_POSITION, &[(1, 0x0800), (2, 0x0FFF)]),
            vec![0xFF, 0xFF, 0xFE, 0x0A, 0x83, 0x2A, 2, 1, 0, 8, 2, 0xFF, 0x0F, 0x2F],
        ),
    ];
    for (packet, expected) in cases {
        assert_eq!(packet.unwrap().as_slice(), expected);
    }
}

/// Values by feetech-servo-sdk 1.0.0, SCS_TOHOST and SCS_TOSCS; addresses and sign bits as in LeRobot's table.
#[test]
fn fields_are_scaled_as_in_the_python_client() {
    assert_eq!(table::PRESENT_SPEED.decode(&[0xE8, 0x83]), Some(-1000));
    assert_eq!(table::PRESENT_LOAD.decode(&[0xDC, 0x05]), Some(-476));
    assert_eq!(table::OFFSET.encode(-100)[..2], 2148_u16.to_le_bytes());
    assert_eq!(table::MOTOR_POSITION.decode(&[0x78, 0x56, 0x34, 0x12]), Some(305_419_896));
    assert_eq!(table::MOTOR_POSITION.decode(&table::MOTOR_POSITION.encode(-2)), Some(-2));
    assert_eq!(table::GOAL_POSITION.encode(-40_000)[..2], [0xFF, 0xFF]);
    assert_eq!(table::PRESENT_VOLTAGE.value_of(12.34), 123);
    assert!((table::PRESENT_CURRENT.quantity_of(100) - 0.65).abs() < 1e-6);
}

#[test]
fn registers_do_not_overlap() {
    for pair in table::FIELDS.windows(2) {
        assert!(pair[0].addresses().end <= pair[1].addresses().start, "{:?}", pair[1]);
    }
    assert_eq!(table::FIELDS.last().unwrap().addresses().end, table::SIZE);
}

#[test]
fn servo_introduces_itself() {
    let mut servo = Servo::new(1);
    assert_eq!(servo.receive(&[0xFF, 0xFF, 1, 2, 1, 0xFB]), [0xFF, 0xFF, 1, 2, 0, 0xFC]);
    assert_eq!(servo.get(table::MODEL), 777);
    assert_eq!(servo.get(table::ID), 1);
    assert_eq!(servo.get(table::PRESENT_VOLTAGE), 120);
    assert_eq!(servo.get(table::PRESENT_TEMPERATURE), 25);
    assert_eq!(servo.server.baud_rate(), 1_000_000);
}

/// Answer of the manual's example: position 1304.
#[test]
fn position_is_that_of_the_output_encoder() {
    let mut servo = Servo::new(1);
    servo.turns = 1304.5 / 4096.0;
    servo.run(1);
    assert_eq!(servo.receive(&[0xFF, 0xFF, 1, 4, 2, 0x38, 2, 0xBE]), [0xFF, 0xFF, 1, 4, 0, 0x18, 5, 0xDD]);
}

#[test]
fn both_encoders_are_readable() {
    let mut servo = Servo::new(1);
    let sensors = Sensors { motor_counts: Some(7000), output_counts: Some(65_536), ..servo.sensors };
    servo.drive = Drive::new(*servo.drive.settings());
    servo.drive.step(&sensors, None);
    assert_eq!((servo.get(table::PRESENT_POSITION), servo.get(table::MOTOR_POSITION)), (2048, 7000));
    // The rotor moves through the gap, the output rests.
    servo.drive.step(&Sensors { motor_counts: Some(6000), ..sensors }, None);
    assert_eq!((servo.get(table::PRESENT_POSITION), servo.get(table::MOTOR_POSITION)), (2048, 6000));
    servo.drive.step(&Sensors { motor_counts: Some(6000), output_counts: Some(64_000), ..sensors }, None);
    assert_eq!((servo.get(table::PRESENT_POSITION), servo.get(table::MOTOR_POSITION)), (2000, 6000));
    assert_eq!(servo.get(table::MOTOR_COUNTS), 1 << 14);
    assert_eq!((servo.get(table::RATIO_NUMERATOR), servo.get(table::RATIO_DENOMINATOR)), (6, 1));
}

#[test]
fn goal_switches_on_and_is_reached() {
    let mut servo = Servo::new(1);
    let begin = servo.get(table::PRESENT_POSITION);
    assert_eq!(servo.get(table::TORQUE_ENABLE), 0);
    // Acceleration, position, duty and speed in one write, as the maker's library.
    servo.ask(client::write(1, table::ACCELERATION.address, &[50, 0, 8, 0, 0, 0xE8, 3]));
    assert_eq!((servo.get(table::TORQUE_ENABLE), servo.get(table::LAST_GOAL)), (1, 2048));
    servo.run(400);
    assert_eq!(servo.get(table::MOVING), 1);
    let speed = servo.get(table::PRESENT_SPEED);
    assert!((speed - 1000).abs() < 60, "{speed}");
    let target = servo.get(table::TARGET_POSITION);
    assert!(begin < target && target < 2048, "{target}");
    servo.run(3000);
    let position = servo.get(table::PRESENT_POSITION);
    assert!((position - 2048).abs() <= 1, "{position}");
    assert_eq!((servo.get(table::MOVING), servo.get(table::TARGET_POSITION)), (0, 2048));
}

#[test]
fn torque_switch_holds_shorts_and_releases() {
    let mut servo = Servo::new(1);
    servo.set(table::TORQUE_ENABLE, 1);
    assert_eq!(servo.get(table::GOAL_POSITION), 1228);
    servo.run(200);
    assert_eq!((servo.get(table::TORQUE_ENABLE), servo.get(table::PRESENT_POSITION)), (1, 1228));
    servo.set(table::TORQUE_ENABLE, 2);
    assert_eq!((servo.get(table::TORQUE_ENABLE), servo.drive.set_point()), (2, Some(&SetPoint::Brake)));
    servo.set(table::TORQUE_ENABLE, 1);
    assert_eq!(servo.get(table::TORQUE_ENABLE), 1);
    servo.set(table::TORQUE_ENABLE, 0);
    assert_eq!((servo.get(table::TORQUE_ENABLE), servo.drive.state()), (0, State::Disabled));
}

#[test]
fn goal_is_clipped_to_the_angle_limits() {
    let mut servo = Servo::new(1);
    servo.set(table::MAX_POSITION, 1500);
    servo.set(table::GOAL_POSITION, 3000);
    assert_eq!(servo.get(table::LAST_GOAL), 1500);
    servo.run(2000);
    let position = servo.get(table::PRESENT_POSITION);
    assert!((position - 1500).abs() <= 1, "{position}");
}

#[test]
fn goal_near_zero_does_not_turn_round() {
    let mut servo = Servo::new(1);
    servo.set(table::GOAL_POSITION, 1);
    servo.run(2000);
    servo.turns = -0.001;
    servo.run(1);
    assert_eq!(servo.get(table::PRESENT_POSITION), 4091);
    servo.set(table::GOAL_POSITION, 2);
    servo.run(500);
    assert!(servo.turns.abs() < 0.01, "{}", servo.turns);
}

#[test]
fn goal_lies_in_the_turn_of_the_switching_on() {
    let mut servo = Servo::new(1);
    for _ in 0..100 {
        servo.turns -= 0.02;
        servo.run(1);
    }
    servo.run(200);
    servo.set(table::GOAL_POSITION, 1024);
    servo.run(2000);
    assert!((servo.turns + 1.75).abs() < 1e-3, "{}", servo.turns);
}

#[test]
fn calibration_makes_the_angle_the_middle() {
    let mut servo = Servo::new(1);
    servo.set(table::TORQUE_ENABLE, 128);
    assert_eq!(servo.get(table::PRESENT_POSITION), 2048);
    assert_eq!(servo.get(table::OFFSET), 1228 - 2048);
    assert_eq!(servo.get(table::TORQUE_ENABLE), 0);
    servo.ask(client::calibrate(1, Some(1000)));
    assert_eq!(servo.get(table::PRESENT_POSITION), 1000);
    servo.ask(client::calibrate(1, None));
    servo.set(table::TORQUE_ENABLE, 1);
    servo.run(100);
    assert_eq!(servo.get(table::PRESENT_POSITION), 2048);
    // As LeRobot sets the offset: position = angle - offset.
    servo.set(table::OFFSET, 28);
    assert_eq!(servo.get(table::PRESENT_POSITION), 1200);
}

#[test]
fn turns_are_counted_by_phase_and_reset() {
    let mut servo = Servo::new(1);
    servo.set(table::PHASE, i32::from(12 | phase::ALL_TURNS));
    servo.set(table::MAX_POSITION, 0);
    servo.set(table::GOAL_POSITION, -3000);
    servo.run(4000);
    let position = servo.get(table::PRESENT_POSITION);
    assert!((position + 3000).abs() <= 1, "{position}");
    servo.ask(client::reset(1));
    let position = servo.get(table::PRESENT_POSITION);
    assert!((position - 1096).abs() <= 1, "{position}");
    assert!(servo.run(100).is_empty());
    assert!((servo.turns + 3000.0 / 4096.0).abs() < 1e-3, "{}", servo.turns);
}

#[test]
fn speed_mode_turns_and_stops() {
    let mut servo = Servo::new(1);
    servo.set(table::MODE, 1);
    servo.set(table::GOAL_SPEED, -800);
    servo.run(1000);
    let speed = servo.get(table::PRESENT_SPEED);
    assert!((speed + 800).abs() < 30, "{speed}");
    servo.set(table::PHASE, 8);
    servo.set(table::GOAL_SPEED, 10);
    servo.run(1000);
    assert_eq!(servo.get(table::PRESENT_SPEED), 10);
    servo.set(table::GOAL_SPEED, 0);
    servo.run(1000);
    assert!(servo.speed.abs() < 0.02, "{}", servo.speed);
}

#[test]
fn duty_mode_is_a_torque() {
    let mut servo = Servo::new(1);
    servo.set(table::MODE, 2);
    servo.set(table::GOAL_DUTY, -100);
    let torque = servo.drive.step(&servo.sensors, None);
    assert!((torque + 0.25).abs() < 1e-5, "{torque}");
}

#[test]
fn step_mode_moves_on_each_write() {
    let mut servo = Servo::new(1);
    servo.set(table::MODE, 3);
    servo.set(table::GOAL_POSITION, 100);
    servo.set(table::GOAL_POSITION, 100);
    servo.set(table::GOAL_POSITION, -50);
    assert_eq!(servo.get(table::LAST_GOAL), 1228 + 150);
    servo.run(1500);
    let position = servo.get(table::PRESENT_POSITION);
    assert!((position - 1378).abs() <= 1, "{position}");
}

#[test]
fn gains_and_limits_act_on_the_drive() {
    let mut servo = Servo::new(1);
    let before = servo.drive.settings().gains;
    servo.set(table::POSITION_P, 16);
    servo.set(table::POSITION_D, 64);
    servo.set(table::POSITION_I, 32);
    servo.set(table::SPEED_P, 20);
    servo.set(table::TORQUE_LIMIT, 500);
    servo.set(table::DEAD_ZONE_CCW, 4);
    let settings = servo.drive.settings();
    assert_eq!(settings.gains.stiffness, 0.5 * before.stiffness);
    assert_eq!(settings.gains.damping, 2.0 * before.damping);
    assert_eq!(settings.gains.integral, before.stiffness);
    assert_eq!(settings.gains.velocity, 2.0 * before.velocity);
    assert_eq!(settings.torque_limit, 1.25);
    assert!((settings.dead_zone.1 - 4.0 * std::f32::consts::TAU / 4096.0).abs() < 1e-7);
    // Registers out of range take the end of the range; those of measurements cannot be written.
    servo.set(table::MAX_TEMPERATURE, 200);
    assert_eq!(servo.get(table::MAX_TEMPERATURE), 100);
    servo.set(table::MODEL, 1);
    assert_eq!(servo.get(table::MODEL), 777);
}

/// Registers, readings, and the error that they lead to.
struct FaultCase {
    registers: Vec<(Field, i32)>,
    sensors: Sensors,
    bit: u8,
    /// Control periods until the error.
    periods: u32,
    /// True if it takes the torque off.
    unloads: bool,
}

fn each_fault() -> [FaultCase; 8] {
    let good = Sensors { motor_counts: Some(0), output_counts: Some(0), bus_voltage: 12.0, ..Sensors::default() };
    let case = |registers: &[(Field, i32)], sensors, bit, periods, unloads| FaultCase {
        registers: registers.to_vec(),
        sensors,
        bit,
        periods,
        unloads,
    };
    let current = [(table::MAX_CURRENT, 1000), (table::OVERCURRENT_TIME, 10)];
    let voltage = [(table::UNLOADING, 1)];
    [
        case(&[], Sensors { bus_voltage: 14.5, ..good }, error::VOLTAGE, 1, false),
        case(&voltage, Sensors { bus_voltage: 14.5, ..good }, error::VOLTAGE, 1, true),
        case(&voltage, Sensors { bus_voltage: 3.5, ..good }, error::VOLTAGE, 1, true),
        case(&[], Sensors { board_temperature: 71.0, ..good }, error::TEMPERATURE, 1, true),
        case(&voltage, Sensors { motor_temperature: 71.0, ..good }, error::TEMPERATURE, 1, false),
        case(&[], Sensors { output_counts: None, ..good }, error::ENCODER, 101, true),
        case(&current, Sensors { motor_torque: 0.7, ..good }, error::CURRENT, 102, true),
        case(&[(table::OVERLOAD_TIME, 5)], Sensors { motor_torque: 2.1, ..good }, error::OVERLOAD, 52, false),
    ]
}

#[test]
fn each_fault_has_its_error_bit() {
    for FaultCase { registers, sensors, bit, periods, unloads } in each_fault() {
        let mut servo = Servo::new(1);
        let good = servo.sensors;
        registers.iter().for_each(|(field, value)| drop(servo.set(*field, *value)));
        servo.set(table::TORQUE_ENABLE, 1);
        (servo.sensors, servo.is_free) = (sensors, false);
        // Two periods of tolerance for the rounding of the times.
        servo.run(periods.saturating_sub(3));
        assert_eq!(servo.server.status(), 0, "{bit} too early");
        servo.run(4);
        assert_eq!(servo.get(table::STATUS), bit.into());
        assert_eq!(servo.ask(client::ping(1)).unwrap().error, bit, "{bit}");
        assert_eq!(servo.get(table::TORQUE_ENABLE), i32::from(!unloads), "{bit}");
        if unloads {
            servo.set(table::GOAL_POSITION, 1300);
            assert_eq!(servo.get(table::TORQUE_ENABLE), 0, "{bit}: no goal past an error");
        }
        servo.sensors = good;
        servo.run(1);
        assert!(!unloads || servo.server.status() == bit, "{bit}: kept");
        servo.set(table::TORQUE_ENABLE, 1);
        servo.run(1);
        assert_eq!((servo.get(table::STATUS), servo.get(table::TORQUE_ENABLE)), (0, 1), "{bit}: cleared");
    }
}

#[test]
fn overload_reduces_the_torque() {
    let mut servo = Servo::new(1);
    servo.set(table::OVERLOAD_TIME, 1);
    servo.set(table::TORQUE_ENABLE, 1);
    (servo.sensors.motor_torque, servo.is_free) = (2.2, false);
    servo.run(20);
    assert!((servo.drive.settings().torque_limit - 0.2 * 2.5).abs() < 1e-6);
    servo.sensors.motor_torque = 0.5;
    servo.run(20);
    assert_eq!(servo.get(table::STATUS), i32::from(error::OVERLOAD), "kept");
    assert_eq!(servo.get(table::PRESENT_LOAD), 200);
    assert_eq!(servo.get(table::PRESENT_CURRENT), 769);
}

#[test]
fn silence_is_no_fault() {
    let mut servo = Servo::new(1);
    servo.set(table::GOAL_POSITION, 1300);
    servo.run(20_000);
    assert_eq!((servo.get(table::TORQUE_ENABLE), servo.server.status()), (1, 0));
    assert_eq!(servo.drive.settings().watchdog, None);
}

#[test]
fn lock_decides_over_the_power_cycle() {
    let mut servo = Servo::new(1);
    servo.set(table::POSITION_P, 20);
    servo.set(table::LOCK, 0);
    servo.set(table::MAX_TORQUE, 700);
    servo.set(table::TORQUE_ENABLE, 1);
    assert_eq!(servo.ask(client::reboot(1)), None);
    assert_eq!(servo.ask(client::ping(1)), None, "asleep");
    servo.run(810);
    assert_eq!((servo.get(table::POSITION_P), servo.get(table::MAX_TORQUE)), (32, 700));
    assert_eq!((servo.get(table::TORQUE_LIMIT), servo.get(table::LOCK)), (700, 1));
    assert_eq!(servo.get(table::TORQUE_ENABLE), 0);
    servo.ask(client::recovery(1));
    assert_eq!(servo.get(table::MAX_TORQUE), 1000);
    servo.set(table::MAX_TORQUE, 600);
    servo.ask(client::backup(1));
    servo.set(table::MAX_TORQUE, 500);
    servo.ask(client::recovery(1));
    assert_eq!(servo.get(table::MAX_TORQUE), 600);
}

#[test]
fn new_identifier_answers_under_the_old_one() {
    let mut servo = Servo::new(1);
    assert_eq!(servo.set(table::ID, 9).id, 1);
    assert_eq!(servo.server.id(), 9);
    assert_eq!(servo.ask(client::ping(1)), None);
    assert_eq!(servo.ask(client::ping(9)).unwrap().id, 9);
}

#[test]
fn kept_write_waits_for_its_action() {
    let mut servo = Servo::new(1);
    servo.ask(client::register_write(1, table::GOAL_POSITION.address, &[0, 6]));
    assert_eq!((servo.get(table::REGISTERED), servo.get(table::GOAL_POSITION)), (1, 0));
    assert_eq!(servo.ask(client::action(BROADCAST)), None);
    assert_eq!((servo.get(table::REGISTERED), servo.get(table::GOAL_POSITION)), (0, 0x0600));
    assert_eq!(servo.ask(client::sync_set(&table::GOAL_POSITION, &[(4, 5), (1, 1000)])), None);
    assert_eq!(servo.get(table::GOAL_POSITION), 1000);
}

#[test]
fn response_level_and_delay() {
    let mut servo = Servo::new(1);
    assert_eq!(servo.ask(client::set(1, &table::STATUS_LEVEL, 0)), None);
    assert_eq!(servo.ask(client::set(1, &table::RETURN_DELAY, 254)), None);
    let ping = client::ping(1).unwrap();
    assert!(servo.receive(&ping).is_empty());
    assert_eq!(servo.run(1), [0xFF, 0xFF, 1, 2, 0, 0xFC], "0.5 ms are over in the next period");
    assert!(servo.run(10).is_empty());
}

#[test]
fn foreign_packets_get_no_answer() {
    let mut servo = Servo::new(1);
    let write = |bytes: &[u8]| Packet::new(1, 0x99, bytes).unwrap().to_bytes();
    assert!(servo.receive(&write(&[1, 2])).is_empty());
    for (code, parameters) in [(2, &[1][..]), (3, &[]), (0x0B, &[1]), (2, &[0, 241])] {
        assert!(servo.receive(&Packet::new(1, code, parameters).unwrap().to_bytes()).is_empty(), "{code}");
    }
    // A write to 2, and the status of a servo 2 with an error that reads like one.
    assert!(servo.receive(&client::set(2, &table::GOAL_POSITION, 5).unwrap()).is_empty());
    assert_eq!(servo.get(table::TORQUE_ENABLE), 0);
    // A packet that does not end, then silence.
    servo.receive(&[0xFF, 0xFF, 1, 9, 3]);
    servo.run(25);
    assert!(servo.ask(client::ping(1)).is_some());
}

/// Servos on one bus: bytes of the client reach all, then the answers reach the others.
fn exchange(servos: &mut [Servo], bytes: &[u8], periods: u32) -> Vec<Status> {
    let mut wire = Vec::new();
    let mut queue: Vec<(Option<usize>, Vec<u8>)> = vec![(None, bytes.to_vec())];
    for period in 0..=periods {
        while !queue.is_empty() {
            let (sender, bytes) = queue.remove(0);
            if sender.is_some() {
                wire.extend_from_slice(&bytes);
            }
            for (index, servo) in servos.iter_mut().enumerate().filter(|(index, _)| Some(*index) != sender) {
                let answer = servo.receive(&bytes);
                if !answer.is_empty() {
                    queue.push((Some(index), answer));
                }
            }
        }
        if period < periods {
            for (index, servo) in servos.iter_mut().enumerate() {
                let answer = servo.run(1);
                if !answer.is_empty() {
                    queue.push((Some(index), answer));
                }
            }
        }
    }
    statuses(&wire)
}

fn ids(statuses: &[Status]) -> Vec<u8> {
    statuses.iter().map(|status| status.id).collect()
}

#[test]
fn synchronous_read_keeps_its_order() {
    let mut servos = [Servo::new(1), Servo::new(2), Servo::new(3)];
    let read = |ids: &[u8]| client::sync_read(table::PRESENT_POSITION.address, 2, ids).unwrap();
    let answers = exchange(&mut servos, &read(&[3, 1, 2]), 0);
    assert_eq!(ids(&answers), [3, 1, 2]);
    assert_eq!(answers[0].value(table::PRESENT_POSITION.address, &table::PRESENT_POSITION), Some(1228));
    // Errors 1 without parameters would read as a ping; the answers have two.
    servos[1].sensors.bus_voltage = 15.0;
    servos[1].run(1);
    assert_eq!(ids(&exchange(&mut servos, &read(&[2, 1]), 0)), [2, 1]);
}

#[test]
fn missing_servo_delays_the_others() {
    let mut servos = [Servo::new(1), Servo::new(2)];
    let read = client::sync_read(table::PRESENT_POSITION.address, 2, &[7, 8, 2, 1]).unwrap();
    assert_eq!(ids(&exchange(&mut servos, &read, 7)), []);
    assert_eq!(ids(&exchange(&mut servos, &read, 8)), [2, 1]);
    // An instruction ends the wait.
    assert_eq!(ids(&exchange(&mut servos, &read, 3)), []);
    assert_eq!(ids(&exchange(&mut servos, &client::ping(5).unwrap(), 20)), []);
    assert_eq!(ids(&exchange(&mut servos, &read, 3)), []);
    assert_eq!(ids(&exchange(&mut servos, &client::ping(1).unwrap(), 20)), [1]);
}

#[test]
fn broadcast_ping_is_answered_in_order() {
    let mut servos = [Servo::new(5), Servo::new(0), Servo::new(2)];
    let answers = exchange(&mut servos, &client::ping(BROADCAST).unwrap(), 20);
    assert_eq!(ids(&answers), [0, 2, 5]);
}

proptest! {
    #[test]
    fn random_instructions_do_not_panic(
        packets: Vec<(bool, u8, Vec<u8>)>,
        noise: Vec<u8>,
        turns in -1e6_f64..1e6,
    ) {
        let mut servo = Servo::new(1);
        servo.turns = turns;
        for (is_broadcast, code, parameters) in packets {
            let id = if is_broadcast { BROADCAST } else { servo.server.id() };
            let code = if code & 3 == 0 { code } else { [1, 2, 3, 4, 5, 6, 9, 0x0A, 0x0B, 0x82, 0x83][usize::from(code) % 11] };
            if let Some(packet) = Packet::new(id, code, &parameters) {
                servo.receive(&packet.to_bytes());
            }
            servo.step(&mut |_| {});
        }
        servo.receive(&noise);
        servo.step(&mut |_| {});
        for status in statuses(&noise) {
            let _ = status.value(56, &table::PRESENT_POSITION);
        }
    }

    #[test]
    fn random_writes_keep_values_in_range(address: u8, data: Vec<u8>) {
        let mut servo = Servo::new(1);
        servo.ask(client::write(1, address, &data[..data.len().min(200)]));
        servo.run(2);
        for field in table::FIELDS.iter().copied() {
            let value = servo.get(field);
            prop_assert!((field.range.0..=field.range.1).contains(&value), "{:?} {}", field, value);
        }
    }

    #[test]
    fn fields_round_trip(value: i32) {
        for field in table::FIELDS.iter().copied() {
            let bytes = field.encode(value);
            let back = field.decode(&bytes).unwrap();
            prop_assert_eq!(field.encode(back), bytes);
            let (low, high) = field.range;
            if field.area != table::Area::ReadOnly {
                let inside = value.clamp(low, high);
                prop_assert_eq!(field.decode(&field.encode(inside)), Some(inside));
            }
        }
    }
}
