//! Precise integration (exp(A h) - I and its input integrals) against a computation with 50 digits, against nalgebra's
//! exponential, and against what plain squaring would leave. Fixtures and their generator are in `data/exponential`.

mod accuracy;
mod apart;
mod fixtures;
mod plan;
