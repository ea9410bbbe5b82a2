//! Run with ticks whose length follows from the counted instructions, while the host sends: the tick must end within
//! its period, and the line must not lose a byte.

use board::device::board::Chip;
use link::messages::{Command, FromBoard, RunMode, RunSettings, Schedule, Statistics, ToBoard};
use link::virtual_joint::{KNOTS_PER_SCHEDULE, Knot, WireTrajectory};

use super::clean;
use crate::boards::{Subject, usual_surroundings};
use crate::talk::Talk;
use crate::wires::{MICROSECOND, SECOND, Time};

/// Number of frames that the host sends.
const FRAMES: u32 = 40;
/// Time between two frames.
const PAUSE: Time = 20_000 * MICROSECOND;
const TIMEOUT: u32 = 1_000_000;

/// Cost of an instruction as estimated on the project's page about its budget [thousandths of a cycle].
pub fn cost(chip: Chip) -> u64 {
    match chip {
        Chip::Stm32f405 => 1400,
        Chip::Stm32g474 | Chip::Stm32g431 => 1900,
        Chip::Stm32h743 => 1000,
    }
}

/// Run of the role `plant`.
pub fn plant(subject: &Subject) -> Result<String, String> {
    let commands = (0..24).map(|tick| Command { tick, drive_torque: 0.3, load_torque: 2.0 }).collect();
    loaded(subject, &ToBoard::Schedule(Schedule { sequence: 0, horizon: TIMEOUT, commands }))
}

/// Run of the role `loop`.
pub fn whole_loop(subject: &Subject) -> Result<String, String> {
    let at_rest = WireTrajectory::Position((0, Default::default()), None);
    let knot = |tick| Knot { tick, load_torque: 1.0, trajectory: at_rest };
    let commands = (0..KNOTS_PER_SCHEDULE as u32).map(knot).collect();
    loaded(subject, &ToBoard::Trajectory(Schedule { sequence: 0, horizon: TIMEOUT, commands }))
}

/// Runs while the host repeats the schedule, which has no further effect.
fn loaded(subject: &Subject, schedule: &ToBoard) -> Result<String, String> {
    let board = subject.start_at(usual_surroundings(&subject.board), cost(subject.board.chip()))?;
    let mut talk = Talk::new(board);
    talk.call(2 * SECOND).ok_or("no answer")?;
    let settings =
        RunSettings { mode: RunMode::Realtime, decimation: 1000, command_timeout: TIMEOUT, from_memory: false };
    talk.start_run(settings)?;
    let (mut answered, before) = (0, talk.board.borrow().machine().wires.line.overruns);
    for _ in 0..FRAMES {
        talk.say(schedule);
        answered += talk.hear(PAUSE).iter().filter(|message| matches!(message, FromBoard::Accepted(_))).count();
    }
    let lost = talk.board.borrow().machine().wires.line.overruns - before;
    let statistics = (0..20).find_map(|_| {
        talk.ask(&ToBoard::Statistics { reset: false }, SECOND / 10, |message| match message {
            FromBoard::Statistics(statistics) => Some(statistics),
            _ => None,
        })
    });
    clean(&talk.board.borrow())?;
    let Some(Statistics { ticks, computation, period, overruns, .. }) = statistics else {
        return Err(format!("{answered} of {FRAMES} frames answered, {lost} bytes lost, no statistics"));
    };
    let share = 100 * computation.max / period.max(1);
    let said = format!(
        "{answered} of {FRAMES} frames answered, {lost} bytes lost, {overruns} of {ticks} ticks too long, the longest \
         {share} % of its period"
    );
    if lost > 0 || overruns > 0 || ticks == 0 { Err(said) } else { Ok(said) }
}
