//! Merges many equal rectangles into one path, so that a diagram of ten thousand points stays small. The code works on
//! text; lines in another form stay unchanged.

use std::fmt::Write as _;

/// Least number of equal neighbours that are merged.
const MIN_RUN: usize = 8;

/// Position of a rectangle, and the attributes that a path shares.
struct Rectangle<'a> {
    x: &'a str,
    y: &'a str,
    /// Width, height, colour.
    alike: [&'a str; 3],
}

/// Picture with every run of equal rectangles merged into one path.
pub fn compact(svg: &str) -> String {
    let lines: Vec<(&str, Option<Rectangle<'_>>)> = svg.lines().map(|line| (line, rectangle(line))).collect();
    let mut text = String::with_capacity(svg.len() / 2);
    let same = |a: &(&str, Option<Rectangle<'_>>), b: &(&str, Option<Rectangle<'_>>)| match (&a.1, &b.1) {
        (Some(a), Some(b)) => a.alike == b.alike,
        _ => false,
    };
    for run in lines.chunk_by(same) {
        match &run[0].1 {
            Some(first) if run.len() >= MIN_RUN => {
                let [width, height, colour] = first.alike;
                // Writing to a string cannot fail.
                let _ = write!(text, "<path fill=\"{colour}\" d=\"");
                for (_, spot) in run {
                    if let Some(Rectangle { x, y, .. }) = spot {
                        let _ = write!(text, "M{x} {y}h{width}v{height}h-{width}z");
                    }
                }
                text.push_str("\"/>\n");
            }
            _ => run.iter().for_each(|(line, _)| {
                text.push_str(line);
                text.push('\n');
            }),
        }
    }
    text
}

/// Parses `<rect x=".." y=".." width=".." height=".." fill=".."/>` and nothing else.
fn rectangle(line: &str) -> Option<Rectangle<'_>> {
    let mut rest = line.strip_prefix("<rect ")?.strip_suffix("/>")?;
    let mut next = |name: &str| {
        let after = rest.trim_start().strip_prefix(name)?.strip_prefix("=\"")?;
        let (value, behind) = after.split_once('"')?;
        rest = behind;
        Some(value)
    };
    let [x, y, width, height, fill] = ["x", "y", "width", "height", "fill"].map(&mut next);
    rest.trim().is_empty().then_some(())?;
    Some(Rectangle { x: x?, y: y?, alike: [width?, height?, fill?] })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn spots(count: usize) -> String {
        (0..count).map(|x| format!("<rect x=\"{x}\" y=\"2\" width=\"3\" height=\"4\" fill=\"#FF0000\"/>\n")).collect()
    }

    #[test]
    fn equal_rectangles_become_one_path() {
        let text = compact(&(spots(MIN_RUN) + "<text/>\n"));
        assert!(text.starts_with("<path fill=\"#FF0000\" d=\"M0 2h3v4h-3zM1 2h3"), "{text}");
        assert!(text.ends_with("<text/>\n"), "{text}");
        assert!(!text.contains("<rect"), "{text}");
    }

    #[test]
    fn few_rectangles_and_other_shapes_stay() {
        let few = spots(MIN_RUN - 1);
        assert_eq!(compact(&few), few);
        let outlined =
            "<rect x=\"1\" y=\"2\" width=\"3\" height=\"4\" fill=\"none\" stroke=\"red\"/>\n".repeat(MIN_RUN);
        assert_eq!(compact(&outlined), outlined);
    }
}
