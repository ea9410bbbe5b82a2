//! A guest in the same controller: the motor controller's tick leaves samples, the guest's own task works on them, and
//! the next tick finds the answer. Two single-producer queues, lock-free; neither side ever waits for the other.

use heapless::spsc::{Consumer, Producer, Queue};
use model_core::compensation::Command;
use model_core::controller::Answer;
use model_core::observer::Samples;

use super::{ControllerPort, PortError, asked};

/// Places in either direction; one is lost to telling full from empty.
const PLACES: usize = 4;

/// One control tick's worth; without a set-point one of a width probe.
type Question = (Samples<f32>, Option<Command<f32>>);

/// The memory that is shared.
pub struct SharedMemory {
    questions: Queue<Question, PLACES>,
    answers: Queue<Answer<f32>, PLACES>,
}

/// The motor controller's side.
pub struct Host<'a> {
    questions: Producer<'a, Question>,
    answers: Consumer<'a, Answer<f32>>,
}

/// The guest's side.
pub struct Guest<'a> {
    questions: Consumer<'a, Question>,
    answers: Producer<'a, Answer<f32>>,
}

impl SharedMemory {
    /// Empty.
    pub const fn new() -> Self {
        Self { questions: Queue::new(), answers: Queue::new() }
    }

    /// Hands each side its end.
    pub fn split(&mut self) -> (Host<'_>, Guest<'_>) {
        let (question_in, question_out) = self.questions.split();
        let (answer_in, answer_out) = self.answers.split();
        (Host { questions: question_in, answers: answer_out }, Guest { questions: question_out, answers: answer_in })
    }
}

impl Default for SharedMemory {
    fn default() -> Self {
        Self::new()
    }
}

impl ControllerPort for Host<'_> {
    /// The newest answer is taken, older ones are dropped; a guest that has fallen behind loses these samples.
    fn exchange(&mut self, samples: &Samples<f32>, command: &Command<f32>) -> Result<Answer<f32>, PortError> {
        self.ask((*samples, Some(*command)))
    }

    fn probe(&mut self, samples: &Samples<f32>) -> Result<Answer<f32>, PortError> {
        self.ask((*samples, None))
    }

    fn reset(&mut self) {
        while self.answers.dequeue().is_some() {}
    }
}

impl Host<'_> {
    fn ask(&mut self, question: Question) -> Result<Answer<f32>, PortError> {
        let mut newest = None;
        for _ in 0..PLACES {
            let Some(answer) = self.answers.dequeue() else { break };
            newest = Some(answer);
        }
        let asked = self.questions.enqueue(question).is_ok();
        newest.filter(|_| asked).ok_or(PortError::Late)
    }
}

impl Guest<'_> {
    /// Works on one tick's samples, if there are any: to be called as often as the controller's tick comes.
    pub fn serve(&mut self, controller: &mut impl ControllerPort) -> bool {
        // An answer that nobody takes must not be worked for.
        if !self.answers.ready() {
            return false;
        }
        let Some((samples, command)) = self.questions.dequeue() else { return false };
        if let Ok(answer) = asked(controller, &samples, command.as_ref()) {
            let _ = self.answers.enqueue(answer);
        }
        true
    }
}
