//! Compares every result of the emulated board and the host bit for bit, also with the board's floating-point unit set
//! to flush subnormals to zero or to return default NaNs. The motions come from the crate `stimuli`; host-tests compare
//! other builds of the host with the same digests.

use std::fmt;

use model_core::gears::design::design;
use parameters::JointParameters;
use stimuli::motion;

use super::joints::{TEST_JOINTS, TestJoint, write_files};
use board::device::image::DEFAULT_TICK_RATE;
use board::device::toolchain::Toolchain;
use board::device::{Say, measuring};
use report::failure::{Failure, Outcome};

/// Digests of a joint's tables and test motions.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Digests {
    /// Name of the joint.
    pub name: String,
    /// Digest of the tables.
    pub tables: u64,
    /// Digests of the motions.
    pub motions: motion::Digests,
}

/// Digests computed on the board, with the mode of its floating-point unit.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct BoardRun {
    /// Digests computed on the board.
    pub digests: Digests,
    /// True if subnormals were flushed to zero.
    pub flush_to_zero: bool,
    /// True if every NaN was the default one.
    pub default_nan: bool,
}

impl fmt::Display for Digests {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { name, tables, motions: motion::Digests { long, unbounded, tiny, changes } } = self;
        write!(f, "{name},{tables:016x},{long:016x},{unbounded:016x},{tiny:016x},{changes}")
    }
}

/// Function that runs its argument in a floating-point mode.
pub type InMode<'a> = &'a dyn Fn(&mut dyn FnMut());

/// Digests of a joint, computed on the host. The step runs in the given floating-point mode; the design always runs in
/// the default one.
pub fn on_host(joint: &TestJoint, in_mode: InMode<'_>) -> Outcome<Digests> {
    let parameters = joint.read()?.parameters;
    match parameters.geometry.planets {
        1 => with_planets::<1>(joint.name, &parameters, in_mode),
        3 => with_planets::<3>(joint.name, &parameters, in_mode),
        4 => with_planets::<4>(joint.name, &parameters, in_mode),
        _ => with_planets::<5>(joint.name, &parameters, in_mode),
    }
}

fn with_planets<const N: usize>(name: &str, parameters: &JointParameters, in_mode: InMode<'_>) -> Outcome<Digests> {
    let tables = design::<f32, N>(parameters, DEFAULT_TICK_RATE)
        .map_err(|error| Failure::new(error.to_string()).while_doing(format_args!("joint {name}")))?;
    let mut motions = motion::Digests::default();
    in_mode(&mut || motions = motion::digests(&tables));
    Ok(Digests { name: name.to_owned(), tables: tables.digest, motions })
}

/// Digests of all joints, computed on the emulated board in every mode.
pub fn on_board(toolchain: &Toolchain, say: Say<'_>) -> Outcome<Vec<BoardRun>> {
    let files = write_files(toolchain.target_directory())?;
    let elf = measuring::build_measuring(toolchain, "same_bits", &files, DEFAULT_TICK_RATE, say)?;
    measuring::read(&elf, parse)
}

/// Parses name, flush, nan, tables, long, unbounded, tiny, changes; a name may hold commas.
fn parse(line: &str) -> Option<BoardRun> {
    let mut fields = line.rsplitn(8, ',');
    let changes = fields.next()?.parse().ok()?;
    let mut digest = || u64::from_str_radix(fields.next()?, 16).ok();
    let (tiny, unbounded, long, tables) = (digest()?, digest()?, digest()?, digest()?);
    let (default_nan, flush_to_zero) = (fields.next()?.parse().ok()?, fields.next()?.parse().ok()?);
    let name = fields.next()?.to_owned();
    let motions = motion::Digests { long, unbounded, tiny, changes };
    Some(BoardRun { digests: Digests { name, tables, motions }, flush_to_zero, default_nan })
}

/// Compares every joint and mode of the board with the host; the first difference ends the comparison. Returns the
/// number of runs compared.
pub fn compare(board: &[BoardRun]) -> Outcome<usize> {
    for joint in &TEST_JOINTS {
        let host = on_host(joint, &|work| work())?;
        let runs: Vec<_> = board.iter().filter(|run| run.digests.name == joint.name).collect();
        if runs.len() != 4 {
            return Err(Failure::check_failed(format!("{}: {} runs on the board, not 4", joint.name, runs.len())));
        }
        if let Some(run) = runs.iter().find(|run| run.digests != host) {
            return Err(difference(run, &host));
        }
    }
    Ok(board.len())
}

fn difference(run: &BoardRun, host: &Digests) -> Failure {
    let on = |set: bool| if set { "on" } else { "off" };
    let (flush, nan) = (on(run.flush_to_zero), on(run.default_nan));
    let what = if run.digests.tables != host.tables {
        "the tables"
    } else if run.digests.motions.long != host.motions.long {
        "the long motion"
    } else if run.digests.motions.tiny != host.motions.tiny {
        "the motions from tiny numbers"
    } else {
        "the motion under infinite torques"
    };
    let message = format!(
        "{what} of joint {} differs in bits between board (flush-to-zero {flush}, default NaN {nan}) and host:\n\
         board {}\nhost  {host}",
        host.name, run.digests
    );
    Failure::check_failed(message).with_help(
        "the step must not use operations that round differently on the two (fused multiply-add, a library's sine),\n\
         nor keep numbers in its state that depend on the caller's floating-point mode",
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn on_board(name: &str, long: u64) -> BoardRun {
        let motions = motion::Digests { long, unbounded: 3, tiny: 4, changes: 5 };
        let digests = Digests { name: name.into(), tables: 1, motions };
        BoardRun { digests, flush_to_zero: true, default_nan: false }
    }

    #[test]
    fn a_line_of_the_board_is_read() {
        let line = "S1 no backlash,true,false,0000000000000001,0000000000000002,0000000000000003,0000000000000004,5";
        assert_eq!(parse(line), Some(on_board("S1 no backlash", 2)));
        assert_eq!(parse("panicked at x.rs:1:1"), None);
    }

    /// A difference names joint, floating-point mode and motion.
    #[test]
    fn difference_names_joint_mode_and_motion() {
        let failure = difference(&on_board("Q1", 7), &on_board("Q1", 2).digests);
        assert!(failure.message().contains("the long motion of joint Q1"), "{failure}");
        assert!(failure.message().contains("flush-to-zero on"), "{failure}");
    }

    /// A board that left out a joint fails.
    #[test]
    fn missing_joint_fails() {
        assert!(compare(&[]).is_err());
    }
}
