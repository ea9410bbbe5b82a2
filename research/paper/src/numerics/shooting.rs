//! Newton's method on the Poincare map: finds the periodic motion that a slowly decaying motion approaches, where waiting would take tens
//! of thousands of periods. Its stability is found afterwards, by running it.

use super::integrator::{EventIntegrator, State};
use super::system::StudyError;

/// Iterations of Newton's method, which doubles the number of digits in each.
const ROUNDS: u32 = 12;

/// Distance of the ends of a closed cycle, over b_c.
const CLOSED: f64 = 1e-9;

/// Longest cycle considered: longer cycles seldom decay slowly, and each costs its length in periods per iteration.
const LONGEST_CYCLE: usize = 6;

/// State on a periodic motion near the present state of `motion`, if there is one.
pub fn periodic_state(motion: &EventIntegrator<'_>) -> Result<Option<State>, StudyError> {
    for periods in candidates(motion)? {
        if let Some(state) = newton(motion, periods)? {
            return Ok(Some(state));
        }
    }
    Ok(None)
}

/// Cycle lengths, the one with the nearest ends first; of equally good lengths the shortest.
fn candidates(motion: &EventIntegrator<'_>) -> Result<Vec<usize>, StudyError> {
    let mut follower = EventIntegrator::new(motion.system(), motion.state());
    let start = entries(motion, &motion.state());
    let mut distances = Vec::new();
    for periods in 1..=LONGEST_CYCLE {
        follower.period()?;
        let end = entries(&follower, &follower.state());
        let distance = start.iter().zip(&end).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        distances.push((periods, distance));
    }
    distances.sort_by(|a, b| a.1.total_cmp(&b.1));
    Ok(distances.into_iter().map(|(periods, _)| periods).collect())
}

fn newton(motion: &EventIntegrator<'_>, periods: usize) -> Result<Option<State>, StudyError> {
    let system = motion.system();
    let coordinates = system.coordinates();
    let size = 2 * coordinates;
    let mut state = motion.state();
    for _ in 0..ROUNDS {
        let mut follower = EventIntegrator::new(system, state);
        *follower.tangents() = (0..size).map(|index| with_entry(State::default(), coordinates, index, 1.0)).collect();
        for _ in 0..periods {
            match follower.period() {
                Ok(()) => {}
                // A diverging guess is not a failure of the study.
                Err(StudyError::NotFinite) => return Ok(None),
                Err(error) => return Err(error),
            }
        }
        let (start, end) = (entries(motion, &state), entries(motion, &follower.state()));
        let residual: Vec<f64> = end.iter().zip(&start).map(|(end, start)| end - start).collect();
        if residual.iter().all(|value| value.abs() < CLOSED) {
            return Ok(Some(state));
        }
        // (1 - D P) step = P(x) - x, column by column from the tangent vectors.
        let columns: Vec<Vec<f64>> = follower.tangents().iter().map(|tangent| entries(motion, tangent)).collect();
        let rows = (0..size)
            .map(|row| {
                let unity = |column: usize| if row == column { 1.0 } else { 0.0 };
                let mut row_values: Vec<f64> = (0..size).map(|column| unity(column) - columns[column][row]).collect();
                row_values.push(residual[row]);
                row_values
            })
            .collect();
        let Some(step) = solve(rows) else { return Ok(None) };
        for (index, value) in step.into_iter().enumerate() {
            state = with_entry(state, coordinates, index, start[index] + value);
        }
    }
    Ok(None)
}

/// Positions, then rates.
fn entries(motion: &EventIntegrator<'_>, state: &State) -> Vec<f64> {
    let coordinates = motion.system().coordinates();
    state.position[..coordinates].iter().chain(&state.rate[..coordinates]).copied().collect()
}

fn with_entry(mut state: State, coordinates: usize, index: usize, value: f64) -> State {
    match index.checked_sub(coordinates) {
        None => state.position[index] = value,
        Some(rate) => state.rate[rate] = value,
    }
    state
}

/// Solves by Gaussian elimination with pivots; each row ends with its right-hand side. `None` if the matrix is singular.
fn solve(mut rows: Vec<Vec<f64>>) -> Option<Vec<f64>> {
    let size = rows.len();
    for column in 0..size {
        let pivot = (column..size).max_by(|a, b| rows[*a][column].abs().total_cmp(&rows[*b][column].abs()))?;
        rows.swap(column, pivot);
        let leading = rows[column].clone();
        if leading[column].abs() < 1e-14 {
            return None;
        }
        for row in rows.iter_mut().skip(column + 1) {
            let factor = row[column] / leading[column];
            row.iter_mut().zip(&leading).for_each(|(value, above)| *value -= factor * above);
        }
    }
    let mut solution = vec![0.0; size];
    for row in (0..size).rev() {
        let known: f64 = (row + 1..size).map(|column| rows[row][column] * solution[column]).sum();
        solution[row] = (rows[row][size] - known) / rows[row][row];
    }
    solution.iter().all(|value| value.is_finite()).then_some(solution)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A system that needs pivots is solved, a singular one is not.
    #[test]
    fn solver_pivots_and_rejects_singular() {
        let solution = solve(vec![vec![0.0, 2.0, 4.0], vec![1.0, 1.0, 5.0]]).expect("regular");
        assert!((solution[0] - 3.0).abs() < 1e-14 && (solution[1] - 2.0).abs() < 1e-14, "{solution:?}");
        assert_eq!(solve(vec![vec![1.0, 2.0, 1.0], vec![2.0, 4.0, 1.0]]), None);
    }
}
