//! The core against the independent reference, against closed forms and the paper's equations, and its own guarantees.

mod comparison;
mod convergence;
mod equations;
mod invariants;
mod oracles;
mod promises;
mod range;
mod scenarios;
mod table_sizes;
mod verlet;
