//! `check`, `budget`, `sim` and `hil` agree on a joint, board and rate: number of sub-steps (that of the board's
//! tables) and verdict on time for every role. Random joint files by seed, through all four commands as libraries.

use std::fs;
use std::path::Path;

use board::device::board::Board;
use board::device::tick_time::RateCheck;
use board::line_options::LineOptions;
use clap::Parser;
use joint_file::{change, named, preset};
use joint_run::plan::{RunPlan, RunRequest};
use link::messages::Role;
use model_core::gears::design::{Effort, Processor, Substeps, design_scheme};
use model_core::gears::{Scheme, Tables};
use parameters::JointParameters;
use simulation::sim::arguments::{Arguments, MotionArguments};
use simulation::sim::plan::SimulationPlan;
use simulation::sim::scheme::SchemeName;
use simulation::{budget, check};

const JOINTS: u64 = 64;
const BOARDS: [&str; 4] = ["olimex-h405", "nucleo-g474re", "nucleo-h743zi", "b-g431b-esc1"];
const RATES: [u32; 5] = [5000, 10_000, 20_000, 40_000, 160_000];

/// Repeatable random numbers (splitmix64).
struct Random(u64);

impl Random {
    fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut mixed = self.0;
        mixed = (mixed ^ (mixed >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((mixed ^ (mixed >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn scaled(&mut self, low: f64, high: f64) -> f64 {
        low * (high / low).powf(self.uniform())
    }

    fn pick<T: Copy>(&mut self, all: &[T]) -> T {
        all[(self.uniform() * all.len() as f64) as usize]
    }
}

/// Random joint file: light and heavy planets, 3 to 5 of them, or a gear without teeth.
fn text(random: &mut Random) -> String {
    let name = random.pick(&["q1", "q1", "l1", "c1"]);
    let mut changes = Vec::new();
    if name == "c1" {
        changes.push(("equivalent_gear.damping_ratio", random.scaled(0.02, 0.2).to_string()));
        changes.push(("equivalent_gear.lost_motion_arcmin", random.scaled(1.0, 10.0).to_string()));
    } else {
        let planets = random.pick(&[3_u32, 4, 5]);
        let sun = 20 + (10.0 * random.uniform()) as u32;
        let planet = (sun..).find(|planet| (2 * (sun + planet)).is_multiple_of(planets)).unwrap_or(sun);
        for (key, value) in [("planets", planets), ("sun_teeth", sun), ("planet_teeth", planet)] {
            changes.push((key, value.to_string()));
        }
        changes.push(("ring_teeth", (sun + 2 * planet).to_string()));
        let planet = random.scaled(0.005, 1.0);
        changes.push(("planet_equivalent_mass_kg", planet.to_string()));
        changes.push(("planet_mass_kg", (planet / 0.57).to_string()));
        changes.push(("mesh.mean_stiffness_N_per_m", random.scaled(5e7, 2e8).to_string()));
        changes.push(("mesh.damping_ratio", random.scaled(0.03, 0.12).to_string()));
        changes.push(("mesh.half_backlash_um", random.scaled(5.0, 80.0).to_string()));
        changes.push(("coherence", "warn".to_owned()));
    }
    let text = preset(name).expect("a preset").to_owned();
    changes.iter().fold(text, |text, (key, value)| {
        change(&text, key, value).unwrap_or_else(|refused| panic!("{key} = {value}: {refused:?}"))
    })
}

/// Sub-steps of the tables for a board with this processor.
fn table_substeps(joint: &JointParameters, processor: Processor, rate: u32) -> Substeps {
    fn of<const N: usize>(joint: &JointParameters, processor: Processor, rate: u32) -> Substeps {
        let tables: Tables<f32, N> =
            design_scheme(joint, rate, Scheme::Realtime, Effort::Within(processor)).expect("a stable rate");
        match tables.verlet.substeps {
            0 => Substeps::Corrected(tables.substeps),
            count => Substeps::Verlet(count),
        }
    }
    match joint.geometry.planets {
        1 => of::<1>(joint, processor, rate),
        3 => of::<3>(joint, processor, rate),
        4 => of::<4>(joint, processor, rate),
        _ => of::<5>(joint, processor, rate),
    }
}

#[derive(Parser)]
struct Line {
    #[command(flatten)]
    line: LineOptions,
}

#[derive(Parser)]
struct Motion {
    #[command(flatten)]
    arguments: Arguments,
}

fn motion(board: &str, rate: u32) -> MotionArguments {
    let rate = rate.to_string();
    Motion::parse_from(["sim", "--board", board, "--rate", &rate]).arguments.motion
}

#[test]
fn four_commands_agree_on_random_joints() {
    let folder = tempfile::tempdir().expect("a folder");
    let (mut leapfrog, mut refused) = (0, 0);
    for seed in 0..JOINTS {
        let mut random = Random(seed);
        let file = folder.path().join(format!("joint-{seed}.toml"));
        fs::write(&file, text(&mut random)).expect("a writable folder");
        let (name, rate) = (random.pick(&BOARDS), random.pick(&RATES));
        let board = Board::load(name).expect("a preset");
        let load = || named::load(&file).unwrap_or_else(|failure| panic!("seed {seed}: {failure}"));
        let joint = load().file.parameters;
        let on_board = RateCheck::new(&joint, &board, Role::Plant);
        if rate < on_board.lowest_rate() {
            assert!(check::summary(&load(), &board, rate, None).is_err(), "seed {seed}");
            continue;
        }
        let truth = table_substeps(&joint, board.processor(), rate);
        let said = (truth.method(), truth.count());
        leapfrog += u32::from(matches!(truth, Substeps::Verlet(_)));

        let checked = check::summary(&load(), &board, rate, None).expect("figures").fixed_step;
        assert_eq!((checked.method, checked.substeps), said, "seed {seed}: check");
        let plan = SimulationPlan::new(load(), &motion(name, rate)).expect("a simulation");
        assert_eq!(plan.run.substeps(SchemeName::Realtime), Some(truth), "seed {seed}: sim");
        let line = Line::parse_from(["hil", "--port", "/dev/null", "--board", name]).line;
        let request = |force| request(&file, &line, rate, force);
        let run = RunPlan::new(&request(true));
        match &run {
            Ok(run) => assert_eq!(run.substeps, truth, "seed {seed}: hil"),
            Err(failure) => assert!(failure.message().contains("no multiple"), "seed {seed}: {failure}"),
        }
        // Errors are measured for some joints only, a second each.
        if seed % 16 == 0 {
            let told = budget::summary(&load().file, &board, Role::Plant, rate, 0.5).expect("figures").verdicts;
            assert_eq!((told.method, told.substeps), said, "seed {seed}: budget");
            let again = check::summary(&load(), &board, rate, Some(0.5)).expect("figures").fixed_step.verdicts;
            assert_eq!(again.as_ref(), Some(&told), "seed {seed}: check and budget");
            assert_eq!(told.time.fits, on_board.check(rate).is_ok(), "seed {seed}");
            assert_eq!(told.rates_that_fit_Hz, on_board.rates_that_fit(), "seed {seed}");
        }
        let fits = on_board.obstacle(rate).is_none();
        refused += u32::from(!fits);
        assert_eq!(RunPlan::new(&request(false)).is_ok(), fits, "seed {seed}: hil's refusal");
        let stretches = on_board.rates_that_fit();
        let told = stretches.iter().any(|[low, high]| (*low..=*high).contains(&rate));
        assert!(!fits || told, "seed {seed}: {rate} Hz fits, and is not among {stretches:?}");
        assert!(fits || !told || !board.core_rate().is_multiple_of(rate), "seed {seed}: {rate} Hz of {stretches:?}");
    }
    assert!(leapfrog >= 8 && refused >= 4, "the joints have become one-sided: {leapfrog} leapfrog, {refused} refused");
}

fn request<'a>(file: &'a Path, line: &'a LineOptions, rate: u32, force: bool) -> RunRequest<'a> {
    RunRequest {
        file,
        line,
        mode: None,
        rate,
        profile: "reversals",
        duration: Some(0.1),
        decimation: 20,
        no_build: true,
        force,
        no_reference: true,
        out: None,
        json: None,
        picture: None,
    }
}
