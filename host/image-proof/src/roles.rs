//! Instructions of the roles with a controller, and of the observer alone, counted tick by tick on the emulated board
//! over a motion with reversals, disturbance torques and a silent encoder, and compared with the time of a control
//! period. The plant's step is bounded over all states in `worst_case`.

use std::fmt;
use std::path::Path;

use joint_file::named;
use link::messages::Role;

use super::worst_case::CYCLES_AN_INSTRUCTION;
use board::device::board::{Board, Chip};
use board::device::image::CONTROL_RATE;
use board::device::tick_time::RateCheck;
use board::device::toolchain::Toolchain;
use board::device::{Say, measuring};
use report::failure::{Failure, Outcome};

/// Instructions of a role's tick.
#[derive(Debug, Clone, PartialEq)]
pub struct RoleCost {
    /// Name of the role.
    pub role: String,
    /// Name of the joint.
    pub joint: String,
    /// Number of control periods.
    pub periods: u32,
    /// Mean instructions.
    pub mean: f64,
    /// Maximum instructions.
    pub most: u32,
    /// Control period with the maximum.
    pub at: u32,
    /// State of the role in memory [B].
    pub bytes: u32,
}

impl fmt::Display for RoleCost {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { role, joint, periods, mean, most, at, bytes } = self;
        let [usual, worst] = [*mean, f64::from(*most)].map(|instructions| 100.0 * period_share(instructions));
        write!(
            f,
            "role {role}, {joint}: {mean:.0} instructions a tick, at most {most} (period {at} of {periods}): {usual:.0} % and \
             {worst:.0} % of a control period; state {bytes} B"
        )
    }
}

/// Counts instructions on the emulated board.
pub fn count(toolchain: &Toolchain, say: Say<'_>) -> Outcome<Vec<RoleCost>> {
    let elf = measuring::build_measuring(toolchain, "roles", &[], CONTROL_RATE, say)?;
    measuring::read(&elf, parse)
}

fn parse(line: &str) -> Option<RoleCost> {
    let mut fields = line.strip_prefix("role;")?.split(';');
    let (role, joint) = (fields.next()?.to_owned(), fields.next()?.to_owned());
    let periods: u32 = fields.next()?.parse().ok()?;
    let sum: f64 = fields.next()?.parse().ok()?;
    let mut number = || fields.next()?.parse().ok();
    let (most, at, bytes) = (number()?, number()?, number()?);
    Some(RoleCost { role, joint, periods, mean: sum / f64::from(periods.max(1)), most, at, bytes })
}

/// Part of a control period of the emulated board that a number of instructions takes.
pub fn period_share(instructions: f64) -> f64 {
    instructions * CYCLES_AN_INSTRUCTION * f64::from(CONTROL_RATE) / f64::from(Chip::Stm32f405.core_rate())
}

/// Fails if a role's worst tick exceeds its part of a control period.
pub fn check(costs: &[RoleCost]) -> Outcome<()> {
    // The bounds by which images are rejected must not be below the counts.
    let (board, joint) = (Board::emulated(), named::load(Path::new("q1"))?.file.parameters);
    let promised = |role| {
        RateCheck::new(&joint, &board, role).tick_time(CONTROL_RATE).map_or(f64::INFINITY, |time| time.instructions)
    };
    let [observer, whole_loop] = [Role::Observer, Role::Loop].map(promised);
    let over = |load: &&RoleCost| match load.role.as_str() {
        "loop" => f64::from(load.most) > whole_loop || period_share(load.most.into()) > 1.0,
        _ => f64::from(load.most) > observer,
    };
    let over: Vec<String> = costs.iter().filter(over).map(RoleCost::to_string).collect();
    if over.is_empty() {
        return Ok(());
    }
    let help = format!(
        "the limits are {observer:.0} instructions for an observer, {whole_loop:.0} for a whole loop (host/board/src/device/tick_time.rs): make \
         that tick cheaper"
    );
    Err(Failure::check_failed(format!("too many instructions:\n{}", over.join("\n"))).with_help(help))
}

#[cfg(test)]
mod tests {
    use board::device::tick_time::OBSERVER_INSTRUCTIONS;

    use super::*;

    /// The board's lines are parsed, and roles above their share of a period fail.
    #[test]
    fn role_costs_checked_against_period() {
        let load = parse("role;loop;Q1;100;200000;12001;7;640").unwrap();
        assert_eq!((load.mean, load.most, load.at, load.bytes), (2000.0, 12001, 7, 640));
        let failure = check(std::slice::from_ref(&load)).unwrap_err();
        assert!(failure.message().contains("role loop, Q1"), "{failure}");
        assert!(check(&[RoleCost { most: 10_000, ..load.clone() }]).is_ok());
        let observer = RoleCost { role: "observer".to_owned(), most: OBSERVER_INSTRUCTIONS + 1, ..load };
        assert!(check(std::slice::from_ref(&observer)).is_err());
        assert!(check(&[RoleCost { most: OBSERVER_INSTRUCTIONS, ..observer }]).is_ok());
        assert_eq!(parse("panicked at x.rs"), None);
    }
}
