//! Pseudo-terminals.

use std::fs::File;
use std::io;
use std::os::unix::fs::OpenOptionsExt;

use rustix::fs::{OFlags, fcntl_setfl};
use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};

/// Opens a pseudo-terminal; returns its far end, its near end and the path of the near end. Reads and writes of the far
/// end do not block. Child processes inherit neither end, and the terminal controls no process.
pub fn pair() -> io::Result<(File, File, String)> {
    let far = openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY | OpenptFlags::CLOEXEC)?;
    grantpt(&far)?;
    unlockpt(&far)?;
    let path = ptsname(&far, Vec::new())?.to_string_lossy().into_owned();
    fcntl_setfl(&far, OFlags::NONBLOCK)?;
    // As the controlling terminal of this process, its hang-up would end the process.
    let not_ours = OFlags::NOCTTY.bits() as i32;
    let near = File::options().read(true).write(true).custom_flags(not_ours).open(&path)?;
    Ok((File::from(far), near, path))
}
