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
        let (taken, rest) = self.answers.split_at_checked(most).unwrap_or((&self.answers, &[]));
        // Both parts fit, since the whole does.
        let [taken, rest] = [taken, rest].map(|part| Vec::from_slice(part).unwrap_or_default());
        self.answers = rest;
        taken
    }
}
