//! Times libraries and fixed-step methods on the cases named as arguments and prints JSON on standard output, for `joint bench`.

use std::process::ExitCode;

use comparison::catalogue;
use comparison::curve::{PHASES, PhaseEnvelope};
use comparison::libraries::timing::{Time, times};

/// Tolerances from loose to tight.
const TOLERANCES: [f64; 9] = [1e-2, 3e-3, 1e-3, 3e-4, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8];
/// Step rates in units of a quarter of the case's sample rate, and sub-steps of each step.
const RATES: [(u32, u32); 16] = [
    (1, 2),
    (1, 3),
    (1, 4),
    (1, 5),
    (1, 6),
    (1, 8),
    (1, 12),
    (1, 16),
    (2, 1),
    (2, 2),
    (2, 3),
    (4, 16),
    (8, 1),
    (16, 1),
    (32, 1),
    (64, 1),
];

fn main() -> ExitCode {
    let wanted: Vec<String> = std::env::args().skip(1).collect();
    let mut all: Vec<Time> = Vec::new();
    for case in catalogue::cases().into_iter().filter(|case| wanted.contains(&case.key)) {
        let unit = case.sample_rate / 4;
        let planets = case.joint.geometry.planets;
        let rates = RATES.map(|(multiple, substeps)| (unit * multiple, substeps));
        let envelope = match PhaseEnvelope::new(case, PHASES) {
            Ok(envelope) => envelope,
            Err(error) => {
                eprintln!("error: the reference cannot follow: {error}");
                return ExitCode::from(2);
            }
        };
        let found = match planets {
            3 => times::<3, 8>(envelope.phases(), &TOLERANCES, &rates),
            4 => times::<4, 10>(envelope.phases(), &TOLERANCES, &rates),
            _ => times::<5, 12>(envelope.phases(), &TOLERANCES, &rates),
        };
        all.extend(found.unwrap_or_default());
    }
    match serde_json::to_string(&all) {
        Ok(text) => {
            println!("{text}");
            ExitCode::SUCCESS
        }
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::from(2)
        }
    }
}
