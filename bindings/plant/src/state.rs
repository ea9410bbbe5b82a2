//! State of a plant as 32-bit words, without addresses: a copy that another plant of the same joint continues from, in
//! another process too.

use model_core::gears::{Relative, RigidBody, State};
use model_core::numbers::state_words::{Reader, StateWords, Writer};
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

/// Writes relative coordinates or rates, with zeros for the planets that the joint does not have.
fn write_relative<const N: usize>(of: &Relative<f32, N>, to: &mut Writer) {
    of.planets.write(to);
    (N..MOST_PLANETS).for_each(|_| to.word(0));
    [of.gap, of.wind_up].write(to);
}

/// Numbers being read, all of which must be finite.
struct Numbers<'words> {
    from: Reader<'words>,
    is_finite: bool,
}

impl Numbers<'_> {
    fn number(&mut self) -> f32 {
        let value = f32::read(&mut self.from);
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
    let mut to = Writer::new(words);
    to.word(N as u32);
    write_relative(&state.gears.position, &mut to);
    write_relative(&state.gears.rate, &mut to);
    state.gears.rigid.turns.write(&mut to);
    state.gears.rigid.fraction.write(&mut to);
    state.gears.rigid.speed.write(&mut to);
    state.gears.phase.write(&mut to);
    state.commands.write(&mut to);
    state.current.write(&mut to);
    state.periods.write(&mut to);
    [state.acting.air_gap, state.acting.drive, state.acting.load].write(&mut to);
}

/// Replaces the state of a joint; a refused state changes nothing.
pub fn load<const N: usize>(
    joint: &mut VirtualJoint<'_, f32, N>,
    words: &[u32; STATE_WORDS],
) -> Result<(), StateError> {
    let mut words = Numbers { from: Reader::new(words), is_finite: true };
    if words.from.word() != N as u32 {
        return Err(StateError::OtherJoint);
    }
    let (position, rate) = (words.relative(), words.relative());
    let from = &mut words.from;
    let rigid = RigidBody { turns: i32::read(from), fraction: u64::read(from), speed: i64::read(from) };
    let gears = State { position, rate, rigid, phase: u64::read(from) };
    let commands = core::array::from_fn(|_| words.number());
    let (current, periods) = (words.number(), words.from.word());
    let acting = ActingTorques { air_gap: words.number(), drive: words.number(), load: words.number() };
    if !words.is_finite {
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
