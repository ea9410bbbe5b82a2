//! The result of `joint budget` as data: figures in SI with their units in their names, as JSON in the schema
//! `joint-budget/1`. They are computed by `model_core::gears::design`.

use model_core::gears::certificate::{Certificate, ErrorQuantiles};
use model_core::gears::design::{DesignError, Effort, Processor, StepSize, Substeps, certificate};
use parameters::JointParameters;
use serde::Serialize;

use super::verdict::highest;
use board::target::board::Board;

/// Says which fields there are; rises when one changes its meaning or goes.
const SCHEMA: &str = "joint-budget/1";

/// A certificate on a board.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[allow(non_snake_case, reason = "Hz is written Hz")]
pub struct BudgetSummary {
    /// `joint-budget/1`.
    pub schema: &'static str,
    /// The joint.
    pub joint: String,
    /// The board.
    pub board: String,
    /// Its core clock.
    pub clock_Hz: u32,
    /// Cycles an instruction, waiting for flash included; reckoned, not measured.
    pub cycles_per_instruction: f64,
    /// Part of the period that a step may take at worst.
    pub share: f64,
    /// Steps a second.
    pub rate_Hz: u32,
    /// How a tick goes through contacts that change: `substeps` or `leaps`.
    pub method: &'static str,
    /// Into how many parts it is divided there.
    pub parts: u32,
    /// Errors while contact holds.
    pub error_holding: PredictedError,
    /// Errors while meshes part and hit.
    pub error_losing: PredictedError,
    /// Work of a tick.
    pub holding: TickWork,
    /// In parts, none of which sees a crossing.
    pub losing: TickWork,
    /// Every mesh crosses in two sub-steps, or touches in every Verlet sub-step.
    pub all_crossing: TickWork,
    /// Every mesh crosses in every part.
    pub bound: TickWork,
    /// Flash of the tables.
    pub table_bytes: u32,
    /// RAM of the model.
    pub model_bytes: u32,
    /// Phase of the fastest mode in a part.
    pub fastest_mode_phase_rad: f64,
    /// From which phase on parts are unstable.
    pub largest_phase_rad: f64,
    /// A mesh that leaves and returns in less may go unseen.
    pub unseen_for_s: f64,
    /// So far it goes in that time at most, over the deflection by its load; null if there is no limit.
    pub unseen_departure: Option<f64>,
    /// Below it no step is stable.
    pub lowest_rate_Hz: u32,
    /// The highest that the board's clock can be divided to and has time for.
    pub highest_rate_Hz: u32,
}

/// RMS error over the motion's standard deviation.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct PredictedError {
    /// Half of all motions stay below.
    pub typical: f64,
    /// Nine in ten do.
    pub nine_in_ten: f64,
}

/// Cost of a tick.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct TickWork {
    /// Instructions.
    pub instructions: u32,
    /// Time.
    pub time_s: f64,
    /// Part of the period.
    pub part: f64,
}

/// The figures of a joint on a board at a rate [Hz].
pub fn summary(parameters: &JointParameters, board: &Board, rate: u32) -> Result<BudgetSummary, DesignError> {
    let processor = board.processor();
    let certificate = certificate(parameters, rate, Effort::Within(processor), &processor)?;
    let highest = highest(&StepSize::new(parameters), &processor);
    Ok(of(parameters, board, &processor, &certificate, highest))
}

fn of(
    parameters: &JointParameters,
    board: &Board,
    processor: &Processor,
    certificate: &Certificate,
    highest: u32,
) -> BudgetSummary {
    let rate = certificate.tick_rate;
    let work = |instructions: u32| TickWork {
        instructions,
        time_s: f64::from(instructions) / processor.instructions_per_second(),
        part: processor.part(instructions.into(), rate),
    };
    let error = |promise: ErrorQuantiles| PredictedError { typical: promise.typical, nine_in_ten: promise.nine_in_ten };
    let instructions = &certificate.instructions;
    BudgetSummary {
        schema: SCHEMA,
        joint: parameters.name.to_string(),
        board: board.name().to_owned(),
        clock_Hz: processor.clock,
        cycles_per_instruction: processor.cycles_per_instruction + processor.flash_wait,
        share: processor.share,
        rate_Hz: rate,
        method: match certificate.substeps {
            Substeps::Corrected(_) => "substeps",
            Substeps::Verlet(_) => "leaps",
        },
        parts: certificate.substeps.count(),
        error_holding: error(certificate.contact_holds),
        error_losing: error(certificate.contact_changes),
        holding: work(instructions.contact_holds),
        losing: work(instructions.contact_changes),
        all_crossing: work(instructions.all_crossing),
        bound: work(instructions.bound),
        table_bytes: certificate.table_bytes,
        model_bytes: certificate.model_bytes,
        fastest_mode_phase_rad: certificate.phase,
        largest_phase_rad: certificate.largest_phase,
        unseen_for_s: certificate.unseen.duration,
        unseen_departure: certificate.unseen.departure,
        lowest_rate_Hz: certificate.lowest_rate,
        highest_rate_Hz: highest,
    }
}
