//! Functions of a linked image with their instructions, including the handler of the tick. The compiler's mapping
//! symbols separate code from literal pools.

use std::collections::BTreeMap;
use std::ops::Range;

use object::elf::{SHF_WRITE, STT_FUNC, STT_OBJECT};
use object::read::elf::ElfFile32;
use object::{Endianness, Object, ObjectSection, ObjectSymbol, SectionFlags};

use super::thumb::{Instruction, decode};

/// Start address of the vector table.
const VECTORS: u64 = 0x0800_0000;

/// Function of the image.
#[derive(Debug, Clone)]
pub struct Function {
    /// Demangled name.
    pub name: String,
    /// Symbol.
    pub symbol: String,
    /// Start address.
    pub address: u32,
    /// End address: at most the start of the next function.
    pub end: u32,
    /// Instructions by address.
    pub code: BTreeMap<u32, Instruction>,
}

/// All functions by address, with the bytes of the image.
#[derive(Debug)]
pub struct Functions {
    functions: BTreeMap<u32, Function>,
    memory: Vec<(u32, Vec<u8>)>,
    /// Address ranges that are never written.
    constants: Vec<Range<u32>>,
    /// Names and addresses of data.
    objects: Vec<(String, u32)>,
}

impl Functions {
    /// Reads an image.
    pub fn read(elf: &[u8]) -> Result<Self, String> {
        let file: ElfFile32<'_, Endianness> = ElfFile32::parse(elf).map_err(|error| error.to_string())?;
        let memory = file
            .sections()
            .filter_map(|section| Some((section.address() as u32, section.data().ok()?.to_vec())))
            .filter(|(address, bytes)| u64::from(*address) >= VECTORS && !bytes.is_empty())
            .collect();
        let constants = file.sections().filter_map(|section| {
            let SectionFlags::Elf { sh_flags } = section.flags() else { return None };
            let address = section.address() as u32;
            (sh_flags & u64::from(SHF_WRITE) == 0).then(|| address..address.saturating_add(section.size() as u32))
        });
        let mut found =
            Self { functions: BTreeMap::new(), memory, constants: constants.collect(), objects: Vec::new() };
        let mut marks = BTreeMap::new();
        let mut starts: BTreeMap<u32, (String, u32)> = BTreeMap::new();
        for symbol in file.symbols() {
            let (Ok(name), address) = (symbol.name(), symbol.address() as u32) else { continue };
            if name.starts_with("$t") || name.starts_with("$d") {
                marks.insert(address, name.starts_with("$t"));
            } else if symbol.elf_symbol().st_type() == STT_FUNC {
                starts.insert(address & !1, (name.to_owned(), symbol.size() as u32));
            } else if symbol.elf_symbol().st_type() == STT_OBJECT {
                found.objects.push((format!("{:#}", rustc_demangle::demangle(name)), address));
            }
        }
        let ends: Vec<u32> = starts.keys().skip(1).copied().chain([u32::MAX]).collect();
        for ((address, (name, size)), next) in starts.into_iter().zip(ends) {
            let section = found.section(address).map_or(address, |(start, bytes)| start + bytes.len() as u32);
            let end = if size > 0 { address + size } else { next.min(section) };
            let (symbol, name) = (name.clone(), format!("{:#}", rustc_demangle::demangle(&name)));
            let code = found.decode(address, end, &marks);
            found.functions.insert(address, Function { name, symbol, address, end, code });
        }
        Ok(found)
    }

    /// Functions from half words, with names; `data` is the range of a table among them.
    #[cfg(test)]
    pub fn assembled(functions: &[(&str, u32, &[u16])], data: Range<u32>) -> Self {
        let bytes = |code: &[u16]| code.iter().flat_map(|half| half.to_le_bytes()).collect::<Vec<u8>>();
        let memory: Vec<(u32, Vec<u8>)> = functions.iter().map(|(_, address, code)| (*address, bytes(code))).collect();
        let constants = memory.iter().map(|(address, bytes)| *address..*address + bytes.len() as u32).collect();
        let mut found = Self { functions: BTreeMap::new(), memory, constants, objects: Vec::new() };
        let marks = functions
            .iter()
            .map(|(_, address, _)| (*address, true))
            .chain([(data.start, false), (data.end, true)])
            .collect();
        for (name, address, code) in functions {
            let (address, end) = (*address, address + 2 * code.len() as u32);
            let code = found.decode(address, end, &marks);
            let function = Function { name: (*name).to_owned(), symbol: (*name).to_owned(), address, end, code };
            found.functions.insert(address, function);
        }
        found
    }

    /// Handler of an exception, from the vector table.
    pub fn handler(&self, exception: u8) -> Option<&Function> {
        let entry = VECTORS + 4 * u64::from(exception);
        self.at(u32::from(self.half(entry as u32 + 2)?) << 16 | u32::from(self.half(entry as u32)?))
    }

    /// Function that begins at an address.
    pub fn at(&self, address: u32) -> Option<&Function> {
        self.functions.get(&(address & !1))
    }

    /// Byte at an address.
    pub fn byte(&self, address: u32) -> Option<u8> {
        let (start, bytes) = self.section(address)?;
        bytes.get((address - start) as usize).copied()
    }

    /// Byte at an address that is never written.
    pub fn constant_byte(&self, address: u32) -> Option<u8> {
        self.constants.iter().any(|range| range.contains(&address)).then(|| self.byte(address))?
    }

    /// All functions.
    pub fn all(&self) -> impl Iterator<Item = &Function> {
        self.functions.values()
    }

    /// Names and addresses of data.
    pub fn objects(&self) -> impl Iterator<Item = (&str, u32)> {
        self.objects.iter().map(|(name, address)| (name.as_str(), *address))
    }

    /// Half word at an address.
    pub fn half(&self, address: u32) -> Option<u16> {
        Some(u16::from_le_bytes([self.byte(address)?, self.byte(address + 1)?]))
    }

    /// Both half words of an instruction; zero outside of the image.
    pub fn halves(&self, address: u32) -> (u16, u16) {
        (self.half(address).unwrap_or(0), self.half(address + 2).unwrap_or(0))
    }

    fn section(&self, address: u32) -> Option<(u32, &[u8])> {
        let holds = |(start, bytes): &&(u32, Vec<u8>)| (*start..*start + bytes.len() as u32).contains(&address);
        self.memory.iter().find(holds).map(|(start, bytes)| (*start, bytes.as_slice()))
    }

    fn decode(&self, start: u32, end: u32, marks: &BTreeMap<u32, bool>) -> BTreeMap<u32, Instruction> {
        let mut code = BTreeMap::new();
        let mut address = start;
        while address < end {
            let is_code = marks.range(..=address).next_back().is_none_or(|(_, is_code)| *is_code);
            let Some(first) = self.half(address) else { break };
            if !is_code {
                // Constants may have an odd size; code begins at an even address again.
                address += 2;
                continue;
            }
            let instruction = decode(address, first, self.half(address + 2).unwrap_or(0));
            code.insert(address, instruction);
            address += instruction.size;
        }
        code
    }
}
