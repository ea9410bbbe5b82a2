//! `joint twin` in the background, and its control socket.

use std::fs::File;
use std::io::{BufRead, BufReader, Read, Write};
use std::os::unix::net::UnixStream;
use std::path::Path;
use std::process::{Child, ChildStdout, Command, Stdio};

use serde_json::Value;
use tempfile::TempDir;

use crate::command::{TIMEOUT, folder, interrupt, text, within};

/// Running twin, ended when dropped.
pub struct Twin {
    child: Child,
    out: BufReader<ChildStdout>,
    announcement: String,
    port: String,
    control: String,
    place: TempDir,
}

impl Twin {
    /// Starts a twin for at most 120 s of the joint's time and waits until clients can connect.
    pub fn start(drive: &str, arguments: &[&str]) -> Self {
        Self::endless(drive, &[&["--for", "120"], arguments].concat())
    }

    /// Starts a twin that ends when it is told to, and waits until clients can connect.
    pub fn endless(drive: &str, arguments: &[&str]) -> Self {
        let place = folder();
        let [link, control] = ["port", "control"].map(|name| text(&place.path().join(name)).to_owned());
        let mut command = Command::new(env!("CARGO_BIN_EXE_joint"));
        command.args(["twin", "--drive", drive, "--control", &control]).args(arguments);
        if !arguments.contains(&"socketcand") {
            command.args(["--link", &link]);
        }
        command.env("NO_COLOR", "1").stdin(Stdio::null()).stdout(Stdio::piped());
        command.stderr(File::create(place.path().join("errors")).expect("a file"));
        let mut child = command.spawn().expect("the command can be started");
        let mut twin = Self {
            out: BufReader::new(child.stdout.take().expect("a pipe")),
            child,
            announcement: String::new(),
            port: String::new(),
            control,
            place,
        };
        // The line of the control socket is the last one of the announcement.
        loop {
            let mut line = String::new();
            twin.out.read_line(&mut line).expect("text");
            twin.announcement += &line;
            match line.split_once(':') {
                Some(("port", port)) => twin.port = port.trim().to_owned(),
                Some(("control", _)) => return twin,
                _ => assert!(!line.is_empty(), "the twin ended at its start: {}", twin.errors()),
            }
        }
    }

    /// Lines from the start up to that of the control socket.
    pub fn announcement(&self) -> &str {
        &self.announcement
    }

    /// Path of the pseudo-terminal, or number of the TCP port.
    pub fn port(&self) -> &str {
        &self.port
    }

    /// Path of the control socket.
    pub fn control(&self) -> &str {
        &self.control
    }

    /// Sends a command to the control socket; returns the answer.
    pub fn order(&self, command: &str) -> Value {
        let mut line = UnixStream::connect(&self.control).expect("the twin listens");
        line.set_read_timeout(Some(TIMEOUT)).expect("a socket has a limit");
        writeln!(line, "{command}").expect("the twin reads");
        let mut answer = String::new();
        BufReader::new(line).read_line(&mut answer).expect("the twin answers in time");
        serde_json::from_str(&answer).expect("JSON")
    }

    /// State of the only joint.
    pub fn status(&self) -> Value {
        self.order(r#"{"status": true}"#)["joints"][0].clone()
    }

    /// State of the bus.
    pub fn bus(&self) -> Value {
        self.order(r#"{"status": true}"#)["bus"].clone()
    }

    /// Ends the twin by Ctrl-C, which must be orderly; returns the summary.
    pub fn end(mut self) -> String {
        interrupt(&self.child);
        let mut summary = String::new();
        self.out.read_to_string(&mut summary).expect("text");
        let status = within(TIMEOUT, "the twin ends", || self.child.try_wait().expect("a child of ours"));
        assert_eq!(status.code(), Some(0), "{summary}{}", self.errors());
        assert!(summary.contains("time:") && summary.contains("from clients"), "{summary}");
        for left in [&self.port, &self.control] {
            assert!(!Path::new(left).exists(), "{left} was left behind");
        }
        summary
    }

    fn errors(&self) -> String {
        std::fs::read_to_string(self.place.path().join("errors")).unwrap_or_default()
    }
}

impl Drop for Twin {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}
