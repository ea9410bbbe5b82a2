//! What a session received from the board, and which commands the board has acknowledged, both unprocessed. Gaps in
//! sequence numbers are counted here; conversion to SI units and verdicts are in `joint-run`.

use link::messages::{Accepted, Command, FromBoard, Hello, Log, RunSettings, Sample, SampleBatch, Statistics, Trip};

/// Everything of one session.
#[derive(Debug, Clone, Default)]
pub struct Recording {
    /// Who the board said it was.
    pub hello: Option<Hello>,
    /// What the run was started with.
    pub settings: Option<RunSettings>,
    /// Commands in schedules that the board said it took, in the order sent.
    pub accepted: Vec<Command>,
    /// Samples in the order in which they came.
    pub samples: Vec<Sample>,
    /// The last statistics.
    pub statistics: Option<Statistics>,
    /// Faults in the order in which they came.
    pub trips: Vec<Trip>,
    /// Encoded log, with the gaps left out.
    pub log: Vec<u8>,
    /// What went over the line and what was lost on it.
    pub traffic: Traffic,
    next_batch: u16,
    next_log: Option<u16>,
}

/// What went over the line and what was lost on it, seen from the host.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Traffic {
    /// Bytes to the board.
    pub sent_bytes: u64,
    /// Bytes from the board.
    pub received_bytes: u64,
    /// Good messages from the board.
    pub messages: u64,
    /// Frames dropped here during the run for a bad CRC, length or content.
    pub bad_frames: u32,
    /// Sample batches missing by sequence number.
    pub lost_batches: u32,
    /// Log frames missing by sequence number.
    pub lost_logs: u32,
}

impl Recording {
    /// Stores a message by its kind.
    pub fn take(&mut self, message: FromBoard) {
        self.traffic.messages += 1;
        match message {
            FromBoard::Hello(hello) => self.hello = Some(hello),
            FromBoard::Accepted(_) => {}
            FromBoard::Samples(batch) => self.take_samples(batch),
            FromBoard::Statistics(statistics) => self.statistics = Some(statistics),
            // Schedules that were under way when a run stopped are refused: that says nothing new.
            FromBoard::Tripped(Trip::NotRunning) if !self.trips.is_empty() => {}
            FromBoard::Tripped(trip) => self.trips.push(trip),
            FromBoard::Log(log) => self.take_log(&log),
            // Kept by the caller that asked for them.
            FromBoard::Answer(_)
            | FromBoard::Loop(_)
            | FromBoard::FaultTaken { .. }
            | FromBoard::MemoryOutcome(_)
            | FromBoard::Memory(_)
            | FromBoard::MemoryChecked(_) => {}
        }
    }

    /// A run starts: only the log and the board's name go on.
    pub fn start_run(&mut self, settings: RunSettings) {
        let log = std::mem::take(&mut self.log);
        let lost_logs = self.traffic.lost_logs;
        *self = Self {
            hello: self.hello.take(),
            settings: Some(settings),
            log,
            next_log: self.next_log,
            traffic: Traffic { lost_logs, ..Traffic::default() },
            ..Self::default()
        };
    }

    /// Forgets samples after a tick.
    pub fn keep_until(&mut self, tick: u32) {
        self.samples.retain(|sample| sample.tick <= tick);
    }

    /// Last tick that the board is known to have done.
    pub fn last_tick(&self) -> u32 {
        self.samples.last().map_or(0, |sample| sample.tick)
    }

    fn take_samples(&mut self, batch: SampleBatch) {
        let Some(lost) = missing(self.next_batch, batch.sequence) else { return };
        self.traffic.lost_batches += lost;
        self.next_batch = batch.sequence.wrapping_add(1);
        self.samples.extend(batch.samples);
    }

    fn take_log(&mut self, log: &Log) {
        let Some(lost) = missing(self.next_log.unwrap_or(log.sequence), log.sequence) else { return };
        self.traffic.lost_logs += lost;
        self.next_log = Some(log.sequence.wrapping_add(1));
        self.log.extend_from_slice(&log.bytes);
    }
}

/// How many numbers are missing before one that has come; none if that one comes once more, as on a line that says a frame
/// twice: numbers rise, so that one far ahead is one from behind.
pub fn missing(next: u16, sequence: u16) -> Option<u32> {
    let gap = sequence.wrapping_sub(next);
    (gap <= u16::MAX / 2).then_some(gap.into())
}

/// Schedules that were sent and not yet answered for.
#[derive(Debug, Default)]
pub struct UnacknowledgedSchedules {
    schedules: Vec<(u16, Vec<Command>)>,
}

impl UnacknowledgedSchedules {
    /// A schedule has been sent.
    pub fn sent(&mut self, sequence: u16, commands: &[Command]) {
        self.schedules.push((sequence, commands.to_vec()));
    }

    /// The board took one: its commands; none if it was not asked.
    pub fn acknowledged(&mut self, accepted: Accepted) -> Vec<Command> {
        let place = self.schedules.iter().position(|(sequence, _)| *sequence == accepted.sequence);
        place.map(|place| self.schedules.remove(place).1).unwrap_or_default()
    }

    /// How many are under way.
    pub fn count(&self) -> usize {
        self.schedules.len()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn batch(sequence: u16) -> FromBoard {
        FromBoard::Samples(SampleBatch { sequence, samples: heapless::Vec::new() })
    }

    fn batch_of_one(sequence: u16) -> FromBoard {
        let sample = Sample {
            tick: sequence.into(),
            state_digest: 0,
            carrier_turns: 0,
            carrier_fraction: 0,
            carrier_speed: 0.0,
            motor_offset: 0.0,
            link_offset: 0.0,
            gap: 0.0,
            wind_up: 0.0,
            deflections: heapless::Vec::new(),
            contacts: 0,
            computation: 0,
        };
        FromBoard::Samples(SampleBatch { sequence, samples: [sample].into_iter().collect() })
    }

    fn log(sequence: u16) -> FromBoard {
        FromBoard::Log(Log { sequence, bytes: heapless::Vec::from_slice(&[1, 2]).expect("room") })
    }

    #[test]
    fn a_gap_in_the_batches_is_counted_by_its_width_also_over_the_wrap() {
        let mut recording = Recording { next_batch: u16::MAX - 1, ..Recording::default() };
        [u16::MAX - 1, u16::MAX, 0, 3, 4].into_iter().for_each(|sequence| recording.take(batch(sequence)));
        assert_eq!(recording.traffic.lost_batches, 2);
    }

    #[test]
    fn batches_lost_at_the_very_start_are_counted() {
        let mut recording = Recording::default();
        recording.take(batch(2));
        assert_eq!(recording.traffic.lost_batches, 2);
    }

    #[test]
    fn a_batch_or_a_log_that_comes_twice_is_kept_once_and_nothing_counts_as_lost() {
        let mut recording = Recording::default();
        [0, 1, 1, 0, 2].into_iter().for_each(|sequence| recording.take(batch_of_one(sequence)));
        [5, 6, 6].into_iter().for_each(|sequence| recording.take(log(sequence)));
        assert_eq!((recording.traffic.lost_batches, recording.samples.len()), (0, 3));
        assert_eq!((recording.traffic.lost_logs, recording.log.len()), (0, 4));
    }

    #[test]
    fn a_log_may_be_joined_anywhere_but_not_lose_a_frame() {
        let mut recording = Recording::default();
        [7, 8, 10].into_iter().for_each(|sequence| recording.take(log(sequence)));
        assert_eq!((recording.traffic.lost_logs, recording.log.len()), (1, 6));
    }
}
