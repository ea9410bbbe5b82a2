//! Numbers of one message, each by its path, such as `position[0]`. Number and path length are limited, so that larger
//! messages such as pictures are not unpacked.

/// Largest number of numbers in a message; a joint's message has some tens.
const NUMBERS_MAX: usize = 4096;
/// Longest path of a number [bytes].
const PATH_LENGTH_MAX: usize = 256;

/// Numbers by their paths, in the message's order.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Numbers(Vec<(String, f64)>);

impl Numbers {
    /// Adds a number.
    pub fn push(&mut self, path: String, value: f64) -> Result<(), String> {
        if self.0.len() == NUMBERS_MAX {
            return Err(format!("it has more than {NUMBERS_MAX} numbers"));
        }
        self.0.push((path, value));
        Ok(())
    }

    /// Number by its path.
    pub fn value(&self, wanted: &str) -> Option<f64> {
        self.0.iter().find(|(path, _)| path == wanted).map(|(_, value)| *value)
    }

    /// All numbers.
    pub fn as_slice(&self) -> &[(String, f64)] {
        &self.0
    }
}

/// Path of a field of a message; the outermost message has an empty path.
pub fn field(message: &str, name: &str) -> Result<String, String> {
    let path = if message.is_empty() { name.len() } else { message.len() + 1 + name.len() };
    check_path(path)?;
    Ok(if message.is_empty() { name.to_owned() } else { format!("{message}.{name}") })
}

/// Path of an element of a list.
pub fn element(list: &str, place: usize) -> Result<String, String> {
    check_path(list.len())?;
    Ok(format!("{list}[{place}]"))
}

fn check_path(length: usize) -> Result<(), String> {
    if length <= PATH_LENGTH_MAX {
        return Ok(());
    }
    Err(format!("the path of a number in it has more than {PATH_LENGTH_MAX} letters"))
}
