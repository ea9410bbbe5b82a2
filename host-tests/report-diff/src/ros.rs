//! ROS 2 messages in CDR, as far as the project's logs need them: fields of 64-bit floats, single or in lists. A message of any other form
//! is compared by its bytes.

use std::rc::Rc;

/// Names of fields, with `true` for a list.
#[derive(Debug, Clone)]
pub struct MessageLayout(Vec<(Rc<str>, bool)>);

impl MessageLayout {
    /// Reads a schema; `None` if it has a field of another type.
    pub fn from_schema(schema: &str) -> Option<Self> {
        let lines = schema.lines().map(|line| line.split('#').next().unwrap_or_default().trim());
        let field = |line: &str| match line.split_once(char::is_whitespace)? {
            ("float64", name) => Some((name.trim().into(), false)),
            ("float64[]", name) => Some((name.trim().into(), true)),
            _ => None,
        };
        lines.filter(|line| !line.is_empty()).map(field).collect::<Option<_>>().map(Self)
    }

    /// Numbers of each field of a message.
    pub fn decode(&self, message: &[u8]) -> Option<Vec<(Rc<str>, Vec<f64>)>> {
        // The header selects little endian.
        let body = message.strip_prefix(&[0, 1, 0, 0])?;
        let mut at = 0_usize;
        let mut fields = Vec::new();
        for (name, is_list) in &self.0 {
            let mut count = 1;
            if *is_list {
                at = at.next_multiple_of(4);
                count = usize::try_from(u32::from_le_bytes(body.get(at..at + 4)?.try_into().ok()?)).ok()?;
                at += 4;
            }
            at = at.next_multiple_of(8);
            let end = count.checked_mul(8)?.checked_add(at)?;
            let (numbers, _) = body.get(at..end)?.as_chunks();
            fields.push((Rc::clone(name), numbers.iter().map(|bytes| f64::from_le_bytes(*bytes)).collect()));
            at = end;
        }
        (at == body.len()).then_some(fields)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Numbers and lists are decoded; messages of another form or length are not.
    #[test]
    fn only_float_messages_are_decoded() {
        let mut message = vec![0, 1, 0, 0];
        message.extend(1.5_f64.to_le_bytes());
        message.extend(2_u32.to_le_bytes());
        message.extend([0; 4]);
        [2.5_f64, 3.5].iter().for_each(|number| message.extend(number.to_le_bytes()));
        let decode = |schema: &str, message: &[u8]| MessageLayout::from_schema(schema)?.decode(message);
        let schema = "float64 a  # [m]\nfloat64[] b\n";
        assert_eq!(decode(schema, &message), Some(vec![("a".into(), vec![1.5]), ("b".into(), vec![2.5, 3.5])]));
        assert_eq!(decode("float64 a\n", &message), None);
        assert_eq!(decode("string a\n", &message), None);
        assert_eq!(decode(schema, &message[..message.len() - 1]), None);
    }
}
