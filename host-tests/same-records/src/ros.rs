//! Messages of ROS 2 in CDR, as far as our logs need them: fields of 64-bit floats, single or in lists. A message of any
//! other form is compared by its bytes.

/// A field by its name, and the numbers in it.
pub type Field = (String, Vec<f64>);

/// Fields of a message, if its schema has no others than those that are understood.
pub fn decoded(schema: &str, message: &[u8]) -> Option<Vec<Field>> {
    // The head says: little endian.
    let body = message.strip_prefix(&[0, 1, 0, 0])?;
    let mut at = 0;
    let mut fields = Vec::new();
    for line in schema.lines() {
        let said = line.split('#').next()?.trim();
        if said.is_empty() {
            continue;
        }
        let (kind, name) = said.split_once(char::is_whitespace)?;
        let count = match kind {
            "float64" => 1,
            "float64[]" => {
                at = usize::next_multiple_of(at, 4);
                let count = u32::from_le_bytes(body.get(at..at + 4)?.try_into().ok()?);
                at += 4;
                usize::try_from(count).ok()?
            }
            _ => return None,
        };
        if count > body.len() {
            return None;
        }
        at = at.next_multiple_of(8);
        let mut numbers = Vec::with_capacity(count);
        for _ in 0..count {
            numbers.push(f64::from_le_bytes(body.get(at..at + 8)?.try_into().ok()?));
            at += 8;
        }
        fields.push((name.trim().to_owned(), numbers));
    }
    (at == body.len()).then_some(fields)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_and_lists_are_read_and_other_messages_are_not() {
        let mut message = vec![0, 1, 0, 0];
        message.extend(1.5_f64.to_le_bytes());
        message.extend(2_u32.to_le_bytes());
        message.extend([0; 4]);
        [2.5_f64, 3.5].iter().for_each(|number| message.extend(number.to_le_bytes()));
        let schema = "float64 a  # [m]\nfloat64[] b\n";
        let wanted = vec![("a".to_owned(), vec![1.5]), ("b".to_owned(), vec![2.5, 3.5])];
        assert_eq!(decoded(schema, &message), Some(wanted));
        assert_eq!(decoded("float64 a\n", &message), None);
        assert_eq!(decoded("string a\n", &message), None);
        assert_eq!(decoded(schema, &message[..message.len() - 1]), None);
    }
}
