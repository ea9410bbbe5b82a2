//! Benchmark: time from a request of a client to the drive's answer, through the pseudo-terminal.

use std::fs::File;
use std::io::{Read, Write};
use std::time::{Duration, Instant};

use crate::line::Line;
use crate::twin::Twin;

/// Round trips of each drive.
const COUNT: usize = 20_000;

/// Measures round trips and prints their median, 99 % and largest values.
fn measure(name: &str, drive: &str, arguments: &[&str], opening: &str, request: &[u8], answer: &[u8]) {
    let twin = Twin::endless(drive, arguments);
    let mut line = Line::terminal(twin.port());
    line.say(opening);
    line.send(request);
    line.hears_bytes(answer);
    drop(line);
    let mut port = File::options().read(true).write(true).open(twin.port()).expect("the terminal of the twin");
    let mut times: Vec<Duration> = Vec::with_capacity(COUNT);
    let (mut buffer, mut heard) = ([0; 4096], Vec::<u8>::new());
    for _ in 0..COUNT {
        let begun = Instant::now();
        port.write_all(request).expect("the twin reads");
        while !heard.windows(answer.len()).any(|part| part == answer) {
            let count = port.read(&mut buffer).expect("the twin answers");
            heard.extend(&buffer[..count]);
        }
        times.push(begun.elapsed());
        heard.clear();
    }
    times.sort();
    let [median, high, worst] = [COUNT / 2, COUNT * 99 / 100, COUNT - 1].map(|index| 1e6 * times[index].as_secs_f64());
    println!("{name}: median {median:.0} us, 99 % {high:.0} us, largest {worst:.0} us of {COUNT}");
    twin.end();
}

#[test]
#[ignore = "benchmark: cargo test --release -p joint --test clients round_trips -- --ignored --nocapture"]
fn round_trips_take_microseconds() {
    measure("odrive, slcan", "odrive", &[], "O\r", b"r0378\r", b"t0378");
    measure("moteus, fdcanusb", "moteus", &[], "\n", b"can send 8001 1D01 BF\n", b"rcv 100 ");
    measure("feetech, serial", "feetech", &[], "", &[0xFF, 0xFF, 1, 2, 1, 0xFB], &[0xFF, 0xFF, 1, 2, 0]);
    measure("odrive, slcan, 1 Mbit/s", "odrive", &["--bitrate", "1000000"], "O\r", b"r0378\r", b"t0378");
}
