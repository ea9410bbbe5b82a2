//! Ctrl-C and SIGTERM end a command within a moment wherever it is, also where no loop of ours looks whether it may go on.

mod command;

use std::fs::{File, OpenOptions};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::mpsc;
use std::time::{Duration, Instant};

use command::{TIMEOUT, folder, send, start, text, wait};

/// It is 0.2 s; a busy machine is given more.
const AT_ONCE: Duration = Duration::from_secs(5);

/// A pipe that nobody writes to: whoever reads it waits for ever, in the system.
fn pipe(path: &Path) {
    assert!(Command::new("mkfifo").arg(path).status().expect("`mkfifo` is there").success());
}

/// The end of a pipe that is written to: it can be opened once somebody reads, and the pipe does not end while it is open.
fn read_by_somebody(path: PathBuf) -> File {
    let (opened, open) = mpsc::channel();
    // Opening it waits in the system, for ever if nobody reads.
    std::thread::spawn(move || opened.send(OpenOptions::new().write(true).open(path)));
    open.recv_timeout(TIMEOUT).expect("the command reads the pipe").expect("a pipe")
}

#[test]
fn a_command_that_waits_for_its_input_hears_that_it_is_to_end() {
    let folder = folder();
    let path = folder.path().join("pipe");
    pipe(&path);
    let pipe = text(&path);
    for arguments in [
        &["identify", pipe][..],
        &["sim", pipe],
        &["sim", "q1", "--profile", pipe],
        &["sweep", pipe, "--vary", "half_backlash_um=1,2"],
        &["hil", pipe, "--host"],
        &["memory", "show", pipe],
    ] {
        for signal in ["-INT", "-TERM"] {
            let child = start(arguments);
            let _open = read_by_somebody(path.clone());
            let start = Instant::now();
            send(signal, &child);
            let ended = wait(child);
            assert_eq!(ended.code, Some(130), "{arguments:?}: {ended:?}");
            assert!(ended.err.contains("stopped by the user"), "{arguments:?}: {ended:?}");
            assert!(start.elapsed() < AT_ONCE, "{arguments:?}, {signal}: after {:?}", start.elapsed());
        }
    }
}
