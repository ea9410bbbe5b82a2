//! Follows a page such as docs/tutorial.md as a reader does: writes the page's files, runs its commands, and compares
//! their output with the page.
//!
//! Parts of a page:
//!
//! - a fence `toml` after a line that begins with a name, as in "`k9/k9.toml`:", is a file, written when it is reached;
//! - a fence `console` holds commands after `$ `, each with its output; `console emulated-board` holds commands that
//!   need the emulated board; any other fence is not run;
//! - in an output a line `...` stands for any lines, and `[...]` within a line for any text;
//! - a command that ends with another code than 0 is followed by `$ echo $?`.

use std::fs;
use std::os::unix::fs::symlink;
use std::path::Path;
use std::process::{Command, Stdio};

use crate::command::folder;

/// Test run that executes a command of the page.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Tier {
    /// `cargo test`.
    Host,
    /// `cargo joint hil --check`.
    EmulatedBoard,
}

/// Outcome of following a page.
#[derive(Debug)]
pub struct Followed {
    /// Number of commands that ran.
    pub commands: usize,
    /// One text for each command whose output differs from the page.
    pub differences: Vec<String>,
    /// The page with the printed output in place of the differing lines.
    pub page: String,
}

impl Tier {
    const fn fence(self) -> &'static str {
        match self {
            Self::Host => "console",
            Self::EmulatedBoard => "console emulated-board",
        }
    }
}

/// Follows a page of the folder docs and fails with each difference; with `UPDATE_TUTORIAL` set it updates the page.
pub fn follow_page(name: &str, tier: Tier) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs").join(name);
    let page = fs::read_to_string(&path).expect("the page");
    let followed = follow(&page, tier);
    assert!(followed.commands > 0, "no command of docs/{name} is run here");
    if std::env::var_os("UPDATE_TUTORIAL").is_some() && followed.page != page {
        fs::write(&path, &followed.page).expect("the page can be written");
        println!("docs/{name} is updated; review the change:\n\n{}", followed.differences.join("\n"));
        return;
    }
    assert!(
        followed.differences.is_empty(),
        "docs/{name} differs from what the commands print. To update the page, set UPDATE_TUTORIAL=1 for this test.\n\n{}",
        followed.differences.join("\n")
    );
}

/// Follows a page in a temporary folder that links to the project's test files.
pub fn follow(page: &str, tier: Tier) -> Followed {
    let place = folder();
    symlink(Path::new(env!("CARGO_MANIFEST_DIR")).join("../../hil"), place.path().join("hil")).expect("a link");
    let lines: Vec<&str> = page.lines().collect();
    let mut followed = Followed { commands: 0, differences: vec![], page: String::new() };
    let mut written: Vec<String> = vec![];
    let mut at = 0;
    while at < lines.len() {
        written.push(lines[at].to_owned());
        at += 1;
        let Some(fence) = lines[at - 1].strip_prefix("```") else { continue };
        let length = lines[at..].iter().position(|line| *line == "```");
        let block = &lines[at..at + length.unwrap_or_else(|| panic!("line {at}: this fence has no end"))];
        if fence == tier.fence() {
            run_block(block, at + 1, place.path(), &mut followed, &mut written);
        } else {
            if let ("toml", Some(name)) = (fence, file_name(&lines[..at - 1])) {
                let file = place.path().join(name);
                fs::create_dir_all(file.parent().expect("it is in a folder")).expect("a folder");
                fs::write(file, block.join("\n") + "\n").expect("a file");
            }
            written.extend(block.iter().map(|line| (*line).to_owned()));
        }
        written.push("```".to_owned());
        at += block.len() + 1;
    }
    followed.page = written.join("\n") + "\n";
    followed
}

/// Name of the file in a fence: the last line before it that is not empty begins with the name.
fn file_name<'p>(before: &[&'p str]) -> Option<&'p str> {
    let line = before.iter().rfind(|line| !line.is_empty())?;
    line.strip_prefix('`')?.split_once("`:").map(|(name, _)| name)
}

/// Runs the commands of a fence; `first` is the number of its first line.
fn run_block(block: &[&str], first: usize, place: &Path, followed: &mut Followed, written: &mut Vec<String>) {
    assert!(block.first().is_some_and(|line| line.starts_with("$ ")), "line {first}: a command begins with `$ `");
    let mut code = 0;
    let mut rest = block;
    while let [head, after @ ..] = rest {
        let line = first + block.len() - rest.len();
        let command = &head["$ ".len()..];
        let (said, next) = after.split_at(after.iter().position(|line| line.starts_with("$ ")).unwrap_or(after.len()));
        let (out, ended) = run(command, code, place);
        code = ended;
        followed.commands += 1;
        written.push((*head).to_owned());
        // A message about another build in progress depends on the other tests.
        let own = |line: &&str| !line.starts_with("waiting for another ");
        let printed: Vec<&str> = out.lines().map(str::trim_end).filter(own).collect();
        let changes = align(said, &printed);
        if changes.iter().any(Change::is_one) {
            followed.differences.push(show(&changes, command, line));
        }
        if code != 0 && next.first().is_none_or(|line| *line != "$ echo $?") {
            followed.differences.push(format!("line {line}: `{command}` ends with {code}:\n{out}"));
        }
        written.extend(changes.iter().filter_map(Change::mended));
        rest = next;
    }
}

/// Output of a command, both streams in order, and its exit code; `before` is the exit code of the previous command.
fn run(command: &str, before: i32, place: &Path) -> (String, i32) {
    let script = format!(
        "exec 2>&1\ncargo() {{ [ \"$1\" = joint ] || exit 127; shift; \"$JOINT\" \"$@\"; }}\n(exit {before})\n{command}"
    );
    let output = Command::new("bash")
        .args(["-c", &script])
        .current_dir(place)
        .env("JOINT", env!("CARGO_BIN_EXE_joint"))
        .env("NO_COLOR", "1")
        .env("COLUMNS", "100")
        .env("LC_ALL", "C.UTF-8")
        .stdin(Stdio::null())
        .output()
        .expect("a shell");
    (String::from_utf8_lossy(&output.stdout).into_owned(), output.status.code().unwrap_or(-1))
}

/// A line of the page beside a printed line.
#[derive(Debug, Clone, PartialEq, Eq)]
enum Change {
    /// Equal on the page and in the output.
    Same(String),
    /// On the page, with a similar printed line.
    Other(String, String),
    /// On the page only.
    Gone(String),
    /// In the output only.
    New(String),
}

impl Change {
    fn is_one(&self) -> bool {
        !matches!(self, Self::Same(_))
    }

    /// Line for the updated page.
    fn mended(&self) -> Option<String> {
        match self {
            Self::Same(line) | Self::New(line) => Some(line.clone()),
            Self::Other(said, printed) => Some(masked(said, printed)),
            Self::Gone(_) => None,
        }
    }
}

/// Printed line with the masks of the page's line, if both have as many words.
fn masked(said: &str, printed: &str) -> String {
    let words = |line: &str| line.split(' ').map(str::to_owned).collect::<Vec<_>>();
    let (said, mut line) = (words(said), words(printed));
    if said.len() == line.len() {
        for (word, mask) in line.iter_mut().zip(said).filter(|(_, mask)| mask.contains("[...]")) {
            *word = mask;
        }
    }
    line.join(" ")
}

/// Returns true if a line of the page allows a printed one.
fn allows(said: &str, printed: &str) -> bool {
    let mut parts = said.split("[...]");
    let Some(mut rest) = parts.next().and_then(|head| printed.strip_prefix(head)) else { return false };
    let mut parts = parts.peekable();
    if parts.peek().is_none() {
        return rest.is_empty();
    }
    while let Some(part) = parts.next() {
        if parts.peek().is_none() {
            return rest.ends_with(part);
        }
        let Some(found) = rest.find(part) else { return false };
        rest = &rest[found + part.len()..];
    }
    true
}

/// Aligns a page's lines with the printed lines with the fewest changes.
fn align(said: &[&str], printed: &[&str]) -> Vec<Change> {
    // A changed line is cheaper than a removed one, so that `...` does not absorb a change beside it.
    const ALIKE: usize = 2;
    const GONE_OR_NEW: usize = 3;
    let price = |said: &str, printed: &str| match () {
        () if allows(said, printed) => 0,
        () if said.split_whitespace().take(2).eq(printed.split_whitespace().take(2)) => ALIKE,
        () => 3 * GONE_OR_NEW,
    };
    let columns = printed.len() + 1;
    // Cost of the remaining lines, and whether the best continuation takes a line of the page, a printed line, or both.
    let mut best = vec![(0, false, false); (said.len() + 1) * columns];
    let place = |row: usize, column: usize| row * columns + column;
    for row in (0..=said.len()).rev() {
        for column in (0..=printed.len()).rev() {
            let cost = |down: usize, right: usize| best[place(row + down, column + right)].0;
            let (is_row, is_column) = (row < said.len(), column < printed.len());
            let mut ways = vec![];
            if is_row && said[row].trim() == "..." {
                ways.push((cost(1, 0), true, false));
                if is_column {
                    ways.push((cost(0, 1), false, true));
                }
            } else {
                if is_row && is_column {
                    ways.push((cost(1, 1) + price(said[row], printed[column]), true, true));
                }
                if is_row {
                    ways.push((cost(1, 0) + GONE_OR_NEW, true, false));
                }
                if is_column {
                    ways.push((cost(0, 1) + GONE_OR_NEW, false, true));
                }
            }
            if let Some(way) = ways.into_iter().min_by_key(|way| way.0) {
                best[place(row, column)] = way;
            }
        }
    }
    let mut changes = vec![];
    let (mut row, mut column) = (0, 0);
    while row < said.len() || column < printed.len() {
        let (_, down, right) = best[place(row, column)];
        let rests = row < said.len() && said[row].trim() == "...";
        let line = |lines: &[&str], at: usize| lines[at].to_owned();
        match (down, right) {
            (true, true) if allows(said[row], printed[column]) => changes.push(Change::Same(line(said, row))),
            (true, true) => changes.push(Change::Other(line(said, row), line(printed, column))),
            (true, false) if rests => changes.push(Change::Same(line(said, row))),
            (true, false) => changes.push(Change::Gone(line(said, row))),
            (false, true) if rests => {}
            _ => changes.push(Change::New(line(printed, column))),
        }
        row += usize::from(down);
        column += usize::from(right);
    }
    changes
}

/// Lines around each difference, with their numbers in the page; `-` marks the page, `+` the output.
fn show(changes: &[Change], command: &str, line: usize) -> String {
    const AROUND: usize = 2;
    let mut text = format!("line {line}: $ {command}\n");
    let mut number = line;
    for (place, change) in changes.iter().enumerate() {
        number += usize::from(!matches!(change, Change::New(_)));
        let near = &changes[place.saturating_sub(AROUND)..(place + AROUND + 1).min(changes.len())];
        if !near.iter().any(Change::is_one) {
            continue;
        }
        text += &match change {
            Change::Same(said) => format!("{number:>6}   {said}\n"),
            Change::Other(said, printed) => format!("{number:>6} - {said}\n       + {printed}\n"),
            Change::Gone(said) => format!("{number:>6} - {said}\n"),
            Change::New(printed) => format!("       + {printed}\n"),
        };
    }
    text
}
