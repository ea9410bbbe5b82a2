use super::*;
use drives::frame::{Kind, extended, standard};

fn frames(wire: &mut dyn Wire, text: &str) -> Vec<Frame> {
    let packets = wire.receive(text.as_bytes());
    packets
        .into_iter()
        .filter_map(|received| match received {
            Received::Packet(Packet::Frame(frame)) => Some(frame),
            _ => None,
        })
        .collect()
}

fn encoded(wire: &mut dyn Wire, frame: &Frame) -> String {
    String::from_utf8(wire.encode(&Packet::Frame(frame.clone())).unwrap_or_default()).unwrap()
}

#[test]
fn slcan_frames_round_trip() {
    let mut slcan = wire(WireName::Slcan);
    assert_eq!(frames(&mut *slcan, "t0213010203\r"), [], "a closed adapter sends nothing");
    slcan.receive(b"C\rS8\r\rO\r");
    let sent = [
        Frame::classic(standard(0x21), &[1, 2, 3]).unwrap(),
        Frame::classic(extended(0x0300_FD01), &[0; 8]).unwrap(),
        Frame::remote(standard(0x29), 8).unwrap(),
        Frame::flexible(extended(0x8001), &[7; 12], 0).unwrap(),
        Frame::with_kind(standard(1), Kind::Flexible(false), &[9; 64]).unwrap(),
    ];
    for frame in sent {
        let text = encoded(&mut *slcan, &frame);
        assert_eq!(frames(&mut *slcan, &text), [frame], "{text}");
    }
    assert_eq!(frames(&mut *slcan, "t0213010203\r")[0].data(), [1, 2, 3]);
}

#[test]
fn slcan_rejects_malformed_lines() {
    let mut slcan = wire(WireName::Slcan);
    slcan.receive(b"O\r");
    for line in ["t", "t0", "t021", "t0219", "tFFF0", "t02110", "T2000000000", "\u{e4}", "t0211\u{e4}\u{e4}", "r0211FF"]
    {
        assert_eq!(slcan.receive(format!("{line}\r").as_bytes()), [Received::Malformed], "{line}");
    }
    let long = [b'x'; 10_000];
    slcan.receive(&long);
    assert_eq!(slcan.receive(b"\rt0210\r").len(), 2);
}

/// Lines of moteus 1.1.1, with the checksums of its client.
#[test]
fn fdcanusb_answers_with_a_checksum_to_a_checksum() {
    let mut line = wire(WireName::Fdcanusb);
    assert_eq!(line.receive(b"can send 8001 1100 BF\n").len(), 2);
    assert_eq!(line.receive(b"can send 8001 1100 bf\n")[0], Received::Answer(b"OK\r\n".into()), "without a checksum");
    let frame = Frame::flexible(standard(0x100), &[0x21, 0x00], 0).unwrap();
    assert_eq!(encoded(&mut *line, &frame), "rcv 100 2100 e B F\r\n");
    let wrong = line.receive(b"can send 8001 1100 BF *00\n");
    assert_eq!(wrong[0], Received::Malformed);
}

#[test]
fn fdcanusb_reads_flags_and_lengths() {
    let mut line = wire(WireName::Fdcanusb);
    let kinds = |text: &str, line: &mut dyn Wire| frames(line, text).first().map(|frame| (frame.kind, frame.length()));
    assert_eq!(kinds("can std 10 0102 f\n", &mut *line), Some((Kind::Classic, 2)));
    assert_eq!(kinds("can ext 10 010203040506070809 b F\n", &mut *line), Some((Kind::Flexible(false), 12)));
    assert_eq!(kinds("can send 10 F\n", &mut *line), Some((Kind::Flexible(true), 0)));
    assert_eq!(kinds("can std 10 010203040506070809 f\n", &mut *line), None, "nine bytes are no classical frame");
    assert_eq!(kinds("can std 800 01\n", &mut *line), None);
}

#[test]
fn socketcand_greets_opens_and_transfers() {
    let mut line = wire(WireName::Socketcand);
    assert_eq!(line.greeting(), b"< hi >");
    assert_eq!(line.receive(b"< open can0 >< rawmode >").len(), 2);
    let sent = frames(&mut *line, "< send 021 3 1 2 3 >");
    assert_eq!(sent, [Frame::classic(standard(0x21), &[1, 2, 3]).unwrap()]);
    let text = encoded(&mut *line, &sent[0]);
    assert!(text.starts_with("< frame 021 ") && text.ends_with(" 010203 >"), "{text}");
    assert_eq!(frames(&mut *line, "< send 00000021 0 >")[0].extended_id(), Some(0x21));
    assert_eq!(line.receive(b"< send 021 3 1 2 >"), [Received::Malformed]);
}

#[test]
fn serial_bytes_are_cut_at_packets() {
    let mut line = wire(WireName::Serial);
    let ping = [0xFF, 0xFF, 1, 2, 1, 0xFB];
    let two: Vec<u8> = ping.iter().chain(&ping).chain(&ping[..3]).copied().collect();
    let whole = Received::Packet(Packet::Bytes(ping.into()));
    assert_eq!(line.receive(&two), [whole.clone(), whole, Received::Part(ping[..3].into())]);
    assert_eq!(line.receive(&ping[3..]), [Received::Packet(Packet::Bytes(ping[3..].into()))]);
}

/// Frames as a client writes them, with some bytes changed, dropped or repeated.
#[test]
fn wires_survive_a_storm() {
    const LINES: [&str; 9] = [
        "t0218DEADBEEF00112233\r",
        "T0300FD01800000000000000FF\r",
        "b80010123456789ABCDEF\r",
        "r0298\rO\rV\r",
        "can send 8001 01000A0E200000C07FCDCC4C3E BF *5A\n",
        "can std 100 1100 r\ncan ext 1FFFFFFF bF t5\n",
        "< send 020 8 0 0 0 0 0 0 0 0 >",
        "< open can0 >< rawmode >< send 12345678 1 FF >",
        "\u{ff}\u{ff}\u{1}\u{4}\u{2}\u{38}\u{2}\u{be}",
    ];
    let count: u64 = std::env::var("STORM_FRAMES").map_or(40_000, |count| count.parse().expect("a number of lines"));
    let mut state = 1;
    let mut word = || model_core::numbers::random::splitmix64(&mut state);
    for name in [WireName::Slcan, WireName::Fdcanusb, WireName::Socketcand, WireName::Serial] {
        let (mut wire, mut packets) = (wire(name), 0_u64);
        for _ in 0..count / 4 {
            let line = LINES[word() as usize % LINES.len()];
            let mut bytes: Vec<u8> = line.chars().map(|letter| letter as u8).collect();
            for _ in 0..word() % 3 {
                let at = word() as usize % bytes.len();
                match word() % 4 {
                    0 => bytes[at] = word() as u8,
                    1 => drop(bytes.remove(at)),
                    2 => bytes.insert(at, bytes[at]),
                    _ => bytes.truncate(at + 1),
                }
            }
            for received in wire.receive(&bytes) {
                if let Received::Packet(packet) = received {
                    packets += 1;
                    let _ = wire.encode(&packet);
                }
            }
        }
        println!("{name:?}: {} lines, {packets} packets", count / 4);
        assert!(packets > count / 400, "{name:?}: {packets}");
    }
}
