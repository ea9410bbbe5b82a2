//! Motion of a simulated joint. Samples of the role `loop` are in `virtual_joint`.

use heapless::Vec;
use serde::{Deserialize, Serialize};

/// Most samples in one [`SampleBatch`].
pub const SAMPLES_PER_BATCH: usize = 4;
/// Most meshes of a joint: two for each of five planets.
pub const MAX_MESHES: usize = 10;

/// Consecutive samples.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SampleBatch {
    /// Sequence number; rises by one per batch of a run, from 0 after a reset.
    pub sequence: u16,
    /// Samples, oldest first.
    pub samples: Vec<Sample, SAMPLES_PER_BATCH>,
}

/// Motion after a step.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Sample {
    /// Steps since the reset.
    pub tick: u32,
    /// Running digest over the whole state after every step so far.
    pub state_digest: u64,
    /// Whole turns of the rigid-body carrier angle.
    pub carrier_turns: i32,
    /// Fraction of the rigid-body carrier angle [2^-32 turns].
    pub carrier_fraction: u32,
    /// Rate of the rigid-body carrier angle [rad/s].
    pub carrier_speed: f32,
    /// Motor angle less ratio times rigid carrier angle [rad].
    pub motor_offset: f32,
    /// Link angle less rigid carrier angle [rad].
    pub link_offset: f32,
    /// Gap coordinate u_s - 2 u_c along the line of action [m].
    pub gap: f32,
    /// Wind-up between carrier and link along the line of action [m].
    pub wind_up: f32,
    /// Mesh deflections [m]: sun-planet of every planet, then ring-planet.
    pub deflections: Vec<f32, MAX_MESHES>,
    /// Contact states, two bits per mesh in the order of `deflections`: 0 separated, 1 drive side, 2 back side.
    pub contacts: u32,
    /// Computation time of this step [timer counts].
    pub computation: u16,
}
