//! Step size control and dense output are left out; event search does not need dense output.

use super::system::{Entries, MAX_ENTRIES, SwitchedSystem};

const STAGES: usize = 12;

/// c: time of each stage within the step.
const NODES: [f64; STAGES] = [
    0.0,
    0.05260015195876773,
    0.0789002279381516,
    0.1183503419072274,
    0.2816496580927726,
    0.3333333333333333,
    0.25,
    0.3076923076923077,
    0.6512820512820513,
    0.6,
    0.8571428571428571,
    1.0,
];

/// b: weights of the stages in the step.
const WEIGHTS: [f64; STAGES] = [
    0.054293734116568765,
    0.0,
    0.0,
    0.0,
    0.0,
    4.450312892752409,
    1.8915178993145003,
    -5.801203960010585,
    0.3111643669578199,
    -0.1521609496625161,
    0.20136540080403034,
    0.04471061572777259,
];

/// Weights of the stages in the error estimate of order 5.
const ERROR_WEIGHTS: [f64; STAGES] = [
    0.01312004499419488,
    0.0,
    0.0,
    0.0,
    0.0,
    -1.2251564463762044,
    -0.4957589496572502,
    1.6643771824549864,
    -0.35032884874997366,
    0.3341791187130175,
    0.08192320648511571,
    -0.022355307863886294,
];

/// Weights of stages 1, 9 and 12 in the embedded result of order 3.
const THIRD_ORDER_WEIGHTS: [f64; 3] = [0.2440944881889764, 0.7338466882816118, 0.022058823529411766];

/// a: row s builds the state of stage s from earlier stages; zeros are skipped.
const COUPLINGS: [&[f64]; STAGES] = [
    &[],
    &[0.05260015195876773],
    &[0.0197250569845379, 0.0591751709536137],
    &[0.02958758547680685, 0.0, 0.08876275643042054],
    &[0.2413651341592667, 0.0, -0.8845494793282861, 0.924834003261792],
    &[0.037037037037037035, 0.0, 0.0, 0.17082860872947386, 0.12546768756682242],
    &[0.037109375, 0.0, 0.0, 0.17025221101954405, 0.06021653898045596, -0.017578125],
    &[
        0.03709200011850479,
        0.0,
        0.0,
        0.17038392571223998,
        0.10726203044637328,
        -0.015319437748624402,
        0.008273789163814023,
    ],
    &[
        0.6241109587160757,
        0.0,
        0.0,
        -3.3608926294469414,
        -0.868219346841726,
        27.59209969944671,
        20.154067550477894,
        -43.48988418106996,
    ],
    &[
        0.47766253643826434,
        0.0,
        0.0,
        -2.4881146199716677,
        -0.590290826836843,
        21.230051448181193,
        15.279233632882423,
        -33.28821096898486,
        -0.020331201708508627,
    ],
    &[
        -0.9371424300859873,
        0.0,
        0.0,
        5.186372428844064,
        1.0914373489967295,
        -8.149787010746927,
        -18.52006565999696,
        22.739487099350505,
        2.4936055526796523,
        -3.0467644718982196,
    ],
    &[
        2.273310147516538,
        0.0,
        0.0,
        -10.53449546673725,
        -2.0008720582248625,
        -17.9589318631188,
        27.94888452941996,
        -2.8589982771350235,
        -8.87285693353063,
        12.360567175794303,
        0.6433927460157636,
    ],
];

/// Result of one step.
#[derive(Debug, Clone, Copy)]
pub(super) struct Trial {
    /// Length of the step [s].
    pub step: f64,
    /// State at the end of the step.
    pub state: Entries,
    /// Rates at the end of the step.
    pub rates: Entries,
    fifth: Entries,
    third: Entries,
}

/// Takes one step of length `step`; `rates` belong to `state`.
pub(super) fn trial<S: SwitchedSystem>(system: &S, time: f64, state: &Entries, rates: &Entries, step: f64) -> Trial {
    let dimension = system.dimension().min(MAX_ENTRIES);
    let mut stages = [[0.0; MAX_ENTRIES]; STAGES];
    stages[0] = *rates;
    for stage in 1..STAGES {
        let mut middle = *state;
        for (coupling, slope) in COUPLINGS[stage].iter().zip(&stages) {
            add_scaled(&mut middle, step * coupling, slope, dimension);
        }
        system.derivative(time + NODES[stage] * step, &middle, &mut stages[stage]);
    }
    let mut mean = [0.0; MAX_ENTRIES];
    let mut fifth = [0.0; MAX_ENTRIES];
    for ((weight, error_weight), slope) in WEIGHTS.iter().zip(&ERROR_WEIGHTS).zip(&stages) {
        add_scaled(&mut mean, *weight, slope, dimension);
        add_scaled(&mut fifth, *error_weight, slope, dimension);
    }
    let mut third = mean;
    for (weight, stage) in THIRD_ORDER_WEIGHTS.iter().zip([0, 8, 11]) {
        add_scaled(&mut third, -weight, &stages[stage], dimension);
    }
    let mut end = *state;
    add_scaled(&mut end, step, &mean, dimension);
    let mut end_rates = [0.0; MAX_ENTRIES];
    system.derivative(time + step, &end, &mut end_rates);
    Trial { step, state: end, rates: end_rates, fifth, third }
}

fn add_scaled(sum: &mut Entries, factor: f64, terms: &Entries, dimension: usize) {
    if factor != 0.0 {
        for (entry, term) in sum[..dimension].iter_mut().zip(terms) {
            *entry += factor * term;
        }
    }
}

impl Trial {
    /// Error relative to the tolerance, joining both estimates as DOP853 does: root mean square over the entries.
    pub fn error<S: SwitchedSystem>(&self, system: &S, step: f64) -> f64 {
        let (mut fifth, mut third) = (0.0, 0.0);
        let dimension = system.dimension();
        for entry in 0..dimension {
            let tolerance = system.tolerance(entry);
            fifth += (self.fifth[entry] / tolerance).powi(2);
            third += (self.third[entry] / tolerance).powi(2);
        }
        let joined = fifth + 0.01 * third;
        let divisor = if joined > 0.0 { (joined * dimension as f64).sqrt() } else { 1.0 };
        step * fifth / divisor
    }
}
