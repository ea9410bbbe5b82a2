//! The longest form of every message fits into a frame, so that a board can send any message without checking its
//! length.

use heapless::Vec;
use link::framing::{Receiver, encode};
use link::messages::*;

const TIMING: Timing = Timing { min: u32::MAX, mean: u32::MAX, max: u32::MAX };

fn full<T: Clone, const LENGTH: usize>(item: T) -> Vec<T, LENGTH> {
    std::iter::repeat_n(item, LENGTH).collect()
}

fn text<const LENGTH: usize>() -> heapless::String<LENGTH> {
    "x".repeat(LENGTH).as_str().try_into().unwrap()
}

fn arrives(message: FromBoard) {
    let frame = encode(&message).expect("fits");
    let mut receiver = Receiver::new();
    assert_eq!(frame.iter().find_map(|&byte| receiver.push(byte)), Some(message));
}

#[test]
fn longest_hello_arrives() {
    arrives(FromBoard::Hello(Hello {
        protocol: u16::MAX,
        firmware_version: [u8::MAX; 3],
        role: Role::Plant,
        board: text(),
        joint: text(),
        joint_digest: u64::MAX,
        digest_good: true,
        tick_rate: u32::MAX,
        timer_rate: u32::MAX,
        clock: Clock { source: ClockSource::OtherFrequency { measured: u32::MAX }, tolerance: u32::MAX },
        planets: u8::MAX,
        queue_capacity: u16::MAX,
        last_panic: Some(text()),
        watchdog_reset: true,
        control_digest: Some(u64::MAX),
        memory: link::messages::MemoryState::OutOfRange,
        forced: true,
    }));
}

#[test]
fn longest_batch_arrives() {
    let sample = Sample {
        tick: u32::MAX,
        state_digest: u64::MAX,
        carrier_turns: i32::MIN,
        carrier_fraction: u32::MAX,
        carrier_speed: f32::MAX,
        motor_offset: f32::MAX,
        link_offset: f32::MAX,
        gap: f32::MAX,
        wind_up: f32::MAX,
        deflections: full(f32::MAX),
        contacts: u32::MAX,
        computation: u16::MAX,
    };
    arrives(FromBoard::Samples(SampleBatch { sequence: u16::MAX, samples: full(sample) }));
}

#[test]
fn longest_statistics_arrive() {
    arrives(FromBoard::Statistics(Statistics {
        ticks: u32::MAX,
        computation: TIMING,
        lateness: TIMING,
        histogram: [u32::MAX; HISTOGRAM_BINS],
        bin_width: u32::MAX,
        period: u32::MAX,
        idle_permille: u16::MAX,
        overruns: u32::MAX,
        starved: u32::MAX,
        waited: u32::MAX,
        queue_low: u16::MAX,
        lost_schedules: u32::MAX,
        bad_frames: u32::MAX,
        lost_bytes: u32::MAX,
        lost_samples: u32::MAX,
        lost_log_bytes: u32::MAX,
        static_ram: u32::MAX,
        stack_used: u32::MAX,
    }));
}

#[test]
fn longest_log_acceptance_and_fault_arrive() {
    arrives(FromBoard::Log(Log { sequence: u16::MAX, bytes: full(u8::MAX) }));
    arrives(FromBoard::Accepted(Accepted { sequence: u16::MAX, queue_free: u16::MAX, tick: u32::MAX }));
    arrives(FromBoard::Tripped(Trip::LateCommand { tick: u32::MAX }));
}

#[test]
fn memory_part_arrives_both_ways() {
    let part = MemoryPart { part: u8::MAX, bytes: full(u8::MAX) };
    arrives(FromBoard::Memory(part.clone()));
    arrives(FromBoard::MemoryChecked(MemoryState::OutOfRange));
    let message = ToBoard::Memory(MemoryRequest::Load(part));
    let mut receiver = Receiver::new();
    assert_eq!(encode(&message).unwrap().iter().find_map(|&byte| receiver.push(byte)), Some(message));
}

#[test]
fn longest_schedule_arrives() {
    let command = Command { tick: u32::MAX, drive_torque: f32::MAX, load_torque: f32::MAX };
    let message = ToBoard::Schedule(Schedule { sequence: u16::MAX, horizon: u32::MAX, commands: full(command) });
    let mut receiver = Receiver::new();
    assert_eq!(encode(&message).unwrap().iter().find_map(|&byte| receiver.push(byte)), Some(message));
}
