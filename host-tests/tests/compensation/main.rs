//! The compensation in the loop with the drive train, against the rivals, on few seeds; the long form is ignored unless
//! asked for. How good an observer is by itself, its own tests say.

mod bad_input;
mod holding;
mod impedance;
mod monte_carlo;
mod position;
mod stepping;

use reference::closed_loop::Figures;
use scenario::trial::{Contender, Trial};

/// Figures of one contender at a trial.
fn figures(trial: &Trial, contender: Contender) -> Figures {
    Figures::of(&trial.run(contender).expect("the trial runs"), trial.from)
}

const PREVIEW: Contender = Contender::Compensated { preview: true };
const NO_PREVIEW: Contender = Contender::Compensated { preview: false };
