//! Memory of estimated parameters: saved, loaded by another observer at another place, rejected where it does not fit.

use std::sync::LazyLock;

use host_tests::tolerance::observer::GAP_COARSE;
use model_core::observer::{MAPPED, MEMORY_BYTES, Memory, MemoryError, Observer, PLAIN};

use crate::experiment::{Encoders, Experiment};
use crate::recording::PeriodSample;
use crate::replay::samples;

/// Experiment whose parameters have been estimated, its recording and the memory of its observer.
static LEARNT: LazyLock<(Experiment, Vec<PeriodSample>, Memory)> = LazyLock::new(|| {
    let experiment = Experiment::new("q1", "gravity", Encoders::Preset, Some(40e-6), 51).lasting(3.0);
    let log = experiment.record();
    let tables = experiment.tables();
    let mut observer = Observer::<f32, MAPPED>::new(&tables);
    for (period, moment) in log.iter().enumerate() {
        observer.step(&samples(&experiment.settings, moment, period));
    }
    let memory = observer.save();
    (experiment, log, memory)
});

/// An observer with a memory knows the gap from its first period.
#[test]
fn loaded_memory_makes_the_gap_valid() {
    let (experiment, log, memory) = &*LEARNT;
    let tables = experiment.tables();
    for loaded_at in [0, 5] {
        let mut observer = Observer::<f32, MAPPED>::new(&tables);
        let mut sum = 0.0;
        // The observer starts in the middle of the recording.
        let part = &log[13_000..18_000];
        for (period, moment) in part.iter().enumerate() {
            if period == loaded_at {
                observer.load(memory).expect("its own memory");
            }
            let estimates = observer.step(&samples(&experiment.settings, moment, period));
            if period >= 200 {
                sum += ((f64::from(estimates.gap.value) - moment.gap) / 160e-6).powi(2);
                assert!(estimates.gap.valid);
            }
        }
        GAP_COARSE.check((sum / (part.len() - 200) as f64).sqrt());
    }
}

/// Memories that do not fit are rejected and change nothing.
#[test]
fn unfit_memories_are_rejected() {
    let (experiment, _, memory) = &*LEARNT;
    let tables = experiment.tables();
    let refusal = |memory: &[u8]| {
        let mut observer = Observer::<f32, MAPPED>::new(&tables);
        let before = observer.save();
        let refusal = observer.load(memory).expect_err("it must be refused");
        assert_eq!(observer.save(), before);
        refusal
    };
    assert_eq!(refusal(&[]), MemoryError::NotAMemory);
    assert_eq!(refusal(&memory[..MEMORY_BYTES - 1]), MemoryError::NotAMemory);
    assert_eq!(refusal(&[0; MEMORY_BYTES]), MemoryError::NotAMemory);
    for place in [6, 20, 40, 300, MEMORY_BYTES - 1] {
        let mut damaged = *memory;
        damaged[place] ^= 1;
        assert_eq!(refusal(&damaged), MemoryError::Damaged);
    }
    let mut newer = *memory;
    newer[4] += 1;
    assert_eq!(refusal(&newer), MemoryError::WrongVersion);

    let other = Experiment::new("d2", "gravity", Encoders::Preset, None, 52);
    let tables = other.tables();
    let mut observer = Observer::<f32, MAPPED>::new(&tables);
    assert_eq!(observer.load(memory), Err(MemoryError::OtherJoint));
    let tables = experiment.tables();
    let mut plain = Observer::<f32, PLAIN>::new(&tables);
    assert_eq!(plain.load(memory), Err(MemoryError::OtherJoint));
}
