//! Events from the threads that read.

use std::net::TcpStream;
use std::sync::mpsc::Sender;

/// Number of a client.
pub type ClientId = u32;

/// Event from a thread that reads.
pub enum Event {
    /// Bytes of a client.
    Bytes {
        /// Number of the client.
        client: ClientId,
        /// Bytes.
        bytes: Vec<u8>,
    },
    /// Client on a TCP connection.
    Connected(ClientId, TcpStream),
    /// Client that is gone.
    Left(ClientId),
    /// Line of the control socket, and where its answer goes.
    Control(String, Sender<String>),
}

impl Event {
    /// Event of bytes.
    pub fn bytes(client: ClientId, bytes: &[u8]) -> Self {
        Self::Bytes { client, bytes: bytes.to_vec() }
    }
}
