//! Port to a guest on the same chip: the motor controller's tick queues samples, the guest's own task works on them,
//! and the next tick finds the answer. Two lock-free single-producer queues; neither side waits for the other.

use heapless::spsc::{Consumer, Producer, Queue};
use model_core::compensation::Command;
use model_core::controller::Answer;
use model_core::observer::Samples;

use super::{ControllerPort, PortError, asked};

/// Places per direction; one stays empty to tell a full queue from an empty one.
const PLACES: usize = 4;

/// Samples of one control tick; without a set-point, of a width probe.
type Question = (Samples<f32>, Option<Command<f32>>);

/// Queues shared by both sides.
pub struct SharedMemory {
    questions: Queue<Question, PLACES>,
    answers: Queue<Answer<f32>, PLACES>,
}

/// Motor controller's side.
pub struct Host<'a> {
    questions: Producer<'a, Question>,
    answers: Consumer<'a, Answer<f32>>,
}

/// Guest's side.
pub struct Guest<'a> {
    questions: Consumer<'a, Question>,
    answers: Producer<'a, Answer<f32>>,
}

impl SharedMemory {
    /// Empty queues.
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
    /// Returns the newest answer and drops older ones. If the guest has fallen behind, these samples are dropped.
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
    /// Processes the samples of one tick, if there are any; to be called at the control rate.
    pub fn serve(&mut self, controller: &mut impl ControllerPort) -> bool {
        // Without room for an answer there is no work.
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
