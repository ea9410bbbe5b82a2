//! A modelled board behind a pseudo-terminal, which the host's commands see as a real board at a port. Its time is
//! slowed to the host's, and may lag behind it.

use std::io::{Read, Write};
use std::thread;
use std::time::{Duration, Instant};

use serialport::{SerialPort, TTYPort};

use crate::cpu::Board;
use crate::wires::{MICROSECOND, Time};

/// Time that the board runs between two polls of the terminal.
const SLICE: Time = 500 * MICROSECOND;
/// Nanosecond [fs].
const NANOSECOND: Time = 1_000_000;

/// Serves a board until it halts or the process ends. `opened` receives the path of the terminal; `watch` is called
/// after every slice.
pub fn serve(
    board: &mut Board<'_>,
    opened: impl FnOnce(&str),
    mut watch: impl FnMut(&Board<'_>),
) -> Result<(), String> {
    let (mut own, theirs) = TTYPort::pair().map_err(|error| format!("no pseudo-terminal: {error}"))?;
    own.set_timeout(Duration::ZERO).map_err(|error| format!("the pseudo-terminal: {error}"))?;
    opened(&theirs.name().ok_or("a pseudo-terminal without a name")?);
    // The host's commands open it for exclusive use.
    drop(theirs);
    let start = Instant::now();
    let mut buffer = [0; 4096];
    while board.machine().halted.is_none() {
        // An error means no data, or no process that has the terminal open: the host's commands come and go.
        if let Ok(count) = own.read(&mut buffer) {
            let machine = board.machine_mut();
            machine.wires.line.to_board.extend(&buffer[..count]);
            machine.attention = true;
        }
        board.run_for(SLICE);
        let said = std::mem::take(&mut board.machine_mut().wires.line.to_host);
        // If no process reads, the excess is lost, as on a real line.
        let _ = own.write(&said);
        watch(board);
        let ahead = Duration::from_nanos(board.now() / NANOSECOND).saturating_sub(start.elapsed());
        thread::sleep(ahead);
    }
    Err(board.machine().halted.clone().unwrap_or_default())
}
