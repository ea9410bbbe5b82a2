//! Whether a chip has time for the tick of a role that controls: instructions as counted on the emulated board, cycles an instruction
//! as reckoned for the chip, none of them measured on silicon.

use std::path::Path;

use joint_file::named;
use link::messages::Role;
use model_core::gears::design::{Effort, StepSize};
use parameters::JointParameters;

use super::board::Board;
use report::failure::{Failure, Outcome};

/// Instructions that a tick of the role `observer` takes at most. What counts them holds them against this and the next.
pub const OBSERVER: u32 = 6500;
/// Those of a tick of the role `loop` beside the joint's step: the worst of both do not meet.
const LOOP: u32 = 5600;
/// Part of the period that an observer may take: the rest is the motor controller's whose guest it is.
const GUEST: f64 = 0.75;
/// Rates that are usual for a control period [Hz].
const USUAL: [u32; 5] = [10_000, 8000, 5000, 4000, 2000];

/// Instructions of the worst tick of a role that controls, none for the plant, which is fitted to its period by its own budget.
pub fn worst(parameters: &JointParameters, board: &Board, role: Role, rate: u32) -> Option<f64> {
    match role {
        Role::Plant => None,
        Role::Observer => Some(OBSERVER.into()),
        Role::Loop => {
            let step_size = StepSize::new(parameters);
            let substeps = step_size.substeps(rate, Effort::Within(board.processor())).ok()?;
            Some(f64::from(LOOP) + step_size.cost().all_crossing(substeps))
        }
    }
}

/// Part of a period that it takes, against the part that it may take: a whole loop has the chip alone.
fn load(parameters: &JointParameters, board: &Board, role: Role, rate: u32) -> Option<(f64, f64)> {
    let share = if role == Role::Observer { GUEST } else { 1.0 };
    Some((board.processor().part(worst(parameters, board, role, rate)?, rate), share))
}

fn fits(parameters: &JointParameters, board: &Board, role: Role, rate: u32) -> bool {
    board.core_rate().is_multiple_of(rate)
        && load(parameters, board, role, rate).is_none_or(|(part, share)| part <= share)
}

/// The highest usual rate at which a role that controls fits into its period; the usual one where none does [Hz].
pub fn usual_rate(parameters: &JointParameters, board: &Board, role: Role) -> u32 {
    USUAL.into_iter().find(|rate| fits(parameters, board, role, *rate)).unwrap_or(USUAL[0])
}

/// Refuses an image whose worst tick outlasts what it may take of its period.
pub(super) fn refuse(joint_file: &Path, board: &Board, role: Role, rate: u32) -> Outcome<()> {
    let parameters = named::load(joint_file)?.file.parameters;
    let Some((part, share)) = load(&parameters, board, role, rate).filter(|(part, share)| part > share) else {
        return Ok(());
    };
    let (name, chip) = (board.name(), board.chip().name());
    let message = format!(
        "{name} has no time for it: the worst tick takes {:.0} % of a period at {rate} Hz on {chip}, and may take {:.0} %",
        100.0 * part,
        100.0 * share
    );
    let usual = usual_rate(&parameters, board, role);
    Err(Failure::new(message).with_help(match fits(&parameters, board, role, usual) {
        true => format!("take a lower rate, such as `--rate {usual}`, or a faster chip"),
        false => "take a faster chip".to_owned(),
    }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_loop_fits_where_its_ticks_do_and_is_offered_the_next_rate_where_not() {
        let q1 = named::load(Path::new("q1")).unwrap().file.parameters;
        let rates = ["olimex-h405", "nucleo-g474re", "nucleo-h743zi"].map(|name| {
            let board = Board::load(name).unwrap();
            [Role::Observer, Role::Loop].map(|role| usual_rate(&q1, &board, role))
        });
        assert_eq!(rates, [[10_000, 10_000], [10_000, 8000], [10_000, 10_000]]);
        let nucleo = Board::load("nucleo-g474re").unwrap();
        let failure = refuse(Path::new("q1"), &nucleo, Role::Loop, 10_000).unwrap_err();
        assert!(failure.message().contains("nucleo-g474re has no time"), "{failure}");
        assert!(failure.help().unwrap().contains("--rate 8000"), "{failure}");
        assert!(refuse(Path::new("q1"), &nucleo, Role::Loop, 8000).is_ok());
    }
}
