//! Gear ratio on counts, in integers (O1).

/// Integer weights of motor less ratio times output: motor count * `motor` - output count * `output`.
pub(crate) struct CountWeights {
    /// Units per motor count.
    pub motor: i64,
    /// Units per output count.
    pub output: i64,
    /// Greatest common divisor of the units per motor turn and per output turn.
    pub modulus: i64,
}

impl CountWeights {
    /// Computes the weights from the counts per turn and the ratio `over / under` of motor to output turns.
    ///
    /// With counts n and counts per turn C, motor less ratio times output is n_m / C_m - (over / under) n_o / C_o
    /// turns. Multiplied by C_m C_o under, and divided by the common divisor, both weights are integers. Returns `None`
    /// if the units of a turn exceed `MOST_UNITS`.
    pub fn new(motor_turn: u32, output_turn: u32, over: u32, under: u32) -> Option<Self> {
        let shared = divisor(over.into(), under.into());
        let (over, under) = (u128::from(over) / shared, u128::from(under) / shared);
        let motor = u128::from(output_turn) * under;
        let output = u128::from(motor_turn) * over;
        let shared = divisor(motor, output);
        let (motor, output) = (motor / shared, output / shared);
        let turns = [motor * u128::from(motor_turn), output * u128::from(output_turn)];
        let fits = turns.iter().all(|turn| *turn <= MOST_UNITS);
        fits.then(|| Self { motor: motor as i64, output: output as i64, modulus: divisor(turns[0], turns[1]) as i64 })
    }
}

/// Largest number of units per turn: leaves room for the difference of two encoders in 64 bits with sign.
const MOST_UNITS: u128 = 1 << 60;

/// Greatest common divisor.
pub(crate) fn divisor(a: u128, b: u128) -> u128 {
    if b == 0 { a } else { divisor(b, a % b) }
}

#[cfg(test)]
mod tests {
    use super::CountWeights;

    #[test]
    fn whole_turns_leave_no_difference() {
        for (motor_turn, output_turn, over, under) in [
            (1 << 14, 1 << 17, 90, 15),
            (20_000, 1 << 18, 126, 27),
            (4000, 7200, 28, 3),
            (24, 1 << 24, 129_671_429, 100_000),
        ] {
            let weights = CountWeights::new(motor_turn, output_turn, over, under).expect("they fit");
            // `over` motor turns are `under` output turns.
            let motor = i128::from(over) * i128::from(motor_turn);
            let output = i128::from(under) * i128::from(output_turn);
            assert_eq!(motor * i128::from(weights.motor) - output * i128::from(weights.output), 0);
            assert_eq!(i64::from(motor_turn) * weights.motor % weights.modulus, 0);
            assert_eq!(i64::from(output_turn) * weights.output % weights.modulus, 0);
        }
    }

    #[test]
    fn turn_of_too_many_units_is_refused() {
        assert!(CountWeights::new(16_777_213, 16_777_183, 99_999_989, 100_003).is_none());
    }
}
