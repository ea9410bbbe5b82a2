//! One sample on its way from the line, or from a simulation, into the columns of `samples`. Raw counts of turns and of
//! the timer become SI here.

use link::messages::Sample;

use report::contacts::Contact;

/// One sample on its way into [`Samples`].
#[derive(Debug, Clone, PartialEq)]
pub struct MotionSample {
    /// Steps done since the reset.
    pub tick: u32,
    /// Rigid-body carrier angle [rad].
    pub carrier_angle: f64,
    /// Motor angle less ratio times rigid carrier angle [rad].
    pub motor_offset: f64,
    /// Link angle less rigid carrier angle [rad].
    pub link_offset: f64,
    /// Rate of the rigid-body carrier angle [rad/s].
    pub carrier_speed: f32,
    /// Gap coordinate [m].
    pub gap: f32,
    /// Wind-up along the line of action [m].
    pub wind_up: f32,
    /// Deflections [m], sun-planet first.
    pub deflections: Vec<f32>,
    /// Contact states in the same order.
    pub contacts: Vec<Contact>,
    /// Running digest over the whole state, where there is one.
    pub state_digest: Option<u64>,
    /// Computation time [s], on a board.
    pub computation: Option<f64>,
}

impl MotionSample {
    /// A board's sample in SI; `timer_rate` is the board's own [Hz].
    pub fn from_board(sample: &Sample, timer_rate: u32) -> Self {
        let turns = f64::from(sample.carrier_turns) + f64::from(sample.carrier_fraction) / 4_294_967_296.0;
        Self {
            tick: sample.tick,
            carrier_angle: turns * core::f64::consts::TAU,
            motor_offset: f64::from(sample.motor_offset),
            link_offset: f64::from(sample.link_offset),
            carrier_speed: sample.carrier_speed,
            gap: sample.gap,
            wind_up: sample.wind_up,
            deflections: sample.deflections.to_vec(),
            contacts: (0..sample.deflections.len()).map(|mesh| Contact::from_bits(sample.contacts, mesh)).collect(),
            state_digest: Some(sample.state_digest),
            computation: Some(f64::from(sample.computation) / f64::from(timer_rate)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::record::Samples;

    fn board_sample() -> Sample {
        Sample {
            tick: 40,
            state_digest: 0xab,
            carrier_turns: -2,
            carrier_fraction: 1 << 30,
            carrier_speed: 1.5,
            motor_offset: 6e-3,
            link_offset: -1e-3,
            gap: 8e-5,
            wind_up: 2e-6,
            deflections: [1e-5, 2e-5, 3e-5, 4e-5].into_iter().collect(),
            contacts: 0b10_01_00_01,
            computation: 1680,
        }
    }

    #[test]
    fn a_sample_of_the_line_comes_out_in_si() {
        let mut samples = Samples::new(4);
        samples.push(&MotionSample::from_board(&board_sample(), 168_000_000), 20_000, 6.0);
        let carrier = -1.75 * core::f64::consts::TAU;
        assert_eq!(samples.time_s, [2e-3]);
        assert!((samples.motor_angle_rad[0] - (6.0 * carrier + 6e-3)).abs() < 1e-9);
        assert!((samples.link_angle_rad[0] - (carrier - 1e-3)).abs() < 1e-9);
        assert!((samples.twist_rad[0] - 2e-3).abs() < 1e-9);
        assert_eq!(samples.state_digest, ["00000000000000ab"]);
        assert_eq!(samples.computation_s, [1e-5]);
        assert_eq!(samples.deflection_m[3], [4e-5]);
        let states: Vec<Contact> = samples.contact.iter().map(|column| column[0]).collect();
        assert_eq!(states, [Contact::DriveSide, Contact::Separated, Contact::DriveSide, Contact::BackSide]);
    }

    #[test]
    fn columns_stay_of_one_length_whatever_a_board_sends() {
        let mut samples = Samples::new(6);
        samples.push(&MotionSample::from_board(&board_sample(), 168_000_000), 20_000, 6.0);
        assert!(samples.deflection_m.iter().all(|column| column.len() == 1));
        assert!(samples.deflection_m[5][0].is_nan());
    }
}
