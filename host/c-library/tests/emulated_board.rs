//! The library on the emulator's machines, called from C: run by `cargo joint hil --check`.

use std::path::Path;

use board::target::board::Board;
use board::target::emulator;
use c_library::costs;
use c_library::library::{self, Target};
use c_library::package;
use c_library::programs::{self, MACHINES, Workbench, said};
use c_library::run;
use c_library::tables::{self, joint_at};

const PERIODS: u32 = 100_000;

fn say(line: &str) {
    println!("{line}");
}

#[test]
#[ignore = "needs the emulated board: run by `cargo joint hil --check`"]
fn three_machines_compute_what_the_core_computes_here_in_every_bit() {
    emulator::ensure(&say).expect("an emulator");
    for target in [Target::M4f, Target::M7] {
        let library = library::build(target, "library", &say).expect("a library");
        for rate in [10_000, 20_000] {
            let joint = joint_at(Path::new("q1"), rate).expect("a joint");
            let tables = tables::for_tests(&joint, true, &Board::emulated()).expect("tables");
            let expected = run::digest(&tables.words, PERIODS).expect("a run");
            let bench = Workbench::new(&library, &tables).expect("room");
            for machine in MACHINES.into_iter().filter(|machine| machine.target == target) {
                let source = programs::folder().join("test_joint.c");
                let flags = [&format!("-DPERIODS={PERIODS}u"), "-O2", "-ffast-math"];
                let program = bench.compile_for(machine, &[&source], &flags).expect("a program");
                let lines = programs::run_on(machine, &program).expect("a run");
                let digest = said(&lines, "digest ").expect("a digest");
                assert_eq!(digest, format!("{expected:016x}"), "{} at {rate} Hz", machine.name);
                println!("{} at {rate} Hz: {digest} after {PERIODS} periods", machine.name);
            }
        }
    }
}

/// Most flash and RAM of observer and compensation, with maps and without [B]. Without maps 30 KiB of flash were wished for: that
/// is not met, since the maps are a few per cent of the code.
const MEMORY: [(&str, u64, u64); 2] = [
    ("observer with maps, compensation", 40 << 10, 4 << 10),
    ("observer without maps, compensation", 40 << 10, 3 << 10),
];

#[test]
#[ignore = "needs the emulated board: run by `cargo joint hil --check`"]
fn calls_and_memory_cost_what_is_promised() {
    emulator::ensure(&say).expect("an emulator");
    for target in [Target::M4f, Target::M7] {
        let library = library::build(target, "library,measuring", &say).expect("a library");
        let joint = joint_at(Path::new("q1"), 10_000).expect("a joint");
        let tables = tables::for_tests(&joint, true, &Board::emulated()).expect("tables");
        let bench = Workbench::new(&library, &tables).expect("room");
        let machine = costs::machine(target).expect("a machine");
        let memory = costs::memory(&library, &joint, machine).expect("sizes");
        for use_of in &memory {
            println!("{}: {use_of:?}", target.name());
        }
        for (what, flash, ram) in MEMORY {
            let found = memory.iter().find(|it| it.what == what).expect("a use");
            assert!(found.flash <= flash && found.ram <= ram, "{}: {found:?}", target.name());
        }
        let calls = costs::calls(&bench, machine, true).expect("counts");
        for call in &calls {
            println!("{}: {call:?}", target.name());
        }
        let of = |name: &str| calls.iter().find(|it| it.name == name).expect("a count");
        // 3 % of the core's or 40, whichever is more; the compensation takes two motions and gives eight numbers, each
        // checked and copied, and is above that: docs/decisions/c-library.md.
        for (call, core, most) in [
            ("joint_observer_step all along", "core's observer", 40),
            ("joint_compensation_follow", "core's compensation", 110),
        ] {
            let (call, core) = (of(call), of(core));
            let (most, over) = (most.max(3 * core.mean / 100), call.mean.saturating_sub(core.mean));
            println!("{}: {} adds {over} instructions to {} of {}", target.name(), call.name, core.mean, core.name);
            assert!(over <= most, "{call:?} beside {core:?}: more than {most} above");
        }
    }
}

#[test]
#[ignore = "builds the library twice from nothing: run by `cargo joint hil --check`"]
fn two_builds_give_the_same_bytes() {
    let first = library::build(Target::Host, "library", &say).expect("a library");
    let archive = package::archive(&first, &say).expect("an archive");
    // What was built of this workspace goes; what it depends on stays.
    let built = board::target::toolchain::target_directory().join("c-library/firmware");
    std::fs::remove_dir_all(&built).expect("a folder of the build");
    let second = library::build(Target::Host, "library", &say).expect("a library");
    assert!(first.archive == second.archive && first.shared == second.shared);
    assert!(archive == package::archive(&second, &say).expect("an archive"));
}
