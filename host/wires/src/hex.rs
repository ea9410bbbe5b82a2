//! Bytes as hexadecimal digits.

/// Upper-case digits of bytes.
pub fn digits(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02X}")).collect()
}

/// Bytes of digits; `None` for anything else.
pub fn bytes(digits: &str) -> Option<Vec<u8>> {
    if !digits.is_ascii() || !digits.len().is_multiple_of(2) {
        return None;
    }
    digits.as_bytes().chunks(2).map(|pair| number(std::str::from_utf8(pair).ok()?).map(|byte| byte as u8)).collect()
}

/// Number of at most eight hexadecimal digits.
pub fn number(digits: &str) -> Option<u32> {
    let is_digits = !digits.is_empty() && digits.bytes().all(|digit| digit.is_ascii_hexdigit());
    is_digits.then(|| u32::from_str_radix(digits, 16).ok())?
}
