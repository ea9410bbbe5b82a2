//! Text of the diagnostic channel on its way in and out.

use heapless::{Deque, Vec};

use crate::frame::MAX_DATA;

/// Line under construction and answers that wait for a request.
#[derive(Debug, Clone, Default)]
pub(super) struct Channel {
    pub(super) line: Vec<u8, 96>,
    answers: Deque<u8, 128>,
}

impl Channel {
    /// Adds an answer. Answers that nobody fetches are lost.
    pub fn answer(&mut self, text: &[u8]) {
        if text.len() <= self.answers.capacity() - self.answers.len() {
            text.iter().for_each(|byte| {
                let _ = self.answers.push_back(*byte);
            });
        }
    }

    /// Takes up to `most` bytes of the answers, at most those of a frame.
    pub fn take(&mut self, most: usize) -> Vec<u8, MAX_DATA> {
        let mut taken = Vec::new();
        for _ in 0..most.min(MAX_DATA) {
            let Some(byte) = self.answers.pop_front() else { break };
            let _ = taken.push(byte);
        }
        taken
    }
}
