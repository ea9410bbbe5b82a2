//! Designs a joint's tables and writes them as a blob.

use model_core::controller::ControllerDesign;
use model_core::controller::design::{NominalPlant, wiring_table};
use model_core::gears::design::{DesignError, Effort, Processor, design_scheme};
use model_core::gears::{Scheme, Tables};
use model_core::observer::design::CLOCK_TICKS;
use model_core::virtual_joint::SurroundingsTable;
use model_core::virtual_joint::design::design_surroundings;
use parameters::{JointParameters, ParameterError, Surroundings};

use crate::fixed::Fixed;
use crate::{HEADER_BYTES, Header, MARK, NAME_BYTES, PARTS, Part, VERSION, WORD, digest_of};

/// Requirements of a blob.
#[derive(Debug, Clone, Copy)]
pub struct Wanted<'a> {
    /// Joint and surroundings, if a plant is wanted.
    pub plant: Option<(&'a JointParameters, &'a Surroundings)>,
    /// Joint as told to the controller.
    pub nominal: NominalPlant<'a>,
    /// Processor for which a plant's sub-steps are chosen.
    pub processor: Processor,
}

/// Designs the blob, as little-endian words.
///
/// ```
/// use model_core::controller::design::{ControlRequest, NominalPlant};
/// use model_core::gears::design::Processor;
/// use table_blob::{Blob, Wanted, design};
///
/// let q1 = joint_file::read(joint_file::preset("q1").unwrap()).unwrap();
/// let request = ControlRequest::USUAL;
/// let nominal = NominalPlant { joint: &q1.parameters, surroundings: &q1.surroundings, request };
/// let words = design(&Wanted { plant: None, nominal, processor: Processor::STM32F405 })?;
/// let blob = Blob::open(&words).unwrap();
/// assert_eq!(blob.observer().unwrap().control_rate, q1.surroundings.control_rate);
/// assert!(blob.plant().is_err(), "none was wanted");
/// # Ok::<(), model_core::gears::design::DesignError>(())
/// ```
pub fn design(wanted: &Wanted<'_>) -> Result<Vec<u64>, DesignError> {
    let ControllerDesign { observer, probe, compensation } = ControllerDesign::for_plant(&wanted.nominal)?;
    let wiring = wiring_table(&wanted.nominal)?;
    let mut blob = Writer { bytes: vec![0; HEADER_BYTES], parts: [Part::default(); PARTS] };
    let mut planets = 0;
    if let Some((joint, around)) = wanted.plant {
        planets = joint.geometry.planets as u32;
        match planets {
            1 => plant::<1>(&mut blob, joint, around, &wanted.processor)?,
            3 => plant::<3>(&mut blob, joint, around, &wanted.processor)?,
            4 => plant::<4>(&mut blob, joint, around, &wanted.processor)?,
            5 => plant::<5>(&mut blob, joint, around, &wanted.processor)?,
            _ => return Err(ParameterError::PlanetCount { given: joint.geometry.planets }.into()),
        }
    }
    blob.add(2, &observer);
    if let Some(probe) = &probe {
        blob.add(3, probe);
    }
    blob.add(4, &compensation);
    blob.add(5, &wiring);
    let control_rate = wanted.nominal.surroundings.control_rate;
    let mut name = [0; NAME_BYTES];
    // The last byte stays zero, to terminate the C string.
    name.iter_mut().take(NAME_BYTES - 1).zip(wanted.nominal.joint.name.bytes()).for_each(|(place, byte)| *place = byte);
    let header = Header {
        mark: MARK,
        version: VERSION,
        bytes: blob.bytes.len() as u32,
        digest: 0,
        name,
        control_rate,
        clock_rate: CLOCK_TICKS * control_rate,
        bandwidth: compensation.law.rate,
        planets,
        parts: blob.parts,
    };
    header.write_to(&mut blob.bytes);
    let digest = digest_of(&words(&blob.bytes));
    Header { digest, ..header }.write_to(&mut blob.bytes);
    Ok(words(&blob.bytes))
}

fn words(bytes: &[u8]) -> Vec<u64> {
    bytes.as_chunks().0.iter().map(|word| u64::from_le_bytes(*word)).collect()
}

fn plant<const N: usize>(
    blob: &mut Writer,
    joint: &JointParameters,
    around: &Surroundings,
    processor: &Processor,
) -> Result<(), DesignError>
where
    Tables<f32, N>: Fixed,
{
    let effort = Effort::Within(*processor);
    let gears: Tables<f32, N> = design_scheme(joint, around.control_rate, Scheme::Realtime, effort)?;
    let surroundings: SurroundingsTable<f32> = design_surroundings(joint, around, &gears)?;
    blob.add(0, &gears);
    blob.add(1, &surroundings);
    Ok(())
}

struct Writer {
    bytes: Vec<u8>,
    parts: [Part; PARTS],
}

impl Writer {
    fn add<T: Fixed>(&mut self, kind: usize, value: &T) {
        let (offset, bytes) = (self.bytes.len(), size_of::<T>().next_multiple_of(WORD));
        self.bytes.resize(offset + bytes, 0);
        value.write_to(&mut self.bytes[offset..]);
        self.parts[kind] = Part { offset: offset as u32, bytes: bytes as u32 };
    }
}

/// Layout of every part, one line per field; [`VERSION`] stands for it.
#[cfg(test)]
pub fn layout() -> Vec<String> {
    use model_core::compensation::CompensationTables;
    use model_core::observer::{ObserverTables, ProbeTable};
    use model_core::wiring::WiringTable;

    let mut out = vec![];
    Header::describe("header", 0, &mut out);
    Tables::<f32, 3>::describe("gears", 0, &mut out);
    SurroundingsTable::<f32>::describe("surroundings", 0, &mut out);
    ObserverTables::<f32>::describe("observer", 0, &mut out);
    ProbeTable::<f32>::describe("probe", 0, &mut out);
    CompensationTables::<f32>::describe("compensation", 0, &mut out);
    WiringTable::<f32>::describe("wiring", 0, &mut out);
    out
}

#[cfg(test)]
mod tests {
    use model_core::numbers::digest;

    /// Digest of the names, offsets and types of all fields in this version.
    const OF_VERSION_5: u64 = 0xaa2a_37f1_ccf6_2b6d;

    #[test]
    fn layout_change_needs_new_version() {
        let layout = super::layout();
        let found = layout
            .iter()
            .flat_map(|line| line.bytes().chain([b'\n']))
            .fold(digest::START, |running, byte| digest::chain(running, byte.into()));
        assert_eq!(crate::VERSION, 5);
        assert_eq!(
            found,
            OF_VERSION_5,
            "the layout of a table changed (digest {found:#x}): raise VERSION and update this digest:\n{}",
            layout.join("\n")
        );
    }
}
