//! Memories with a correct digest whose numbers are impossible for any joint of the design.

use model_core::numbers::digest;
use model_core::observer::{MAPPED, MEMORY_BYTES, Memory, MemoryError, Observer, memory_numbers};

use super::attack::{PRESETS, RandomValues, Subject, finite};

/// Byte range of a memory's numbers.
const NUMBERS: std::ops::Range<usize> = 24..24 + 4 * (MAPPED + MAPPED * (MAPPED + 1) / 2 + 5 + 2);

/// Memory with one number replaced, and its digest corrected.
fn forged(memory: &Memory, place: usize, number: f32) -> Memory {
    let mut forged = *memory;
    forged[place..place + 4].copy_from_slice(&number.to_le_bytes());
    let sum = forged[..MEMORY_BYTES - 8].iter().fold(digest::START, |sum, byte| digest::chain(sum, (*byte).into()));
    forged[MEMORY_BYTES - 8..].copy_from_slice(&sum.to_le_bytes());
    forged
}

/// An impossible memory is rejected, and an accepted one keeps the estimates finite.
#[test]
fn impossible_memory_is_rejected() {
    let mut random = RandomValues::new(7, "memories");
    for name in PRESETS {
        let subject = Subject::preset(name);
        let (mut joint, mut controller) = (subject.joint(), subject.controller());
        for period in 0..subject.periods(2.0) {
            joint.advance(controller.step(&joint.samples(), &subject.swing(period)).shaped.torque, 0.0);
        }
        let memory = controller.save();
        assert_eq!(Observer::<f32, MAPPED>::new(&subject.observer).load(&memory), Ok(()), "its own");
        assert_eq!(memory_numbers(&memory).take((NUMBERS.len()) / 4).count(), NUMBERS.len() / 4);
        let mut refused = 0;
        let forgeries = 300;
        for _ in 0..forgeries {
            let place = NUMBERS.start + 4 * random.below(NUMBERS.len() as u64 / 4) as usize;
            let forged = forged(&memory, place, random.any_f32());
            let mut observer = Observer::<f32, MAPPED>::new(&subject.observer);
            let before = observer.save();
            match observer.load(&forged) {
                Ok(()) => {
                    let mut joint = subject.joint();
                    for _ in 0..200 {
                        let published = *observer.step(&joint.samples());
                        assert!(finite(&published), "{name}: byte {place} of the memory: {published:#?}");
                        joint.advance(0.1 * subject.limit, 0.0);
                    }
                }
                Err(error) => {
                    assert_eq!(error, MemoryError::OutOfRange, "{name}: byte {place}");
                    assert_eq!(observer.save(), before, "a refused memory changes nothing");
                    refused += 1;
                }
            }
        }
        println!("{name}: {refused} of {forgeries} refused");
        assert!(refused > forgeries / 2, "{name}: {refused} of {forgeries} nonsense memories refused");
    }
}

/// An impossible mobility of the link is rejected.
#[test]
fn impossible_mobility_is_rejected() {
    let subject = Subject::preset("q1");
    let memory = subject.controller().save();
    // Byte offset of the last but one number.
    let place = NUMBERS.end - 8;
    for mobility in [0.0, -1.0, 1e30] {
        let mut observer = Observer::<f32, MAPPED>::new(&subject.observer);
        assert_eq!(observer.load(&forged(&memory, place, mobility)), Err(MemoryError::OutOfRange), "{mobility}");
        assert_eq!(observer.load(&forged(&memory, place, 1.25)), Ok(()), "one that a link may have");
    }
}
