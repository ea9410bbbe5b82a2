//! Messages of a session as received, and the commands that the board has acknowledged. Gaps in sequence numbers are
//! counted here; conversion to SI units and verdicts are in `joint-run`.

use link::messages::{Accepted, Command, FromBoard, Hello, Log, RunSettings, Sample, SampleBatch, Statistics, Trip};

/// Messages and counters of one session.
#[derive(Debug, Clone, Default)]
pub struct Recording {
    /// Identity of the board.
    pub hello: Option<Hello>,
    /// Settings of the run.
    pub settings: Option<RunSettings>,
    /// Commands in acknowledged schedules, in the order sent.
    pub accepted: Vec<Command>,
    /// Samples in order of arrival.
    pub samples: Vec<Sample>,
    /// Most recent statistics.
    pub statistics: Option<Statistics>,
    /// Trips in order of arrival.
    pub trips: Vec<Trip>,
    /// Encoded log, with lost frames left out.
    pub log: Vec<u8>,
    /// Traffic on the line.
    pub traffic: Traffic,
    next_batch: u16,
    next_log: Option<u16>,
}

/// Traffic and losses on the line, counted on the host.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Traffic {
    /// Bytes to the board.
    pub sent_bytes: u64,
    /// Bytes from the board.
    pub received_bytes: u64,
    /// Good messages from the board.
    pub messages: u64,
    /// Frames dropped on the host during the run for a bad CRC, length or content.
    pub bad_frames: u32,
    /// Sample batches missing in the sequence.
    pub lost_batches: u32,
    /// Log frames missing in the sequence.
    pub lost_logs: u32,
}

impl Recording {
    /// Stores a message by its kind.
    pub fn store(&mut self, message: FromBoard) {
        self.traffic.messages += 1;
        match message {
            FromBoard::Hello(hello) => self.hello = Some(hello),
            FromBoard::Accepted(_) => {}
            FromBoard::Samples(batch) => self.store_samples(batch),
            FromBoard::Statistics(statistics) => self.statistics = Some(statistics),
            // Schedules in flight when a run stops are refused; the refusal repeats the trip.
            FromBoard::Tripped(Trip::NotRunning) if !self.trips.is_empty() => {}
            FromBoard::Tripped(trip) => self.trips.push(trip),
            FromBoard::Log(log) => self.store_log(&log),
            // Kept by the caller that asked for them.
            FromBoard::Answer(_)
            | FromBoard::Loop(_)
            | FromBoard::FaultTaken { .. }
            | FromBoard::MemoryOutcome(_)
            | FromBoard::Memory(_)
            | FromBoard::MemoryChecked(_) => {}
        }
    }

    /// Starts a run: clears everything but the log and the board's identity.
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

    /// Drops samples after a tick.
    pub fn drop_samples_after(&mut self, tick: u32) {
        self.samples.retain(|sample| sample.tick <= tick);
    }

    /// Tick of the last received sample.
    pub fn last_tick(&self) -> u32 {
        self.samples.last().map_or(0, |sample| sample.tick)
    }

    fn store_samples(&mut self, batch: SampleBatch) {
        let Some(lost) = lost_frames(self.next_batch, batch.sequence) else { return };
        self.traffic.lost_batches += lost;
        self.next_batch = batch.sequence.wrapping_add(1);
        self.samples.extend(batch.samples);
    }

    fn store_log(&mut self, log: &Log) {
        let Some(lost) = lost_frames(self.next_log.unwrap_or(log.sequence), log.sequence) else { return };
        self.traffic.lost_logs += lost;
        self.next_log = Some(log.sequence.wrapping_add(1));
        self.log.extend_from_slice(&log.bytes);
    }
}

/// Number of frames missing before `sequence`, or `None` for a repeated frame. Sequence numbers rise, so a number more
/// than half the range ahead is an old one.
pub fn lost_frames(next: u16, sequence: u16) -> Option<u32> {
    let gap = sequence.wrapping_sub(next);
    (gap <= u16::MAX / 2).then_some(gap.into())
}

/// Schedules sent and not yet acknowledged.
#[derive(Debug, Default)]
pub struct UnacknowledgedSchedules {
    schedules: Vec<(u16, Vec<Command>)>,
}

impl UnacknowledgedSchedules {
    /// Records a schedule as sent.
    pub fn add(&mut self, sequence: u16, commands: &[Command]) {
        self.schedules.push((sequence, commands.to_vec()));
    }

    /// Removes an acknowledged schedule and returns its commands; empty if no such schedule was sent.
    pub fn remove(&mut self, accepted: Accepted) -> Vec<Command> {
        let place = self.schedules.iter().position(|(sequence, _)| *sequence == accepted.sequence);
        place.map(|place| self.schedules.remove(place).1).unwrap_or_default()
    }

    /// Number of schedules in flight.
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

    /// A gap counts by its width, also where sequence numbers wrap.
    #[test]
    fn lost_batches_counted_over_wrap() {
        let mut recording = Recording { next_batch: u16::MAX - 1, ..Recording::default() };
        [u16::MAX - 1, u16::MAX, 0, 3, 4].into_iter().for_each(|sequence| recording.store(batch(sequence)));
        assert_eq!(recording.traffic.lost_batches, 2);
    }

    /// Batches lost before the first received one count.
    #[test]
    fn lost_first_batches_counted() {
        let mut recording = Recording::default();
        recording.store(batch(2));
        assert_eq!(recording.traffic.lost_batches, 2);
    }

    /// Repeated batches and log frames are dropped and do not count as lost.
    #[test]
    fn repeated_frames_kept_once() {
        let mut recording = Recording::default();
        [0, 1, 1, 0, 2].into_iter().for_each(|sequence| recording.store(batch_of_one(sequence)));
        [5, 6, 6].into_iter().for_each(|sequence| recording.store(log(sequence)));
        assert_eq!((recording.traffic.lost_batches, recording.samples.len()), (0, 3));
        assert_eq!((recording.traffic.lost_logs, recording.log.len()), (0, 4));
    }

    /// A log may begin at any sequence number; gaps after it count.
    #[test]
    fn log_may_start_at_any_frame() {
        let mut recording = Recording::default();
        [7, 8, 10].into_iter().for_each(|sequence| recording.store(log(sequence)));
        assert_eq!((recording.traffic.lost_logs, recording.log.len()), (1, 6));
    }
}
