//! A storm of frames at the servers and clients of all drives: none panics, and the torque stays a number.
//!
//! `STORM_FRAMES` is the number of frames for all of them together; a frame of a serial bus counts as one packet.

use drives::bus::{CanServer, SerialServer};
use drives::cybergear::{Answer, Model};
use drives::drive::{Drive, Sensors, Settings};
use drives::frame::{Frame, Id, Kind, extended, standard};
use drives::{cia402, cybergear, damiao, feetech, moteus, odrive};
use model_core::numbers::random::splitmix64;

/// Frames of the short form.
const SHORT: u64 = 400_000;
/// Frames between two control periods.
const FRAMES_A_PERIOD: u64 = 8;
/// Frames after which a drive is as at power-up: a write of nonsense does not hide all that would follow.
const FRAMES_A_LIFE: u64 = 4096;
/// Frames without an answer after which a drive is as at power-up: it may have another identifier.
const SILENT_FRAMES: u64 = 64;
/// Identifier of each drive.
const ID: u8 = 1;

/// Random numbers.
struct Random(u64);

impl Random {
    fn word(&mut self) -> u64 {
        splitmix64(&mut self.0)
    }

    fn below(&mut self, end: u64) -> u64 {
        self.word() % end
    }

    fn pick<T: Copy>(&mut self, items: &[T]) -> T {
        items[self.below(items.len() as u64) as usize]
    }

    /// Data of up to `most` bytes: noise, or numbers at which protocols decide.
    fn data(&mut self, most: usize) -> Vec<u8> {
        let mut data = vec![0; self.below(most as u64 + 1) as usize];
        let style = self.below(4);
        for chunk in data.chunks_mut(4) {
            let bytes = match style {
                0 => self.word() as u32,
                1 => self.below(32) as u32,
                2 => self.pick(&[f32::NAN, f32::INFINITY, -0.0, 1.0, -1e38, 1e-38, 0.1]).to_bits(),
                _ => self.pick(&[0, u32::MAX, 0x7FFF_FFFF, 0x8000_0000, 0xFFFF, 0x0101_0101]),
            };
            chunk.copy_from_slice(&bytes.to_le_bytes()[..chunk.len()]);
        }
        data
    }

    fn frame(&mut self, id: Id, most: usize) -> Frame {
        let kind = match most {
            64 => Kind::Flexible(self.below(2) == 0),
            _ => Kind::Classic,
        };
        if self.below(32) == 0 {
            return Frame::remote(id, self.below(9) as u8).expect("up to 8 bytes");
        }
        let data = self.data(most);
        Frame::with_kind(id, kind, &data).expect("a frame has room")
    }
}

/// Readings of a joint that turns.
fn sensors(random: &mut Random) -> Sensors {
    let lost = random.below(64) == 0;
    Sensors {
        motor_counts: (!lost).then(|| random.word() as u32 & 0x3FFF),
        output_counts: (random.below(64) != 0).then(|| random.word() as u32 & 0x1_FFFF),
        bus_voltage: random.pick(&[24.0, 24.0, 24.0, 5.0]),
        motor_temperature: 25.0,
        ..Sensors::default()
    }
}

/// Sends frames to a server, and its answers to its client.
fn storm(
    name: &str,
    settings: Settings,
    server: impl Fn() -> Box<dyn CanServer>,
    draw: impl Fn(&mut Random) -> Frame,
    decode: impl Fn(&Frame),
) {
    let mut random = Random(name.bytes().fold(1, |sum, byte| 31 * sum + u64::from(byte)));
    let (mut unit, mut server, frames) = (Drive::new(settings), (server(), server), count());
    let (mut answers, mut silence) = (0_u64, 0);
    for index in 0..frames {
        if index % FRAMES_A_LIFE == 0 || silence > SILENT_FRAMES {
            (unit, server.0, silence) = (Drive::new(settings), server.1(), 0);
        }
        let frame = draw(&mut random);
        let mut answered = Vec::new();
        server.0.receive(&frame, &mut unit, &mut |answer| answered.push(answer));
        if index % FRAMES_A_PERIOD == 0 {
            let torque = unit.step(&sensors(&mut random), None);
            assert!(!torque.is_nan(), "{name}: {frame:?}");
            server.0.tick(&mut unit, &mut |answer| answered.push(answer));
        }
        if random.below(1024) == 0 {
            server.0.bus_off(random.below(2) == 0, &mut unit, &mut |answer| answered.push(answer));
        }
        answers += answered.len() as u64;
        silence = if answered.is_empty() { silence + 1 } else { 0 };
        answered.iter().for_each(&decode);
        decode(&frame);
    }
    println!("{name}: {frames} frames, {answers} from the drive");
    assert!(answers > frames / 100, "{name}: the storm missed the drive");
}

/// Frames for each of the eight storms.
fn count() -> u64 {
    let all = std::env::var("STORM_FRAMES").map_or(SHORT, |count| count.parse().expect("a number of frames"));
    all / 8
}

#[test]
fn moteus_survives_a_storm() {
    let client = moteus::client::Client::new(ID);
    storm(
        "moteus",
        moteus::settings(Settings::default()),
        || Box::new(moteus::Server::new(ID)),
        |random| {
            let id = random.pick(&[0x8001, 0x8001, 0x0001, 0x0100, 0x807F]);
            random.frame(extended(id), 64)
        },
        |frame| {
            let _ = client.answers(frame).map(Iterator::count);
        },
    );
}

fn odrive(name: &str, firmware: odrive::Firmware) {
    storm(
        name,
        odrive::settings(Settings::default()),
        || Box::new(odrive::Server::new(ID, firmware)),
        |random| {
            let node = random.pick(&[1, 1, 1, 2, 0x3F]);
            let id = standard(node << 5 | random.below(32) as u16);
            random.frame(id, 8)
        },
        |frame| {
            let _ = odrive::client::decode(firmware, frame);
        },
    );
}

#[test]
fn odrive_0_5_survives_a_storm() {
    odrive("odrive 0.5", odrive::Firmware::V0_5);
}

#[test]
fn odrive_0_6_survives_a_storm() {
    odrive("odrive 0.6", odrive::Firmware::V0_6);
}

#[test]
fn damiao_survives_a_storm() {
    let ranges = damiao::MOTOR_TYPES[0].1;
    let client = damiao::Client { id: ID.into(), feedback_id: 0x11, ranges };
    storm(
        "damiao",
        damiao::settings(Settings::default()),
        || Box::new(damiao::Server::new(ID.into(), 0x11, ranges)),
        |random| {
            let id = random.pick(&[0x001, 0x101, 0x201, 0x301, 0x7FF]);
            let mut frame = random.frame(standard(id), 8);
            // Orders, and accesses to registers.
            if random.below(2) == 0 {
                let data = match id {
                    0x7FF => {
                        let code = random.pick(&[0x33, 0x55, 0xAA, 0xCC]);
                        let value = (random.word() as u32).to_le_bytes();
                        vec![1, 0, code, random.below(96) as u8, value[0], value[1], value[2], value[3]]
                    }
                    _ => [vec![0xFF; 7], vec![random.pick(&[0xFB, 0xFC, 0xFC, 0xFD, 0xFE])]].concat(),
                };
                frame = Frame::classic(standard(id), &data).expect("8 bytes");
            }
            frame
        },
        |frame| {
            let _ = client.decode(frame);
        },
    );
}

fn cybergear(name: &str, model: Model) {
    storm(
        name,
        cybergear::settings(model, Settings::default()),
        || Box::new(cybergear::Server::new(ID, model)),
        |random| {
            let kind = random.below(32) as u32;
            let id = kind << 24 | (random.word() as u32 & 0xFFFF) << 8 | u32::from(ID);
            let mut frame = random.frame(extended(id), 8);
            // Reads and writes of a parameter in the tables.
            if matches!(kind, 17 | 18) {
                let value = (random.word() as u32).to_le_bytes();
                let low = random.below(0x50) as u8;
                let data = [low, random.pick(&[0x20, 0x30, 0x70]), 0, 0, value[0], value[1], value[2], value[3]];
                frame = Frame::classic(extended(id), &data).expect("8 bytes");
            }
            frame
        },
        |frame| {
            let _ = Answer::decode(model, frame);
        },
    );
}

#[test]
fn cybergear_survives_a_storm() {
    cybergear("cybergear", Model::CyberGear);
}

#[test]
fn robstride_survives_a_storm() {
    cybergear("robstride", Model::RobStride03);
}

#[test]
fn cia402_survives_a_storm() {
    let entries = &cia402::dictionary::ENTRIES;
    storm(
        "cia402",
        cia402::settings(Settings::default()),
        || Box::new(cia402::Server::new(ID)),
        |random| {
            let id = random.pick(&[0x000, 0x080, 0x201, 0x301, 0x401, 0x501, 0x601, 0x601, 0x701, 0x77F]);
            let mut frame = random.frame(standard(id), 8);
            let command = random.pick(&[0x22, 0x23, 0x27, 0x2B, 0x2F, 0x40, 0x60, 0x70, 0x80]);
            // Objects of the dictionary; a started network.
            if id == 0x601 && random.below(8) != 0 {
                let address = entries[random.below(entries.len() as u64) as usize].address;
                let [low, high] = address.index.to_le_bytes();
                let noise = random.word() as u32;
                let value = random.pick(&[0, 1, 6, 15, 128, noise]).to_le_bytes();
                let data = [command, low, high, address.sub, value[0], value[1], value[2], value[3]];
                frame = Frame::classic(standard(id), &data).expect("8 bytes");
            } else if id == 0 && random.below(2) == 0 {
                frame = Frame::classic(standard(0), &[1, 0]).expect("2 bytes");
            }
            frame
        },
        |frame| {
            let _ = cia402::client::decode(ID, frame);
        },
    );
}

/// Packets with and without a right checksum, at the servo and at its client.
#[test]
fn feetech_survives_a_storm() {
    let mut random = Random(9);
    let settings = feetech::settings(Settings::default());
    let fresh = || (Drive::new(settings), feetech::Server::new(ID, &settings));
    let (mut unit, mut server) = fresh();
    let mut client = feetech::client::Answers::default();
    let (frames, mut answers, mut silence) = (count(), 0_u64, 0);
    for index in 0..frames {
        if index % FRAMES_A_LIFE == 0 || silence > SILENT_FRAMES {
            (unit, server) = fresh();
            silence = 0;
        }
        let mut packet = vec![0xFF, 0xFF, random.pick(&[ID, ID, 0xFE, 7]), 0, random.pick(&INSTRUCTIONS)];
        packet.extend(random.data(12));
        packet[3] = (packet.len() - 3) as u8;
        let sum = packet[2..].iter().fold(0_u8, |sum, byte| sum.wrapping_add(*byte));
        packet.push(if random.below(8) == 0 { random.word() as u8 } else { !sum });
        let mut answered = Vec::new();
        for byte in &packet {
            server.receive(*byte, &mut unit, &mut |bytes: &[u8]| answered.push(bytes.to_vec()));
        }
        if index % FRAMES_A_PERIOD == 0 {
            assert!(!unit.step(&sensors(&mut random), None).is_nan(), "{packet:?}");
            server.tick(&mut unit, &mut |bytes: &[u8]| answered.push(bytes.to_vec()));
        }
        answers += answered.len() as u64;
        silence = if answered.is_empty() { silence + 1 } else { 0 };
        for byte in answered.iter().flatten().chain(&packet) {
            let _ = client.receive(*byte);
        }
    }
    println!("feetech: {frames} packets, {answers} from the servo");
    assert!(answers > frames / 100);
}

/// Instructions of the protocol, and one that does not exist.
const INSTRUCTIONS: [u8; 11] = [1, 2, 3, 4, 5, 6, 8, 10, 11, 0x82, 0x83];
