//! Idle's part: reads frames from the host, hands commands and orders to the tick, and sends what the tick, the log
//! and the timing monitor have to say. One thing at a time, and only when the line has room for the longest frame, so
//! that nothing has to be dropped for want of room; when that matters to the tick, the queues tell it.

use core::sync::atomic::Ordering::{Acquire, Release};

use heapless::Vec;
use heapless::spsc::Consumer;
use link::framing::{MAX_FRAME, Receiver, encode};
use link::messages::{
    Accepted, Fault, FromBoard, Hello, Kept, LOG_BYTES, Log, Remembered, RunMode, RunSettings, ToBoard,
};

use crate::queues::{Event, IdleEnd, Order};
use crate::serial::LineEnd;
use crate::timing_report::{LineCounts, Resources, statistics};
use crate::words::{Batch, Timed, Timetable, Words};

/// The encoded log, as far as it waits to be sent.
pub struct LogEnd<'a> {
    /// Encoded bytes.
    pub bytes: Consumer<'a, u8>,
    /// Bytes dropped so far because the queue was full.
    pub lost: fn() -> u32,
}

/// Both directions of the talk with the host.
pub struct Conversation<'a, W: Words> {
    hello: Hello,
    period: u32,
    end: IdleEnd<'a, W>,
    line: LineEnd<'a>,
    log: LogEnd<'a>,
    receiver: Receiver,
    batch: W::Batch,
    log_sequence: u16,
    awaiting: bool,
    cause: Option<Fault>,
    clear_with_report: bool,
    mode: RunMode,
    held: Option<W::Timetable>,
    next_sequence: u16,
    lost_schedules: u32,
    cleared: LineCounts,
}

impl<'a, W: Words> Conversation<'a, W> {
    /// Before the first word; `period` is the tick's, in timer counts.
    pub fn new(hello: Hello, period: u32, end: IdleEnd<'a, W>, line: LineEnd<'a>, log: LogEnd<'a>) -> Self {
        Self {
            hello,
            period,
            end,
            line,
            log,
            receiver: Receiver::new(),
            batch: W::Batch::default(),
            log_sequence: 0,
            awaiting: false,
            cause: None,
            clear_with_report: false,
            mode: RunMode::Lockstep,
            held: None,
            next_sequence: 0,
            lost_schedules: 0,
            cleared: LineCounts::default(),
        }
    }

    /// What is to be written to flash now, and said to be by [`Conversation::kept`]: nothing runs until then.
    pub fn to_keep(&mut self) -> Option<W::Learnt> {
        self.end.learnt.dequeue()
    }

    /// Says what became of it.
    pub fn kept(&mut self, stored: bool) {
        if stored {
            self.hello.remembered = Remembered::Good;
        }
        self.say(&FromBoard::Kept(if stored { Kept::Stored } else { Kept::NotWritten }));
    }

    /// Does one thing of each kind if there is one; says whether there was any. `resources` is asked when a report is
    /// due, with `true` if it should start afresh.
    pub fn attend(&mut self, resources: &mut dyn FnMut(bool) -> Resources) -> bool {
        let sampled = self.has_room() && self.report_samples();
        let happened = self.has_room() && self.report_event(resources);
        let heard = !self.awaiting && self.has_room() && self.take_held_or_listen();
        let logged = self.has_room() && self.report_log();
        sampled || happened || heard || logged
    }

    fn has_room(&self) -> bool {
        self.line.room() >= MAX_FRAME
    }

    fn say(&mut self, message: &FromBoard) {
        // Every message of ours fits into a frame: link's tests hold the longest of each.
        if let Ok(frame) = encode(message) {
            self.line.write(&frame);
        }
    }

    fn is_running(&self) -> bool {
        self.end.progress.running.load(Acquire)
    }

    /// Takes samples into the batch and sends it once it is full, or once there are no more to come for now.
    fn report_samples(&mut self) -> bool {
        let mut taken = false;
        while !self.batch.is_full() {
            let Some(sample) = self.end.samples.dequeue() else { break };
            self.batch.add(&sample);
            taken = true;
        }
        let at_rest = || !self.is_running() || self.has_caught_up();
        if self.batch.is_full() || (!self.batch.is_empty() && at_rest() && !self.end.samples.ready()) {
            let message = self.batch.take();
            self.say(&message);
            return true;
        }
        taken
    }

    fn has_caught_up(&self) -> bool {
        self.end.progress.steps.load(Acquire) >= self.end.progress.horizon.load(Acquire)
    }

    /// Tells the host what the tick says. The end of a run is told after its last sample.
    fn report_event(&mut self, resources: &mut dyn FnMut(bool) -> Resources) -> bool {
        let samples_left = self.end.samples.ready() || !self.batch.is_empty();
        match self.end.events.peek() {
            None => return false,
            Some(Event::Stopped | Event::Tripped(_)) if samples_left => return false,
            Some(_) => {}
        }
        let Some(event) = self.end.events.dequeue() else { return false };
        self.awaiting &= matches!(event, Event::Tripped(_));
        match event {
            Event::ResetDone => {
                self.forget_run();
                self.say(&FromBoard::Hello(self.hello.clone()));
            }
            // Said once it is written.
            Event::Memory(Ok(())) => {}
            Event::Memory(Err(why)) => self.say(&FromBoard::Kept(why)),
            Event::Upset { taken } => self.say(&FromBoard::Upset { taken }),
            Event::Refused(fault) | Event::Tripped(fault) => self.say(&FromBoard::Fault(fault)),
            Event::Stopped => {
                if let Some(cause) = self.cause.take() {
                    self.say(&FromBoard::Fault(cause));
                }
            }
            Event::Timing(monitor) => {
                let counts = self.counts();
                let since = counts.since(self.cleared);
                let report = statistics(&monitor, self.period, since, resources(self.clear_with_report));
                if self.clear_with_report {
                    self.cleared = counts;
                }
                self.say(&FromBoard::Statistics(report));
            }
        }
        true
    }

    /// Drops what is left of the run before a reset.
    fn forget_run(&mut self) {
        while self.end.samples.dequeue().is_some() {}
        self.batch = W::Batch::default();
        self.cause = None;
        self.cleared = self.counts();
    }

    fn counts(&self) -> LineCounts {
        LineCounts {
            lost_schedules: self.lost_schedules,
            bad_frames: self.receiver.dropped().frames,
            lost_bytes: self.line.lost(),
            lost_log_bytes: (self.log.lost)(),
        }
    }

    fn report_log(&mut self) -> bool {
        let mut bytes = Vec::<u8, LOG_BYTES>::new();
        while !bytes.is_full() {
            let Some(byte) = self.log.bytes.dequeue() else { break };
            let _ = bytes.push(byte);
        }
        if bytes.is_empty() {
            return false;
        }
        let sequence = self.log_sequence;
        self.log_sequence = sequence.wrapping_add(1);
        self.say(&FromBoard::Log(Log { sequence, bytes }));
        true
    }

    fn take_held_or_listen(&mut self) -> bool {
        match self.held.take() {
            None => self.listen(),
            Some(schedule) => {
                self.take(schedule);
                self.held.is_none()
            }
        }
    }

    /// Reads up to the end of a frame.
    fn listen(&mut self) -> bool {
        let mut heard = false;
        while let Some(byte) = self.line.read() {
            heard = true;
            if let Some(message) = self.receiver.push(byte) {
                self.answer(message);
                break;
            }
        }
        heard
    }

    fn answer(&mut self, message: ToBoard) {
        match message {
            ToBoard::Hello { .. } => self.say(&FromBoard::Hello(self.hello.clone())),
            ToBoard::Reset(settings) => self.reset(settings),
            ToBoard::Statistics { reset } => {
                self.clear_with_report = reset;
                self.order(Order::Report { reset });
            }
            ToBoard::Stop => self.order(Order::Stop),
            ToBoard::Keep => self.order(Order::Keep),
            ToBoard::Upset(upset) => self.order(Order::Upset(upset)),
            commands => match W::timetable(commands) {
                Some(timetable) => self.take(timetable),
                None => self.say(&FromBoard::Fault(Fault::WrongRole)),
            },
        }
    }

    /// Gives the tick an order and listens to no frame before it is answered.
    fn order(&mut self, order: Order) {
        let _ = self.end.orders.enqueue(order);
        self.awaiting = true;
    }

    fn trip(&mut self, fault: Fault) {
        self.cause = Some(fault);
        self.order(Order::Trip(fault));
    }

    fn reset(&mut self, settings: RunSettings) {
        if settings.decimation == 0 || settings.command_timeout == 0 {
            return self.trip(Fault::BadSettings);
        }
        self.mode = settings.mode;
        self.next_sequence = 0;
        self.end.progress.horizon.store(0, Release);
        self.order(Order::Reset(settings));
    }

    /// Queues a schedule's commands, or says why not. In lockstep a schedule that follows a gap is not taken: nothing
    /// is simulated on torques that never arrived, and the host may send again from the missing one on. Nor is one
    /// taken there before there is room for it: until then nothing more is read.
    fn take(&mut self, timetable: W::Timetable) {
        if !self.is_running() {
            return self.say(&FromBoard::Fault(Fault::NotRunning));
        }
        let lockstep = self.mode == RunMode::Lockstep;
        let sequence = timetable.sequence();
        let gap = sequence.wrapping_sub(self.next_sequence);
        let is_repeated = gap > u16::MAX / 2;
        if is_repeated {
            return self.accept(sequence);
        }
        if gap > 0 {
            self.lost_schedules = self.lost_schedules.saturating_add(gap.into());
            if lockstep {
                return;
            }
        }
        if let Err(fault) = self.check(&timetable) {
            return self.trip(fault);
        }
        if timetable.commands().len() > self.queue_free() {
            if lockstep {
                self.held = Some(timetable);
                return;
            }
            return self.trip(Fault::QueueFull);
        }
        for command in timetable.commands() {
            let _ = self.end.commands.enqueue(command.clone());
        }
        self.next_sequence = sequence.wrapping_add(1);
        self.end.progress.horizon.store(timetable.horizon(), Release);
        self.accept(sequence);
    }

    fn accept(&mut self, sequence: u16) {
        let queue_free = self.queue_free() as u16;
        self.say(&FromBoard::Accepted(Accepted { sequence, queue_free, tick: self.end.progress.steps.load(Acquire) }));
    }

    fn queue_free(&self) -> usize {
        self.end.commands.capacity() - self.end.commands.len()
    }

    /// Commands lie between the old horizon and the new one, in rising order: those before the old one would be late,
    /// those past the new one would block the queue.
    fn check(&self, timetable: &W::Timetable) -> Result<(), Fault> {
        let mut earliest = self.end.progress.horizon.load(Acquire);
        if timetable.horizon() < earliest {
            return Err(Fault::LateCommand { tick: timetable.horizon() });
        }
        for command in timetable.commands() {
            let tick = command.tick();
            if !command.is_sound() {
                return Err(Fault::BadCommand { tick });
            }
            if tick < earliest || tick >= timetable.horizon() {
                return Err(Fault::LateCommand { tick });
            }
            earliest = tick + 1;
        }
        Ok(())
    }
}
