//! Numbers of messages defined by ROS 2 message text and encoded in CDR, each by its path, such as `header.stamp.sec`
//! or `position[0]`. Text is skipped.

use std::collections::BTreeMap;

use super::numbers::{self, Numbers};

/// Deepest nesting of messages; deeper ones are taken for a recursive definition.
const DEPTH_MAX: usize = 16;
/// Letters of a line shown in a failure.
const LETTERS_SHOWN: usize = 80;

/// Definition of a message.
#[derive(Debug, Clone, PartialEq)]
pub struct MessageDefinition {
    /// Fields by the type's name; the message itself has an empty name.
    types: BTreeMap<String, Vec<Field>>,
}

#[derive(Debug, Clone, PartialEq)]
struct Field {
    name: String,
    kind: Kind,
    count: Count,
}

#[derive(Debug, Clone, PartialEq)]
enum Kind {
    Number(Number),
    Text,
    Message(String),
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Count {
    One,
    Fixed(u32),
    List,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Number {
    Unsigned(usize),
    Signed(usize),
    Float(usize),
}

impl Number {
    fn parse(word: &str) -> Option<Self> {
        Some(match word {
            "bool" | "byte" | "char" | "uint8" => Self::Unsigned(1),
            "uint16" => Self::Unsigned(2),
            "uint32" => Self::Unsigned(4),
            "uint64" => Self::Unsigned(8),
            "int8" => Self::Signed(1),
            "int16" => Self::Signed(2),
            "int32" => Self::Signed(4),
            "int64" => Self::Signed(8),
            "float32" => Self::Float(4),
            "float64" => Self::Float(8),
            _ => return None,
        })
    }

    fn size(self) -> usize {
        let (Self::Unsigned(size) | Self::Signed(size) | Self::Float(size)) = self;
        size
    }

    /// Value from bits in the lower bytes.
    fn value(self, bits: u64) -> f64 {
        match self {
            Self::Unsigned(_) => bits as f64,
            Self::Signed(size) => {
                let above = 64 - 8 * size as u32;
                ((bits << above) as i64 >> above) as f64
            }
            Self::Float(4) => f32::from_bits(bits as u32).into(),
            Self::Float(_) => f64::from_bits(bits),
        }
    }
}

impl MessageDefinition {
    /// Parses ROS 2 message text: the message's own fields, then those of nested messages behind lines of `=`.
    pub fn read(text: &str) -> Result<Self, String> {
        let (mut types, mut name) = (BTreeMap::new(), String::new());
        types.insert(String::new(), Vec::new());
        for line in text.lines() {
            let line = line.split('#').next().unwrap_or_default().trim();
            if line.is_empty() || line.starts_with("===") {
                continue;
            }
            if let Some(next) = line.strip_prefix("MSG:") {
                name = last_part(next.trim());
                types.insert(name.clone(), Vec::new());
            } else if let Some(field) = field(line).ok_or_else(|| no_field(line))? {
                types.entry(name.clone()).or_insert_with(Vec::new).push(field);
            }
        }
        // Time and Duration are built in.
        for stamp in ["Time", "Duration"] {
            let part = |name: &str, number| Field { name: name.into(), kind: Kind::Number(number), count: Count::One };
            let parts = vec![part("sec", Number::Signed(4)), part("nanosec", Number::Unsigned(4))];
            types.entry(stamp.to_owned()).or_insert(parts);
        }
        Ok(Self { types })
    }

    /// Paths and values of all numbers in a message, in its order.
    pub fn numbers(&self, message: &[u8]) -> Result<Numbers, String> {
        let [0, kind @ (0 | 1), _, _, body @ ..] = message else {
            return Err("it is not encoded in plain CDR".to_owned());
        };
        let mut reading = Decoder { definition: self, body, at: 0, big: *kind == 0, numbers: Numbers::default() };
        reading.read_message("", "", 0)?;
        Ok(reading.numbers)
    }
}

/// Name of a type without its package.
fn last_part(name: &str) -> String {
    name.rsplit('/').next().unwrap_or_default().to_owned()
}

fn no_field(line: &str) -> String {
    format!("`{}` is not a field of a message", line.chars().take(LETTERS_SHOWN).collect::<String>())
}

/// Field of a line; `Some(None)` for a constant.
fn field(line: &str) -> Option<Option<Field>> {
    let (kind, rest) = line.split_once(char::is_whitespace)?;
    let name = rest.trim_start().split([' ', '\t']).next()?;
    if name.contains('=') || rest.trim_start()[name.len()..].trim_start().starts_with('=') {
        return Some(None);
    }
    let (kind, count) = match kind.split_once('[') {
        None => (kind, Count::One),
        Some((kind, "]")) => (kind, Count::List),
        Some((kind, most)) if most.starts_with("<=") => (kind, Count::List),
        // As in ROS, an array has at least one element: every element then takes at least a byte of the message.
        Some((kind, number)) => {
            let many = number.strip_suffix(']')?.parse().ok()?;
            (kind, Count::Fixed(Some(many).filter(|many| *many > 0)?))
        }
    };
    let kind = match kind.split("<=").next()? {
        "string" => Kind::Text,
        "wstring" => return None,
        word => Number::parse(word).map_or_else(|| Kind::Message(last_part(word)), Kind::Number),
    };
    Some(Some(Field { name: name.to_owned(), kind, count }))
}

/// State of decoding a message.
struct Decoder<'r> {
    definition: &'r MessageDefinition,
    body: &'r [u8],
    at: usize,
    /// Most significant byte first.
    big: bool,
    numbers: Numbers,
}

impl Decoder<'_> {
    fn read_message(&mut self, kind: &str, path: &str, depth: usize) -> Result<(), String> {
        let form = self.definition;
        let fields = form.types.get(kind).ok_or_else(|| format!("the definition of `{kind}` is missing"))?;
        if depth > DEPTH_MAX {
            return Err(format!("`{kind}` contains itself"));
        }
        for field in fields {
            let name = numbers::field(path, &field.name)?;
            let many = match field.count {
                Count::One => {
                    self.element(&field.kind, name, depth)?;
                    continue;
                }
                Count::Fixed(many) => many,
                Count::List => self.read_aligned(4)? as u32,
            };
            if many as usize > self.body.len() {
                return Err("it is cut off".to_owned());
            }
            for place in 0..many as usize {
                self.element(&field.kind, numbers::element(&name, place)?, depth)?;
            }
        }
        if fields.is_empty() {
            self.read_aligned(1)?;
        }
        Ok(())
    }

    fn element(&mut self, kind: &Kind, name: String, depth: usize) -> Result<(), String> {
        match kind {
            Kind::Number(number) => {
                let bits = self.read_aligned(number.size())?;
                self.numbers.push(name, number.value(bits))
            }
            Kind::Text => {
                let length = self.read_aligned(4)? as usize;
                self.at = self.at.saturating_add(length);
                if self.at <= self.body.len() { Ok(()) } else { Err("it is cut off".to_owned()) }
            }
            Kind::Message(kind) => self.read_message(kind, &name, depth + 1),
        }
    }

    /// Reads `size` bytes, aligned to `size` from the end of the header.
    fn read_aligned(&mut self, size: usize) -> Result<u64, String> {
        let from = self.at.next_multiple_of(size);
        let bytes = self.body.get(from..from + size).ok_or("it is cut off")?;
        self.at = from + size;
        let join = |bits: u64, byte: &u8| bits << 8 | u64::from(*byte);
        Ok(if self.big { bytes.iter().fold(0, join) } else { bytes.iter().rev().fold(0, join) })
    }
}

#[cfg(test)]
mod tests;
