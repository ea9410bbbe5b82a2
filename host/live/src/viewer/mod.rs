//! One viewer on its WebSocket: items of its queue out, its messages in.
//!
//! The socket never blocks. While the viewer does not read, its queue fills up and loses batches; after `PATIENCE` it
//! is disconnected.

mod foxglove;
mod page;

use std::io;
use std::net::TcpStream;
use std::sync::mpsc::{Receiver, RecvTimeoutError};
use std::thread;
use std::time::{Duration, Instant};

pub use foxglove::Foxglove;
pub use page::Page;
use tungstenite::protocol::{Role, WebSocketConfig};
use tungstenite::{Error, Message, WebSocket};

use crate::shared::{Batch, Item};
use crate::source::Source;

/// Longest wait for an item, after which messages of the viewer are read.
const TURN: Duration = Duration::from_millis(15);
/// Time without progress after which a viewer is disconnected.
const PATIENCE: Duration = Duration::from_secs(10);
/// Time for the end of the connection.
const FAREWELL: Duration = Duration::from_millis(300);
/// Messages of a viewer a second, and at once. The rest waits in the connection.
const MESSAGES_PER_SECOND: f64 = 100.0;
/// Longest message of a viewer [bytes].
const MAX_MESSAGE: usize = 64 << 10;
/// Buffers of a connection [bytes].
const READ_BUFFER: usize = 4 << 10;
const WRITE_BUFFER: usize = 64 << 10;
const MAX_WRITE_BUFFER: usize = 4 << 20;

/// Form of the messages of a kind of viewer.
pub trait View {
    /// First messages.
    fn greet(&mut self) -> Vec<Message>;
    /// Messages of a new source.
    fn source(&mut self, source: &Source) -> Vec<Message>;
    /// Messages of a batch; `lost` is the number of samples that the viewer did not get so far.
    fn batch(&mut self, batch: &Batch, lost: u64) -> Vec<Message>;
    /// Answers to a text of the viewer.
    fn receive(&mut self, text: &str) -> Vec<Message>;
    /// Last messages.
    fn end(&mut self) -> Vec<Message>;
}

/// Serves a viewer until it leaves or the run is over. `rest` are its bytes behind the request.
pub fn serve(
    stream: TcpStream,
    rest: Vec<u8>,
    mut view: Box<dyn View>,
    queue: &Receiver<Item>,
    lost: &dyn Fn() -> u64,
) -> io::Result<()> {
    stream.set_nonblocking(true)?;
    let config = WebSocketConfig::default()
        .read_buffer_size(READ_BUFFER)
        .write_buffer_size(WRITE_BUFFER)
        .max_write_buffer_size(MAX_WRITE_BUFFER)
        .max_message_size(Some(MAX_MESSAGE))
        .max_frame_size(Some(MAX_MESSAGE));
    let mut line = Line {
        socket: WebSocket::from_partially_read(stream, rest, Role::Server, Some(config)),
        stuck_since: None,
        allowance: MESSAGES_PER_SECOND,
        refilled: Instant::now(),
    };
    line.write(view.greet())?;
    loop {
        let messages = match line.next_item(queue) {
            Ok(Item::Source(source)) => view.source(&source),
            Ok(Item::Batch(batch)) => view.batch(&batch, lost()),
            Ok(Item::End) | Err(RecvTimeoutError::Disconnected) => return line.close(view.end()),
            Err(RecvTimeoutError::Timeout) => Vec::new(),
        };
        line.write(messages)?;
        while let Some(text) = line.read()? {
            line.write(view.receive(&text))?;
        }
    }
}

/// Connection to a viewer.
struct Line {
    socket: WebSocket<TcpStream>,
    stuck_since: Option<Instant>,
    /// Messages that the viewer may send at once.
    allowance: f64,
    refilled: Instant,
}

impl Line {
    /// Next item of the queue; none while the viewer does not read.
    fn next_item(&self, queue: &Receiver<Item>) -> Result<Item, RecvTimeoutError> {
        if self.stuck_since.is_none() {
            return queue.recv_timeout(TURN);
        }
        thread::sleep(TURN);
        Err(RecvTimeoutError::Timeout)
    }

    /// Writes messages as far as the viewer takes them; fails once it takes nothing for too long.
    fn write(&mut self, messages: Vec<Message>) -> io::Result<()> {
        for message in messages {
            match self.socket.write(message).map_err(Box::new) {
                Ok(()) => {}
                Err(error) if is_blocked(&error) => {}
                Err(error) if matches!(*error, Error::WriteBufferFull(_)) => {}
                Err(error) => return Err(io::Error::other(error)),
            }
        }
        match self.socket.flush().map_err(Box::new) {
            Ok(()) => self.stuck_since = None,
            Err(error) if is_blocked(&error) => {
                if self.stuck_since.get_or_insert_with(Instant::now).elapsed() > PATIENCE {
                    return Err(io::ErrorKind::TimedOut.into());
                }
            }
            Err(error) => return Err(io::Error::other(error)),
        }
        Ok(())
    }

    /// Next text of the viewer; `None` if there is none, or if it has sent too many.
    fn read(&mut self) -> io::Result<Option<String>> {
        let earned = MESSAGES_PER_SECOND * self.refilled.elapsed().as_secs_f64();
        self.refilled = Instant::now();
        self.allowance = (self.allowance + earned).min(MESSAGES_PER_SECOND);
        while self.allowance >= 1.0 {
            match self.socket.read().map_err(Box::new) {
                Ok(message) => {
                    self.allowance -= 1.0;
                    if let Message::Text(text) = message {
                        return Ok(Some(text.to_string()));
                    }
                }
                Err(error) if is_blocked(&error) => return Ok(None),
                Err(error) => return Err(io::Error::other(error)),
            }
        }
        Ok(None)
    }

    /// Says farewell and closes the connection.
    fn close(&mut self, messages: Vec<Message>) -> io::Result<()> {
        self.write(messages)?;
        let end = Instant::now() + FAREWELL;
        // Errors from here on are the end of the connection.
        let _ = self.socket.close(None);
        while Instant::now() < end {
            match self.socket.read().map_err(Box::new) {
                Err(error) if is_blocked(&error) => thread::sleep(TURN),
                Err(_) => break,
                Ok(_) => {}
            }
        }
        Ok(())
    }
}

/// True for an error by which a socket tells that it would have to wait.
fn is_blocked(error: &Error) -> bool {
    matches!(error, Error::Io(error) if error.kind() == io::ErrorKind::WouldBlock)
}
