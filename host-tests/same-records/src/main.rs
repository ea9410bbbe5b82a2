//! `same-records OLD NEW`: are two trees of records the same? The comparison itself is in the library.

use std::path::PathBuf;
use std::process::ExitCode;

use same_records::html::Level;
use same_records::{Options, compare, findings, ignored};

const USAGE: &str = "Compares two trees of records value by value, or two files.

Usage: same-records [OPTIONS] OLD NEW

Options:
  --html LEVEL      What counts on HTML pages: numbers (each word with a digit, as often as it stands there),
                    figures (those, and the texts of tables' cells; the default), text (all of it, in order)
  --html-may-grow   Pages of NEW may have more figures and cells than those of OLD, but none may be gone
  --shown N         Differences shown of each file [default: 20]
  --ignored         Lists what is not compared, and ends
  --help            Prints this, and ends

Exit code: 0 if both are the same, 1 if not, 2 for bad usage or what cannot be read.
";

/// What was asked for.
struct Asked {
    old: PathBuf,
    new: PathBuf,
    options: Options,
    shown: usize,
}

fn main() -> ExitCode {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let wants = |option: &str| words.iter().any(|word| word == option);
    if wants("--help") || wants("-h") {
        print!("{USAGE}");
        return ExitCode::SUCCESS;
    }
    if wants("--ignored") {
        print!("{}", ignored::list());
        return ExitCode::SUCCESS;
    }
    let outcome = asked(&words).and_then(|asked| Ok((compare(&asked.old, &asked.new, asked.options)?, asked.shown)));
    match outcome {
        Ok((found, shown)) => {
            print!("{}", findings::report(&found, shown));
            ExitCode::from(u8::from(!found.all_same()))
        }
        Err(why) => {
            eprintln!("error: {why}");
            ExitCode::from(2)
        }
    }
}

fn asked(words: &[String]) -> Result<Asked, String> {
    let (mut trees, mut options, mut shown) = (Vec::new(), Options::default(), 20);
    let mut words = words.iter();
    while let Some(word) = words.next() {
        let mut value = || words.next().ok_or_else(|| format!("{word} wants a value\n\n{USAGE}"));
        match word.as_str() {
            "--html" => {
                options.html = match value()?.as_str() {
                    "numbers" => Level::Numbers,
                    "figures" => Level::Figures,
                    "text" => Level::Text,
                    other => return Err(format!("--html {other}: it is numbers, figures or text")),
                }
            }
            "--html-may-grow" => options.html_may_grow = true,
            "--shown" => {
                let value = value()?;
                shown = value.parse().map_err(|_| format!("--shown {value}: not a whole number"))?;
            }
            unknown if unknown.starts_with('-') => return Err(format!("unknown option {unknown}\n\n{USAGE}")),
            tree => trees.push(PathBuf::from(tree)),
        }
    }
    match <[PathBuf; 2]>::try_from(trees) {
        Ok([old, new]) => Ok(Asked { old, new, options, shown }),
        Err(trees) => Err(format!("two trees are compared, not {}\n\n{USAGE}", trees.len())),
    }
}
