//! Text of the diagnostic channel on its way in and out.

use heapless::Vec;

/// Line under construction and answers that wait for a request.
#[derive(Debug, Clone, Default)]
pub(super) struct Channel {
    pub(super) line: Vec<u8, 96>,
    pub(super) answers: Vec<u8, 128>,
}

impl Channel {
    /// Takes up to `most` bytes of the answers.
    pub fn take(&mut self, most: usize) -> Vec<u8, 128> {
        let taken = self.answers.iter().copied().take(most).collect();
        self.answers = self.answers.iter().copied().skip(most).collect();
        taken
    }
}
