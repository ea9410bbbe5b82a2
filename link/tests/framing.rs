//! Frames on a bad line: a sent message arrives or is counted as dropped, and the receiver synchronises at the next
//! zero byte.

use link::framing::{MAX_FRAME, Receiver, encode, sealed, unsealed, unsealed_within_a_tick};
use link::messages::{COMMANDS_PER_SCHEDULE, Command, RunMode, RunSettings, Schedule, ToBoard};
use link::scanner::{Scanned, Scanner};
use proptest::collection::vec;
use proptest::prelude::*;

fn receive(receiver: &mut Receiver, bytes: &[u8]) -> Vec<ToBoard> {
    bytes.iter().filter_map(|&byte| receiver.push(byte)).collect()
}

fn command() -> impl Strategy<Value = Command> {
    (any::<u32>(), any::<f32>(), any::<f32>())
        .prop_filter("NaN is not equal to itself", |(_, drive, load)| !drive.is_nan() && !load.is_nan())
        .prop_map(|(tick, drive_torque, load_torque)| Command { tick, drive_torque, load_torque })
}

fn schedule() -> impl Strategy<Value = ToBoard> {
    (any::<u16>(), any::<u32>(), vec(command(), 0..=COMMANDS_PER_SCHEDULE)).prop_map(|(sequence, horizon, commands)| {
        ToBoard::Schedule(Schedule { sequence, horizon, commands: commands.into_iter().collect() })
    })
}

fn message() -> impl Strategy<Value = ToBoard> {
    let settings = (any::<bool>(), any::<u16>(), any::<u32>()).prop_map(|(lockstep, decimation, command_timeout)| {
        let mode = if lockstep { RunMode::Lockstep } else { RunMode::Realtime };
        ToBoard::Reset(RunSettings { mode, decimation, command_timeout, from_memory: false })
    });
    prop_oneof![
        any::<u16>().prop_map(|protocol| ToBoard::Hello { protocol }),
        any::<bool>().prop_map(|reset| ToBoard::Statistics { reset }),
        Just(ToBoard::Stop),
        settings,
        schedule(),
    ]
}

proptest! {
    #[test]
    fn messages_arrive_in_order(messages in vec(message(), 1..8)) {
        let mut receiver = Receiver::new();
        let bytes: Vec<u8> = messages.iter().flat_map(|message| encode(message).unwrap()).collect();
        prop_assert_eq!(receive(&mut receiver, &bytes), messages);
        prop_assert_eq!(receiver.dropped().frames, 0);
    }

    #[test]
    fn only_last_byte_of_frame_is_zero(message in message()) {
        let frame = encode(&message).unwrap();
        prop_assert_eq!(frame.iter().position(|&byte| byte == 0), Some(frame.len() - 1));
        prop_assert!(frame.len() <= MAX_FRAME);
    }

    #[test]
    fn receiver_resynchronises_at_zero(
        garbage in vec(any::<u8>(), 0..2 * MAX_FRAME),
        message in message(),
    ) {
        let mut receiver = Receiver::new();
        let mut bytes = garbage;
        bytes.push(0);
        let before = receive(&mut receiver, &bytes);
        prop_assert!(before.is_empty(), "garbage was taken for {:?}", before);
        prop_assert_eq!(receive(&mut receiver, &encode(&message).unwrap()), vec![message]);
    }

    #[test]
    fn changed_byte_is_rejected(message in message(), place in any::<prop::sample::Index>(), change in 1_u8..) {
        let mut frame = encode(&message).unwrap();
        let last = frame.len() - 1;
        let place = place.index(last);
        frame[place] ^= change;
        let mut receiver = Receiver::new();
        prop_assert!(receive(&mut receiver, &frame).is_empty());
        prop_assert!(receiver.dropped().frames > 0);
    }

    #[test]
    fn half_frame_costs_one_frame(first in message(), second in message(), place in any::<prop::sample::Index>()) {
        let frame = encode(&first).unwrap();
        let missing = 1 + place.index(frame.len() - 1);
        let mut receiver = Receiver::new();
        let mut bytes = frame[missing..].to_vec();
        bytes.extend(encode(&second).unwrap());
        prop_assert_eq!(receive(&mut receiver, &bytes), vec![second]);
    }

    #[test]
    fn scanner_agrees_with_receiver(
        pieces in vec((message(), vec(any::<u8>(), 0..4), any::<prop::sample::Index>(), any::<Option<u8>>()), 1..12)
    ) {
        let (mut receiver, mut scanner) = (Receiver::new(), Scanner::new());
        for (message, garbage, place, change) in pieces {
            let mut bytes = garbage;
            bytes.extend(encode(&message).unwrap());
            if let Some(change) = change {
                let place = place.index(bytes.len());
                bytes[place] ^= change;
            }
            for byte in bytes {
                let (taken, scanned) = (receiver.push::<ToBoard>(byte), scanner.push(byte));
                prop_assert_eq!(taken.is_some(), scanned.is_some());
                prop_assert_eq!(taken == Some(ToBoard::Stop), scanned.is_some_and(ToBoard::is_stop));
            }
        }
    }

    #[test]
    fn lost_end_costs_two_frames(first in message(), second in message(), third in message()) {
        let frame = encode(&first).unwrap();
        let mut bytes = frame[..frame.len() - 1].to_vec();
        bytes.extend(encode(&second).unwrap());
        bytes.extend(encode(&third).unwrap());
        let mut receiver = Receiver::new();
        prop_assert_eq!(receive(&mut receiver, &bytes), vec![third]);
        prop_assert_eq!(receiver.dropped().frames, 1);
    }
}

#[test]
fn overlong_frame_is_counted_once() {
    let mut receiver = Receiver::new();
    let mut bytes = vec![7; 10 * MAX_FRAME];
    bytes.push(0);
    assert!(receive(&mut receiver, &bytes).is_empty());
    assert_eq!(receiver.dropped().frames, 1);
    assert_eq!(receive(&mut receiver, &encode(&ToBoard::Stop).unwrap()), [ToBoard::Stop]);
}

#[test]
fn scanner_skips_overlong_frames() {
    let mut scanner = Scanner::new();
    assert!((0..10 * MAX_FRAME).all(|_| scanner.push(7).is_none()) && scanner.push(0).is_none());
    let long = encode(&([[1_u8; 20]; 20])).unwrap();
    let scanned: Vec<_> = long.iter().filter_map(|&byte| scanner.push(byte)).collect();
    assert_eq!(scanned, [Scanned { length: 400, first: 1 }]);
}

#[test]
fn checksum_alone_is_no_frame() {
    // COBS of four zero bytes: the valid checksum of an empty message.
    let (mut receiver, mut scanner) = (Receiver::new(), Scanner::new());
    for byte in [1, 1, 1, 1, 1, 0] {
        assert_eq!((receiver.push::<ToBoard>(byte), scanner.push(byte)), (None, None));
    }
    assert_eq!(receiver.dropped().frames, 1);
}

#[test]
fn zero_bytes_between_frames_are_ignored() {
    let mut receiver = Receiver::new();
    assert!(receive(&mut receiver, &[0; 100]).is_empty());
    assert_eq!(receiver.dropped().frames, 0);
}

#[test]
fn padded_number_is_a_bad_frame() {
    // A hello is its variant number, 0, and the protocol version: 7 as one byte, or padded with zero bits.
    for (short, long) in [(&[0, 7][..], &[0, 0x87, 0][..]), (&[0, 7], &[0x80, 0, 7]), (&[0, 7], &[0, 0x87, 0x80, 0])] {
        let mut receiver = Receiver::new();
        let message = ToBoard::Hello { protocol: 7 };
        assert_eq!(receive(&mut receiver, &encode(&Raw(short)).unwrap()), [message], "{short:?}");
        assert!(receive(&mut receiver, &encode(&Raw(long)).unwrap()).is_empty(), "{long:?}");
        assert_eq!(receiver.dropped().frames, 1);
    }
}

#[test]
fn padded_number_is_bad_in_fixed_length() {
    for (bytes, good) in
        [(&[0, 7][..], true), (&[0, 0x87, 0], false), (&[0x80, 0, 7], false), (&[0, 0x87, 0x80, 0], false)]
    {
        let mut frame = [0; 32];
        sealed(&Raw(bytes), &mut frame).unwrap();
        let message = ToBoard::Hello { protocol: 7 };
        assert_eq!(unsealed(&frame), good.then_some(message), "{bytes:?}");
    }
}

#[test]
fn trailing_nonzero_is_bad_in_fixed_length() {
    for (bytes, good) in [(&[0, 7, 0][..], true), (&[0, 7, 1], false), (&[0, 7, 0, 0, 1], false)] {
        let mut frame = [0; 32];
        sealed(&Raw(bytes), &mut frame).unwrap();
        assert_eq!(unsealed::<ToBoard>(&frame).is_some(), good, "{bytes:?}");
        assert!(unsealed_within_a_tick::<ToBoard>(&frame).is_some(), "{bytes:?}");
    }
}

/// Message given as encoded bytes.
struct Raw<'b>(&'b [u8]);

impl serde::Serialize for Raw<'_> {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        use serde::ser::SerializeTuple;
        let mut tuple = serializer.serialize_tuple(self.0.len())?;
        self.0.iter().try_for_each(|byte| tuple.serialize_element(byte))?;
        tuple.end()
    }
}

#[test]
fn trailing_bytes_are_a_bad_frame() {
    let stop_and_more = encode(&(ToBoard::Stop, 7_u32)).unwrap();
    let mut receiver = Receiver::new();
    assert!(receive(&mut receiver, &stop_and_more).is_empty());
    assert_eq!(receiver.dropped().frames, 1);
}
