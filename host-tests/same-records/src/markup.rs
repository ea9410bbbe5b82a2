//! HTML and XML in pieces: tags with their attributes, and the text between them. Whether tags are well nested is nobody's
//! business here; comments, declarations and the document's type are passed over.

use std::collections::BTreeMap;

/// A piece of a document.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Piece {
    /// `<name attribute="value">`; `empty` if it closes itself.
    Open {
        /// Name of the element.
        name: String,
        /// Its attributes.
        attributes: BTreeMap<String, String>,
        /// Whether it closes itself.
        empty: bool,
    },
    /// `</name>`.
    Close(String),
    /// Text, with its entities resolved.
    Text(String),
}

/// Elements whose content is no markup.
const RAW: [&str; 2] = ["style", "script"];

/// The pieces of a document.
pub fn pieces(document: &str) -> Vec<Piece> {
    let mut pieces = Vec::new();
    let mut rest = document;
    while !rest.is_empty() {
        let Some(start) = rest.find('<') else {
            pieces.push(Piece::Text(resolved(rest)));
            break;
        };
        if start > 0 {
            pieces.push(Piece::Text(resolved(&rest[..start])));
        }
        rest = &rest[start..];
        let (length, piece) = tag(rest);
        rest = &rest[length..];
        if let Some(Piece::Open { name, empty: false, .. }) = &piece
            && RAW.contains(&name.as_str())
        {
            let end = rest.find(&format!("</{name}")).unwrap_or(rest.len());
            pieces.extend(piece);
            pieces.push(Piece::Text(rest[..end].to_owned()));
            rest = &rest[end..];
            continue;
        }
        pieces.extend(piece);
    }
    pieces
}

/// The tag that a text begins with, and its length in bytes.
fn tag(text: &str) -> (usize, Option<Piece>) {
    if text.starts_with("<!--") {
        return (text.find("-->").map_or(text.len(), |end| end + 3), None);
    }
    // A `>` in a quoted value ends nothing.
    let mut quote = None;
    let end = text.char_indices().find(|&(_, c)| {
        match (quote, c) {
            (None, '"' | '\'') => quote = Some(c),
            (Some(open), _) if open == c => quote = None,
            (None, '>') => return true,
            _ => {}
        }
        false
    });
    let Some((end, _)) = end else { return (text.len(), Some(Piece::Text(resolved(text)))) };
    let inside = &text[1..end];
    let piece = match inside.chars().next() {
        Some('!' | '?') | None => None,
        Some('/') => Some(Piece::Close(inside[1..].trim().to_lowercase())),
        Some(_) => Some(open(inside)),
    };
    (end + 1, piece)
}

fn open(inside: &str) -> Piece {
    let empty = inside.ends_with('/');
    let inside = inside.trim_end_matches('/').trim();
    let (name, mut rest) = inside.split_once(char::is_whitespace).unwrap_or((inside, ""));
    let mut attributes = BTreeMap::new();
    loop {
        rest = rest.trim_start();
        if rest.is_empty() {
            break;
        }
        let end = rest.find(|c: char| c == '=' || c.is_whitespace()).unwrap_or(rest.len());
        let key = rest[..end].to_owned();
        let behind = rest[end..].trim_start();
        let Some(value) = behind.strip_prefix('=').map(str::trim_start) else {
            attributes.insert(key, String::new());
            rest = &rest[end..];
            continue;
        };
        let (value, after) = match value.chars().next() {
            Some(quote @ ('"' | '\'')) => value[1..].split_once(quote).unwrap_or((&value[1..], "")),
            _ => value.split_once(char::is_whitespace).unwrap_or((value, "")),
        };
        attributes.insert(key, resolved(value));
        rest = after;
    }
    Piece::Open { name: name.to_lowercase(), attributes, empty }
}

/// A text with the entities that our writers use put back; others stay as they are.
fn resolved(text: &str) -> String {
    let known = [("&lt;", "<"), ("&gt;", ">"), ("&quot;", "\""), ("&#39;", "'"), ("&apos;", "'"), ("&nbsp;", " ")];
    let text = known.iter().fold(text.to_owned(), |text, (entity, sign)| text.replace(entity, sign));
    text.replace("&amp;", "&")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_document_falls_into_tags_and_text() {
        let found =
            pieces("<!DOCTYPE html><!-- <b> --><p class=\"a>b\" id=x hidden>1 &lt; 2</p><br/><style>p > a{}</style>");
        let open = |name: &str, attributes: &[(&str, &str)], empty| Piece::Open {
            name: name.into(),
            attributes: attributes.iter().map(|(key, value)| (key.to_string(), value.to_string())).collect(),
            empty,
        };
        let wanted = [
            open("p", &[("class", "a>b"), ("hidden", ""), ("id", "x")], false),
            Piece::Text("1 < 2".into()),
            Piece::Close("p".into()),
            open("br", &[], true),
            open("style", &[], false),
            Piece::Text("p > a{}".into()),
            Piece::Close("style".into()),
        ];
        assert_eq!(found, wanted);
    }
}
