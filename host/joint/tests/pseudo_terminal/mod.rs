//! A serial port without hardware: a pseudo-terminal whose far end is a stream with a short read timeout. Child
//! processes do not inherit it, so the port hangs up when its owner drops it.

use std::fs::File;
use std::io::{self, Read, Write};
use std::thread;
use std::time::Duration;

const PAUSE: Duration = Duration::from_millis(1);

/// Far end of the port.
pub struct Master(File);

/// Far end, near end and path of a new port.
pub fn pair() -> (Master, File, String) {
    let (far, near, path) = twin::terminal::pair().expect("a pseudo-terminal");
    (Master(far), near, path)
}

impl Read for Master {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        self.0.read(buffer).inspect_err(|_| thread::sleep(PAUSE))
    }
}

impl Write for Master {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        loop {
            match self.0.write(bytes) {
                Err(error) if error.kind() == io::ErrorKind::WouldBlock => thread::sleep(PAUSE),
                other => return other,
            }
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        self.0.flush()
    }
}
