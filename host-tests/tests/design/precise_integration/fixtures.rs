//! Reader of the files in `data/exponential`. Their numbers are nearest f64s, so reading is exact.

use nalgebra::DMatrix;

/// Matrix with inputs, and its flow to 50 digits at several steps.
pub struct Fixture {
    pub name: &'static str,
    pub matrix: DMatrix<f64>,
    pub inputs: DMatrix<f64>,
    pub steps: Vec<Expected>,
}

/// Flow over one step.
pub struct Expected {
    pub step: f64,
    /// exp(A h) - I.
    pub transition: DMatrix<f64>,
    /// Integrals of exp(A (h - s)) B (s / h)^k over s in [0, h], for k = 0, 1, 2.
    pub integrals: Vec<DMatrix<f64>>,
}

macro_rules! files {
    ($($name:literal)*) => {
        [$(($name, include_str!(concat!("../../../data/exponential/", $name, ".txt")))),*]
    };
}

/// Fixtures of the model's matrices: paper and Q1, each with three to five planets.
pub fn models() -> Vec<Fixture> {
    files!["paper_3" "paper_4" "paper_5" "q1_3" "q1_4" "q1_5"].map(|(name, text)| read(name, text)).into()
}

/// Stiff, defective, nearly defective and large matrices.
pub fn others() -> Vec<Fixture> {
    let files = files![
        "rotation" "stiff_oscillator" "stiff_symmetric" "stiff_triangle" "moler_van_loan" "ward" "defective"
        "defective_steep" "defective_hump" "hidden_hump" "nilpotent" "nearly_defective" "nearly_defective_pair" "nearly_critical" "hump" "growing"
        "skew" "stable"
    ];
    files.map(|(name, text)| read(name, text)).into()
}

fn read(name: &'static str, text: &str) -> Fixture {
    let mut lines = text.lines().filter(|line| !line.starts_with('#')).peekable();
    let mut steps: Vec<Expected> = Vec::new();
    let (mut matrix, mut inputs) = (DMatrix::zeros(0, 0), DMatrix::zeros(0, 0));
    while let Some(heading) = lines.next() {
        let mut rows: Vec<Vec<f64>> = Vec::new();
        while let Some(row) = lines.next_if(|line| line.starts_with(|first: char| first == '-' || first.is_numeric())) {
            rows.push(row.split(' ').map(|field| field.parse().expect("a number")).collect());
        }
        let block = DMatrix::from_fn(rows.len(), rows.first().map_or(0, Vec::len), |row, column| rows[row][column]);
        match heading.split_once(' ').unwrap_or((heading, "")) {
            ("matrix", _) => matrix = block,
            ("inputs", _) => inputs = block,
            ("step", step) => steps.push(Expected {
                step: step.parse().expect("a number"),
                transition: DMatrix::zeros(0, 0),
                integrals: Vec::new(),
            }),
            ("transition", _) => steps.last_mut().expect("a step first").transition = block,
            ("integral", _) => steps.last_mut().expect("a step first").integrals.push(block),
            _ => panic!("{name}: what is {heading:?}?"),
        }
    }
    assert!(!steps.is_empty() && steps.iter().all(|step| step.integrals.len() == 3), "{name} is cut short");
    Fixture { name, matrix, inputs, steps }
}
