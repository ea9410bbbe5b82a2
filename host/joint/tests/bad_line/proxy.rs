//! Forwards bytes between host and board, one thread for each direction.

use std::io::{Read, Write};
use std::net::Shutdown;
use std::os::unix::net::UnixStream;
use std::sync::{Arc, Mutex};
use std::thread;

use super::disturbance::{Direction, LineFaults};

/// Both directions of a line; dropping the proxy closes the line.
pub struct Proxy {
    directions: [Arc<Mutex<LineFaults>>; 2],
    board: UnixStream,
}

impl Proxy {
    /// Returns an undisturbed line to a board, and the host's end of the line.
    pub fn before(board: UnixStream) -> (Self, UnixStream) {
        let (host, ours) = UnixStream::pair().expect("a pair of sockets");
        let directions =
            [Direction::ToBoard, Direction::ToHost].map(|way| Arc::new(Mutex::new(LineFaults::undisturbed(way))));
        carry(&ours, &board, directions[0].clone());
        carry(&board, &ours, directions[1].clone());
        (Self { directions, board }, host)
    }

    /// Disturbs the line by a seed; returns the disturbances as text.
    pub fn disturb(&self, seed: u64) -> String {
        let [to_board, to_host] = [0, 1].map(|way| self.directions[way].lock().expect("no panic").begin(seed));
        format!("to the board:{to_board}; to the host:{to_host}")
    }

    /// Ends all disturbances.
    pub fn end_disturbance(&self) {
        self.directions.iter().for_each(|way| way.lock().expect("no panic").end());
    }
}

impl Drop for Proxy {
    fn drop(&mut self) {
        let _ = self.board.shutdown(Shutdown::Both);
    }
}

fn carry(from: &UnixStream, to: &UnixStream, faults: Arc<Mutex<LineFaults>>) {
    let (mut from, mut to) = (from.try_clone().expect("a socket"), to.try_clone().expect("a socket"));
    thread::spawn(move || {
        let mut buffer = [0; 4096];
        while let Ok(count @ 1..) = from.read(&mut buffer) {
            let pieces = faults.lock().expect("no panic").transmit(&buffer[..count]);
            for (held_back, bytes) in pieces {
                thread::sleep(held_back);
                if to.write_all(&bytes).is_err() {
                    break;
                }
            }
        }
        let _ = to.shutdown(Shutdown::Both);
    });
}
