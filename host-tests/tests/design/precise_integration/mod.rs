//! Precise integration (exp(A h) - I and its input integrals) against 50 digits, against nalgebra's exponential, and against plain
//! squaring. Fixtures and their generator are in `data/exponential`.

mod accuracy;
mod apart;
mod fixtures;
mod plan;
