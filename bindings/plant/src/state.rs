//! State of a plant as 32-bit words, without addresses: a copy that another plant of the same joint continues from, in
//! another process too.

use model_core::gears::{Relative, RigidBody, State};
use model_core::virtual_joint::tables::COMMAND_QUEUE_LENGTH;
use model_core::virtual_joint::{ActingTorques, VirtualJoint, VirtualJointState};

use crate::MOST_PLANETS;

/// 32-bit words of a plant's state: number of planets; relative coordinates and rates; rigid body and mesh phase;
/// commands, current, periods and torques of the last period. Numbers are bits of `f32`, wide integers the low word first.
pub const STATE_WORDS: usize = 1 + 2 * (MOST_PLANETS + 2) + 7 + COMMAND_QUEUE_LENGTH + 5;

/// Reason for refusing a state.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StateError {
    /// The state has another number of planets.
    OtherJoint,
    /// A number is infinite or not a number.
    NotFinite,
}

/// Words being written, one after the other.
struct Writer<'a> {
    words: &'a mut [u32; STATE_WORDS],
    count: usize,
}

impl Writer<'_> {
    fn word(&mut self, word: u32) {
        if let Some(place) = self.words.get_mut(self.count) {
            *place = word;
        }
        self.count += 1;
    }

    fn wide(&mut self, value: u64) {
        self.word(value as u32);
        self.word((value >> 32) as u32);
    }

    fn numbers(&mut self, values: &[f32]) {
        values.iter().for_each(|value| self.word(value.to_bits()));
    }

    fn relative<const N: usize>(&mut self, of: &Relative<f32, N>) {
        self.numbers(&of.planets);
        self.numbers(&[0.0; MOST_PLANETS][N.min(MOST_PLANETS)..]);
        self.numbers(&[of.gap, of.wind_up]);
    }
}

/// Words being read, one after the other.
struct Reader<'a> {
    words: &'a [u32; STATE_WORDS],
    count: usize,
    is_finite: bool,
}

impl Reader<'_> {
    fn word(&mut self) -> u32 {
        let word = self.words.get(self.count).copied().unwrap_or(0);
        self.count += 1;
        word
    }

    fn wide(&mut self) -> u64 {
        let low = u64::from(self.word());
        low | (u64::from(self.word()) << 32)
    }

    fn number(&mut self) -> f32 {
        let value = f32::from_bits(self.word());
        self.is_finite &= value.is_finite();
        value
    }

    fn relative<const N: usize>(&mut self) -> Relative<f32, N> {
        let all: [f32; MOST_PLANETS] = core::array::from_fn(|_| self.number());
        let planets = core::array::from_fn(|planet| all.get(planet).copied().unwrap_or(0.0));
        Relative { planets, gap: self.number(), wind_up: self.number() }
    }
}

/// Writes the state of a joint.
pub fn save<const N: usize>(joint: &VirtualJoint<'_, f32, N>, words: &mut [u32; STATE_WORDS]) {
    let state = joint.state();
    let mut to = Writer { words, count: 0 };
    to.word(N as u32);
    to.relative(&state.gears.position);
    to.relative(&state.gears.rate);
    to.word(state.gears.rigid.turns as u32);
    to.wide(state.gears.rigid.fraction);
    to.wide(state.gears.rigid.speed as u64);
    to.wide(state.gears.phase);
    to.numbers(&state.commands);
    to.numbers(&[state.current]);
    to.word(state.periods);
    to.numbers(&[state.acting.air_gap, state.acting.drive, state.acting.load]);
}

/// Replaces the state of a joint; a refused state changes nothing.
pub fn load<const N: usize>(
    joint: &mut VirtualJoint<'_, f32, N>,
    words: &[u32; STATE_WORDS],
) -> Result<(), StateError> {
    let mut from = Reader { words, count: 0, is_finite: true };
    if from.word() != N as u32 {
        return Err(StateError::OtherJoint);
    }
    let (position, rate) = (from.relative(), from.relative());
    let rigid = RigidBody { turns: from.word() as i32, fraction: from.wide(), speed: from.wide() as i64 };
    let gears = State { position, rate, rigid, phase: from.wide() };
    let commands = core::array::from_fn(|_| from.number());
    let (current, periods) = (from.number(), from.word());
    let acting = ActingTorques { air_gap: from.number(), drive: from.number(), load: from.number() };
    if !from.is_finite {
        return Err(StateError::NotFinite);
    }
    joint.set_state(&VirtualJointState { gears, commands, current, periods, acting });
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use model_core::VirtualJointDesign;
    use model_core::virtual_joint::DrivenLink;

    fn q1() -> VirtualJointDesign<3> {
        let q1 = joint_file::read(joint_file::preset("q1").unwrap()).unwrap();
        VirtualJointDesign::new(&q1, 10_000).unwrap()
    }

    #[test]
    fn loaded_state_continues_with_equal_bits() {
        let design = q1();
        let (mut joint, mut other, mut words) = (design.joint(), design.joint(), [0; STATE_WORDS]);
        for period in 0..2_000 {
            let link = DrivenLink { inverse_inertia: 2.0, acceleration: 0.3 };
            joint.advance_with_link((0.01 * period as f32).cos(), link);
        }
        save(&joint, &mut words);
        load(&mut other, &words).unwrap();
        // Both continue from a loaded state.
        load(&mut joint, &words).unwrap();
        for _ in 0..500 {
            joint.advance(0.4, 0.1);
            other.advance(0.4, 0.1);
        }
        let [mut first, mut second] = [[0; STATE_WORDS]; 2];
        save(&joint, &mut first);
        save(&other, &mut second);
        assert_eq!(first, second);
        assert_eq!(joint.samples(), other.samples());
    }

    #[test]
    fn refused_state_changes_nothing() {
        let design = q1();
        let (mut joint, mut words) = (design.joint(), [0; STATE_WORDS]);
        assert_eq!(load(&mut joint, &words), Err(StateError::OtherJoint));
        joint.advance(1.0, 0.0);
        save(&joint, &mut words);
        let before = words;
        words[1] = f32::NAN.to_bits();
        assert_eq!(load(&mut joint, &words), Err(StateError::NotFinite));
        save(&joint, &mut words);
        assert_eq!(words, before);
    }
}
