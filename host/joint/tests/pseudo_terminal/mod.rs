//! A serial port without hardware: a pseudo-terminal whose far end is a stream with a short read timeout. Child
//! processes do not inherit it, so the port hangs up when its owner drops it.

use std::fs::File;
use std::io::{self, Read, Write};
use std::os::unix::fs::OpenOptionsExt;
use std::thread;
use std::time::Duration;

use rustix::fs::{OFlags, fcntl_setfl};
use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};

const PAUSE: Duration = Duration::from_millis(1);

/// Far end of the port.
pub struct Master(File);

/// Far end, near end and path of a new port.
pub fn pair() -> (Master, File, String) {
    let master = openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY | OpenptFlags::CLOEXEC).expect("a pseudo-terminal");
    grantpt(&master).expect("a port of our own");
    unlockpt(&master).expect("a port that can be opened");
    let path = ptsname(&master, Vec::new()).expect("a name").into_string().expect("plain letters");
    fcntl_setfl(&master, OFlags::NONBLOCK).expect("reads that do not wait");
    // As the controlling terminal of this process, its hang-up would end the process.
    let not_ours = OFlags::NOCTTY.bits() as i32;
    let slave = File::options().read(true).write(true).custom_flags(not_ours).open(&path).expect("the near end");
    (Master(File::from(master)), slave, path)
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
