//! Bytes between a UART and idle: the interrupt's side and idle's side of two byte queues. The interrupt also says at once
//! what the tick must know whatever idle is doing: that a good frame has come, and that it was a stop.

use core::sync::atomic::Ordering::{Acquire, Relaxed, Release};

use link::messages::ToBoard;
use link::scanner::Scanner;

use crate::shared::{AtomicU32, Consumer, Producer, Queue};

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
    /// Whether room for a byte to send interrupts.
    fn interrupt_on_write(&mut self, on: bool);
    /// Interrupts once more, although nothing has happened.
    fn interrupt_again(&mut self);
}

/// What has come over the line, counted by its interrupt. The counts wrap.
#[derive(Debug, Default)]
pub struct Heard {
    stops: AtomicU32,
    frames: AtomicU32,
    lost: AtomicU32,
}

impl Heard {
    /// Nothing yet.
    pub const fn new() -> Self {
        Self { stops: AtomicU32::new(0), frames: AtomicU32::new(0), lost: AtomicU32::new(0) }
    }

    /// Good frames so far. Whoever sees one that was a stop sees it in [`Heard::stops`] afterwards.
    #[inline]
    pub fn frames(&self) -> u32 {
        self.frames.load(Acquire)
    }

    /// Those among them that were a stop.
    #[inline]
    pub fn stops(&self) -> u32 {
        self.stops.load(Acquire)
    }

    /// Received bytes that found no room, and times that the UART lost some.
    pub fn lost(&self) -> u32 {
        self.lost.load(Relaxed)
    }

    /// Called by the one interrupt that counts.
    fn hear(&self, stop: bool) {
        if stop {
            self.stops.store(self.stops.load(Relaxed).wrapping_add(1), Release);
        }
        self.frames.store(self.frames.load(Relaxed).wrapping_add(1), Release);
    }

    fn lose(&self) {
        self.lost.store(self.lost.load(Relaxed).saturating_add(1), Relaxed);
    }
}

/// The two queues.
pub struct Line {
    inbox: Queue<u8, INBOX>,
    outbox: Queue<u8, OUTBOX>,
    heard: Heard,
}

impl Line {
    /// Empty.
    pub const fn new() -> Self {
        Self { inbox: Queue::new(), outbox: Queue::new(), heard: Heard::new() }
    }

    /// Hands out the two sides. `wake` makes the UART's interrupt run.
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

/// The interrupt's side.
pub struct Serial<'a, U> {
    uart: U,
    inbox: Producer<'a, u8>,
    outbox: Consumer<'a, u8>,
    heard: &'a Heard,
    scanner: Scanner,
    /// The byte before found no room.
    gap: bool,
}

impl<U: Uart> Serial<'_, U> {
    /// Moves what can be moved.
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
                self.heard.hear(ToBoard::is_stop(frame));
            }
            self.keep(byte);
        }
        if self.uart.overran() {
            self.heard.lose();
        }
        if more {
            // Where bytes wait elsewhere than in the UART, none of them interrupts.
            self.uart.interrupt_again();
        }
    }

    /// A full inbox costs bytes, not the interrupt: what comes next may be a stop. A zero keeps half a frame apart from the
    /// frames after it.
    fn keep(&mut self, byte: u8) {
        let kept = (!self.gap || self.inbox.enqueue(0).is_ok()) && self.inbox.enqueue(byte).is_ok();
        self.gap = !kept;
        if !kept {
            self.heard.lose();
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
    heard: &'a Heard,
    wake: fn(),
}

impl<'a> LineEnd<'a> {
    /// The next received byte.
    pub fn read(&mut self) -> Option<u8> {
        self.inbox.dequeue()
    }

    /// Received bytes that were not read yet.
    pub fn waiting(&self) -> usize {
        self.inbox.len()
    }

    /// What the line's interrupt counts.
    pub fn heard(&self) -> &'a Heard {
        self.heard
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
    fn bytes_arrive_in_order_and_none_is_lost_while_there_is_room() {
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

    #[test]
    fn a_full_inbox_costs_counted_bytes_and_no_stop_and_the_frames_after_it_arrive() {
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
        assert_eq!(end.heard().lost(), 1);
    }
}
