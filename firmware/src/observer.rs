//! Role `observer`: observer and compensation for a motor controller; samples and a set-point in, estimates and a
//! torque out, at most one exchange per tick. The role never steps without samples: a controller that stops sending
//! ends the run.

use link::controller::{Answered, EXCHANGES_PER_SCHEDULE, Exchange};
use link::messages::{FromBoard, Role, Schedule, ToBoard};
use model_core::controller::Answer;
use model_core::numbers::digest;
use model_core::observer::{Memory, MemoryError};

use crate::learnt::RunMemory;
use crate::port::{ControllerPort, asked};
use crate::protocol::{Batch, Protocol, Timed};
use crate::work::Work;

/// Messages of the role.
pub struct ObserverProtocol;

impl Protocol for ObserverProtocol {
    const ROLE: Role = Role::Observer;
    type Command = Exchange;
    type Timetable = Schedule<Exchange, EXCHANGES_PER_SCHEDULE>;
    type Sample = Answered;
    type Batch = AnswerBatch;
    type Learnt = Memory;

    fn timetable(message: ToBoard) -> Option<Self::Timetable> {
        if let ToBoard::Exchanges(schedule) = message { Some(schedule) } else { None }
    }
}

impl Timed for Exchange {
    fn tick(&self) -> u32 {
        self.tick
    }

    /// Always `true`: observer and compensation detect non-finite numbers themselves and continue.
    fn is_sound(&self) -> bool {
        true
    }
}

/// Batch of one answer: the controller waits for each answer.
#[derive(Debug, Default)]
pub struct AnswerBatch(Option<Answered>);

impl Batch for AnswerBatch {
    type Sample = Answered;

    fn add(&mut self, answered: &Answered) {
        self.0 = Some(answered.clone());
    }

    fn is_full(&self) -> bool {
        self.0.is_some()
    }

    fn is_empty(&self) -> bool {
        self.0.is_none()
    }

    fn take(&mut self) -> FromBoard {
        let empty = Answered {
            tick: 0,
            digest: 0,
            shaped: (&Answer::default().shaped).into(),
            estimates: None,
            probed: None,
            computation: 0,
        };
        FromBoard::Answer(self.0.take().unwrap_or(empty))
    }
}

/// State of the role `observer`.
pub struct Observing<P> {
    port: P,
    /// The memory at hand.
    run_memory: RunMemory,
    /// The tables match their digest.
    sound: bool,
    next: Option<Exchange>,
    answer: Answer<f32>,
    /// The last exchange requested estimates.
    wants_estimates: bool,
    digest: u64,
}

impl<P: ControllerPort> Observing<P> {
    /// Role that uses the controller behind `port`; `sound` is true if the controller's tables match their digest.
    pub fn new(port: P, sound: bool) -> Self {
        Self {
            port,
            run_memory: RunMemory::default(),
            sound,
            next: None,
            answer: Answer::default(),
            wants_estimates: false,
            digest: digest::START,
        }
    }
}

impl<P: ControllerPort> Work for Observing<P> {
    type Protocol = ObserverProtocol;
    const FREE_RUNNING: bool = false;

    fn is_sound(&self) -> bool {
        self.sound
    }

    fn reset(&mut self, from_memory: bool) {
        self.port.reset();
        if from_memory {
            self.run_memory.load_into(&mut self.port);
        }
        self.next = None;
        self.answer = Answer::default();
        self.wants_estimates = false;
        self.digest = digest::START;
    }

    fn take(&mut self, exchange: Exchange) {
        self.next = Some(exchange);
    }

    fn learn(&mut self) -> bool {
        self.run_memory.learn_from(&self.port)
    }

    fn learnt(&self) -> Option<&Memory> {
        self.run_memory.get()
    }

    fn remember(&mut self, memory: &Memory) -> Result<(), MemoryError> {
        self.run_memory.take(memory, &mut self.port)
    }

    fn remember_learnt(&mut self, learnt: &Memory) -> Result<(), MemoryError> {
        self.remember(learnt)
    }

    fn forget(&mut self) {
        self.run_memory.forget();
    }

    fn step(&mut self) {
        let Some(exchange) = self.next.take() else { return };
        self.wants_estimates = exchange.wants_estimates;
        if let Ok(answer) = asked(&mut self.port, &exchange.samples(), exchange.command().as_ref()) {
            self.answer = answer;
        }
        self.digest = self.answer.digest(self.digest);
    }

    fn is_finite(&self) -> bool {
        self.answer.shaped.torque.is_finite()
    }

    fn sample(&self, steps: u32, computation: u16) -> Answered {
        Answered {
            tick: steps,
            digest: self.digest,
            shaped: (&self.answer.shaped).into(),
            estimates: self.wants_estimates.then(|| (&self.answer.estimates).into()),
            probed: self.answer.probed.map(Into::into),
            computation,
        }
    }
}
