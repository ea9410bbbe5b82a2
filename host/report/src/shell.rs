//! What all pages and pictures share: documents that need neither network nor scripts, with their style inside. What
//! stands in them is each report's business.

use maud::{DOCTYPE, Markup, PreEscaped, html};

use super::plot::ink;

const STYLE: &str = include_str!("style.css");

/// A whole page around its body; `own_style` is what it needs beyond the style of all reports.
pub fn page(title: &str, own_style: &str, body: &Markup) -> String {
    let page = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                meta name="color-scheme" content="light dark";
                title { (title) }
                style { (PreEscaped(ink::style_sheet(":root"))) (PreEscaped(STYLE)) (PreEscaped(own_style)) }
            }
            body { main { (body) } }
        }
    };
    page.into_string()
}

/// A picture as a file of its own.
pub fn standalone(svg: &str) -> String {
    let style = format!(
        "<style>\n{}svg{{font-family:system-ui,sans-serif;background:#fff}}\n\
         @media screen and (prefers-color-scheme:dark){{svg{{background:#12171e}}}}\n\
         rect{{shape-rendering:crispEdges}}polyline{{stroke-linejoin:round}}\n</style>\n",
        ink::style_sheet("svg")
    );
    match svg.split_once('\n') {
        Some((open, rest)) => format!("{open}\n{style}{rest}"),
        None => svg.to_owned(),
    }
}
