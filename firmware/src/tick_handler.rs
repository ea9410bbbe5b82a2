//! Tick of any role: handles an order from idle, takes the command that is due, steps the role's work, hands out a
//! sample every `decimation` steps, and records its time. It is called at the tick rate at the highest priority; a tick
//! that has not ended when the next one is due counts as an overrun. The tick does not allocate, panic, log, loop
//! without a bound or depend on the board.

use core::convert::Infallible;
use core::sync::atomic::Ordering::{Acquire, Relaxed, Release};

use embedded_hal::digital::OutputPin;
use link::messages::{MemoryOutcome, RunMode, RunSettings, Trip};

use crate::learnt::{Learnt, memory_state};
use crate::protocol::Protocol;
use crate::queues::{BEFORE_ANY_RUN, COMMAND_CAPACITY, Event, Order, TickEnd};
use crate::safe_state::{SafeState, State};
use crate::schedule::{Schedule, TickAction};
use crate::serial::Heard;
use crate::silence::{Host, Silence};
use crate::timing_monitor::{Monitor, TickTimer};
use crate::work::Work;

/// A role's work with its command schedule, safe state and timing monitor.
pub struct TickHandler<'a, E, W: Work> {
    work: W,
    steps: u32,
    /// A reset was accepted, and the work has not been reset yet.
    is_fresh: bool,
    decimation: u16,
    until_sample: u16,
    schedule: Schedule,
    safe_state: SafeState<E>,
    monitor: Monitor,
    period: u32,
    end: TickEnd<'a, W::Protocol>,
    heard: &'a Heard,
    silence: Silence,
    /// Stop frames received before this run.
    stops: u32,
}

impl<'a, E: OutputPin<Error = Infallible>, W: Work> TickHandler<'a, E, W> {
    /// Work at rest with the enable output off; `period` is the tick period in timer counts. Tables that do not match
    /// their digest trip the safe state for good. `heard` counts the frames that the line's interrupt has received.
    pub fn new(work: W, enable: E, period: u32, end: TickEnd<'a, W::Protocol>, heard: &'a Heard) -> Self {
        let mut safe_state = SafeState::new(enable);
        if !work.is_sound() {
            safe_state.trip(Trip::BadDigest);
        }
        let control = Self {
            work,
            steps: 0,
            is_fresh: false,
            decimation: BEFORE_ANY_RUN.decimation,
            until_sample: BEFORE_ANY_RUN.decimation,
            schedule: Schedule::new(BEFORE_ANY_RUN),
            safe_state,
            monitor: Monitor::new(period),
            period,
            end,
            heard,
            silence: Silence::new(BEFORE_ANY_RUN.command_timeout),
            stops: 0,
        };
        control.show_state();
        control
    }

    /// State of the board.
    pub fn state(&self) -> State {
        self.safe_state.state()
    }

    /// Runs one tick. Deadline: the next expiry of the timer.
    pub fn tick(&mut self, timer: &impl TickTimer) {
        let lateness = timer.since_expiry();
        self.end.progress.ticks.store(self.end.progress.ticks.load(Relaxed).wrapping_add(1), Relaxed);
        self.monitor.lateness.record(lateness);
        self.obey();
        let host = self.silence.after(self.heard.frames());
        let stepped =
            matches!(self.state(), State::Running) && self.host_allows_run(host) && self.advance(timer, lateness);
        let end = timer.since_expiry();
        if stepped {
            self.monitor.record_step(end.saturating_sub(lateness));
        }
        if end >= self.period {
            self.monitor.overruns = self.monitor.overruns.saturating_add(1);
        }
    }

    /// Handles one order; at most one is pending. Its parts are not inlined: the tick's step does not need their stack,
    /// nor does one part need the stack of another.
    fn obey(&mut self) {
        match self.end.orders.take() {
            None => {}
            Some(Order::SaveMemory) if !matches!(self.state(), State::Running) => {
                let there_is = self.work.learn();
                self.hand_out_memory(there_is);
            }
            Some(Order::LoadMemory) => self.take_memory(),
            Some(order) => {
                self.answer(order);
                if let (Order::Reset { settings, .. }, true) = (order, self.is_fresh) {
                    self.is_fresh = false;
                    self.work.reset(settings.from_memory);
                }
            }
        }
    }

    #[inline(never)]
    fn answer(&mut self, order: Order) {
        let event = match order {
            Order::Reset { settings, stops } => self.reset(settings, stops),
            Order::Stop => {
                self.safe_state.stop();
                Event::Stopped
            }
            Order::Trip(trip) => {
                self.safe_state.trip(trip);
                Event::Stopped
            }
            Order::SaveMemory => Event::MemoryReady(Err(MemoryOutcome::Running)),
            // Handled by `obey`, where this function's stack is not in use.
            Order::LoadMemory => return,
            Order::DiscardMemory => {
                self.work.forget();
                Event::MemoryDiscarded
            }
            Order::Fault(fault) => {
                let begins = matches!(self.state(), State::Running) && self.steps == 0;
                Event::FaultTaken { taken: begins && self.work.add_fault(fault) }
            }
            Order::Report { reset } => {
                let report = Event::Timing(self.monitor.clone());
                if reset {
                    self.monitor = Monitor::new(self.period);
                }
                report
            }
        };
        self.show_state();
        // There is always room: idle takes the answer to an order before it gives the next order.
        let _ = self.end.events.enqueue(event);
    }

    #[inline(never)]
    fn hand_out_memory(&mut self, there_is: bool) {
        let memory = self.work.learnt().filter(|_| there_is);
        // The queue is free: idle has taken the memory before.
        let given = memory.is_some_and(|memory| self.end.learnt.enqueue(memory.clone()).is_ok());
        let _ = self.end.events.enqueue(Event::MemoryReady(if given { Ok(()) } else { Err(MemoryOutcome::Nothing) }));
    }

    /// Takes a memory from idle, which sends memories between runs only.
    #[inline(never)]
    fn take_memory(&mut self) {
        if <W::Protocol as Protocol>::Learnt::EMPTY.is_none() {
            return;
        }
        // Checked in place: the stack has no room for a copy.
        let Some(learnt) = self.end.remembered.peek() else { return };
        let judged = self.work.remember_learnt(learnt);
        self.end.remembered.take();
        let _ = self.end.events.enqueue(Event::MemoryChecked(memory_state(Some(judged))));
    }

    fn reset(&mut self, settings: RunSettings, stops: u32) -> Event {
        if settings.mode == RunMode::Realtime && !W::FREE_RUNNING {
            return Event::Refused(Trip::BadSettings);
        }
        if stops != self.heard.stops() || !self.silence.allows(settings.command_timeout, self.heard.frames()) {
            return Event::Refused(Trip::Overtaken);
        }
        if let Err(trip) = self.safe_state.run() {
            return Event::Refused(trip);
        }
        for _ in 0..COMMAND_CAPACITY {
            self.end.commands.take();
        }
        self.is_fresh = true;
        self.steps = 0;
        self.decimation = settings.decimation.max(1);
        self.until_sample = self.decimation;
        self.schedule = Schedule::new(settings);
        self.monitor = Monitor::new(self.period);
        self.end.progress.horizon.store(0, Release);
        self.end.progress.steps.store(0, Release);
        self.stops = stops;
        Event::ResetDone
    }

    /// Returns `true` if a frame has arrived in time and none was a stop. Frames that idle has not read yet count.
    fn host_allows_run(&mut self, host: Host) -> bool {
        match host {
            Host::IsThere => true,
            Host::HasSpoken => {
                let goes_on = self.heard.stops() == self.stops;
                if !goes_on {
                    self.safe_state.stop();
                    self.show_state();
                }
                goes_on
            }
            Host::IsSilent => {
                self.trip(Trip::CommandLoss { tick: self.steps });
                false
            }
        }
    }

    /// Steps if a step is due; returns `true` if it did.
    fn advance(&mut self, timer: &impl TickTimer, lateness: u32) -> bool {
        let lockstep = self.schedule.mode() == RunMode::Lockstep;
        if lockstep && self.until_sample == 1 && !self.end.samples.has_room() {
            self.monitor.waited = self.monitor.waited.saturating_add(1);
            return false;
        }
        let horizon = self.end.progress.horizon.load(Acquire);
        match self.schedule.next_action(self.steps, horizon, W::FREE_RUNNING, &mut self.end.commands) {
            TickAction::Step(None) => {}
            TickAction::Step(Some(command)) => self.work.take(command),
            TickAction::StarvedStep => self.monitor.starved = self.monitor.starved.saturating_add(1),
            TickAction::Wait => {
                self.monitor.waited = self.monitor.waited.saturating_add(lockstep.into());
                return false;
            }
            TickAction::Trip(trip) => {
                self.trip(trip);
                return false;
            }
        }
        self.work.step();
        self.steps = self.steps.wrapping_add(1);
        self.end.progress.steps.store(self.steps, Release);
        self.monitor.queue_low = self.monitor.queue_low.min(self.end.commands.count() as u16);
        self.until_sample -= 1;
        if self.until_sample == 0 {
            self.until_sample = self.decimation;
            self.hand_out_sample(timer.since_expiry().saturating_sub(lateness));
        }
        // After the sample, so that idle finds the last sample before the trip.
        if !self.work.is_finite() {
            self.trip(Trip::NotFinite { tick: self.steps });
        }
        true
    }

    /// Not inlined: the step does not need its stack.
    #[inline(never)]
    fn hand_out_sample(&mut self, computation: u32) {
        let sample = self.work.sample(self.steps, computation.min(u16::MAX.into()) as u16);
        if self.end.samples.enqueue(sample).is_err() {
            self.monitor.lost_samples = self.monitor.lost_samples.saturating_add(1);
        }
    }

    fn show_state(&self) {
        self.end.progress.running.store(matches!(self.state(), State::Running), Release);
        self.end.progress.tripped.store(matches!(self.state(), State::Tripped(_)), Release);
    }

    fn trip(&mut self, trip: Trip) {
        self.safe_state.trip(trip);
        self.show_state();
        // There is always room: a run trips once, and at most one other event, an answer, is pending.
        let _ = self.end.events.enqueue(Event::Tripped(trip));
    }
}
