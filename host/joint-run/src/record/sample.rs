//! One sample from the line or a simulation, before it enters the columns of `samples`. Raw counts of turns and of the
//! timer are converted to SI here.

use link::messages::Sample;

use report::contacts::Contact;

/// One sample before it enters [`Samples`].
#[derive(Debug, Clone, PartialEq)]
pub struct MotionSample {
    /// Steps since the reset.
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
    /// Contact states in the order of the deflections.
    pub contacts: Vec<Contact>,
    /// Running digest over the whole state, if there is one.
    pub state_digest: Option<u64>,
    /// Computation time on a board [s].
    pub computation: Option<f64>,
}

impl MotionSample {
    /// Sample of a board in SI; `timer_rate` is the board's timer rate [Hz].
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
