//! Image that ships: the bytes of its ELF file for flash, and its functions by address.

use std::path::Path;

use object::{Object, ObjectSegment, ObjectSymbol, SymbolKind};

/// Address range of images, including the initial values of RAM.
const FLASH: std::ops::Range<u64> = 0x0800_0000..0x0840_0000;

/// Image as bytes and functions.
#[derive(Debug, Clone)]
pub struct Image {
    /// Bytes from the start of flash on.
    pub bytes: Vec<u8>,
    /// Functions by address, in ascending order.
    functions: Vec<(u32, String)>,
}

impl Image {
    /// Reads an ELF file.
    pub fn read(path: &Path) -> Result<Self, String> {
        let named = |error: &dyn std::fmt::Display| format!("{}: {error}", path.display());
        let file = std::fs::read(path).map_err(|error| named(&error))?;
        Self::parse(&file).map_err(|error| named(&error))
    }

    /// Parses an ELF file in memory.
    pub fn parse(file: &[u8]) -> Result<Self, object::Error> {
        let file = object::File::parse(file)?;
        let mut bytes = Vec::new();
        for segment in file.segments() {
            // Load address; for initial values it is in the program header only.
            let object::SegmentFlags::Elf { .. } = segment.flags() else { continue };
            let data = segment.data()?;
            let address = physical(&file, segment.address()).unwrap_or(segment.address());
            if FLASH.contains(&address) {
                let place = (address - FLASH.start) as usize;
                bytes.resize(bytes.len().max(place + data.len()), 0xff);
                bytes[place..place + data.len()].copy_from_slice(data);
            }
        }
        let mut functions: Vec<_> = file
            .symbols()
            .filter(|symbol| symbol.kind() == SymbolKind::Text)
            .filter_map(|symbol| Some((symbol.address() as u32 & !1, symbol.name().ok()?.to_owned())))
            .collect();
        functions.sort();
        Ok(Self { bytes, functions })
    }

    /// Name of the function at an address.
    pub fn function(&self, address: u32) -> &str {
        let after = self.functions.partition_point(|(start, _)| *start <= address);
        after.checked_sub(1).map_or("?", |place| &self.functions[place].1)
    }
}

/// Physical address of the segment at a virtual address.
fn physical(file: &object::File<'_>, address: u64) -> Option<u64> {
    use object::read::elf::ProgramHeader;
    let object::File::Elf32(elf) = file else { return None };
    let headers = elf.elf_program_headers();
    let header = headers.iter().find(|header| u64::from(header.p_vaddr(elf.endian())) == address)?;
    Some(header.p_paddr(elf.endian()).into())
}
