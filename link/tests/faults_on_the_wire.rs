//! Byte-exact wire form of injected faults and of trip reasons: boards and hosts of one protocol version must
//! understand each other, whatever the types are called. Framing has tests of its own.

use link::messages::{FromBoard, ToBoard, Trip};
use model_core::virtual_joint::fault::{EncoderShaft, Fault, FaultKind, FixedPoint};
use postcard::{from_bytes, to_slice};
use serde::Serialize;

fn bytes(message: &impl Serialize) -> Vec<u8> {
    let mut buffer = [0; 64];
    to_slice(message, &mut buffer).expect("there is room").to_vec()
}

fn fault(kind: FaultKind<FixedPoint<f32>>) -> ToBoard {
    ToBoard::Fault(Fault { start: 30_000, end: u32::MAX, seed: 0x0123_4567_89ab_cdef, kind })
}

/// The variant, periods and seed of [`fault`].
const HEAD: [u8; 18] =
    [0x08, 0xb0, 0xea, 0x01, 0xff, 0xff, 0xff, 0xff, 0x0f, 0xef, 0x9b, 0xaf, 0xcd, 0xf8, 0xac, 0xd1, 0x91, 0x01];

#[test]
fn fault_bytes_are_unchanged() {
    let kinds: [(FaultKind<FixedPoint<f32>>, &[u8]); 9] = [
        (FaultKind::Frozen(EncoderShaft::Motor), &[0x00, 0x00]),
        (FaultKind::Frozen(EncoderShaft::Link), &[0x00, 0x01]),
        (FaultKind::Offset(EncoderShaft::Link, -300), &[0x01, 0x01, 0xd7, 0x04]),
        (FaultKind::Noise(EncoderShaft::Motor, 98_304), &[0x02, 0x00, 0x80, 0x80, 0x06]),
        (FaultKind::MissingCounts(EncoderShaft::Link, 42_949_672), &[0x03, 0x01, 0xa8, 0xb8, 0xbd, 0x14]),
        (FaultKind::Eccentric(EncoderShaft::Motor, -1193.5), &[0x04, 0x00, 0x00, 0x30, 0x95, 0xc4]),
        (FaultKind::LostReadings(EncoderShaft::Link, u32::MAX), &[0x05, 0x01, 0xff, 0xff, 0xff, 0xff, 0x0f]),
        (FaultKind::TorqueBias(0.05, -0.25), &[0x06, 0xcd, 0xcc, 0x4c, 0x3d, 0x00, 0x00, 0x80, 0xbe]),
        (FaultKind::Saturation(1.5), &[0x07, 0x00, 0x00, 0xc0, 0x3f]),
    ];
    for (kind, tail) in kinds {
        let message = fault(kind);
        assert_eq!(bytes(&message), [&HEAD, tail].concat(), "{kind:?}");
        assert_eq!(from_bytes::<ToBoard>(&[&HEAD, tail].concat()), Ok(message));
    }
    for (taken, byte) in [(false, 0x00), (true, 0x01)] {
        assert_eq!(bytes(&FromBoard::FaultTaken { taken }), [0x09, byte]);
    }
}

#[test]
fn unknown_fault_is_no_message() {
    for tail in [[0x08, 0x00], [0x09, 0x00], [0x00, 0x02]] {
        assert!(from_bytes::<ToBoard>(&[&HEAD[..], &tail].concat()).is_err(), "{tail:?}");
    }
}

#[test]
fn trip_bytes_are_unchanged() {
    let tick = 300;
    let trips: [(Trip, &[u8]); 11] = [
        (Trip::CommandLoss { tick }, &[0x04, 0x00, 0xac, 0x02]),
        (Trip::NotFinite { tick }, &[0x04, 0x01, 0xac, 0x02]),
        (Trip::BadCommand { tick }, &[0x04, 0x02, 0xac, 0x02]),
        (Trip::LateCommand { tick }, &[0x04, 0x03, 0xac, 0x02]),
        (Trip::BadDigest, &[0x04, 0x04]),
        (Trip::QueueFull, &[0x04, 0x05]),
        (Trip::BadSettings, &[0x04, 0x06]),
        (Trip::NotRunning, &[0x04, 0x07]),
        (Trip::WrongRole, &[0x04, 0x08]),
        (Trip::FarHorizon { tick }, &[0x04, 0x09, 0xac, 0x02]),
        (Trip::Overtaken, &[0x04, 0x0a]),
    ];
    for (trip, expected) in trips {
        assert_eq!(bytes(&FromBoard::Tripped(trip)), expected, "{trip:?}");
        assert_eq!(from_bytes::<FromBoard>(expected), Ok(FromBoard::Tripped(trip)));
    }
}
