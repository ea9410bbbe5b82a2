//! Phrases of messages: the type of a value, a number as typed, lists of names.

use toml::Spanned;
use toml::de::DeValue;

/// Type of a value, for "must be a number, not ...".
pub fn kind(value: &Spanned<DeValue<'_>>) -> &'static str {
    match value.get_ref() {
        DeValue::String(_) => "a string",
        DeValue::Integer(_) => "a whole number",
        DeValue::Float(_) => "a number with a fraction",
        DeValue::Boolean(_) => "true or false",
        DeValue::Datetime(_) => "a date",
        DeValue::Array(_) => "a list",
        DeValue::Table(_) => "a section",
    }
}

/// Number as typed.
pub fn shown(value: &Spanned<DeValue<'_>>) -> String {
    match value.get_ref() {
        DeValue::Integer(integer) => integer.to_string(),
        DeValue::Float(float) => float.to_string(),
        _ => kind(value).to_owned(),
    }
}

/// List of names: "`a`, `b` and `c`".
pub fn listed(names: &[&str]) -> String {
    listed_as(names, '`', "and")
}

/// List of words in the given quotes, with `last` before the last one.
pub fn listed_as(names: &[&str], quote: char, last: &str) -> String {
    let quoted: Vec<String> = names.iter().map(|name| format!("{quote}{name}{quote}")).collect();
    match quoted.split_last() {
        Some((end, rest)) if !rest.is_empty() => format!("{} {last} {end}", rest.join(", ")),
        Some((end, _)) => end.clone(),
        None => String::new(),
    }
}
