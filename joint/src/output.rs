//! What the command prints: results on standard output, remarks on standard error. A reader that has gone away is no
//! error; progress lines are made elsewhere.

use std::io::{self, Write};

use crate::failure::{Failure, Outcome};

/// Prints a result on standard output.
pub fn print(text: &str) -> Outcome<()> {
    let mut out = io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
            Err(Failure::new(format!("cannot write to standard output: {error}")))
        }
        _ => Ok(()),
    }
}

/// Prints a remark on standard error, as far as anyone listens.
pub fn remark(text: &str) {
    let _ = writeln!(io::stderr().lock(), "{text}");
}
