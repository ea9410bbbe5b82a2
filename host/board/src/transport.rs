//! Byte streams to a board: a serial port, or a Unix socket to the emulator.

use std::io::{self, Read, Write};
use std::os::unix::net::UnixStream;
use std::path::Path;
use std::time::Duration;

use serialport::{ErrorKind, SerialPort};

use report::failure::{Failure, Outcome};

/// Longest wait of one [`Line::receive`], and interval at which a session checks its deadlines and Ctrl-C.
pub const RECEIVE_TIMEOUT: Duration = Duration::from_millis(20);
/// Longest wait for the other end to accept sent bytes.
const WRITE_TIMEOUT: Duration = Duration::from_secs(2);

/// Byte stream in both directions.
pub trait Line {
    /// Sends everything, or fails.
    fn send(&mut self, bytes: &[u8]) -> io::Result<()>;
    /// Waits for up to [`RECEIVE_TIMEOUT`]; 0 bytes mean that nothing came, an error that the line is gone.
    fn receive(&mut self, buffer: &mut [u8]) -> io::Result<usize>;
    /// Name of the line, as shown to the user.
    fn name(&self) -> &str;
}

/// A Unix socket: the emulator's serial line, or one end of a pair in a test.
pub struct Socket {
    stream: UnixStream,
    name: String,
}

impl Socket {
    /// Wraps a connected socket.
    pub fn new(stream: UnixStream, name: impl Into<String>) -> io::Result<Self> {
        stream.set_read_timeout(Some(RECEIVE_TIMEOUT))?;
        stream.set_write_timeout(Some(WRITE_TIMEOUT))?;
        Ok(Self { stream, name: name.into() })
    }
}

impl Line for Socket {
    fn send(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.stream.write_all(bytes)
    }

    fn receive(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        match self.stream.read(buffer) {
            Ok(0) => Err(io::ErrorKind::UnexpectedEof.into()),
            other => zero_on_timeout(other),
        }
    }

    fn name(&self) -> &str {
        &self.name
    }
}

/// A serial port.
pub struct Port {
    port: Box<dyn SerialPort>,
    path: String,
}

impl Port {
    /// Opens a port for exclusive use.
    pub fn open(path: &str, baud: u32) -> Outcome<Self> {
        let opened = serialport::new(path, baud).timeout(RECEIVE_TIMEOUT).exclusive(true).open();
        match opened {
            Ok(port) => Ok(Self { port, path: path.to_owned() }),
            Err(error) => Err(cannot_open(path, baud, &error)),
        }
    }
}

impl Line for Port {
    fn send(&mut self, bytes: &[u8]) -> io::Result<()> {
        // The port has one timeout, the short one for reading: a busy driver is tried again.
        let deadline = std::time::Instant::now() + WRITE_TIMEOUT;
        let mut rest = bytes;
        while !rest.is_empty() {
            match zero_on_timeout(self.port.write(rest))? {
                0 if std::time::Instant::now() > deadline => return Err(io::ErrorKind::TimedOut.into()),
                sent => rest = &rest[sent..],
            }
        }
        Ok(())
    }

    fn receive(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        match self.port.read(buffer) {
            // Silence ends in a timeout; a read of 0 bytes without a timeout means that the port has hung up, as after
            // unplugging.
            Ok(0) => Err(io::ErrorKind::UnexpectedEof.into()),
            other => zero_on_timeout(other),
        }
    }

    fn name(&self) -> &str {
        &self.path
    }
}

/// Turns a wait that ended without a byte into a count of 0.
fn zero_on_timeout(result: io::Result<usize>) -> io::Result<usize> {
    match result {
        Err(error) if matches!(error.kind(), io::ErrorKind::WouldBlock | io::ErrorKind::TimedOut) => Ok(0),
        Err(error) if error.kind() == io::ErrorKind::Interrupted => Ok(0),
        other => other,
    }
}

fn cannot_open(path: &str, baud: u32, error: &serialport::Error) -> Failure {
    if !Path::new(path).exists() {
        return Failure::new(format!("there is no serial port {path}")).with_help(available_ports());
    }
    match error.kind() {
        ErrorKind::NoDevice => Failure::new(format!("serial port {path} is busy: another program has it open"))
            .with_help(format!("close that program (`fuser {path}` names it), or use another port")),
        ErrorKind::Io(io::ErrorKind::PermissionDenied) => {
            Failure::new(format!("no permission to open serial port {path}"))
                .with_help("add yourself to the port's group (`sudo usermod -aG dialout $USER`), then log in again")
        }
        _ => Failure::new(format!("cannot open {path} as a serial port at {baud} baud: {}", error.description))
            .with_help(available_ports()),
    }
}

fn available_ports() -> String {
    let mut names: Vec<String> =
        serialport::available_ports().unwrap_or_default().into_iter().map(|port| port.port_name).collect();
    names.sort();
    if names.is_empty() {
        "no serial port was found: connect the board; without --port the emulated board is used".to_owned()
    } else {
        format!("available ports: {}; without --port the emulated board is used", names.join(", "))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The failure names the port, and its help the ports of this machine.
    #[test]
    fn missing_port_named() {
        let failure = Port::open("/dev/no-such-port", 115_200).err().expect("there is no such port");
        assert!(failure.message().contains("/dev/no-such-port"), "{failure}");
        assert!(failure.help().is_some_and(|help| help.contains("port")), "{failure}");
        assert_eq!(failure.exit_code(), 2);
    }

    /// Opening a file that is no serial port fails, and the message names the file.
    #[test]
    fn file_is_no_port() {
        let failure = Port::open("/dev/null", 115_200).err().expect("not a port");
        assert!(failure.message().contains("/dev/null"), "{failure}");
    }

    /// A port opened by another program is reported as busy.
    #[test]
    fn port_in_use_reported_busy() {
        let (_master, slave) = serialport::TTYPort::pair().expect("pseudo-terminals");
        let path = slave.name().expect("a pseudo-terminal has a path");
        let _held = Port::open(&path, 115_200).expect("the port is free");
        let failure = Port::open(&path, 115_200).err().expect("the pair holds the port");
        assert!(failure.message().contains("busy"), "{failure}");
        assert!(failure.message().contains(&path), "{failure}");
    }

    /// A closed socket is an error, a silent one is not.
    #[test]
    fn closed_socket_fails_silent_one_waits() {
        let (ours, theirs) = UnixStream::pair().expect("a pair");
        let mut line = Socket::new(ours, "pair").expect("options");
        assert_eq!(line.receive(&mut [0; 8]).expect("silence"), 0);
        drop(theirs);
        assert!(line.receive(&mut [0; 8]).is_err());
    }
}
