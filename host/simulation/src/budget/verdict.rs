//! Whether a board can step a joint at a rate: the rate can be made of its clock, is stable, and leaves time for a tick in
//! which every mesh crosses twice. Otherwise the nearest rate that can is found.

use model_core::gears::design::{Effort, Processor, StepSize};
use parameters::JointParameters;

use board::target::board::Board;
use report::failure::{Failure, Outcome};

/// No rate above is looked at [Hz].
const HIGHEST: u32 = 500_000;

/// Refuses a rate that cannot be met; names the nearest that can.
pub fn refuse(parameters: &JointParameters, board: &Board, rate: u32) -> Outcome<()> {
    let (step_size, processor) = (StepSize::new(parameters), board.processor());
    let Some(why) = obstacle(&step_size, &processor, rate) else { return Ok(()) };
    let message = format!("{} cannot be stepped at {rate} Hz on {}: {why}", parameters.name, board.name());
    Err(Failure::new(message).with_help(match nearest(&step_size, &processor, rate) {
        Some(nearest) => format!("the nearest rate that can be met is {nearest} Hz: `--rate {nearest}`"),
        None => "no rate can be met on this board: take a faster one, or fewer planets or harmonics".to_owned(),
    }))
}

/// What stands against a rate.
fn obstacle(step_size: &StepSize, processor: &Processor, rate: u32) -> Option<String> {
    let lowest = step_size.lowest_rate(Effort::Within(*processor));
    if rate < lowest {
        return Some(format!("below {lowest} Hz no step is stable"));
    }
    if !processor.clock.is_multiple_of(rate) {
        return Some(format!("its clock of {} Hz is no multiple of it", processor.clock));
    }
    let parts = step_size.substeps(rate, Effort::Within(*processor)).ok()?;
    let most = step_size.cost().all_crossing(parts);
    let part = processor.part(most, rate);
    (part > processor.share).then(|| {
        format!(
            "a tick in which every mesh crosses twice takes {most:.0} instructions, {:.0} % of the period; {:.0} % are the limit",
            100.0 * part,
            100.0 * processor.share
        )
    })
}

/// The highest rate that nothing stands against; zero if there is none.
pub(super) fn highest(step_size: &StepSize, processor: &Processor) -> u32 {
    rates(step_size, processor).find(|candidate| obstacle(step_size, processor, *candidate).is_none()).unwrap_or(0)
}

/// Rates that can be made of a processor's clock and are stable, the highest first.
fn rates(step_size: &StepSize, processor: &Processor) -> impl Iterator<Item = u32> {
    let clock = processor.clock;
    let divisors = (clock / HIGHEST).max(1)..=clock / step_size.lowest_rate(Effort::Within(*processor));
    divisors.filter(move |divisor| clock.is_multiple_of(*divisor)).map(move |divisor| clock / divisor)
}

/// The nearest rate that nothing stands against; of two as near, the higher.
pub(super) fn nearest(step_size: &StepSize, processor: &Processor, rate: u32) -> Option<u32> {
    rates(step_size, processor)
        .filter(|candidate| obstacle(step_size, processor, *candidate).is_none())
        .min_by_key(|candidate| (candidate.abs_diff(rate), u32::MAX - candidate))
}
