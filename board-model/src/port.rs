//! A modelled board behind pseudo-terminals: its serial line, which the host's commands see as a real board at a port,
//! and its CAN bus as slcan, for clients of drives. Its time is slowed to the host's, and may lag behind it.

use std::io::{self, Read, Write};
use std::thread;
use std::time::{Duration, Instant};

use bus_wires::{Packet, Received, Wire, WireName, wire};
use serialport::{SerialPort, TTYPort};

use crate::cpu::Board;
use crate::wires::{MICROSECOND, Time};

/// Time that the board runs between two polls of the terminals.
const SLICE: Time = 500 * MICROSECOND;
/// Nanosecond [fs].
const NANOSECOND: Time = 1_000_000;

/// Pseudo-terminal that processes open and leave as they like.
struct Terminal {
    own: TTYPort,
    path: String,
    /// True once a process has sent something.
    had_client: bool,
    /// True while no process has it open.
    is_left: bool,
}

impl Terminal {
    fn open() -> Result<Self, String> {
        let (mut own, theirs) = TTYPort::pair().map_err(|error| format!("no pseudo-terminal: {error}"))?;
        own.set_timeout(Duration::ZERO).map_err(|error| format!("the pseudo-terminal: {error}"))?;
        let path = theirs.name().ok_or("a pseudo-terminal without a name")?;
        // The host's commands open it for exclusive use, so that this end is closed.
        Ok(Self { own, path, had_client: false, is_left: false })
    }

    /// Bytes that wait.
    fn read(&mut self) -> Vec<u8> {
        let mut buffer = [0; 4096];
        match self.own.read(&mut buffer) {
            Ok(count) => {
                (self.had_client, self.is_left) = (true, false);
                buffer[..count].to_vec()
            }
            Err(error) => {
                self.is_left = error.kind() != io::ErrorKind::TimedOut;
                Vec::new()
            }
        }
    }

    /// Writes bytes. If no process reads, the excess is lost, as on a real line.
    fn write(&mut self, bytes: &[u8]) {
        let _ = self.own.write(bytes);
    }
}

/// CAN bus as slcan.
struct Adapter {
    terminal: Terminal,
    codec: Box<dyn Wire>,
    /// Frames of the bus that were encoded.
    told: usize,
}

impl Adapter {
    fn exchange(&mut self, board: &mut Board<'_>) {
        let bytes = self.terminal.read();
        let bus = &mut board.machine_mut().wires.can;
        for received in self.codec.receive(&bytes) {
            match received {
                Received::Packet(Packet::Frame(frame)) => bus.to_board.push_back(frame),
                Received::Answer(answer) => self.terminal.write(&answer),
                _ => {}
            }
        }
        for frame in &bus.to_others[self.told..] {
            if let Some(line) = self.codec.encode(&Packet::Frame(frame.clone())) {
                self.terminal.write(&line);
            }
        }
        self.told = bus.to_others.len();
    }
}

/// Paths of the terminals: serial line, and CAN bus if the board has one.
pub struct Paths<'p> {
    /// Serial line.
    pub line: &'p str,
    /// CAN bus.
    pub can: Option<&'p str>,
}

/// Serves a board until it halts, the process ends or, if `once`, the client of the CAN bus has left. `opened` receives
/// the paths of the terminals; `watch` is called after every slice.
pub fn serve(
    board: &mut Board<'_>,
    once: bool,
    opened: impl FnOnce(&Paths<'_>),
    mut watch: impl FnMut(&Board<'_>),
) -> Result<(), String> {
    let mut line = Terminal::open()?;
    let mut adapter = match board.machine().wires.can.cable.unit {
        0 => None,
        _ => Some(Adapter { terminal: Terminal::open()?, codec: wire(WireName::Slcan), told: 0 }),
    };
    opened(&Paths { line: &line.path, can: adapter.as_ref().map(|adapter| adapter.terminal.path.as_str()) });
    let start = Instant::now();
    while board.machine().halted.is_none() {
        let bytes = line.read();
        if let Some(adapter) = &mut adapter {
            adapter.exchange(board);
            if once && adapter.terminal.had_client && adapter.terminal.is_left {
                return Ok(());
            }
        }
        let machine = board.machine_mut();
        machine.wires.line.to_board.extend(&bytes);
        machine.attention = true;
        board.run_for(SLICE);
        let said = std::mem::take(&mut board.machine_mut().wires.line.to_host);
        line.write(&said);
        watch(board);
        let ahead = Duration::from_nanos(board.now() / NANOSECOND).saturating_sub(start.elapsed());
        thread::sleep(ahead);
    }
    Err(board.machine().halted.clone().unwrap_or_default())
}
