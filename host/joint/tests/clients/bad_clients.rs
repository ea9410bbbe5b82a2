//! Clients that send nonsense, do not read, or disappear: the twin stays responsive and ends in order.

use serde_json::Value;

use crate::command::until;
use crate::line::Line;
use crate::twin::Twin;

/// Request for the estimates of ODrive 1 over slcan, and the beginning of the answer.
const ESTIMATES: (&str, &str) = ("r0298\r", "t0298");
/// Bus voltage of ODrive 1: request, and the beginning of the answer. No cyclic message has the identifier.
pub const VOLTAGE: (&str, &str) = ("r0378\r", "t0378");
/// Answer of moteus 1 on fdcanusb, up to its data.
const MOTEUS_ANSWER: &str = "rcv 100 ";
/// Request for the mode of moteus 1.
const MOTEUS_MODE: &str = "can send 8001 1100 BF";

/// Number in a line of the summary such as `7 malformed`.
pub fn count(summary: &str, words: &str) -> u64 {
    let before = summary.split(words).next().filter(|before| before.len() < summary.len());
    let number = before.and_then(|before| before.split_whitespace().last()).and_then(|word| word.parse().ok());
    number.unwrap_or_else(|| panic!("no number of `{words}` in {summary}"))
}

#[test]
fn slcan_half_frames_and_garbage_are_counted() {
    let twin = Twin::start("odrive", &[]);
    let mut line = Line::terminal(twin.port());
    line.say("C\rS8\rO\r");
    // A frame in two halves is one frame.
    line.say("r02");
    std::thread::sleep(std::time::Duration::from_millis(100));
    line.say("98\r");
    line.hears(ESTIMATES.1);
    // Five lines that are no frames: short, too long, no digits, identifier too large, not ASCII.
    line.say("t029\rt0298\rtxyz0\rtFFF0\r");
    line.send(b"t\xC3\xA40\r");
    line.forget();
    line.say(ESTIMATES.0);
    line.hears(ESTIMATES.1);
    let summary = twin.end();
    assert_eq!(count(&summary, " malformed"), 5, "{summary}");
}

#[test]
fn fdcanusb_wrong_checksum_is_refused() {
    let twin = Twin::start("moteus", &[]);
    let mut line = Line::terminal(twin.port());
    line.say(&format!("{MOTEUS_MODE} *00\n"));
    line.hears("ERR checksum");
    assert!(!line.has(b"rcv "), "the frame went to the drive");
    // Without a checksum the next line is taken.
    line.say(&format!("{MOTEUS_MODE}\n"));
    line.hears(MOTEUS_ANSWER);
    let summary = twin.end();
    assert_eq!(count(&summary, " malformed"), 1, "{summary}");
}

#[test]
fn feetech_wrong_checksum_gets_no_answer() {
    // Ping of servo 1: length, instruction, complement of the sum.
    const PING: [u8; 6] = [0xFF, 0xFF, 1, 2, 1, 0xFB];
    const ANSWER: [u8; 5] = [0xFF, 0xFF, 1, 2, 0];
    let twin = Twin::start("feetech", &[]);
    let mut line = Line::terminal(twin.port());
    line.send(&[0xFF, 0xFF, 1, 2, 1, 0xFA]);
    // Half a packet, which the next one must not complete.
    line.send(&[0xFF, 0xFF, 1, 4, 2]);
    std::thread::sleep(std::time::Duration::from_millis(500));
    line.forget();
    until("the servo answers", || {
        line.send(&PING);
        std::thread::sleep(std::time::Duration::from_millis(100));
        line.read();
        line.has(&ANSWER)
    });
    twin.end();
}

#[test]
fn frames_for_other_drives_are_ignored() {
    let twin = Twin::start("odrive", &[]);
    let mut line = Line::terminal(twin.port());
    line.say("O\r");
    let before = twin.status();
    // All other nodes are told to close their loops, then a CANopen master and a 29-bit client speak.
    for node in (0..64).filter(|node| *node != 1 && *node != 63) {
        line.say(&format!("t{:03X}408000000\r", node << 5 | 0x07));
    }
    line.say(&format!("t00020101\rT0300FD018{}\r", "00".repeat(8)));
    line.say(ESTIMATES.0);
    line.hears(ESTIMATES.1);
    let after = twin.status();
    assert_eq!(before["state"], after["state"]);
    assert_eq!(after["fault"], Value::Null);
    let summary = twin.end();
    assert!(!summary.contains("malformed"), "{summary}");
}

#[test]
fn flood_without_reading_drops_answers_only() {
    const FRAMES: usize = 100_000;
    let twin = Twin::start("odrive", &[]);
    let mut line = Line::terminal(twin.port());
    line.say("O\r");
    let burst = ESTIMATES.0.repeat(1000);
    for _ in 0..FRAMES / 1000 {
        line.say(&burst);
    }
    // The control socket is answered all the while; the line is, once the client reads again.
    assert_eq!(twin.status()["fault"], Value::Null);
    // No request of the flood has this answer, and requests are answered in their order.
    until("the flood is over", || {
        line.say(VOLTAGE.0);
        line.read();
        line.has(VOLTAGE.1.as_bytes())
    });
    let summary = twin.end();
    assert!(count(&summary, " from clients") > FRAMES as u64, "no frame of the client is lost: {summary}");
    assert!(count(&summary, " not read in time") > 1000, "{summary}");
}

#[test]
fn socketcand_clients_share_the_bus() {
    let twin = Twin::start("odrive", &["--wire", "socketcand", "--port", "0"]);
    let [mut first, mut second] = [(); 2].map(|()| Line::socketcand(twin.port()));
    // Version: asked for by one of them, and heard by both. A frame cut by a pause is one frame.
    first.say("< send 020 8 0 0 0 ");
    std::thread::sleep(std::time::Duration::from_millis(100));
    first.say("0 0 0 0 0 >");
    for line in [&mut first, &mut second] {
        line.hears("< frame 021 ");
    }
    // Nonsense of the second does not concern the first: no number, too few bytes, no bracket, no such command.
    second.say("< send zz 1 1 >< send 020 2 1 >nonsense>< unknown >");
    second.hears("< error unknown command >");
    drop(second);
    first.forget();
    first.hears("< frame 021 ");
    let summary = twin.end();
    assert_eq!(count(&summary, " malformed"), 3, "{summary}");
}

/// An ODrive turns at a rotor turn a second under a watchdog of 2 s when its client is cut off.
#[test]
fn odrive_client_lost_in_motion_disarms() {
    let twin = Twin::start("odrive", &["--wire", "socketcand", "--port", "0"]);
    let mut line = Line::socketcand(twin.port());
    // Velocity control, closed loop, 1 turn/s; watchdog_timeout = 2 s, enable_watchdog.
    line.say("< send 02B 8 2 0 0 0 1 0 0 0 >< send 027 4 8 0 0 0 >< send 02D 8 0 0 80 3f 0 0 0 0 >");
    line.say("< send 024 8 1 c8 0 0 0 0 0 40 >< send 024 5 1 c9 0 0 1 >");
    until("the drive is enabled", || twin.status()["state"] == "Enabled");
    drop(line);
    until("the drive is off", || twin.status()["state"] == "Disabled");
    assert_eq!(twin.status()["fault"], "Watchdog");
    // The bus is there for the next client.
    Line::socketcand(twin.port()).hears("< frame 021 ");
    twin.end();
}

/// A moteus turns when its client closes the terminal: its default watchdog of 0.1 s damps the motion.
#[test]
fn moteus_client_lost_in_motion_times_out() {
    let twin = Twin::start("moteus", &[]);
    let mut line = Line::terminal(twin.port());
    // Mode 10; position NaN and velocity 0.2 turns/s.
    line.say("can send 8001 01000A0E200000C07FCDCC4C3E BF\n");
    line.hears("OK");
    drop(line);
    until("the watchdog expires", || twin.status()["state"] == "TimedOut");
    let mut line = Line::terminal(twin.port());
    line.say(&format!("{MOTEUS_MODE}\n"));
    line.hears("rcv 100 21000B");
    twin.end();
}
