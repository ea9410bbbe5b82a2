//! Faults act alike on the host, between the f64 drive train and its controller, and on a board, between the virtual
//! joint and its controller. The test runs every kind that both can apply, at either encoder, through both
//! implementations over the same counts and torques.
//!
//! The host rounds to whole counts, the board truncates: a shift by fractions of a count may differ by one, and noise
//! has its mean half a count lower on the board. The random numbers differ, so noise and lost readings agree only in
//! their statistics.

use std::f64::consts::TAU;

use model_core::gears::Tables;
use model_core::gears::design::design;
use model_core::observer::{Reading, Samples};
use model_core::virtual_joint::SurroundingsTable;
use model_core::virtual_joint::design::design_surroundings;
use model_core::virtual_joint::fault::{EncoderShaft, Fault, FaultKind};
use model_core::virtual_joint::fault_injector::FaultInjector;
use reference::drive_train::Measurement;

use super::faults::{counts_per_turn, quantised_faults};
use crate::case::Case;
use crate::faults::HostFaults;
use crate::file;
use crate::file::{Offset, Si};

/// Control periods of a run, half a second.
const PERIODS: u32 = 5000;
/// Start of the faults [s]; the first whole control period after it is 1001.
const START: f64 = 0.100_03;
/// End of the faults [s].
const END: f64 = 0.4;
/// Control periods with faults.
const ACTIVE_PERIODS: std::ops::Range<usize> = 1001..4000;

/// Data of one control period.
#[derive(Debug, Clone, Copy)]
struct Period {
    /// True counts of motor and link, whole turns included.
    counts: [i64; 2],
    /// Reading of the host's controller: counts with whole turns, and its period.
    host: [Option<(i64, u64)>; 2],
    /// Reading of the board's controller: counts within a turn, and its time.
    board: [Option<(u32, u32)>; 2],
    /// Motor torque on the host and on the board [N m].
    torques: [f64; 2],
}

/// A joint with both implementations.
struct FaultPair {
    case: Case,
    table: SurroundingsTable<f32>,
    turns: [i64; 2],
}

impl FaultPair {
    fn new(joint: &str) -> Self {
        let test = file::read("profile = \"T2\"").expect("a good file");
        let case = Case::new(&test, joint, 1, None).expect("a case");
        let surroundings = case.truth.surroundings;
        let tables: Tables<f32, 3> = design(&case.truth.parameters, surroundings.control_rate).expect("tables");
        let table = design_surroundings(&case.truth.parameters, &surroundings, &tables).expect("surroundings");
        Self { case, table, turns: counts_per_turn(&surroundings) }
    }

    /// Joints with encoders of 2^14 and 2^17 counts, and with counts that are no power of two.
    fn all() -> [Self; 2] {
        let q1 = joint_file::preset("q1").expect("a preset");
        let lines =
            ["motor", "output"].into_iter().zip(["20000", "100003"]).fold(q1.to_owned(), |text, (side, turn)| {
                joint_file::change(&text, &format!("{side}_encoder.counts_per_turn"), turn).expect("a known key")
            });
        [Self::new(q1), Self::new(&lines)]
    }

    /// Runs both encoders back and forth over more than a turn, with full torque commands of both signs.
    fn run(&self, kinds: &[FaultKind<Si>]) -> Vec<Period> {
        let faults: Vec<_> = kinds.iter().map(|kind| Fault { start: START, end: END, seed: (), kind: *kind }).collect();
        let rate = f64::from(self.case.truth.surroundings.control_rate);
        let mut host = HostFaults::new(&faults, 1, &self.case.truth.parameters, &self.case.train);
        let mut board = FaultInjector::default();
        let quantised = quantised_faults(&faults, rate, self.turns, 1).expect("a board can do it");
        assert!(quantised.iter().all(|fault| board.add(*fault)), "there is room");
        let one = |period: u32| {
            let wave = (TAU * f64::from(period) / 3700.0).sin();
            let turn = self.turns;
            let counts = [2.3 * wave * turn[0] as f64, 1.7 * wave * turn[1] as f64].map(|counts| counts.round() as i64);
            let [motor_counts, output_counts] = counts;
            let seen = host.sense(&Measurement { period: period.into(), motor_counts, output_counts });
            let within = |of: usize| counts[of].rem_euclid(turn[of]) as u32;
            let reading = |of: usize| Reading { counts: within(of), time: period };
            let samples = Samples { time: period, motor: reading(0), output: Some(reading(1)), torque: 0.0 };
            let samples = board.apply_to_samples(samples, &self.table);
            let command = 2.5 * (TAU * f64::from(period) / 500.0).sin();
            Period {
                counts,
                host: [Some(seen.motor), seen.output].map(|frame| frame.map(|frame| (frame.counts, frame.period))),
                board: [Some(samples.motor), samples.output]
                    .map(|reading| reading.map(|reading| (reading.counts, reading.time))),
                torques: [
                    host.torque(f64::from(period) / rate, command),
                    f64::from(board.apply_to_torque(command as f32)),
                ],
            }
        };
        (0..PERIODS).map(one).collect()
    }

    /// Errors of an encoder's counts on the host and on the board in every period; every reading must have arrived.
    fn count_errors(&self, run: &[Period], shaft: EncoderShaft) -> Vec<[i64; 2]> {
        let of = usize::from(shaft == EncoderShaft::Link);
        let turn = self.turns[of];
        // Wraps to within half a turn.
        let near = |counts: i64| (counts + turn / 2).rem_euclid(turn) - turn / 2;
        let one = |period: &Period| {
            let (host, board) = (period.host[of].expect("a reading"), period.board[of].expect("a reading"));
            assert_eq!(host.1, u64::from(board.1), "read at the same time");
            [near(host.0 - period.counts[of]), near(i64::from(board.0) - period.counts[of])]
        };
        run.iter().map(one).collect()
    }
}

const SHAFTS: [EncoderShaft; 2] = [EncoderShaft::Motor, EncoderShaft::Link];

fn other(shaft: EncoderShaft) -> EncoderShaft {
    if shaft == EncoderShaft::Motor { EncoderShaft::Link } else { EncoderShaft::Motor }
}

#[test]
fn encoder_faults_agree_to_one_count() {
    let all = FaultPair::all();
    for (both, shaft) in all.iter().flat_map(|both| SHAFTS.map(|shaft| (both, shaft))) {
        let of_counts = FaultKind::Offset(shaft, Offset { counts: -7.0, angle: 0.0 });
        let of_angle = FaultKind::Offset(shaft, Offset { counts: 3.0, angle: 20.3e-3 });
        let eccentric = FaultKind::Eccentric(shaft, 0.3_f64.to_radians());
        let missing = FaultKind::MissingCounts(shaft, 0.01);
        // Largest difference between both [counts], and least effect of the fault at its worst [counts].
        let cases: [(&[FaultKind<Si>], i64, i64); 6] = [
            (&[FaultKind::Frozen(shaft)], 0, 1000),
            (&[of_counts], 0, 7),
            (&[of_angle], 1, 40),
            (&[eccentric], 1, 13),
            (&[missing], 1, 300),
            (&[of_angle, eccentric, missing], 3, 300),
        ];
        for (kinds, apart, moved) in cases {
            let run = both.run(kinds);
            let errors = both.count_errors(&run, shaft);
            for (period, [host, board]) in errors.iter().enumerate() {
                assert!((host - board).abs() <= apart, "{kinds:?}: {host} and {board} counts in period {period}");
                assert!(
                    period >= ACTIVE_PERIODS.start || (*host, *board) == (0, 0),
                    "{kinds:?}: it has begun in period {period}"
                );
            }
            let most = errors[ACTIVE_PERIODS].iter().map(|[host, _]| host.abs()).max().expect("some");
            assert!(most >= moved, "{kinds:?} moves {most} counts at most");
            let left = errors[ACTIVE_PERIODS.end + 1][0];
            assert!(kinds.contains(&missing) || left == 0, "{kinds:?} has not ended: {left} counts");
            assert!(both.count_errors(&run, other(shaft)).iter().all(|errors| *errors == [0, 0]), "{kinds:?}");
        }
    }
}

#[test]
fn encoder_noise_agrees_in_deviation() {
    let all = FaultPair::all();
    for (both, shaft) in all.iter().flat_map(|both| SHAFTS.map(|shaft| (both, shaft))) {
        let errors = both.count_errors(&both.run(&[FaultKind::Noise(shaft, 6.0)]), shaft);
        let statistics = |side: usize| {
            let count = ACTIVE_PERIODS.len() as f64;
            let mean = errors[ACTIVE_PERIODS].iter().map(|errors| errors[side] as f64).sum::<f64>() / count;
            let square = errors[ACTIVE_PERIODS].iter().map(|errors| (errors[side] as f64 - mean).powi(2)).sum::<f64>();
            (mean, (square / count).sqrt())
        };
        // Standard error of a deviation 1.3 %, of a mean 0.11 counts: four times as much is allowed.
        let (host, board) = (statistics(0), statistics(1));
        assert!((host.1 / board.1 - 1.0).abs() < 0.08, "{shaft:?}: deviations of {} and {} counts", host.1, board.1);
        assert!((host.1 / 6.0 - 1.0).abs() < 0.055, "{shaft:?}: a deviation of {} counts", host.1);
        assert!((host.0 - board.0 - 0.5).abs() < 0.62, "{shaft:?}: means of {} and {} counts", host.0, board.0);
        let quiet = |range: std::ops::Range<usize>| errors[range].iter().all(|errors| *errors == [0, 0]);
        assert!(quiet(0..ACTIVE_PERIODS.start) && quiet(ACTIVE_PERIODS.end..errors.len()), "{shaft:?}");
    }
}

#[test]
fn lost_readings_agree_in_share() {
    let all = FaultPair::all();
    for (both, shaft) in all.iter().flat_map(|both| SHAFTS.map(|shaft| (both, shaft))) {
        let of = usize::from(shaft == EncoderShaft::Link);
        let turn = both.turns[of];
        let came = |reading: Option<(i64, u64)>, period: usize| reading.is_some_and(|(_, time)| time == period as u64);
        for share in [0.2, 1.0] {
            let run = both.run(&[FaultKind::LostReadings(shaft, share)]);
            let mut lost = [0_u32; 2];
            for (number, period) in run.iter().enumerate() {
                let board = period.board[of].map(|(counts, time)| (i64::from(counts), u64::from(time)));
                let host = period.host[of].map(|(counts, time)| (counts.rem_euclid(turn), time));
                for (lost, reading) in lost.iter_mut().zip([host, board]) {
                    *lost += u32::from(!came(reading, number));
                    assert!(
                        came(reading, number) || ACTIVE_PERIODS.contains(&number),
                        "{shaft:?}: lost in period {number}"
                    );
                    assert!(shaft == EncoderShaft::Link || reading.is_some(), "a motor's last word stands");
                    if let Some((counts, time)) = reading {
                        assert_eq!(counts, run[time as usize].counts[of].rem_euclid(turn), "{shaft:?} in {number}");
                    }
                }
                assert!(share < 1.0 || host == board, "{shaft:?}: {host:?} and {board:?} in period {number}");
            }
            // The standard deviation of the difference of two such counts is 31: four times as much is allowed.
            let apart = if share < 1.0 { 124 } else { 0 };
            assert!(lost[0].abs_diff(lost[1]) <= apart, "{shaft:?}: {lost:?} readings lost");
            assert!(
                f64::from(lost[0].abs_diff((share * ACTIVE_PERIODS.len() as f64) as u32)) <= 88.0,
                "{shaft:?}: {lost:?}"
            );
        }
    }
}

#[test]
fn torque_faults_agree() {
    let [both, _] = FaultPair::all();
    let (bias, limit) = (FaultKind::TorqueBias(0.05, -0.2), FaultKind::Saturation(1.5));
    for kinds in [vec![bias], vec![limit], vec![bias, limit], vec![limit, bias]] {
        let run = both.run(&kinds);
        let commands = both.run(&[]);
        for (number, (period, command)) in run.iter().zip(&commands).enumerate() {
            let [host, board] = period.torques;
            // Three roundings of single precision at 2.5 N m.
            assert!((host - board).abs() < 1e-6, "{kinds:?}: {host} and {board} N m in period {number}");
            assert!(
                ACTIVE_PERIODS.contains(&number) || host == command.torques[0],
                "{kinds:?} acts in period {number}"
            );
        }
        let wrong = run[ACTIVE_PERIODS]
            .iter()
            .zip(&commands[ACTIVE_PERIODS])
            .filter(|(run, command)| run.torques[0] != command.torques[0]);
        assert!(wrong.count() > 1000, "{kinds:?} does something");
    }
}
