//! HTML and XML as a sequence of tags with their attributes and the text between them. Nesting of tags is not checked; comments,
//! declarations and the document type are skipped.

use quick_xml::escape::unescape;
use quick_xml::events::Event;

/// Piece of a document.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Piece {
    /// Start tag `<name attribute="value">`, or `<name/>`, which is followed by its end.
    Open {
        /// Name of the element.
        name: String,
        /// Attributes, sorted by name.
        attributes: Vec<(String, String)>,
    },
    /// End tag `</name>`.
    Close(String),
    /// Text with its entities resolved.
    Text(String),
}

/// Pieces of a document; fails at an invalid tag.
pub fn pieces(document: &str) -> Result<Vec<Piece>, String> {
    let mut reader = quick_xml::Reader::from_str(document);
    let settings = reader.config_mut();
    (settings.expand_empty_elements, settings.allow_dangling_amp) = (true, true);
    (settings.check_end_names, settings.allow_unmatched_ends) = (false, true);
    let resolved = |text: &str| unescape(text).map_or(text.to_owned(), |text| text.into_owned());
    // The parser cuts a text at its entities.
    let (mut pieces, mut text) = (Vec::new(), String::new());
    loop {
        let piece = match reader.read_event().map_err(|error| error.to_string())? {
            Event::Text(part) => {
                text += &part;
                continue;
            }
            Event::GeneralRef(name) => {
                text += &resolved(&format!("&{};", &*name));
                continue;
            }
            Event::Start(tag) => {
                let pairs = tag.html_attributes().flatten();
                let mut attributes: Vec<_> =
                    pairs.map(|it| (it.key.as_ref().to_owned(), resolved(&it.value))).collect();
                attributes.sort();
                Some(Piece::Open { name: tag.name().as_ref().to_lowercase(), attributes })
            }
            Event::End(tag) => Some(Piece::Close(tag.name().as_ref().to_lowercase())),
            Event::Eof => None,
            _ => continue,
        };
        if !text.is_empty() {
            pieces.push(Piece::Text(std::mem::take(&mut text)));
        }
        match piece {
            Some(piece) => pieces.push(piece),
            None => return Ok(pieces),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Tags, attributes and text are separated, entities resolved.
    #[test]
    fn document_splits_into_tags_and_text() {
        let found = pieces(
            "<!DOCTYPE html><!-- <b> --><p class=\"a>b\" id=x hidden>1 &lt; 2 & 3</p><br/><style>p > a{}</style>",
        );
        let open = |name: &str, attributes: &[(&str, &str)]| Piece::Open {
            name: name.into(),
            attributes: attributes.iter().map(|(key, value)| (key.to_string(), value.to_string())).collect(),
        };
        let close = |name: &str| Piece::Close(name.into());
        let text = |text: &str| Piece::Text(text.into());
        let wanted = [
            open("p", &[("class", "a>b"), ("hidden", ""), ("id", "x")]),
            text("1 < 2 & 3"),
            close("p"),
            open("br", &[]),
            close("br"),
            open("style", &[]),
            text("p > a{}"),
            close("style"),
        ];
        assert_eq!(found.expect("markup"), wanted);
    }
}
