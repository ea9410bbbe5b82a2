//! Job script for SLURM: an array whose elements each run one task.

use std::path::{Path, PathBuf};

use report::command_line::quoted;
use report::failure::{Failure, Outcome};
use report::workspace::is_declared_installed;
use report::write::write_text;

/// Name of the script.
const SCRIPT: &str = "slurm.sh";

/// Writes the script for tasks by number and returns the message with the next commands.
pub fn write(folder: &Path, numbers: &[usize], repeat: &str) -> Outcome<String> {
    if numbers.is_empty() {
        return Ok(format!("every task has a result; collect them:\n{repeat}\n"));
    }
    // Elements of the array may start in any folder of another machine.
    let folder = folder.canonicalize().map_err(|error| {
        Failure::new(format!("cannot read the folder {}: {error}", folder.display())).with_help("name another by --out")
    })?;
    let script = folder.join(SCRIPT);
    write_text(&script, &text(&program()?, &folder, numbers))?;
    let count = numbers.len();
    let tasks = if count == 1 { "1 task is".to_owned() } else { format!("{count} tasks are") };
    let path = quoted(&script.display().to_string());
    Ok(format!("{tasks} left; submit the job:\nsbatch {path}\nafter it, collect the results:\n{repeat}\n"))
}

/// Text of the script. A program that a signal kills, as for want of memory, runs again in its place; a job whose node is
/// lost is queued again by SLURM.
fn text(program: &str, folder: &Path, numbers: &[usize]) -> String {
    let array = ranges(numbers);
    let folder = folder.display().to_string();
    let log = format!("{folder}/slurm-%a.log");
    let folder = quoted(&folder);
    format!(
        "#!/bin/sh
#SBATCH --job-name=joint
#SBATCH --array={array}
#SBATCH --requeue
#SBATCH --open-mode=append
#SBATCH --output=\"{log}\"
for attempt in 1 2 3; do
    {program} task {folder} --number \"$SLURM_ARRAY_TASK_ID\"
    code=$?
    [ $code -gt 130 ] || exit $code
done
exit $code
"
    )
}

/// Numbers as SLURM lists them: `0-5,7`.
fn ranges(numbers: &[usize]) -> String {
    let mut ranges: Vec<(usize, usize)> = Vec::new();
    for number in numbers {
        match ranges.last_mut() {
            Some((_, last)) if *last + 1 == *number => *last = *number,
            _ => ranges.push((*number, *number)),
        }
    }
    let word = |(first, last): &(usize, usize)| match first == last {
        true => first.to_string(),
        false => format!("{first}-{last}"),
    };
    ranges.iter().map(word).collect::<Vec<_>>().join(",")
}

/// Command that starts this program on another machine with the same files.
fn program() -> Outcome<String> {
    // The package of Python has no program of its own; a release has.
    if is_declared_installed() {
        return Ok(format!("{} -m lostmotion", quoted(&super::dask::python())));
    }
    let path: PathBuf = std::env::current_exe()
        .map_err(|error| Failure::new(format!("cannot find the program's own path: {error}")))?;
    Ok(quoted(&path.display().to_string()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_listed_as_ranges() {
        assert_eq!(ranges(&[0, 1, 2, 5, 7, 8]), "0-2,5,7-8");
        assert_eq!(ranges(&[4]), "4");
    }

    #[test]
    fn paths_with_spaces_are_quoted() {
        let script = text("'/opt/my tools/joint'", Path::new("/data/my sweep"), &[0]);
        assert!(script.contains("'/opt/my tools/joint' task '/data/my sweep' --number"), "{script}");
        assert!(script.contains("--output=\"/data/my sweep/slurm-%a.log\""), "{script}");
    }
}
