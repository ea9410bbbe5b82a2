//! Verdicts of `joint check` and `joint budget` on a joint's step on a board at a rate, in equal words and figures:
//! sub-steps, time and accuracy, each verdict with a rate that would reach it.

use board::device::board::Board;
use board::device::image::role_name;
use board::device::tick_time::{Obstacle, RateCheck, TickTime};
use link::messages::Role;
use model_core::gears::design::DesignError;
use parameters::JointParameters;
use report::document::Sheet;
use report::failure::{Failure, Outcome};
use serde::Serialize;

use crate::accuracy::{self, MotionErrors, StandardErrors, Unmeasured};
use crate::sim::errors::Errors;

/// Default largest acceptable error.
pub const DEFAULT_ACCURACY: f64 = 1e-2;
/// Factors on the given rate that are tried for a smaller error, in this order, and the highest rate tried [Hz].
const RATE_FACTORS: [f64; 5] = [1.25, 1.6, 2.0, 3.2, 0.5];
const MAX_TRIED_RATE: u32 = 100_000;
/// Length of a first try at each rate [s]; if it exceeds twice the acceptable error, the whole motion is not tried.
const FIRST_TRY_DURATION: f64 = 1.5;

/// Sub-steps, errors, and both verdicts.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[allow(non_snake_case, reason = "Hz is written Hz")]
pub struct Verdicts {
    /// Board that steps the joint.
    pub board: String,
    /// Role of the board: `plant`, `observer` or `loop`.
    pub role: &'static str,
    /// Step rate.
    pub rate_Hz: u32,
    /// Method of the sub-steps of a tick in which contacts change: `corrected` or `leapfrog`.
    pub method: &'static str,
    /// Number of sub-steps.
    pub substeps: u32,
    /// Measured errors.
    pub errors: StandardErrors,
    /// Verdict on the board's time.
    pub time: TimeVerdict,
    /// Verdict on the error.
    pub accuracy: AccuracyVerdict,
    /// Ranges of rates that the board's clock can be divided to, that are stable, and that the board has time for.
    pub rates_that_fit_Hz: Vec<[u32; 2]>,
}

/// Verdict on the board's time for the worst tick.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[allow(non_snake_case, reason = "Hz is written Hz")]
pub struct TimeVerdict {
    /// True if the worst tick fits, so that images are built.
    pub fits: bool,
    /// True if the board's clock can be divided to the rate.
    pub rate_can_be_made: bool,
    /// Instructions of the worst tick of the role.
    pub worst_instructions: u32,
    /// Share of the period that the worst tick takes.
    pub part: f64,
    /// Share of the period that the worst tick may take.
    pub share: f64,
    /// Rate itself if it fits, else the nearest that does.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rate_that_fits_Hz: Option<u32>,
}

/// Verdict on the error.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[allow(non_snake_case, reason = "Hz is written Hz")]
pub struct AccuracyVerdict {
    /// Largest acceptable error.
    pub wanted: f64,
    /// Greatest of the typical errors of deflections, gap and link on the reversals; absent if unknown.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub error: Option<f64>,
    /// True if the error is acceptable.
    pub reached: bool,
    /// Rate itself if it reaches the accuracy, else the first rate that was found to.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rate_that_reaches_it_Hz: Option<u32>,
    /// True if the board has time for that rate.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub fits_there: Option<bool>,
}

/// Measures a joint's step on a board; `wanted` is the largest acceptable error.
pub fn verdicts(joint: &JointParameters, board: &Board, role: Role, rate: u32, wanted: f64) -> Outcome<Verdicts> {
    let on_board = RateCheck::new(joint, board, role);
    if let Some(Obstacle::Unstable(_)) = on_board.obstacle(rate) {
        on_board.check(rate)?;
    }
    let failed = |error: DesignError| Failure::new(format!("no fixed step for {}: {error}", joint.name));
    let substeps = on_board.substeps(rate).map_err(failed)?;
    let errors = accuracy::measure(joint, &board.processor(), rate)?;
    let obstacle = on_board.obstacle(rate);
    let TickTime { instructions, part, share } =
        on_board.tick_time(rate).ok_or_else(|| Failure::new(format!("no fixed step for {}", joint.name)))?;
    let fits = obstacle.is_none();
    Ok(Verdicts {
        board: board.name().to_owned(),
        role: role_name(role),
        rate_Hz: rate,
        method: substeps.method(),
        substeps: substeps.count(),
        time: TimeVerdict {
            fits,
            rate_can_be_made: !matches!(obstacle, Some(Obstacle::NoMultiple(_))),
            worst_instructions: instructions.ceil() as u32,
            part,
            share,
            rate_that_fits_Hz: if fits { Some(rate) } else { on_board.nearest_accepted(rate) },
        },
        accuracy: accuracy_verdict(joint, board, &on_board, rate, wanted, errors.reversals.typical)?,
        errors,
        rates_that_fit_Hz: on_board.rates_that_fit(),
    })
}

fn accuracy_verdict(
    joint: &JointParameters,
    board: &Board,
    on_board: &RateCheck<'_>,
    rate: u32,
    wanted: f64,
    typical: Option<Errors>,
) -> Outcome<AccuracyVerdict> {
    let within = |errors: Option<Errors>, wanted: f64| errors.is_some_and(|errors| errors.greatest() <= wanted);
    let typical_up_to = |rate: u32, longest: f64| accuracy::typical(joint, &board.processor(), rate, longest);
    let reached = within(typical, wanted);
    let mut found = reached.then_some(rate);
    let tried = RATE_FACTORS.iter().map(|factor| on_board.nearest_divisor_rate(factor * f64::from(rate)));
    for candidate in tried.filter(|candidate| (on_board.lowest_rate()..=MAX_TRIED_RATE).contains(candidate)) {
        if found.is_some() {
            break;
        }
        let reached = within(typical_up_to(candidate, FIRST_TRY_DURATION)?, 2.0 * wanted)
            && within(typical_up_to(candidate, f64::INFINITY)?, wanted);
        found = reached.then_some(candidate);
    }
    Ok(AccuracyVerdict {
        wanted,
        error: typical.map(|errors| errors.greatest()),
        reached,
        rate_that_reaches_it_Hz: found,
        fits_there: found.map(|rate| on_board.obstacle(rate).is_none()),
    })
}

impl Verdicts {
    /// Sub-steps as text, equal on every page.
    pub fn substeps_in_words(&self) -> String {
        format!("{} {} sub-steps", self.substeps, self.method)
    }

    /// Adds errors and verdicts as rows to a sheet.
    pub fn rows(&self, page: &mut Sheet) {
        page.heading("Error, measured: RMS over the motion's own standard deviation (deflections, gap, link)");
        for (name, errors) in [("reversals", &self.errors.reversals), ("steady, rated torque", &self.errors.steady)] {
            page.row(name, in_words(errors));
        }
        page.heading(&format!("Verdicts on {} in the role `{}` at {} Hz", self.board, self.role, self.rate_Hz));
        page.row("time", self.time_in_words());
        page.row("accuracy", self.accuracy_in_words());
        let stretches: Vec<String> = self
            .rates_that_fit_Hz
            .iter()
            .map(|[low, high]| if low == high { low.to_string() } else { format!("{low} to {high}") })
            .collect();
        page.row(
            "rates that fit in time",
            if stretches.is_empty() { "none".into() } else { stretches.join(", ") + " Hz" },
        );
    }

    fn time_in_words(&self) -> String {
        let TimeVerdict { fits, rate_can_be_made, worst_instructions, part, share, rate_that_fits_Hz } = self.time;
        let taken = format!(
            "the worst tick takes {worst_instructions} instructions, {:.0} % of the period; {:.0} % are the limit",
            100.0 * part,
            100.0 * share
        );
        let instead = match rate_that_fits_Hz {
            Some(rate) => format!("{rate} Hz would fit"),
            None => "no rate would".to_owned(),
        };
        match (fits, rate_can_be_made) {
            (true, _) => format!("fits: {taken}"),
            (false, true) => format!("DOES NOT FIT: {taken}; {instead}"),
            (false, false) => format!("DOES NOT FIT: the clock cannot be divided to that rate; {instead}"),
        }
    }

    fn accuracy_in_words(&self) -> String {
        let AccuracyVerdict { wanted, error, reached, rate_that_reaches_it_Hz, fits_there } = self.accuracy;
        let error = error.map_or("error unknown".to_owned(), |error| format!("{error:.1e} on the reversals"));
        if reached {
            return format!("reached: {error}, {wanted:.0e} wanted");
        }
        let where_reached = match (rate_that_reaches_it_Hz, fits_there) {
            (Some(rate), Some(true)) => format!("{rate} Hz would reach it"),
            (Some(rate), _) => format!("{rate} Hz would reach it, too fast for this board"),
            (None, _) => format!("no rate up to {MAX_TRIED_RATE} Hz was found that would"),
        };
        format!("NOT REACHED: {error}, {wanted:.0e} wanted; {where_reached}")
    }
}

fn in_words(errors: &MotionErrors) -> String {
    let three = |errors: &Errors| format!("{:.1e}, {:.1e}, {:.1e}", errors.deflections, errors.gap, errors.link);
    let (Some(typical), Some(bound)) = (&errors.typical, &errors.bound) else {
        return errors.unmeasured.map_or("error unknown", Unmeasured::in_words).to_owned();
    };
    let until = if errors.predictable_until_s < errors.duration_s {
        format!("; can be predicted for {:.3} of {:.3} s", errors.predictable_until_s, errors.duration_s)
    } else {
        String::new()
    };
    format!("typical {}; bound {}{until}", three(typical), three(bound))
}
