//! Synthetic run that looks like a real one: two masses with a gap between them under torque reversals. It serves the
//! tests and the inspection of reports; no figure was measured.

use board::logs::LogLine;
use joint_run::record::{
    CloseUp, Completeness, Counters, ErrorSeries, HistogramBin, Identity, Image, JointFigures, MinMeanMax,
    MotionSample, Reference, RunRecord, Samples, Settings, TimingFigures, TorqueCommand,
};
use report::checks::{Bound, Check, Source};
use report::contacts::Contact;

const TICK_RATE: u32 = 20_000;
const TICKS: u32 = 60_000;
const DECIMATION: u32 = 20;
const PLANETS: usize = 3;
const RATIO: f64 = 6.0;
const SUN_RADIUS: f64 = 7.0477e-3;
const CARRIER_RADIUS: f64 = 21.1431e-3;
const HALF_BACKLASH: f64 = 40e-6;
const STIFFNESS: f64 = 1.5e8;
const DAMPING: f64 = 2.0e3;
const SUN_MASS: f64 = 2.5e-4 / (SUN_RADIUS * SUN_RADIUS);
const LINK_MASS: f64 = 0.15 / (CARRIER_RADIUS * CARRIER_RADIUS);

/// Complete run of an emulated board on which every check holds.
pub fn record() -> RunRecord {
    let mut record = RunRecord::new(identity(), joint(), settings());
    record.completeness = Completeness::Complete;
    record.schedule = schedule();
    simulate(&mut record);
    record.timing = Some(timing());
    record.log = log();
    record.checks = checks();
    record
}

/// Empty run: a board that answered and was then lost.
pub fn empty() -> RunRecord {
    let mut record = RunRecord::new(identity(), joint(), settings());
    record.completeness = Completeness::Interrupted { reason: "the emulator ended".into(), tick: 0 };
    record
}

fn identity() -> Identity {
    Identity {
        joint: "q1".into(),
        joint_file: "joints/q1.toml".into(),
        joint_digest: "8f3a41c07d925be6".into(),
        role: "plant".into(),
        board: "olimex-h405".into(),
        emulated: true,
        transport: "QEMU emulator version 7.2.22, machine netduinoplus2".into(),
        firmware_version: "0.1.0".into(),
        clock: "not modelled by the emulator".into(),
        image: Some(Image {
            file: "target/joint/q1/thumbv7em-none-eabihf/firmware/plant".into(),
            elf_sha256: "3b1f0c55d7ae2a41f27ad9e5a5f0b6d7c1840c2f7e99d4f6a80d8a4a1e6b90c2".into(),
            flash_bytes: 46_312,
            ram_bytes: 11_904,
            compiler: "rustc 1.96.0".into(),
            flags: "profile firmware: opt-level 3, fat LTO, one codegen unit, -C target-cpu=cortex-m4".into(),
        }),
        git_commit: Some("28e5d21c0ffee (changed)".into()),
        host: "linux, x86_64".into(),
        host_version: "0.1.0".into(),
        date: "2025-11-20T11:30:00Z".into(),
        ..Identity::default()
    }
}

fn joint() -> JointFigures {
    JointFigures {
        planets: PLANETS,
        ratio: RATIO,
        half_backlash_m: vec![HALF_BACKLASH; 2 * PLANETS],
        gap_band_m: [-2.0 * HALF_BACKLASH, 2.0 * HALF_BACKLASH],
        lost_motion_rad: 2.0 * HALF_BACKLASH / CARRIER_RADIUS,
    }
}

fn settings() -> Settings {
    Settings {
        mode: "lockstep".into(),
        tick_rate_hz: TICK_RATE,
        decimation: DECIMATION,
        ticks: TICKS,
        profile: "reversals".into(),
        seed: 1,
        replay: "cargo joint hil joints/q1.toml --profile reversals --seed 1 --duration 3".into(),
        ..Settings::default()
    }
}

fn schedule() -> Vec<TorqueCommand> {
    let torque = |step: u32| {
        let time = f64::from(step) / 1000.0;
        let level = [1.2, -1.2, 2.4, -2.4, 0.4, -0.4][(time / 0.5) as usize % 6];
        let drive = level + 0.2 * (40.0 * time).sin();
        (drive, 0.85 * RATIO * level)
    };
    let command = |step: u32| {
        let (drive, load) = torque(step);
        TorqueCommand { tick: step * 20, drive_torque: drive as f32, load_torque: load as f32 }
    };
    (0..TICKS / 20).map(command).collect()
}

/// Explicit steps of the two masses, ten per tick.
fn simulate(record: &mut RunRecord) {
    let (mut sun, mut sun_speed, mut link, mut link_speed) = (0.0, 0.0, 0.0, 0.0);
    let step = 0.1 / f64::from(TICK_RATE);
    let mut close_up = Samples::new(2 * PLANETS);
    let mut error = ErrorSeries { quantity: "gap".into(), bound_percent: 1.0, ..ErrorSeries::default() };
    let mut reference = Samples::new(2 * PLANETS);
    for tick in 1..=TICKS {
        let command = record.schedule[((tick - 1) / 20) as usize];
        for _ in 0..10 {
            let gap: f64 = sun - 2.0 * link;
            let over = gap - gap.clamp(-2.0 * HALF_BACKLASH, 2.0 * HALF_BACKLASH);
            let speed = sun_speed - 2.0 * link_speed;
            let ripple = 1.0 + 0.15 * (75.0 * link / CARRIER_RADIUS).sin();
            let force = if over == 0.0 { 0.0 } else { STIFFNESS * ripple * over + DAMPING * speed };
            sun_speed += step * (f64::from(command.drive_torque) / SUN_RADIUS - force) / SUN_MASS;
            link_speed += step * (2.0 * force - f64::from(command.load_torque) / CARRIER_RADIUS) / LINK_MASS;
            sun += step * sun_speed;
            link += step * link_speed;
        }
        let sample = sample(tick, sun, link, link_speed);
        if tick % DECIMATION == 0 {
            record.samples.push(&sample, TICK_RATE, RATIO);
            let wobble = 2e-8 * (f64::from(tick) * 0.013).sin();
            reference.push(&MotionSample { gap: sample.gap + wobble as f32, ..sample.clone() }, TICK_RATE, RATIO);
            error.time_s.push(f64::from(tick) / f64::from(TICK_RATE));
            error.error_percent.push(100.0 * wobble / 7e-5);
        }
        if (9_950..10_350).contains(&tick) {
            close_up.push(&sample, TICK_RATE, RATIO);
        }
    }
    let method = "host twin, equal to the board bit for bit".into();
    record.close_up = Some(CloseUp { method, samples: close_up });
    let method = "absolute coordinates in f64, order 8 with events, relative tolerance 1e-10".into();
    record.reference = Some(Reference { method, samples: reference, errors: vec![error] });
}

fn sample(tick: u32, sun: f64, link: f64, link_speed: f64) -> MotionSample {
    let gap = sun - 2.0 * link;
    let deflection = |mesh: usize| {
        let own = 0.15 * HALF_BACKLASH * (f64::from(tick) * 0.02 + 2.1 * mesh as f64).sin();
        (0.5 * gap + if gap.abs() < 2.0 * HALF_BACKLASH { own } else { 0.05 * own }) as f32
    };
    let contact = |deflection: &f32| match f64::from(*deflection) {
        d if d > HALF_BACKLASH => Contact::DriveSide,
        d if d < -HALF_BACKLASH => Contact::BackSide,
        _ => Contact::Separated,
    };
    let deflections: Vec<f32> = (0..2 * PLANETS).map(deflection).collect();
    MotionSample {
        tick,
        carrier_angle: link / CARRIER_RADIUS,
        motor_offset: gap / SUN_RADIUS,
        link_offset: -2e-4 * (0.001 * f64::from(tick)).sin(),
        carrier_speed: (link_speed / CARRIER_RADIUS) as f32,
        gap: gap as f32,
        wind_up: (4e-6 * (0.001 * f64::from(tick)).sin()) as f32,
        contacts: deflections.iter().map(contact).collect(),
        deflections,
        state_digest: Some(u64::from(tick).wrapping_mul(0x9e37_79b9_7f4a_7c15)),
        computation: Some(8.2e-6),
    }
}

fn timing() -> TimingFigures {
    let bin = |index: usize| HistogramBin {
        from_s: index as f64 * 1e-6,
        steps: [0, 0, 0, 0, 0, 0, 120, 41_000, 15_300, 2_900, 640, 37, 3, 0][index.min(13)],
    };
    TimingFigures {
        timer_rate_hz: 168_000_000,
        ticks: TICKS,
        period_s: 50e-6,
        computation: MinMeanMax { min_s: 6.81e-6, mean_s: 7.92e-6, max_s: 12.4e-6 },
        lateness: MinMeanMax { min_s: 0.09e-6, mean_s: 0.094e-6, max_s: 0.41e-6 },
        histogram: (0..32).map(bin).collect(),
        idle_percent: 61.3,
        counters: Counters { waited: 3_012, queue_low: 4, ..Counters::default() },
        static_ram_bytes: 11_904,
        stack_used_bytes: 1_312,
    }
}

fn log() -> Vec<LogLine> {
    let line = |time: &str, level: &str, text: &str| LogLine {
        timestamp: time.into(),
        level: level.into(),
        text: text.into(),
    };
    vec![
        line("0.000000", "info", "plant q1, 20000 Hz, tables good"),
        line("0.000041", "warn", "no clock controller: an emulated board"),
        line("0.000100", "info", "run starts: lockstep, a sample every 20 ticks"),
    ]
}

fn checks() -> Vec<Check> {
    let at_most = Bound::AtMost;
    vec![
        Check::new(
            "Steps equal to the host twin bit for bit",
            60_000.0,
            "steps",
            Bound::AtLeast(50_000.0),
            Source::Host,
        )
        .note("running digest of the whole state, compared at every sample"),
        Check::new("Gap against the f64 reference, RMS", 0.021, "%", at_most(1.0), Source::Host)
            .note("of its own standard deviation"),
        Check::new("Overruns", 0.0, "", Bound::Exactly(0.0), Source::Board),
        Check::new("Lost frames", 0.0, "", Bound::Exactly(0.0), Source::Host),
        Check::new("Longest computation", 12.4, "µs", at_most(40.0), Source::Board),
        Check::new("Flash", 45.2, "KiB", at_most(256.0), Source::Image),
        Check::new("RAM", 11.6, "KiB", at_most(16.0), Source::Image),
        Check::new("Idle share", 61.3, "%", Bound::None, Source::Board),
    ]
}
