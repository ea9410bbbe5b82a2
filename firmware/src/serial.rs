//! Bytes between a UART and idle: the interrupt's side and idle's side of two byte queues.

use core::sync::atomic::Ordering::{Acquire, Relaxed, Release};
use core::sync::atomic::{AtomicBool, AtomicU32};

use heapless::spsc::{Consumer, Producer, Queue};

/// Bytes received and not yet looked at: more than the schedules that a host may have under way.
const INBOX: usize = 1024;
/// Bytes to be sent: a few of the longest frames.
const OUTBOX: usize = 2048;
/// Most bytes each way in one interrupt, so that none lasts long.
const BURST: usize = 16;

/// What a board's UART must offer.
pub trait Uart {
    /// The next received byte.
    fn read(&mut self) -> Option<u8>;
    /// Whether bytes were lost in the UART since the last call.
    fn overran(&mut self) -> bool;
    /// Whether a byte can be written now.
    fn can_write(&self) -> bool;
    /// Sends a byte.
    fn write(&mut self, byte: u8);
    /// Whether a received byte interrupts.
    fn interrupt_on_read(&mut self, on: bool);
    /// Whether room for a byte to send interrupts.
    fn interrupt_on_write(&mut self, on: bool);
    /// Interrupts once more, although nothing has happened.
    fn interrupt_again(&mut self);
}

/// What both sides see.
#[derive(Debug, Default)]
struct Signals {
    lost: AtomicU32,
    paused: AtomicBool,
}

/// The two queues.
pub struct Line {
    inbox: Queue<u8, INBOX>,
    outbox: Queue<u8, OUTBOX>,
    signals: Signals,
}

impl Line {
    /// Empty.
    pub const fn new() -> Self {
        let signals = Signals { lost: AtomicU32::new(0), paused: AtomicBool::new(false) };
        Self { inbox: Queue::new(), outbox: Queue::new(), signals }
    }

    /// Hands out the two sides. `wake` makes the UART's interrupt run.
    pub fn split<U: Uart>(&mut self, uart: U, wake: fn()) -> (Serial<'_, U>, LineEnd<'_>) {
        let (inbox, inbox_out) = self.inbox.split();
        let (outbox_in, outbox) = self.outbox.split();
        let signals = &self.signals;
        (Serial { uart, inbox, outbox, signals }, LineEnd { inbox: inbox_out, outbox: outbox_in, signals, wake })
    }
}

impl Default for Line {
    fn default() -> Self {
        Self::new()
    }
}

/// The interrupt's side.
pub struct Serial<'a, U> {
    uart: U,
    inbox: Producer<'a, u8>,
    outbox: Consumer<'a, u8>,
    signals: &'a Signals,
}

impl<U: Uart> Serial<'_, U> {
    /// Moves what can be moved. A full inbox leaves the bytes in the UART, which counts what it then loses.
    pub fn service(&mut self) {
        self.receive();
        self.transmit();
    }

    fn receive(&mut self) {
        for _ in 0..BURST {
            let room = self.inbox.ready();
            self.signals.paused.store(!room, Release);
            self.uart.interrupt_on_read(room);
            if !room {
                break;
            }
            let Some(byte) = self.uart.read() else { break };
            let _ = self.inbox.enqueue(byte);
        }
        if self.uart.overran() {
            let lost = self.signals.lost.load(Relaxed);
            self.signals.lost.store(lost.saturating_add(1), Relaxed);
        }
    }

    /// A UART that is ready again at once, as an emulated one is, may never raise an interrupt for it: more bytes than
    /// a burst are taken up by another run of this interrupt. One that needs time raises it.
    fn transmit(&mut self) {
        for _ in 0..BURST {
            if !self.uart.can_write() {
                self.uart.interrupt_on_write(true);
                return;
            }
            let Some(byte) = self.outbox.dequeue() else {
                self.uart.interrupt_on_write(false);
                return;
            };
            self.uart.write(byte);
        }
        self.uart.interrupt_again();
    }
}

/// Idle's side.
pub struct LineEnd<'a> {
    inbox: Consumer<'a, u8>,
    outbox: Producer<'a, u8>,
    signals: &'a Signals,
    wake: fn(),
}

impl LineEnd<'_> {
    /// The next received byte.
    pub fn read(&mut self) -> Option<u8> {
        let byte = self.inbox.dequeue();
        if self.signals.paused.load(Acquire) {
            (self.wake)();
        }
        byte
    }

    /// Places free for bytes to send.
    pub fn room(&self) -> usize {
        self.outbox.capacity() - self.outbox.len()
    }

    /// Sends bytes; the caller has looked whether there is room.
    pub fn write(&mut self, bytes: &[u8]) {
        for &byte in bytes {
            let _ = self.outbox.enqueue(byte);
        }
        (self.wake)();
    }

    /// Times that the UART lost received bytes.
    pub fn lost(&self) -> u32 {
        self.signals.lost.load(Relaxed)
    }
}

#[cfg(test)]
mod tests {
    use std::collections::VecDeque;

    use super::*;

    #[derive(Default)]
    struct Wire {
        incoming: VecDeque<u8>,
        outgoing: Vec<u8>,
        room: usize,
        reading: bool,
        writing: bool,
        again: bool,
        overran: bool,
    }

    impl Uart for &mut Wire {
        fn read(&mut self) -> Option<u8> {
            self.incoming.pop_front()
        }
        fn overran(&mut self) -> bool {
            std::mem::take(&mut self.overran)
        }
        fn can_write(&self) -> bool {
            self.room > 0
        }
        fn write(&mut self, byte: u8) {
            self.room -= 1;
            self.outgoing.push(byte);
        }
        fn interrupt_on_read(&mut self, on: bool) {
            self.reading = on;
        }
        fn interrupt_on_write(&mut self, on: bool) {
            self.writing = on;
        }
        fn interrupt_again(&mut self) {
            self.again = true;
        }
    }

    fn nothing() {}

    #[test]
    fn bytes_arrive_in_order_and_none_is_lost_when_the_inbox_is_full() {
        let mut wire = Wire { incoming: (0..3 * INBOX).map(|i| i as u8).collect(), ..Wire::default() };
        let mut line = Line::new();
        let (mut serial, mut end) = line.split(&mut wire, nothing);
        (0..INBOX).for_each(|_| serial.service());
        assert!(!serial.uart.reading, "a full inbox stops the interrupt");
        let mut received = Vec::new();
        while let Some(byte) = end.read() {
            received.push(byte);
            serial.service();
        }
        assert_eq!(received, (0..3 * INBOX).map(|i| i as u8).collect::<Vec<_>>());
        assert!(serial.uart.reading);
    }

    #[test]
    fn a_uart_that_needs_time_is_asked_to_interrupt_and_one_that_needs_none_is_called_again() {
        let mut wire = Wire { room: 3, ..Wire::default() };
        let mut line = Line::new();
        let (mut serial, mut end) = line.split(&mut wire, nothing);
        end.write(&[7; 100]);
        serial.service();
        assert!(serial.uart.writing && !serial.uart.again);
        serial.uart.room = 1000;
        serial.service();
        assert!(serial.uart.again);
        (0..10).for_each(|_| serial.service());
        assert!(!serial.uart.writing);
        assert_eq!(serial.uart.outgoing, [7; 100]);
    }

    #[test]
    fn what_the_uart_loses_is_counted() {
        let mut wire = Wire { overran: true, ..Wire::default() };
        let mut line = Line::new();
        let (mut serial, end) = line.split(&mut wire, nothing);
        (0..5).for_each(|_| serial.service());
        assert_eq!(end.lost(), 1);
    }
}
