//! Tests of the AS5047P driver against a bus that expects every byte: frames, parity, error flag, missing encoder.
//! Angles and errors are invented; the driver may read no other register.

use embedded_hal_mock::eh1::spi::{Mock, Transaction};
use firmware::encoder::{As5047p, CountSource, EncoderFault};
use model_core::observer::Reading;

/// Read ANGLECOM: address 0x3fff, read bit, even parity.
const ANGLE: u16 = 0xffff;
/// Read ERRFL.
const ERRORS: u16 = 0x4001;
/// Read DIAAGC.
const DIAGNOSTICS: u16 = 0xfffc;

/// Even parity over an answer.
fn answer(content: u16) -> u16 {
    content | if content.count_ones().is_multiple_of(2) { 0 } else { 0x8000 }
}

/// Encoder with expected commands and given answers.
fn encoder(frames: &[(u16, u16)]) -> As5047p<Mock<u8>> {
    let transactions = frames.iter().flat_map(|(command, answer)| {
        [
            Transaction::transaction_start(),
            Transaction::transfer_in_place(command.to_be_bytes().to_vec(), answer.to_be_bytes().to_vec()),
            Transaction::transaction_end(),
        ]
    });
    As5047p::new(Mock::new(&transactions.collect::<Vec<_>>()))
}

/// Diagnostics of a good magnet: ready, the gain in its middle.
const WELL: u16 = 0x0180;

/// Results of reads in every tick after the encoder was found good; the clock advances by ten per tick.
fn reads(frames: &[(u16, u16)], ticks: u32) -> Vec<Result<Reading, EncoderFault>> {
    let first = [(ANGLE, 0), (ANGLE, answer(1)), (DIAGNOSTICS, answer(1)), (ANGLE, answer(WELL))];
    // The first frame answers an earlier request.
    let mut encoder = encoder(&[&first[..], &frames[1..]].concat());
    assert_eq!(encoder.read(0), Err(EncoderFault::Pending));
    assert_eq!(encoder.read(0), Ok(Reading { counts: 1, time: 0 }));
    let mut list = vec![Err(EncoderFault::Pending)];
    list.extend((1..ticks).map(|tick| encoder.read(10 * tick)));
    encoder.release().done();
    list
}

/// Results of reads in every tick from the first read on.
fn first_reads(frames: &[(u16, u16)], ticks: u32) -> Vec<Result<Reading, EncoderFault>> {
    let mut encoder = encoder(frames);
    let list = (0..ticks).map(|tick| encoder.read(10 * tick)).collect();
    encoder.release().done();
    list
}

/// With the time of the request.
#[test]
fn angle_arrives_one_tick_later() {
    let frames = [(ANGLE, 0x1234), (ANGLE, answer(0x2abc)), (ANGLE, answer(0x0001)), (ANGLE, answer(0x3fff))];
    let expected = [
        Err(EncoderFault::Pending),
        Ok(Reading { counts: 0x2abc, time: 0 }),
        Ok(Reading { counts: 1, time: 10 }),
        Ok(Reading { counts: 0x3fff, time: 20 }),
    ];
    assert_eq!(reads(&frames, 4), expected);
}

#[test]
fn every_flipped_bit_detected() {
    for bit in 0..16 {
        let frames = [(ANGLE, 0), (ANGLE, answer(0x1a5) ^ 1 << bit)];
        assert_eq!(reads(&frames, 2)[1], Err(EncoderFault::Parity), "bit {bit}");
    }
}

/// The next angle is good.
#[test]
fn reading_reason_clears_error_flag() {
    let frames = [
        (ANGLE, 0),
        (ANGLE, answer(0x4123)),
        (ERRORS, answer(0x4123)),
        (ANGLE, answer(0x0004)),
        (ANGLE, answer(0x0777)),
    ];
    let expected =
        [Err(EncoderFault::Pending), Err(EncoderFault::Reported(4)), Ok(Reading { counts: 0x777, time: 10 })];
    assert_eq!(reads(&frames, 3), expected);
}

/// A line that no encoder drives reads as missing, pulled up or down.
#[test]
fn undriven_line_is_no_encoder() {
    assert_eq!(reads(&[(ANGLE, 0xffff), (ANGLE, 0xffff)], 2)[1], Err(EncoderFault::Missing));
    let low = [(ANGLE, 0), (ANGLE, 0), (DIAGNOSTICS, 0), (ANGLE, 0)];
    assert_eq!(reads(&low, 2)[1], Err(EncoderFault::Missing));
}

#[test]
fn angle_zero_accepted_after_diagnostics() {
    let frames = [(ANGLE, 0), (ANGLE, 0), (DIAGNOSTICS, 0), (ANGLE, answer(0x0180)), (ANGLE, answer(3))];
    let expected =
        [Err(EncoderFault::Pending), Ok(Reading { counts: 0, time: 0 }), Ok(Reading { counts: 3, time: 10 })];
    assert_eq!(reads(&frames, 3), expected);
}

#[test]
fn damaged_reason_is_bad_reading() {
    let frames = [(ANGLE, 0), (ANGLE, answer(0x4123)), (ERRORS, answer(0x4123)), (ANGLE, 0x0001)];
    assert_eq!(reads(&frames, 2)[1], Err(EncoderFault::Parity));
}

#[test]
fn reading_time_correct_after_fault() {
    let frames = [(ANGLE, 0), (ANGLE, answer(5) ^ 1), (ANGLE, answer(6))];
    let expected = [Err(EncoderFault::Pending), Err(EncoderFault::Parity), Ok(Reading { counts: 6, time: 10 })];
    assert_eq!(reads(&frames, 3), expected);
}

/// A magnet that is too weak, too strong or missing is reported until it is good again.
#[test]
fn magnet_faults_reported_by_name() {
    let cases = [
        (0x0980 | 0x7f, EncoderFault::MagnetTooWeak),
        (0x0500, EncoderFault::MagnetTooStrong),
        (0x0aff, EncoderFault::MagnetLost),
        (0x08ff, EncoderFault::MagnetLost),
        (0x0380, EncoderFault::MagnetLost),
    ];
    for (diagnostics, fault) in cases {
        let angle = (ANGLE, answer(7));
        let look = |found: u16| vec![angle, (DIAGNOSTICS, answer(7)), (ANGLE, answer(found))];
        // Found at the first check, gone at the next, 256 readings later.
        let frames = [vec![(ANGLE, 0)], look(diagnostics), vec![angle; 255], look(WELL), vec![angle]].concat();
        let list = first_reads(&frames, 1 + 256 + 2);
        assert!(list[1..257].iter().all(|read| *read == Err(fault)), "{diagnostics:#x}");
        assert!(list[257..].iter().all(|read| matches!(read, Ok(Reading { counts: 7, .. }))), "{diagnostics:#x}");
    }
}
