//! The numbers of one message, each by its path, as in `position[0]`: as many and with as long a path as a joint's message may
//! have. A message that has more, such as a picture, is not spread out.

/// Numbers that a message may have: a joint has some tens of them.
const MOST: usize = 4096;
/// Letters that the path of a number may have.
const LONGEST_PATH: usize = 256;

/// Numbers by their paths, in the message's order.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Numbers(Vec<(String, f64)>);

impl Numbers {
    /// One more.
    pub fn push(&mut self, path: String, value: f64) -> Result<(), String> {
        if self.0.len() == MOST {
            return Err(format!("it has more than {MOST} numbers"));
        }
        self.0.push((path, value));
        Ok(())
    }

    /// A number by its path.
    pub fn value(&self, wanted: &str) -> Option<f64> {
        self.0.iter().find(|(path, _)| path == wanted).map(|(_, value)| *value)
    }

    /// All of them.
    pub fn as_slice(&self) -> &[(String, f64)] {
        &self.0
    }
}

/// The path of a field of a message; the outermost message has none of its own.
pub fn field(message: &str, name: &str) -> Result<String, String> {
    let path = if message.is_empty() { name.len() } else { message.len() + 1 + name.len() };
    check_path(path)?;
    Ok(if message.is_empty() { name.to_owned() } else { format!("{message}.{name}") })
}

/// The path of a place in a list.
pub fn place(list: &str, place: usize) -> Result<String, String> {
    check_path(list.len())?;
    Ok(format!("{list}[{place}]"))
}

fn check_path(length: usize) -> Result<(), String> {
    if length <= LONGEST_PATH {
        return Ok(());
    }
    Err(format!("the path of a number in it has more than {LONGEST_PATH} letters"))
}
