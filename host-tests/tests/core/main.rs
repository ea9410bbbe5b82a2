//! The core: against the independent reference, against the paper's equations written out, and by its own promises.

mod comparison;
mod equations;
mod promises;
mod range;
mod scenarios;
