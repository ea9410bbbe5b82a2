//! The gear ratio on counts, in whole numbers. Angles come later.

/// Motor less ratio times output, as motor * `motor` - output * `output` of the two counts.
pub(super) struct Weights {
    /// Units in a motor count.
    pub motor: i64,
    /// Units in an output count.
    pub output: i64,
    /// A whole turn of the motor adds a multiple of this, and so does one of the output.
    pub modulus: i64,
}

impl Weights {
    /// For counts in a turn of each, and the ratio `over / under` of motor to output turns.
    ///
    /// With n counts of C each, motor less ratio times output is n_m / C_m - (over / under) n_o / C_o turns; times
    /// C_m C_o under and over what all weights share, it is whole.
    pub fn new(motor_turn: u32, output_turn: u32, over: u32, under: u32) -> Self {
        let shared = divisor(over.into(), under.into());
        let (over, under) = (u64::from(over) / shared, u64::from(under) / shared);
        let motor = u64::from(output_turn) * under;
        let output = u64::from(motor_turn) * over;
        let shared = divisor(motor, output);
        let (motor, output) = (motor / shared, output / shared);
        let turn = motor * u64::from(motor_turn);
        Self {
            motor: motor as i64,
            output: output as i64,
            modulus: divisor(turn, output * u64::from(output_turn)) as i64,
        }
    }
}

fn divisor(a: u64, b: u64) -> u64 {
    if b == 0 { a } else { divisor(b, a % b) }
}

#[cfg(test)]
mod tests {
    use super::Weights;

    #[test]
    fn whole_turns_of_a_rigid_joint_leave_no_difference() {
        for (motor_turn, output_turn, over, under) in [(1 << 14, 1 << 17, 90, 15), (20_000, 1 << 18, 126, 27)] {
            let weights = Weights::new(motor_turn, output_turn, over, under);
            // `over` motor turns are `under` output turns.
            let motor = i64::from(over) * i64::from(motor_turn);
            let output = i64::from(under) * i64::from(output_turn);
            assert_eq!(motor * weights.motor - output * weights.output, 0);
            assert_eq!(i64::from(motor_turn) * weights.motor % weights.modulus, 0);
            assert_eq!(i64::from(output_turn) * weights.output % weights.modulus, 0);
        }
    }
}
