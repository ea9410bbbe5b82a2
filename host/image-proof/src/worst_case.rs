//! Worst case of a tick: instructions of one step from many random states (trials), counted on the emulated board
//! without serial traffic and compared with the time that the tick rate allows. The states come from the crate
//! `stimuli`.

use std::fmt;
use std::path::{Path, PathBuf};

use super::joints::write_files;
use model_core::gears::certificate::Substeps;

use board::device::board::Chip;
use board::device::image::DEFAULT_TICK_RATE;
use board::device::toolchain::Toolchain;
use board::device::{Say, measuring};
use report::failure::{Failure, Outcome};

/// Part of a period allowed for the worst step: one and a half times the half that a step may take on average. The rest
/// is for the board's other work.
const WORST_SHARE: f64 = 0.75;
/// Cycles per instruction of a Cortex-M4F in this code, from the timing tables of its manual weighted by a trace.
pub const CYCLES_AN_INSTRUCTION: f64 = 1.4;

/// Instructions of one group of trials.
#[derive(Debug, Clone, PartialEq)]
pub struct Count {
    /// Name of the group.
    pub name: String,
    /// Number of trials.
    pub trials: u32,
    /// Mean instructions per tick.
    pub mean: f64,
    /// Maximum instructions per tick.
    pub most: u32,
    /// First trial with the maximum.
    pub trial: u32,
}

/// Result of the search for a joint.
#[derive(Debug, Clone, PartialEq)]
pub struct SearchResult {
    /// Name of the joint.
    pub name: String,
    /// Number of planets.
    pub planets: u32,
    /// Sub-steps of a tick in which contacts change.
    pub parts: Substeps,
    /// Seed of the trials.
    pub seed: u64,
    /// Counts by the change of the contact set.
    pub classes: Vec<Count>,
    /// Counts by the origin of the trial.
    pub kinds: Vec<Count>,
    /// State of the worst trial.
    pub state: String,
}

impl SearchResult {
    /// Class with the worst trial.
    pub fn worst(&self) -> Option<&Count> {
        self.classes.iter().max_by_key(|count| count.most)
    }

    /// Maximum instructions of a tick.
    pub fn most(&self) -> u32 {
        self.worst().map_or(0, |worst| worst.most)
    }

    /// Number of all trials.
    pub fn trials(&self) -> u32 {
        self.classes.iter().map(|count| count.trials).sum()
    }
}

/// Instructions allowed for a step at a tick rate on a board.
pub fn budget(chip: Chip, tick_rate: u32) -> u32 {
    let period = f64::from(chip.core_rate()) / f64::from(tick_rate);
    (WORST_SHARE * period / CYCLES_AN_INSTRUCTION) as u32
}

/// Builds the searching image with the test joints; returns the ELF file.
pub fn build(toolchain: &Toolchain, say: Say<'_>) -> Outcome<PathBuf> {
    let files = write_files(toolchain.target_directory())?;
    measuring::build_measuring(toolchain, "worst_case", &files, DEFAULT_TICK_RATE, say)
}

/// Searches on the emulated board.
pub fn search(elf: &Path) -> Outcome<Vec<SearchResult>> {
    let mut found = Vec::new();
    measuring::read(elf, |line| parse(line, &mut found))?;
    Ok(found)
}

/// Parses a line of the board and adds it to the results.
pub(crate) fn parse(line: &str, found: &mut Vec<SearchResult>) -> Option<()> {
    let (sort, rest) = line.split_once(';')?;
    let mut fields = rest.split(';');
    if sort == "joint" {
        let (classes, kinds, state) = (Vec::new(), Vec::new(), String::new());
        let name = fields.next()?.to_owned();
        let planets = fields.next()?.parse().ok()?;
        let parts = super::parse_substeps(&mut fields)?;
        let seed = fields.next()?.parse().ok()?;
        found.push(SearchResult { name, planets, parts, seed, classes, kinds, state });
        return Some(());
    }
    let search = found.last_mut()?;
    if sort == "state" {
        search.state = rest.to_owned();
        return Some(());
    }
    let name = fields.next()?.to_owned();
    let trials: u32 = fields.next()?.parse().ok()?;
    let sum: f64 = fields.next()?.parse().ok()?;
    let (most, trial) = (fields.next()?.parse().ok()?, fields.next()?.parse().ok()?);
    let count = Count { name, trials, mean: sum / f64::from(trials.max(1)), most, trial };
    match sort {
        "class" => search.classes.push(count),
        "kind" => search.kinds.push(count),
        _ => return None,
    }
    Some(())
}

/// Joints whose tick is designed to fit the emulated board at the default rate. The others are only shown: the paper's
/// joint needs a lower rate, and five planets or a state that is not finite need more time than is left.
const FITTED_JOINTS: [&str; 2] = ["Q1", "L1 with 4 planets"];

/// Fails if a step of a fitted joint exceeds its time on the emulated board.
pub fn check(found: &[SearchResult]) -> Outcome<()> {
    let chip = Chip::Stm32f405;
    let budget = budget(chip, DEFAULT_TICK_RATE);
    let over: Vec<_> = found
        .iter()
        .filter(|search| FITTED_JOINTS.contains(&search.name.as_str()) && search.most() > budget)
        .map(|search| excess_message(search, budget))
        .collect();
    match over.is_empty() {
        true => Ok(()),
        false => Err(Failure::check_failed(over.join("\n")).with_help(format!(
            "{budget} instructions are {} % of the period at {DEFAULT_TICK_RATE} Hz on {}, at {CYCLES_AN_INSTRUCTION} \
             cycles each:\nreduce the step on that path, or let `design` choose fewer sub-steps",
            100.0 * WORST_SHARE,
            chip.name(),
        ))),
    }
}

fn excess_message(search: &SearchResult, budget: u32) -> String {
    let (class, trial) = search.worst().map_or(("", 0), |worst| (worst.name.as_str(), worst.trial));
    format!(
        "joint {}: a step may take {} instructions, more than {budget} ({class}, trial {trial} of seed {}):\n{}",
        search.name,
        search.most(),
        search.seed,
        search.state,
    )
}

impl fmt::Display for SearchResult {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { name, planets, parts, seed, .. } = self;
        writeln!(f, "{name}: {planets} planets, {parts} a tick, {} states, seed {seed}", self.trials())?;
        writeln!(f, "  instructions            states    a tick: mean    most    of a part: mean    most   trial")?;
        let parts = f64::from(parts.count().max(1));
        for (index, Count { name, trials, mean, most, trial }) in self.classes.iter().chain(&self.kinds).enumerate() {
            if index == self.classes.len() {
                writeln!(f, "  by origin")?;
            }
            let (mean_part, most_part) = (mean / parts, f64::from(*most) / parts);
            writeln!(
                f,
                "  {name:<22} {trials:>7}  {mean:>14.0} {most:>7}  {mean_part:>17.0} {most_part:>7.0} {trial:>7}"
            )?;
        }
        write!(f, "  worst: {}", self.state)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found() -> Vec<SearchResult> {
        let mut found = Vec::new();
        for line in
            ["joint;Q1;3;2;0;1", "class;apart;10;1000;4600;7", "kind;grazing;10;1000;4600;7", "state;X { y: 1 }"]
        {
            parse(line, &mut found).unwrap();
        }
        found
    }

    /// The budget is 75 % of a period in instructions.
    #[test]
    fn budget_follows_clock_and_rate() {
        // 75 % of 8400 cycles at 1.4 cycles per instruction.
        assert_eq!(budget(Chip::Stm32f405, 20_000), 4500);
        assert_eq!(budget(Chip::Stm32f405, 10_000), 9000);
    }

    /// Lines of the board become the results of a search.
    #[test]
    fn search_output_parsed() {
        let found = found();
        assert_eq!((found[0].most(), found[0].trials(), found[0].classes[0].mean), (4600, 10, 100.0));
        assert_eq!(found[0].state, "X { y: 1 }");
        assert_eq!(parse("panicked at x.rs", &mut Vec::new()), None);
    }

    /// A step above the budget is reported with its trial and state.
    #[test]
    fn excessive_step_shown_with_state() {
        let failure = check(&found()).unwrap_err();
        assert!(
            failure.message().contains("trial 7 of seed 1") && failure.message().contains("X { y: 1 }"),
            "{failure}"
        );
        assert!(failure.help().unwrap().contains("75 %"), "{failure}");
        assert_eq!(failure.exit_code(), 1);
    }
}
