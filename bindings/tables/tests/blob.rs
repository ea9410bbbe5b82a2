//! Tables are read in place bit for bit as designed; changed ones are rejected with the reason.

use model_core::controller::ControllerDesign;
use model_core::controller::design::{ControlRequest, NominalPlant, wiring_table};
use model_core::gears::Tables;
use model_core::gears::design::{Effort, Processor, design_scheme};
use model_core::gears::tables::Scheme;
use model_core::numbers::digest;
use model_core::virtual_joint::design::design_surroundings;
use table_blob::{Blob, BlobError, Gears, VERSION, Wanted, design};

const REQUEST: ControlRequest = ControlRequest::USUAL;
/// Indices of the words with version and size, and with the digest.
const VERSION_AT: usize = 1;
const DIGEST_AT: usize = 2;

fn joint(name: &str) -> joint_file::JointFile {
    joint_file::read(joint_file::preset(name).unwrap()).unwrap()
}

fn blob(name: &str) -> Vec<u64> {
    let joint = joint(name);
    let nominal = NominalPlant { joint: &joint.parameters, surroundings: &joint.surroundings, request: REQUEST };
    let plant = Some((&joint.parameters, &joint.surroundings));
    design(&Wanted { plant, nominal, processor: Processor::STM32F405 }).unwrap()
}

/// Replaces the digest by the right one, as somebody would who changes tables on purpose.
fn with_right_digest(mut words: Vec<u64>) -> Vec<u64> {
    let others = words.iter().enumerate().filter(|(index, _)| *index != DIGEST_AT);
    words[DIGEST_AT] = others.fold(digest::START, |running, (_, word)| digest::chain(running, *word));
    words
}

#[test]
fn tables_read_in_place_as_designed() {
    for name in ["q1", "s1", "d2", "l1"] {
        let (words, joint) = (blob(name), joint(name));
        let blob = Blob::open(&words).unwrap();
        let nominal = NominalPlant { joint: &joint.parameters, surroundings: &joint.surroundings, request: REQUEST };
        let tables = ControllerDesign::for_plant(&nominal).unwrap();
        assert_eq!(blob.observer().unwrap(), &tables.observer);
        assert_eq!(blob.probe().ok(), tables.probe.as_ref());
        assert_eq!(blob.compensation().unwrap(), &tables.compensation);
        assert_eq!(blob.wiring().unwrap(), &wiring_table(&nominal).unwrap());
        let (gears, around) = blob.plant().unwrap();
        let rate = joint.surroundings.control_rate;
        if let Gears::Three(gears) = gears {
            let effort = Effort::Within(Processor::STM32F405);
            let designed: Tables<f32, 3> = design_scheme(&joint.parameters, rate, Scheme::Realtime, effort).unwrap();
            assert_eq!(gears, &designed);
            assert!(gears.digest_is_good());
            assert_eq!(around, &design_surroundings(&joint.parameters, &joint.surroundings, &designed).unwrap());
        }
        assert_eq!(blob.header().control_rate, rate);
    }
}

#[test]
fn equivalent_gear_has_plant_tables() {
    assert!(matches!(Blob::open(&blob("c1")).unwrap().plant().unwrap().0, Gears::One(_)));
}

#[test]
fn changed_word_rejected() {
    let words = blob("q1");
    for index in 0..words.len() {
        let mut changed = words.clone();
        changed[index] ^= 1 << (index % 64);
        assert!(Blob::open(&changed).is_err(), "word {index}");
    }
}

#[test]
fn foreign_tables_rejected_with_reason() {
    let words = blob("q1");
    let refused = |words: &[u64]| Blob::open(words).err();
    assert_eq!(refused(&[]), Some(BlobError::NotTables));
    assert_eq!(refused(&[0; 100]), Some(BlobError::NotTables));
    assert_eq!(refused(&words[..words.len() - 1]), Some(BlobError::WrongSize));
    let mut newer = words.clone();
    newer[VERSION_AT] += 1;
    assert_eq!(newer[VERSION_AT] as u32, VERSION + 1);
    assert_eq!(refused(&with_right_digest(newer)), Some(BlobError::WrongVersion));
    let mut damaged = words.clone();
    *damaged.last_mut().unwrap() ^= 1;
    assert_eq!(refused(&damaged), Some(BlobError::Damaged));
}

#[test]
fn invalid_values_rejected_despite_digest() {
    let words = blob("q1");
    let observer = std::ptr::from_ref(Blob::open(&words).unwrap().observer().unwrap()) as usize;
    let begin = words.as_ptr() as usize;
    // The boolean of the counts is neither zero nor one.
    let at = observer - begin + std::mem::offset_of!(model_core::observer::ObserverTables<f32>, counts.has_output);
    let mut wrong = words.clone();
    wrong[at / 8] = wrong[at / 8] & !(0xff << (8 * (at % 8))) | 7 << (8 * (at % 8));
    let wrong = with_right_digest(wrong);
    assert_eq!(Blob::open(&wrong).unwrap().observer().err(), Some(BlobError::Damaged));
    assert!(Blob::open(&wrong).unwrap().compensation().is_ok());
}
