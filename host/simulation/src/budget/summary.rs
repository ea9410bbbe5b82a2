//! Result of `joint budget` as data: figures in SI with their units in their names, as JSON in the schema
//! `joint-budget/2`.

use board::device::board::Board;
use joint_file::JointFile;
use link::messages::Role;
use model_core::gears::design::{DesignError, Effort, Processor, certificate};
use report::failure::{Failure, Outcome};
use serde::Serialize;

use crate::bandwidth::Bandwidth;
use crate::verdicts::{Verdicts, verdicts};

/// Name and version of the schema; the version rises when a field changes its meaning or is removed.
const SCHEMA: &str = "joint-budget/2";

/// Budget of a joint on a board.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[allow(non_snake_case, reason = "Hz is written Hz")]
pub struct BudgetSummary {
    /// `joint-budget/2`.
    pub schema: &'static str,
    /// Name of the joint.
    pub joint: String,
    /// Core clock of the board.
    pub clock_Hz: u32,
    /// Cycles an instruction, with wait states of the flash; computed, not measured.
    pub cycles_per_instruction: f64,
    /// Sub-steps, errors, and both verdicts.
    #[serde(flatten)]
    pub verdicts: Verdicts,
    /// Work of the joint's step while contacts hold.
    pub contact_holds: TickWork,
    /// Work of a tick in sub-steps without a crossing.
    pub contact_changes: TickWork,
    /// Work if every mesh crosses in two sub-steps, or touches in every Verlet sub-step.
    pub all_crossing: TickWork,
    /// Work if every mesh crosses in every sub-step.
    pub bound: TickWork,
    /// Flash of the tables.
    pub table_bytes: u32,
    /// RAM of the model.
    pub model_bytes: u32,
    /// Phase of the fastest mode in a sub-step.
    pub fastest_mode_phase_rad: f64,
    /// Phase from which sub-steps are unstable.
    pub largest_phase_rad: f64,
    /// Shortest absence of a mesh from its flank that is always detected.
    pub unseen_for_s: f64,
    /// Largest undetected departure of a mesh, over the deflection by its load; null without a limit.
    pub unseen_departure: Option<f64>,
    /// Lowest rate with a stable step.
    pub lowest_rate_Hz: u32,
    /// Bandwidth of the control; absent if no compensation can be designed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bandwidth: Option<Bandwidth>,
}

/// Cost of a tick.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct TickWork {
    /// Instructions.
    pub instructions: u32,
    /// Time.
    pub time_s: f64,
    /// Share of the period.
    pub part: f64,
}

/// Budget of a joint on a board in a role at a rate [Hz]; `wanted` is the largest acceptable error.
pub fn summary(file: &JointFile, board: &Board, role: Role, rate: u32, wanted: f64) -> Outcome<BudgetSummary> {
    let parameters = &file.parameters;
    let verdicts = verdicts(parameters, board, role, rate, wanted)?;
    let processor = board.processor();
    let failed = |error: DesignError| Failure::new(format!("no fixed step for {}: {error}", parameters.name));
    let certificate = certificate(parameters, rate, Effort::Within(processor)).map_err(failed)?;
    let work = |instructions: u32| work(&processor, instructions, rate);
    let instructions = &certificate.instructions;
    Ok(BudgetSummary {
        schema: SCHEMA,
        joint: parameters.name.to_string(),
        clock_Hz: processor.clock,
        cycles_per_instruction: processor.cycles_per_instruction + processor.flash_wait,
        verdicts,
        contact_holds: work(instructions.contact_holds),
        contact_changes: work(instructions.contact_changes),
        all_crossing: work(instructions.all_crossing),
        bound: work(instructions.bound),
        table_bytes: certificate.table_bytes,
        model_bytes: certificate.model_bytes,
        fastest_mode_phase_rad: certificate.phase,
        largest_phase_rad: certificate.largest_phase,
        unseen_for_s: certificate.unseen.duration,
        unseen_departure: certificate.unseen.departure,
        lowest_rate_Hz: certificate.lowest_rate,
        bandwidth: Bandwidth::for_joint(&file.parameters, &file.surroundings),
    })
}

fn work(processor: &Processor, instructions: u32, rate: u32) -> TickWork {
    TickWork {
        instructions,
        time_s: f64::from(instructions) / processor.instructions_per_second(),
        part: processor.part(instructions.into(), rate),
    }
}
