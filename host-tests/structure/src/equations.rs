//! Numbered equations: a page of docs/theory defines them, its list "Equations in the code" names the files that apply
//! them, and the comments of these files cite the numbers.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// Number of an equation: letter of its page, and the number on the page.
type Number = (char, u32);

/// Folders whose comments cite equations.
const SOURCES: [&str; 5] =
    ["model-core/src", "parameters/src", "host/reference/src", "host/data-sheet/src", "research/paper/src"];

/// Findings of all pages in docs/theory against the sources below `root`.
pub fn mismatches(root: &Path) -> Vec<String> {
    let comments: BTreeMap<PathBuf, BTreeSet<Number>> = SOURCES
        .iter()
        .flat_map(|folder| files_below(&root.join(folder), "rs"))
        .map(|path| {
            let text = std::fs::read_to_string(&path).unwrap_or_default();
            let cited = text.lines().filter_map(|line| line.split_once("//")).flat_map(|(_, comment)| ranges(comment));
            (path, cited.collect())
        })
        .collect();
    let mut found = vec![];
    let mut defined = BTreeSet::new();
    for page in files_below(&root.join("docs/theory"), "md") {
        let text = std::fs::read_to_string(&page).unwrap_or_default();
        let name = page.strip_prefix(root).unwrap_or(&page).display().to_string();
        let here = definitions(&text);
        if here.is_empty() {
            continue;
        }
        let (letter, count) = (here[0].0, here.len() as u32);
        let missing = (1..=count).map(|it| (letter, it)).filter(|it| !here.contains(it));
        found.extend(missing.map(|it| format!("{name}: {} of {count} equations is not defined", show(&it))));
        let listed = list(&text);
        for (file, given) in &listed {
            let candidates = comments.keys().filter(|path| path.ends_with(file)).collect::<Vec<_>>();
            let [path] = candidates[..] else {
                found.push(format!("{name}: {} files end in {}", candidates.len(), file.display()));
                continue;
            };
            let missing = given.iter().filter(|number| !comments[path].contains(number)).map(show);
            found.extend(missing.map(|number| format!("{name}: no comment of {} cites {number}", file.display())));
        }
        let all: BTreeSet<Number> = listed.into_iter().flat_map(|(_, given)| given).collect();
        let here: BTreeSet<Number> = here.into_iter().collect();
        found.extend(here.difference(&all).map(|it| format!("{name}: no file is listed for {}", show(it))));
        found.extend(all.difference(&here).map(|it| format!("{name}: lists {}, which it does not define", show(it))));
        defined.extend(here);
    }
    let letters: BTreeSet<char> = defined.iter().map(|number| number.0).collect();
    for (path, cited) in &comments {
        let unknown = cited.iter().filter(|number| letters.contains(&number.0) && !defined.contains(number)).map(show);
        let path = path.strip_prefix(root).unwrap_or(path).display();
        found.extend(unknown.map(|number| format!("{path}: cites {number}, which no page defines")));
    }
    found
}

/// Files with an extension below a folder.
fn files_below(folder: &Path, extension: &str) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let mut found: Vec<PathBuf> = entries
        .map(|entry| entry.path())
        .flat_map(|path| if path.is_dir() { files_below(&path, extension) } else { vec![path] })
        .filter(|path| path.extension().is_some_and(|it| it == extension))
        .collect();
    found.sort();
    found
}

fn show(number: &Number) -> String {
    format!("{}{}", number.0, number.1)
}

/// Numbers at the beginning of a line in a block of equations, such as `    (O7)  m = ...`.
fn definitions(text: &str) -> Vec<Number> {
    let inside = text.lines().filter(|line| line.starts_with("    ("));
    inside.filter_map(|line| number(line.trim_start().strip_prefix('(')?.split_once(')')?.0)).collect()
}

/// Files of the section "Equations in the code" with the numbers behind each. A path in backquotes that ends in `/`
/// opens the folder of its item, others the folder of all items below, unless they end in `.rs`.
fn list(text: &str) -> Vec<(PathBuf, Vec<Number>)> {
    let section = text.split("## Equations in the code").nth(1).unwrap_or_default();
    let section = section.split("\n## ").next().unwrap_or_default();
    let (mut base, mut found) = (PathBuf::new(), vec![]);
    for item in section.split("\n- ").flat_map(|item| item.split("\n\n")) {
        let (mut folder, mut files): (PathBuf, Vec<PathBuf>) = (base.clone(), vec![]);
        for (index, part) in item.split('`').enumerate() {
            if index % 2 == 0 {
                let given: Vec<Number> = ranges(part);
                if !given.is_empty() {
                    found.extend(files.drain(..).map(|file| (file, given.clone())));
                } else if part.contains(';') || part.chars().any(|letter| letter.is_alphabetic()) {
                    files.clear();
                }
            } else if part.ends_with(".rs") {
                files.push(folder.join(part));
            } else if part.ends_with('/') || item.contains(&format!("`{part}`:")) && !item.starts_with("In ") {
                folder = base.join(part);
            } else if part.contains('/') {
                base = PathBuf::from(part);
                folder.clone_from(&base);
            }
        }
    }
    found
}

/// Numbers in a text, ranges such as `E1 to E4` written out.
fn ranges(text: &str) -> Vec<Number> {
    let words: Vec<&str> =
        text.split_whitespace().map(|word| word.trim_matches([',', ';', ':', '.', '(', ')', '`'])).collect();
    let mut found: Vec<Number> = vec![];
    for (index, word) in words.iter().enumerate() {
        let Some(this) = number(word) else { continue };
        let first = found.last().filter(|_| index > 0 && words[index - 1] == "to").map_or(this.1, |last| last.1 + 1);
        found.extend((first..=this.1).map(|it| (this.0, it)));
    }
    found
}

/// Number that a word is.
fn number(word: &str) -> Option<Number> {
    let letter = word.chars().next().filter(|letter| "OKSERP".contains(*letter))?;
    let digits = &word[1..];
    (digits.len() <= 2 && digits.chars().all(|it| it.is_ascii_digit())).then(|| Some((letter, digits.parse().ok()?)))?
}
