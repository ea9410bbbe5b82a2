//! Runs of both roles on a board beside the host's twin, equal in every bit: exchanges in lockstep for observer and
//! compensation, a motion in knots for the whole loop.

use std::cell::RefCell;
use std::rc::Rc;
use std::time::{Duration, Instant};

use super::faults::{counts_per_turn, mounting_faults, quantised_faults};
use super::port::BoardPort;
use super::twin::{Twin, TwinResult};
use super::{BoardResult, Boards, RunJoints};
use crate::case::Case;
use crate::execution::{RunSpec, Watch, execute_with};
use crate::rig::RunError;
use crate::suite::Test;
use board::session::Session;
use report::failure::Failure;

/// Limit of a run on a board in lockstep, independent of the test's time on the clock.
const RUN_TIMEOUT: Duration = Duration::from_secs(4 * 3600);

impl Boards<'_> {
    pub(super) fn run_observer(
        &self,
        test: &Test,
        case: &Case,
        seed: u64,
        spec: RunSpec,
        pair: &RunJoints,
        watch: Watch<'_>,
    ) -> BoardResult {
        let (session, image) = self.session(pair)?;
        let session = Rc::new(RefCell::new(session));
        let watch = watch.extended_to(Instant::now() + RUN_TIMEOUT);
        let history = execute_with(&test.file, case, seed, spec, watch, &|designed| {
            Ok(Box::new(BoardPort::new(session.clone(), designed)))
        });
        let mut session = session.borrow_mut();
        let history = match history {
            Ok(history) => history,
            Err(error) => {
                session.abandon();
                return Err(as_run_error(error));
            }
        };
        session.finish(u32::MAX)?;
        let run = self.board_run(image, history.run.samples.len() as u32, session.recording.statistics.as_ref());
        Ok((history, run))
    }

    pub(super) fn run_loop(&self, test: &Test, case: &Case, seed: u64, pair: &RunJoints) -> BoardResult {
        let designed = case.design(&test.file)?;
        let surroundings = &case.truth.surroundings;
        let turns = counts_per_turn(surroundings);
        let mut faults = mounting_faults(&case.zeros, turns).to_vec();
        faults.extend(quantised_faults(
            &test.file.faults,
            f64::from(case.nominal_surroundings.control_rate),
            turns,
            seed,
        )?);
        let (truth, board) = (&pair.truth, self.request.board);
        let twin = Twin { file: &test.file, case, designed: &designed, truth, board, faults: &faults };
        let TwinResult { knots, history, digests } = twin.run()?;
        let (mut session, image) = self.session(pair)?;
        let follow = |session: &mut Session<'_>| {
            session.add_faults(&faults)?;
            session.stream_motion(&knots, digests.len() as u32)
        };
        let followed = match test.file.from_memory {
            true => {
                follow(&mut session).and_then(|_| session.restart_from_memory()).and_then(|()| follow(&mut session))
            }
            false => follow(&mut session),
        };
        let samples = match followed {
            Ok(samples) => samples,
            Err(failure) => {
                session.abandon();
                return Err(as_run_error(failure.into()));
            }
        };
        session.finish(u32::MAX)?;
        let agrees = |tick: u32, digest: u64| {
            tick.checked_sub(1).and_then(|index| digests.get(index as usize)).is_some_and(|own| *own == digest)
        };
        if let Some(first) = samples.iter().find(|sample| !agrees(sample.tick, sample.digest)) {
            let time = f64::from(first.tick) / f64::from(surroundings.control_rate);
            return Err(RunError::Broke(format!(
                "board and host differ at t = {time:.4} s, control period {}, or in the periods since the sample before: \
                 the digest over joint and answers",
                first.tick
            )));
        }
        let periods = samples.last().map_or(0, |sample| sample.tick);
        Ok((history, self.board_run(image, periods, session.recording.statistics.as_ref())))
    }
}

/// A failure of the board fails only its test; a failure of the request or the machine ends all tests.
fn as_run_error(error: RunError) -> RunError {
    match error {
        RunError::Refused(failure) if failure.exit_code() == Failure::check_failed("").exit_code() => {
            RunError::Broke(failure.message().to_owned())
        }
        other => other,
    }
}
