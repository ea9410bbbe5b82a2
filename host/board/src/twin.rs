//! Twin of the board on the host: the same f32 step under the same torques, compared with every sample bit for bit. A
//! running digest over the whole state covers the ticks between samples. `joint-run` checks accuracy against the
//! reference.

use link::messages::{Command, Sample};
use model_core::gears::design::{DesignError, Effort, design_scheme};
use model_core::numbers::digest;

use model_core::gears::{Model, Scheme, Tables, Torques};
use parameters::{ContactState, JointParameters};

use crate::device::board::Chip;
use report::failure::{Failure, Outcome};

/// Result of the comparison.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Agreement {
    /// Steps up to the last agreeing sample before any difference, all covered by its digest.
    pub steps: u32,
    /// Samples compared.
    pub samples: usize,
    /// Samples that differ in any bit.
    pub different: usize,
    /// First difference.
    pub first: Option<Difference>,
}

/// First field in which two samples differ.
#[derive(Debug, Clone, PartialEq)]
pub struct Difference {
    /// Steps done at the sample.
    pub tick: u32,
    /// Name of the field.
    pub field: &'static str,
    /// Value of the board.
    pub board: String,
    /// Value of the twin.
    pub twin: String,
}

/// Digest of the tables that a board with this joint must state.
pub fn tables_digest(joint: &JointParameters, chip: Chip, tick_rate: u32) -> Outcome<u64> {
    match joint.geometry.planets {
        1 => Ok(tables::<1>(joint, chip, tick_rate)?.digest),
        3 => Ok(tables::<3>(joint, chip, tick_rate)?.digest),
        4 => Ok(tables::<4>(joint, chip, tick_rate)?.digest),
        5 => Ok(tables::<5>(joint, chip, tick_rate)?.digest),
        other => Err(unsupported_planets(joint, other)),
    }
}

/// Repeats the commands on the twin and compares every sample. Samples must be in ascending order of ticks.
pub fn compare(
    joint: &JointParameters,
    image: Chip,
    tick_rate: u32,
    commands: &[Command],
    samples: &[Sample],
) -> Outcome<Agreement> {
    let ticks: Vec<u32> = samples.iter().map(|sample| sample.tick).collect();
    let mut agreement = Agreement::default();
    for (board, twin) in samples.iter().zip(replay(joint, image, tick_rate, commands, &ticks)?) {
        agreement.samples += 1;
        match difference(board, &twin) {
            None if agreement.different == 0 => agreement.steps = board.tick,
            None => {}
            Some(difference) => {
                agreement.different += 1;
                agreement.first.get_or_insert(difference);
            }
        }
    }
    Ok(agreement)
}

/// Samples of the twin after the given numbers of steps, in ascending order.
pub fn replay(
    joint: &JointParameters,
    chip: Chip,
    tick_rate: u32,
    commands: &[Command],
    ticks: &[u32],
) -> Outcome<Vec<Sample>> {
    match joint.geometry.planets {
        1 => Ok(replay_tables(&tables::<1>(joint, chip, tick_rate)?, commands, ticks)),
        3 => Ok(replay_tables(&tables::<3>(joint, chip, tick_rate)?, commands, ticks)),
        4 => Ok(replay_tables(&tables::<4>(joint, chip, tick_rate)?, commands, ticks)),
        5 => Ok(replay_tables(&tables::<5>(joint, chip, tick_rate)?, commands, ticks)),
        other => Err(unsupported_planets(joint, other)),
    }
}

fn unsupported_planets(joint: &JointParameters, planets: usize) -> Failure {
    Failure::new(format!("joint `{}` has {planets} planets", joint.name))
        .with_help("a joint may have 3, 4 or 5 planets")
}

fn tables<const N: usize>(joint: &JointParameters, chip: Chip, tick_rate: u32) -> Outcome<Tables<f32, N>> {
    design_scheme(joint, tick_rate, Scheme::Realtime, Effort::Within(chip.processor())).map_err(|error| {
        let failure = Failure::new(format!("joint `{}` cannot be designed for {tick_rate} Hz: {error}", joint.name));
        match error {
            DesignError::RateTooLow { lowest, .. } => {
                failure.with_help(format!("give --rate {lowest} or more; in a test file control_rate_Hz in [known]"))
            }
            _ => failure,
        }
    })
}

fn replay_tables<const N: usize>(tables: &Tables<f32, N>, commands: &[Command], ticks: &[u32]) -> Vec<Sample> {
    let mut model = Model::new(tables);
    let mut torques = Torques { drive: 0.0, load: 0.0 };
    let mut running = digest::START;
    let mut commands = commands.iter().peekable();
    let mut tick = 0;
    let mut samples = Vec::with_capacity(ticks.len());
    for &wanted in ticks {
        while tick < wanted {
            while let Some(command) = commands.next_if(|command| command.tick <= tick) {
                torques = Torques { drive: command.drive_torque, load: command.load_torque };
            }
            model.step(torques);
            running = digest::chain(running, model.state_digest());
            tick += 1;
        }
        samples.push(sample(&model, tick, running, 0));
    }
    samples
}

/// First field in which two samples differ. The digest comes last because it tells least.
fn difference(board: &Sample, twin: &Sample) -> Option<Difference> {
    let (board_fields, twin_fields) = (fields(board), fields(twin));
    let place = board_fields.iter().zip(&twin_fields).position(|(board, twin)| board != twin)?;
    let (field, board_value) = board_fields[place].clone();
    Some(Difference { tick: board.tick, field, board: board_value, twin: twin_fields[place].1.clone() })
}

/// All fields as text, floats with their bits, because only the bits tell -0 from 0 and one NaN from another.
fn fields(sample: &Sample) -> [(&'static str, String); 10] {
    let float = |value: &f32| format!("{value:e} (bits {:08x})", value.to_bits());
    let deflections: Vec<String> = sample.deflections.iter().map(float).collect();
    [
        ("carrier_turns", sample.carrier_turns.to_string()),
        ("carrier_fraction", sample.carrier_fraction.to_string()),
        ("carrier_speed", float(&sample.carrier_speed)),
        ("motor_offset", float(&sample.motor_offset)),
        ("link_offset", float(&sample.link_offset)),
        ("gap", float(&sample.gap)),
        ("wind_up", float(&sample.wind_up)),
        ("deflections", deflections.join(", ")),
        ("contacts", format!("{:b}", sample.contacts)),
        ("state_digest", format!("{:016x}", sample.state_digest)),
    ]
}

/// Sample of the twin after a step.
pub fn sample<const N: usize>(model: &Model<'_, f32, N>, tick: u32, state_digest: u64, computation: u16) -> Sample {
    let outputs = model.outputs();
    let mut contacts = 0;
    for (mesh, state) in outputs.contacts.iter().flatten().enumerate() {
        let code: u32 = match state {
            ContactState::Separated => 0,
            ContactState::DriveSide => 1,
            ContactState::BackSide => 2,
        };
        contacts |= code << (2 * mesh);
    }
    Sample {
        tick,
        state_digest,
        carrier_turns: outputs.carrier_turns,
        carrier_fraction: outputs.carrier_fraction,
        carrier_speed: outputs.carrier_speed,
        motor_offset: outputs.motor_offset,
        link_offset: outputs.link_offset,
        gap: outputs.gap,
        wind_up: outputs.wind_up,
        deflections: outputs.deflections.iter().flatten().copied().collect(),
        contacts,
        computation,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TICK_RATE: u32 = 20_000;

    fn joint() -> JointParameters {
        joint_file::read(joint_file::preset("q1").expect("the default preset")).expect("a good preset").parameters
    }

    fn commands() -> Vec<Command> {
        let command = |tick, drive_torque, load_torque| Command { tick, drive_torque, load_torque };
        vec![command(0, 0.5, 3.0), command(40, -0.5, -3.0), command(90, 1.0, 6.0)]
    }

    /// Correct board in an independent form: torques looked up instead of queued.
    fn board(joint: &JointParameters, commands: &[Command], ticks: u32, decimation: u32) -> Vec<Sample> {
        let tables: Tables<f32, 3> = tables(joint, Chip::Stm32f405, TICK_RATE).expect("a good joint");
        let mut model = Model::new(&tables);
        let mut running = digest::START;
        let mut samples = Vec::new();
        for tick in 0..ticks {
            let last = commands.iter().rfind(|command| command.tick <= tick);
            let (drive, load) = last.map_or((0.0, 0.0), |command| (command.drive_torque, command.load_torque));
            model.step(Torques { drive, load });
            running = digest::chain(running, model.state_digest());
            if (tick + 1) % decimation == 0 {
                samples.push(sample(&model, tick + 1, running, 7));
            }
        }
        samples
    }

    /// A correct board agrees in every bit.
    #[test]
    fn correct_board_agrees_bitwise() {
        let samples = board(&joint(), &commands(), 200, 20);
        let agreement = compare(&joint(), Chip::Stm32f405, TICK_RATE, &commands(), &samples).expect("a good joint");
        assert_eq!(agreement, Agreement { steps: 200, samples: 10, different: 0, first: None });
    }

    /// One changed bit in any field makes exactly its sample differ.
    #[test]
    fn single_bit_difference_detected() {
        let flips: [fn(&mut Sample); 6] = [
            |sample| sample.gap = f32::from_bits(sample.gap.to_bits() ^ 1),
            |sample| sample.wind_up = -sample.wind_up,
            |sample| sample.deflections[5] = f32::from_bits(sample.deflections[5].to_bits() ^ 1),
            |sample| sample.contacts ^= 1 << 11,
            |sample| sample.carrier_fraction ^= 1,
            |sample| sample.state_digest ^= 1 << 63,
        ];
        for (place, flip) in flips.iter().enumerate() {
            let mut samples = board(&joint(), &commands(), 200, 20);
            flip(&mut samples[4]);
            let agreement = compare(&joint(), Chip::Stm32f405, TICK_RATE, &commands(), &samples).expect("a good joint");
            assert_eq!((agreement.steps, agreement.different), (80, 1), "{place}: {agreement:?}");
        }
    }

    /// A command applied one tick late makes every later sample differ.
    #[test]
    fn late_command_detected_in_later_samples() {
        let mut late = commands();
        late[1].tick += 1;
        let samples = board(&joint(), &late, 200, 20);
        let agreement = compare(&joint(), Chip::Stm32f405, TICK_RATE, &commands(), &samples).expect("a good joint");
        assert_eq!((agreement.steps, agreement.different), (40, 8), "{agreement:?}");
        assert!(agreement.first.is_some_and(|first| first.tick == 60));
    }
}
