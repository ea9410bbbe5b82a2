//! Ctrl-C and SIGTERM end a command at once, also in code that does not check for interruption.

mod command;

use std::time::{Duration, Instant};

use command::{folder, send, start, text, until, wait};
use report::workspace::workspace;

/// Delay that a user does not notice.
const AT_ONCE: Duration = Duration::from_millis(200);
/// Attempts for each command and signal, at different times. One in time is enough, because a busy machine delays any of
/// them, and a command that waits for something is late each time.
const TRIES: u32 = 5;

/// Seen to fail with a counted instead of a measured pause, and with logs written to their end: 0.2 to 0.45 s.
#[test]
fn working_command_stops_at_once() {
    let place = folder();
    let out = place.path().join("out");
    let tests = ["real-any", "random-plants"].map(|name| workspace().join("hil").join(name).with_extension("toml"));
    let [real, random] = tests.each_ref().map(text);
    for arguments in [
        &["sim", "q1", "--duration", "3600", "--every", "2000"][..],
        &["sweep", "q1", "--vary", "half_backlash_um=1:100:1", "--duration", "10"],
        &["hil", real, "--host", "--plant", "reference", "--seed", "1-100"],
        &["hil", random, "--host", "--seed", "1-100"],
    ] {
        for signal in ["-INT", "-TERM"] {
            let end = |attempt: u32| {
                let _ = std::fs::remove_dir_all(&out);
                let child = start(&[arguments, &["--out", text(&out)]].concat());
                until("it writes to its folder", || out.exists());
                std::thread::sleep(Duration::from_millis(70) * attempt);
                let begin = Instant::now();
                send(signal, &child);
                let ended = wait(child);
                assert_eq!(ended.code, Some(130), "{arguments:?}: {ended:?}");
                assert!(ended.err.contains("stopped by the user"), "{arguments:?}: {ended:?}");
                begin.elapsed()
            };
            let took: Vec<Duration> = (1..=TRIES).map(end).collect();
            assert!(took.iter().any(|took| *took < AT_ONCE), "{arguments:?}, {signal}: after {took:?}");
        }
    }
}
