//! One tick of the plant: take the torques that are due, step the model, extend the digest over its state, hand out a
//! sample every so often, and watch the clock. Called at the tick rate at the highest priority, it must end before the
//! next call: a miss is counted as an overrun. Nothing here allocates, panics, logs, loops without a bound or knows
//! what board it is on.

use core::convert::Infallible;
use core::sync::atomic::Ordering::{Acquire, Relaxed, Release};

use embedded_hal::digital::OutputPin;
use link::messages::{Fault, RunMode, RunSettings};
use model_core::digest;
use model_core::realtime::Model;
use model_core::tables::Tables;

use crate::budget::{Monitor, TickTimer};
use crate::queues::{COMMAND_CAPACITY, Event, Order, RawSample, TickEnd};
use crate::safe_state::{SafeState, State};
use crate::schedule::{Schedule, Turn};

/// What a board is told before its first reset.
const BEFORE_ANY_RUN: RunSettings = RunSettings { mode: RunMode::Lockstep, decimation: 1, command_timeout: 1 };

/// The simulated joint, its commands and its watchmen.
pub struct Plant<'a, E, const N: usize> {
    model: Model<'a, f32, N>,
    steps: u32,
    digest: u64,
    decimation: u16,
    until_sample: u16,
    schedule: Schedule,
    safe_state: SafeState<E>,
    monitor: Monitor,
    period: u32,
    end: TickEnd<'a, N>,
}

impl<'a, E: OutputPin<Error = Infallible>, const N: usize> Plant<'a, E, N> {
    /// A plant at rest with its enable output off; `period` is the tick's, in timer counts. Tables that do not match
    /// their digest leave it in the safe state for good.
    pub fn new(tables: &'a Tables<f32, N>, enable: E, period: u32, end: TickEnd<'a, N>) -> Self {
        let mut safe_state = SafeState::new(enable);
        if !tables.digest_is_good() {
            safe_state.trip(Fault::BadDigest);
        }
        let plant = Self {
            model: Model::new(tables),
            steps: 0,
            digest: digest::START,
            decimation: BEFORE_ANY_RUN.decimation,
            until_sample: BEFORE_ANY_RUN.decimation,
            schedule: Schedule::new(BEFORE_ANY_RUN),
            safe_state,
            monitor: Monitor::new(period),
            period,
            end,
        };
        plant.show_state();
        plant
    }

    /// What the board does.
    pub fn state(&self) -> State {
        self.safe_state.state()
    }

    /// One tick. Deadline: the next expiry of the timer.
    pub fn tick(&mut self, timer: &impl TickTimer) {
        let lateness = timer.since_expiry();
        self.end.progress.beats.store(self.end.progress.beats.load(Relaxed).wrapping_add(1), Relaxed);
        self.monitor.lateness.record(lateness);
        self.obey();
        let stepped = matches!(self.state(), State::Running) && self.advance(timer, lateness);
        let end = timer.since_expiry();
        if stepped {
            self.monitor.step_took(end.saturating_sub(lateness));
        }
        if end >= self.period {
            self.monitor.overruns = self.monitor.overruns.saturating_add(1);
        }
    }

    /// Takes one order: idle has at most one under way. Kept out of line, since its stack is not needed while stepping.
    #[inline(never)]
    fn obey(&mut self) {
        let event = match self.end.orders.take() {
            None => return,
            Some(Order::Reset(settings)) => self.reset(settings),
            Some(Order::Stop) => {
                self.safe_state.stop();
                Event::Stopped
            }
            Some(Order::Trip(fault)) => {
                self.safe_state.trip(fault);
                Event::Stopped
            }
            Some(Order::Report { reset }) => {
                let report = Event::Timing(self.monitor.clone());
                if reset {
                    self.monitor = Monitor::new(self.period);
                }
                report
            }
        };
        self.show_state();
        // Room is certain: idle takes the answer to an order before it gives the next.
        let _ = self.end.events.give(event);
    }

    fn reset(&mut self, settings: RunSettings) -> Event {
        if let Err(fault) = self.safe_state.run() {
            return Event::Refused(fault);
        }
        for _ in 0..COMMAND_CAPACITY {
            self.end.commands.take();
        }
        self.model.reset();
        self.steps = 0;
        self.digest = digest::START;
        self.decimation = settings.decimation.max(1);
        self.until_sample = self.decimation;
        self.schedule = Schedule::new(settings);
        self.monitor = Monitor::new(self.period);
        self.end.progress.steps.store(0, Release);
        Event::ResetDone
    }

    /// Steps the model if there is a step to do; says whether there was.
    fn advance(&mut self, timer: &impl TickTimer, lateness: u32) -> bool {
        let lockstep = self.schedule.mode() == RunMode::Lockstep;
        if lockstep && self.until_sample == 1 && !self.end.samples.has_room() {
            self.monitor.waited = self.monitor.waited.saturating_add(1);
            return false;
        }
        let horizon = self.end.progress.horizon.load(Acquire);
        match self.schedule.turn(self.steps, horizon, &mut self.end.commands) {
            Turn::Step => {}
            Turn::StarvedStep => self.monitor.starved = self.monitor.starved.saturating_add(1),
            Turn::Wait => {
                self.monitor.waited = self.monitor.waited.saturating_add(lockstep.into());
                return false;
            }
            Turn::Trip(fault) => {
                self.trip(fault);
                return false;
            }
        }
        self.model.step(self.schedule.torques());
        self.digest = digest::chain(self.digest, self.model.state_digest());
        self.steps = self.steps.wrapping_add(1);
        self.end.progress.steps.store(self.steps, Release);
        self.monitor.queue_low = self.monitor.queue_low.min(self.end.commands.count() as u16);
        if !self.model.is_finite() {
            self.trip(Fault::NotFinite { tick: self.steps });
        }
        self.until_sample -= 1;
        if self.until_sample == 0 {
            self.until_sample = self.decimation;
            self.hand_out_sample(timer.since_expiry().saturating_sub(lateness));
        }
        true
    }

    /// Kept out of line for the same reason.
    #[inline(never)]
    fn hand_out_sample(&mut self, computation: u32) {
        let sample = RawSample {
            tick: self.steps,
            state_digest: self.digest,
            outputs: self.model.outputs(),
            computation: computation.min(u16::MAX.into()) as u16,
        };
        if self.end.samples.give(sample).is_err() {
            self.monitor.lost_samples = self.monitor.lost_samples.saturating_add(1);
        }
    }

    fn show_state(&self) {
        self.end.progress.running.store(matches!(self.state(), State::Running), Release);
        self.end.progress.faulted.store(matches!(self.state(), State::Faulted(_)), Release);
    }

    fn trip(&mut self, fault: Fault) {
        self.safe_state.trip(fault);
        self.show_state();
        // Room is certain: a run trips once, and besides that only one answer can be under way.
        let _ = self.end.events.give(Event::Tripped(fault));
    }
}
