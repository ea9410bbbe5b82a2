//! Byte queues between the UART's interrupt and idle. The interrupt also counts good frames and stops at once, so that
//! the tick knows them while idle is busy.

use core::sync::atomic::Ordering::{Acquire, Relaxed, Release};

use link::messages::ToBoard;
use link::scanner::Scanner;

use crate::shared::{AtomicU32, Consumer, Producer, Queue};

/// Capacity for unread bytes: more than the schedules that a host may have pending.
const INBOX: usize = 1024;
/// Capacity for bytes to send: a few of the longest frames.
const OUTBOX: usize = 2048;
/// Most bytes per direction and interrupt, which bounds the interrupt's duration.
const BURST: usize = 16;

/// UART of a board.
pub trait Uart {
    /// Returns the next received byte.
    fn read(&mut self) -> Option<u8>;
    /// Returns `true` if the UART lost bytes since the last call.
    fn overran(&mut self) -> bool;
    /// Returns `true` if a byte can be written now.
    fn can_write(&self) -> bool;
    /// Sends a byte.
    fn write(&mut self, byte: u8);
    /// Enables or disables the interrupt for room in the transmitter.
    fn interrupt_on_write(&mut self, on: bool);
    /// Requests another interrupt without an event.
    fn interrupt_again(&mut self);
}

/// Counts of good frames, stops and losses, kept by the line's interrupt. Frames and stops wrap.
#[derive(Debug, Default)]
pub struct Heard {
    stops: AtomicU32,
    frames: AtomicU32,
    lost: AtomicU32,
}

impl Heard {
    /// Counts at zero.
    pub const fn new() -> Self {
        Self { stops: AtomicU32::new(0), frames: AtomicU32::new(0), lost: AtomicU32::new(0) }
    }

    /// Good frames so far. A reader that sees a stop frame counted here sees it in [`Heard::stops`], too.
    #[inline]
    pub fn frames(&self) -> u32 {
        self.frames.load(Acquire)
    }

    /// Stop frames so far.
    #[inline]
    pub fn stops(&self) -> u32 {
        self.stops.load(Acquire)
    }

    /// Received bytes dropped for lack of room, plus the number of losses in the UART.
    pub fn lost(&self) -> u32 {
        self.lost.load(Relaxed)
    }

    /// Counts a good frame; called by one interrupt only.
    fn count_frame(&self, stop: bool) {
        if stop {
            self.stops.store(self.stops.load(Relaxed).wrapping_add(1), Release);
        }
        self.frames.store(self.frames.load(Relaxed).wrapping_add(1), Release);
    }

    fn count_loss(&self) {
        self.lost.store(self.lost.load(Relaxed).saturating_add(1), Relaxed);
    }
}

/// Queues and counts of a line.
pub struct Line {
    inbox: Queue<u8, INBOX>,
    outbox: Queue<u8, OUTBOX>,
    heard: Heard,
}

impl Line {
    /// Line with empty queues.
    pub const fn new() -> Self {
        Self { inbox: Queue::new(), outbox: Queue::new(), heard: Heard::new() }
    }

    /// Splits into the interrupt's side and idle's side. `wake` requests the UART's interrupt.
    pub fn split<U: Uart>(&mut self, uart: U, wake: fn()) -> (Serial<'_, U>, LineEnd<'_>) {
        let (inbox, inbox_out) = self.inbox.split();
        let (outbox_in, outbox) = self.outbox.split();
        let heard = &self.heard;
        (
            Serial { uart, inbox, outbox, heard, scanner: Scanner::new(), gap: false },
            LineEnd { inbox: inbox_out, outbox: outbox_in, heard, wake },
        )
    }
}

impl Default for Line {
    fn default() -> Self {
        Self::new()
    }
}

/// Interrupt's side of a line.
pub struct Serial<'a, U> {
    uart: U,
    inbox: Producer<'a, u8>,
    outbox: Consumer<'a, u8>,
    heard: &'a Heard,
    scanner: Scanner,
    /// The last byte was dropped for lack of room.
    gap: bool,
}

impl<U: Uart> Serial<'_, U> {
    /// Moves received bytes to the inbox and bytes to send to the UART.
    pub fn service(&mut self) {
        self.receive();
        self.transmit();
    }

    fn receive(&mut self) {
        let mut more = true;
        for _ in 0..BURST {
            let Some(byte) = self.uart.read() else {
                more = false;
                break;
            };
            if let Some(frame) = self.scanner.push(byte) {
                self.heard.count_frame(ToBoard::is_stop(frame));
            }
            self.queue_byte(byte);
        }
        if self.uart.overran() {
            self.heard.count_loss();
        }
        if more {
            // Bytes that wait outside the UART raise no interrupt.
            self.uart.interrupt_again();
        }
    }

    /// Queues a byte. With a full inbox bytes are dropped, but the interrupt reads on: the next frame may be a stop. A
    /// zero separates an incomplete frame from the frames after it.
    fn queue_byte(&mut self, byte: u8) {
        let kept = (!self.gap || self.inbox.enqueue(0).is_ok()) && self.inbox.enqueue(byte).is_ok();
        self.gap = !kept;
        if !kept {
            self.heard.count_loss();
        }
    }

    /// Sends bytes. A UART that is ready at once (emulated) may never raise an interrupt for room, so that this
    /// interrupt is requested again after a burst; a UART that needs time raises it.
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

/// Idle's side of a line.
pub struct LineEnd<'a> {
    inbox: Consumer<'a, u8>,
    outbox: Producer<'a, u8>,
    heard: &'a Heard,
    wake: fn(),
}

impl<'a> LineEnd<'a> {
    /// Returns the next received byte.
    pub fn read(&mut self) -> Option<u8> {
        self.inbox.dequeue()
    }

    /// Number of received, unread bytes.
    pub fn waiting(&self) -> usize {
        self.inbox.len()
    }

    /// Counts of the line's interrupt.
    pub fn heard(&self) -> &'a Heard {
        self.heard
    }

    /// Free places for bytes to send.
    pub fn room(&self) -> usize {
        self.outbox.capacity() - self.outbox.len()
    }

    /// Queues bytes for sending; the caller has checked [`LineEnd::room`].
    pub fn write(&mut self, bytes: &[u8]) {
        for &byte in bytes {
            let _ = self.outbox.enqueue(byte);
        }
        (self.wake)();
    }
}

#[cfg(test)]
mod tests {
    use std::collections::VecDeque;

    use link::framing::encode;

    use super::*;

    #[derive(Default)]
    struct Wire {
        incoming: VecDeque<u8>,
        outgoing: Vec<u8>,
        room: usize,
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
        fn interrupt_on_write(&mut self, on: bool) {
            self.writing = on;
        }
        fn interrupt_again(&mut self) {
            self.again = true;
        }
    }

    fn nothing() {}

    #[test]
    fn bytes_arrive_complete_and_in_order() {
        let mut wire = Wire { incoming: (0..3 * INBOX).map(|i| i as u8).collect(), ..Wire::default() };
        let mut line = Line::new();
        let (mut serial, mut end) = line.split(&mut wire, nothing);
        let mut received = Vec::new();
        for _ in 0..INBOX {
            serial.service();
            received.extend(std::iter::from_fn(|| end.read()));
        }
        assert_eq!(received, (0..3 * INBOX).map(|i| i as u8).collect::<Vec<_>>());
        assert_eq!(end.heard().lost(), 0);
    }

    /// A full inbox loses bytes and counts them; a stop and the frames after the loss still arrive.
    #[test]
    fn full_inbox_counts_lost_bytes() {
        let stop = encode(&ToBoard::Stop).unwrap();
        let flood = [7; 2 * INBOX].iter().chain(&stop);
        let mut wire = Wire { incoming: flood.copied().collect(), ..Wire::default() };
        let mut line = Line::new();
        let (mut serial, mut end) = line.split(&mut wire, nothing);
        (0..INBOX).for_each(|_| serial.service());
        assert_eq!((end.heard().frames(), end.heard().stops()), (0, 0), "the stop ends no frame of its own");
        serial.uart.incoming.extend(&stop);
        serial.service();
        assert_eq!((end.heard().frames(), end.heard().stops()), (1, 1));
        assert_eq!(end.heard().lost() as usize, 2 * INBOX + 2 * stop.len() - (INBOX - 1));
        while end.read().is_some() {}
        serial.uart.incoming.extend(&stop);
        serial.service();
        let kept: Vec<u8> = std::iter::from_fn(|| end.read()).collect();
        assert_eq!(kept, [&[0], &stop[..]].concat(), "half a frame is kept apart from what follows");
    }

    /// A UART that needs time is asked to interrupt; one that needs none is called again.
    #[test]
    fn interrupt_requested_from_slow_uart_only() {
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
    fn uart_losses_counted() {
        let mut wire = Wire { overran: true, ..Wire::default() };
        let mut line = Line::new();
        let (mut serial, end) = line.split(&mut wire, nothing);
        (0..5).for_each(|_| serial.service());
        assert_eq!(end.heard().lost(), 1);
    }
}
