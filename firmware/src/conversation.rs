//! Conversation with the host, run in idle: reads frames, hands commands and orders to the tick, and sends samples,
//! events, log and timing statistics. A message is sent only while the line has room for the longest frame, so that no
//! message is dropped. If idle falls behind, the tick notices by its queues.

use core::sync::atomic::Ordering::Acquire;

use heapless::Vec;
use link::framing::{MAX_FRAME, Receiver, encode};
use link::messages::{FromBoard, Hello, LOG_BYTES, Log, MemoryOutcome, MemoryRequest, RunSettings, ToBoard, Trip};

use crate::intake::{Intake, Taken};
use crate::kept_memory::{KeptMemory, Slots};
use crate::memory_requests::{MemoryRequests, Reaction};
use crate::protocol::{Batch, Protocol};
use crate::queues::{BEFORE_ANY_RUN, Event, Events, IdleEnd, Order, Progress};
use crate::serial::{Heard, LineEnd};
use crate::shared::{Consumer, Producer};
use crate::timing_report::{LineCounts, Resources, statistics};

/// Encoded log that waits to be sent.
pub struct LogEnd<'a> {
    /// Encoded bytes.
    pub bytes: Consumer<'a, u8>,
    /// Bytes dropped so far because the queue was full.
    pub lost: fn() -> u32,
}

/// Both directions of the conversation with the host.
pub struct Conversation<'a, W: Protocol> {
    hello: Hello,
    period: u32,
    intake: Intake<'a, W>,
    memory_requests: MemoryRequests<'a, W::Learnt>,
    orders: Producer<'a, Order>,
    samples: Consumer<'a, W::Sample>,
    events: Events<'a>,
    progress: &'a Progress,
    line: LineEnd<'a>,
    heard: &'a Heard,
    log: LogEnd<'a>,
    receiver: Receiver,
    batch: W::Batch,
    log_sequence: u16,
    awaiting: bool,
    /// Settings of the last requested run.
    settings: RunSettings,
    /// Stop frames read so far.
    stops: u32,
    /// Unread bytes that were received while flash was written.
    stale: usize,
    cause: Option<Trip>,
    clear_with_report: bool,
    cleared: LineCounts,
}

impl<'a, W: Protocol> Conversation<'a, W> {
    /// State before the first message; `period` is the tick period in timer counts.
    pub fn new(hello: Hello, period: u32, end: IdleEnd<'a, W>, line: LineEnd<'a>, log: LogEnd<'a>) -> Self {
        let IdleEnd { commands, orders, samples, events, learnt, remembered, progress } = end;
        Self {
            hello,
            period,
            intake: Intake::new(commands, progress),
            memory_requests: MemoryRequests::new(learnt, remembered),
            orders,
            samples,
            events,
            progress,
            heard: line.heard(),
            line,
            log,
            receiver: Receiver::new(),
            batch: W::Batch::default(),
            log_sequence: 0,
            awaiting: false,
            settings: BEFORE_ANY_RUN,
            stops: 0,
            stale: 0,
            cause: None,
            clear_with_report: false,
            cleared: LineCounts::default(),
        }
    }

    /// Does the pending flash work, if there is any; no run goes on meanwhile. `writing` wraps the write, which may
    /// take two seconds. During the write the line may lose any frame, also a stop; resets received before its end are
    /// therefore refused.
    pub fn serve_flash(
        &mut self,
        kept: &mut KeptMemory<impl Slots>,
        writing: impl FnOnce(&mut dyn FnMut() -> MemoryOutcome) -> MemoryOutcome,
    ) {
        if !self.has_room() {
            return;
        }
        if let Some(outcome) = self.memory_requests.serve(kept, writing) {
            self.hello.memory = outcome.remembered.unwrap_or(self.hello.memory);
            if matches!(outcome.answer, FromBoard::MemoryOutcome(_)) {
                self.stale = self.line.waiting();
            }
            self.send(&outcome.answer);
        }
    }

    /// Handles at most one frame, one batch of samples, one event and one log message; returns `true` if there was any.
    /// `resources` is called for a report; its argument asks to restart the measurement. Frames come first: otherwise a
    /// line filled with samples would delay the answers to the host.
    pub fn poll(&mut self, resources: &mut dyn FnMut(bool) -> Resources) -> bool {
        let heard = !self.awaiting && !self.memory_requests.is_busy() && self.has_room() && self.take_held_or_listen();
        let sampled = self.has_room() && self.report_samples();
        let happened = self.has_room() && self.report_event(resources);
        let logged = self.has_room() && self.report_log();
        sampled || happened || heard || logged
    }

    fn has_room(&self) -> bool {
        self.line.room() >= MAX_FRAME
    }

    fn send(&mut self, message: &FromBoard) {
        // Every message of the board fits into a frame: tests of `link` encode the longest of each.
        if let Ok(frame) = encode(message) {
            self.line.write(&frame);
        }
    }

    fn is_running(&self) -> bool {
        self.progress.running.load(Acquire)
    }

    /// Collects samples; sends the batch once it is full, or once no sample is expected for now.
    fn report_samples(&mut self) -> bool {
        let mut taken = false;
        while !self.batch.is_full() {
            let Some(sample) = self.samples.dequeue() else { break };
            self.batch.add(&sample);
            taken = true;
        }
        let at_rest = || !self.is_running() || self.intake.has_caught_up();
        if self.batch.is_full() || (!self.batch.is_empty() && at_rest() && !self.samples.ready()) {
            let message = self.batch.take();
            self.send(&message);
            return true;
        }
        taken
    }

    /// Sends an event of the tick. The end of a run is sent after the last sample: samples are checked after the event
    /// was seen, since the tick may interrupt in between and add both.
    fn report_event(&mut self, resources: &mut dyn FnMut(bool) -> Resources) -> bool {
        let Some(event) = self.events.peek() else { return false };
        let ends_run = matches!(event, Event::Stopped | Event::Tripped(_));
        if ends_run && (self.samples.ready() || !self.batch.is_empty()) {
            return false;
        }
        let Some(event) = self.events.take() else { return false };
        self.awaiting &= matches!(event, Event::Tripped(_));
        match event {
            Event::ResetDone => {
                self.intake.begin(self.settings);
                self.forget_run();
                self.send(&FromBoard::Hello(self.hello.clone()));
            }
            // The answer follows once flash is written.
            Event::MemoryReady(Ok(())) => {}
            Event::MemoryReady(Err(why)) => self.send(&FromBoard::MemoryOutcome(why)),
            Event::MemoryChecked(state) => {
                self.memory_requests.checked(state);
                self.send(&FromBoard::MemoryChecked(state));
            }
            // The answer follows once flash is erased.
            Event::MemoryDiscarded => self.memory_requests.discarded(),
            Event::FaultTaken { taken } => self.send(&FromBoard::FaultTaken { taken }),
            Event::Refused(trip) | Event::Tripped(trip) => self.send(&FromBoard::Tripped(trip)),
            Event::Stopped => {
                if let Some(cause) = self.cause.take() {
                    self.send(&FromBoard::Tripped(cause));
                }
            }
            Event::Timing(monitor) => {
                let counts = self.counts();
                let since = counts.since(self.cleared);
                let report = statistics(&monitor, self.period, since, resources(self.clear_with_report));
                if self.clear_with_report {
                    self.cleared = counts;
                }
                self.send(&FromBoard::Statistics(report));
            }
        }
        true
    }

    /// Drops samples and counts of the run before a reset.
    fn forget_run(&mut self) {
        while self.samples.dequeue().is_some() {}
        self.batch = W::Batch::default();
        self.cause = None;
        self.cleared = self.counts();
    }

    fn counts(&self) -> LineCounts {
        LineCounts {
            lost_schedules: self.intake.lost(),
            bad_frames: self.receiver.dropped().frames,
            lost_bytes: self.heard.lost(),
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
        self.send(&FromBoard::Log(Log { sequence, bytes }));
        true
    }

    fn take_held_or_listen(&mut self) -> bool {
        if !self.intake.holds() {
            return self.listen();
        }
        let taken = self.intake.take_held();
        self.send_outcome(taken);
        !self.intake.holds()
    }

    /// Reads bytes up to the end of a frame.
    fn listen(&mut self) -> bool {
        let (mut heard, stops) = (false, self.heard.stops());
        while let Some(byte) = self.line.read() {
            heard = true;
            let is_stale = self.stale > 0;
            self.stale = self.stale.saturating_sub(1);
            if let Some(message) = self.receiver.push(byte) {
                self.answer(message, is_stale);
                return heard;
            }
        }
        // All received bytes have been read: a stop that is not among them was dropped for lack of room.
        self.stops = stops;
        heard
    }

    fn answer(&mut self, message: ToBoard, is_stale: bool) {
        match message {
            ToBoard::Hello { .. } => self.send(&FromBoard::Hello(self.hello.clone())),
            ToBoard::Reset(_) if is_stale => self.send(&FromBoard::Tripped(Trip::Overtaken)),
            ToBoard::Reset(settings) => self.reset(settings),
            ToBoard::Statistics { reset } => {
                self.clear_with_report = reset;
                self.order(Order::Report { reset });
            }
            ToBoard::Stop => {
                self.stops = self.stops.wrapping_add(1);
                self.order(Order::Stop);
            }
            ToBoard::Memory(request) => self.begin(request),
            ToBoard::Fault(fault) => self.order(Order::Fault(fault)),
            commands => match W::timetable(commands) {
                Some(timetable) => {
                    let taken = self.intake.take(timetable);
                    self.send_outcome(taken);
                }
                None => self.send(&FromBoard::Tripped(Trip::WrongRole)),
            },
        }
    }

    /// Gives the tick an order; no further frame is read until the order is answered.
    fn order(&mut self, order: Order) {
        let _ = self.orders.enqueue(order);
        self.awaiting = true;
    }

    fn trip(&mut self, trip: Trip) {
        self.cause = Some(trip);
        self.order(Order::Trip(trip));
    }

    fn reset(&mut self, settings: RunSettings) {
        if settings.decimation == 0 || settings.command_timeout == 0 {
            return self.trip(Trip::BadSettings);
        }
        self.settings = settings;
        self.order(Order::Reset { settings, stops: self.stops });
    }

    /// Sends the outcome of a schedule.
    fn send_outcome(&mut self, taken: Taken) {
        match taken {
            Taken::Accepted(accepted) => self.send(&FromBoard::Accepted(accepted)),
            Taken::NotRunning => self.send(&FromBoard::Tripped(Trip::NotRunning)),
            Taken::Unfit(trip) => self.trip(trip),
            Taken::Nothing => {}
        }
    }

    fn begin(&mut self, request: MemoryRequest) {
        match self.memory_requests.begin(request, self.is_running()) {
            Reaction::Order(order) => self.order(order),
            Reaction::Say(answer) => self.send(&answer),
            Reaction::Wait => {}
        }
    }
}
