//! Debug information of an image: source lines of instructions, and offsets of structure members.

use addr2line::Context;
use addr2line::gimli::{self, AttributeValue, Dwarf, EndianSlice, LittleEndian, SectionId};
use object::read::elf::ElfFile32;
use object::{Endianness, Object, ObjectSection};

type Reader<'a> = EndianSlice<'a, LittleEndian>;

/// Debug information of an image.
pub struct Source<'a> {
    context: Context<Reader<'a>>,
    dwarf: Dwarf<Reader<'a>>,
}

impl<'a> Source<'a> {
    /// Reads the debug information of an image.
    pub fn read(elf: &'a [u8]) -> Result<Self, String> {
        let file: ElfFile32<'a, Endianness> = ElfFile32::parse(elf).map_err(|error| error.to_string())?;
        let section = |id: SectionId| -> Result<Reader<'a>, gimli::Error> {
            let data = file.section_by_name(id.name()).and_then(|section| section.data().ok());
            Ok(EndianSlice::new(data.unwrap_or_default(), LittleEndian))
        };
        let failed = |error: gimli::Error| format!("cannot read its debug information: {error}");
        let context = Context::from_dwarf(Dwarf::load(section).map_err(failed)?).map_err(failed)?;
        Ok(Self { context, dwarf: Dwarf::load(section).map_err(failed)? })
    }

    /// File and line of an instruction, with at most two folders. Of inlined frames the innermost outside of the
    /// standard library counts.
    pub fn line(&self, address: u32) -> Option<String> {
        let mut frames = self.context.find_frames(address.into()).skip_all_loads().ok()?;
        let mut innermost = None;
        while let Ok(Some(frame)) = frames.next() {
            let Some((file, line)) = frame.location.and_then(|at| Some((at.file?, at.line?))) else { continue };
            let start = file.rmatch_indices('/').nth(2).map_or(0, |(index, _)| index + 1);
            let here = format!("{}:{line}", &file[start..]);
            if !file.contains("/library/") {
                return Some(here);
            }
            innermost.get_or_insert(here);
        }
        innermost
    }

    /// Symbols of the functions with this name, including generic arguments.
    pub fn symbols(&self, function: &str) -> Vec<String> {
        let mut found = Vec::new();
        let mut units = self.dwarf.units();
        while let Ok(Some(header)) = units.next() {
            let Ok(unit) = self.dwarf.unit(header) else { continue };
            let text = |value: Option<AttributeValue<Reader<'a>>>| self.dwarf.attr_string(&unit, value?).ok();
            let mut entries = unit.entries();
            while let Ok(Some(entry)) = entries.next_dfs() {
                let name = text(entry.attr_value(gimli::DW_AT_name));
                if entry.tag() == gimli::DW_TAG_subprogram
                    && name.is_some_and(|name| name.slice() == function.as_bytes())
                {
                    let symbol = text(entry.attr_value(gimli::DW_AT_linkage_name));
                    found.extend(symbol.map(|symbol| symbol.to_string_lossy().into_owned()));
                }
            }
        }
        found
    }

    /// Offset of a member in a structure with this name [byte].
    pub fn offset(&self, structure: &str, member: &str) -> Option<u32> {
        let mut units = self.dwarf.units();
        while let Ok(Some(header)) = units.next() {
            let Ok(unit) = self.dwarf.unit(header) else { continue };
            let is_named = |name: Option<AttributeValue<Reader<'a>>>, wanted: &str| {
                let name = name.and_then(|name| self.dwarf.attr_string(&unit, name).ok());
                name.is_some_and(|name| name.slice() == wanted.as_bytes())
            };
            let mut entries = unit.entries();
            let mut inside = None;
            while let Ok(Some(entry)) = entries.next_dfs() {
                let depth = entry.depth();
                if inside.is_some_and(|inside| depth <= inside) {
                    inside = None;
                }
                let name = entry.attr_value(gimli::DW_AT_name);
                match entry.tag() {
                    gimli::DW_TAG_structure_type if is_named(name, structure) => inside = Some(depth),
                    gimli::DW_TAG_member if inside == Some(depth - 1) && is_named(name, member) => {
                        let offset = entry.attr_value(gimli::DW_AT_data_member_location)?.udata_value()?;
                        return u32::try_from(offset).ok();
                    }
                    _ => {}
                }
            }
        }
        None
    }
}
