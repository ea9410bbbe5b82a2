//! The library on this machine, called from C and C++: bits equal to the core's, whatever the caller's compiler flags.

use std::path::Path;
use std::sync::LazyLock;

use board::device::board::Board;
use c_library::library::{self, Library, Target};
use c_library::programs::{self, Workbench, value_after};
use c_library::run;
use c_library::tables::{self, CTables, joint_at};
use model_core::controller::design::ControlRequest;

const PERIODS: u32 = 100_000;

static LIBRARY: LazyLock<Library> =
    LazyLock::new(|| library::build(Target::Host, "library", &|line| println!("{line}")).expect("a library"));

fn designed(joint: &str, rate: u32) -> CTables {
    let joint = joint_at(Path::new(joint), rate).expect("a joint");
    tables::for_tests(&joint, true, &Board::emulated()).expect("tables")
}

/// Digest that the test program prints after a number of periods.
fn digest(bench: &Workbench, compiler: &str, flags: &[&str], periods: u32) -> u64 {
    let periods = format!("-DPERIODS={periods}u");
    let source = programs::folder().join("test_joint.c");
    let program = bench.compile(compiler, &[&source], &[&[periods.as_str()], flags].concat()).expect("a program");
    let lines = programs::run(&program, &[]).expect("a run");
    u64::from_str_radix(&value_after(&lines, "digest ").expect("a digest"), 16).expect("a number")
}

/// A C program computes the core's bits, also with -ffast-math in its own code.
#[test]
fn c_program_matches_core_bitwise() {
    for rate in [10_000, 20_000] {
        let tables = designed("q1", rate);
        let bench = Workbench::new(&LIBRARY, &tables).expect("room");
        let expected = run::digest(&tables.words, PERIODS).expect("a run");
        assert_eq!(digest(&bench, "gcc", &["-std=c99", "-O2"], PERIODS), expected, "{rate} Hz");
        // These flags make the caller's code flush to zero, round differently and assume finite numbers.
        let wild = ["-std=c17", "-O3", "-ffast-math", "-march=native"];
        assert_eq!(digest(&bench, "gcc", &wild, PERIODS), expected, "{rate} Hz, -ffast-math");
    }
}

/// A caller that rounds upwards gets the same bits and keeps its rounding mode.
#[test]
fn caller_rounding_mode_has_no_effect() {
    let tables = designed("q1", 10_000);
    let bench = Workbench::new(&LIBRARY, &tables).expect("room");
    let expected = run::digest(&tables.words, 20_000).expect("a run");
    let upward = ["-std=c99", "-O1", "-frounding-math", "-DROUND_UPWARD", "-Wno-error"];
    assert_eq!(digest(&bench, "gcc", &upward, 20_000), expected);
}

/// Compiled as C++, the program computes the core's bits for other joints too.
#[test]
fn cpp_program_matches_core_for_other_joints() {
    for joint in ["s1", "c1", "d2"] {
        let tables = designed(joint, 10_000);
        let bench = Workbench::new(&LIBRARY, &tables).expect("room");
        let expected = run::digest(&tables.words, 20_000).expect("a run");
        assert_eq!(digest(&bench, "g++", &["-std=c++20"], 20_000), expected, "{joint}");
    }
}

/// The C++ interface computes the core's bits without exceptions and RTTI.
#[test]
fn cpp_interface_matches_core_bitwise() {
    let tables = designed("q1", 10_000);
    let bench = Workbench::new(&LIBRARY, &tables).expect("room");
    let expected = run::digest(&tables.words, 20_000).expect("a run");
    let source = programs::folder().join("wrapped.cpp");
    let flags = ["-std=c++20", "-O2", "-fno-exceptions", "-fno-rtti"];
    let program = bench.compile("g++", &[&source], &flags).expect("a program");
    let lines = programs::run(&program, &[]).expect("a run");
    assert_eq!(value_after(&lines, "digest "), Some(format!("{expected:016x}")));
}

/// The library exports the header's functions only, needs `memcpy` and `memset` only, and links no panic.
#[test]
fn library_symbols_match_header() {
    let bench = Workbench::new(&LIBRARY, &designed("q1", 10_000)).expect("room");
    let names = |options: &[&str]| {
        let out =
            std::process::Command::new("nm").args(options).arg(bench.path("liblostmotion.a")).output().expect("nm");
        let text = String::from_utf8(out.stdout).expect("a text");
        let mut names: Vec<String> =
            text.lines().filter_map(|line| line.split_whitespace().last()).map(str::to_owned).collect();
        names.retain(|name| !name.ends_with(':'));
        names.sort();
        names
    };
    assert_eq!(names(&["--defined-only", "--extern-only"]), library::functions().expect("a header"));
    assert_eq!(names(&["--undefined-only"]), ["memcpy", "memset"], "as the header states");
    // Neither a panic nor its message is linked, so no path leads to one.
    let all = names(&[]);
    assert!(all.len() > 50 && !all.iter().any(|name| name.contains("panic")), "{all:?}");
}

/// The width probe finds 40 um with the core's bits, and its memory is accepted by another observer.
#[test]
fn width_probe_and_memory_match_core() {
    let mut joint = joint_at(Path::new("q1"), 10_000).expect("a joint");
    // High friction stands for the hand that holds the link.
    joint.surroundings.load_friction.coulomb = 50.0;
    let mut told = joint.clone();
    told.surroundings.load_friction.coulomb = 0.3;
    let tables = CTables {
        name: "test".to_owned(),
        ..tables::make(&joint, &tables::nominal(&told, ControlRequest::USUAL), true, &Board::emulated())
            .expect("tables")
    };
    let bench = Workbench::new(&LIBRARY, &tables).expect("room");
    let program =
        bench.compile("gcc", &[&programs::folder().join("probe.c")], &["-std=c99", "-O2"]).expect("a program");
    let lines = programs::run(&program, &[]).expect("a run");
    let number = |word: &str| value_after(&lines, word).expect("a number");
    assert_eq!(number("progress "), "1", "done: {lines:?}");
    let width_nm: f64 = number("width_nm ").parse().expect("a number");
    assert!((width_nm / 40_000.0 - 1.0).abs() < 0.1, "it is 40 um: {lines:?}");
    let expected = run::probe_digest(&tables.words, 10_000).expect("a run");
    assert_eq!(number("digest "), format!("{expected:016x}"));
    assert!(lines.contains(&"memory the same".to_owned()), "{lines:?}");
}

/// States continue in objects of the same tables only: a joint with as many planets, or the same joint at another rate, is
/// refused.
#[test]
fn states_of_other_tables_are_refused() {
    let bench = Workbench::new(&LIBRARY, &designed("q1", 10_000)).expect("room");
    let source = programs::folder().join("states.c");
    let program = bench.compile("gcc", &[&source], &["-std=c99", "-O2"]).expect("a program");
    for (joint, rate) in [("s1", 10_000), ("q1", 20_000)] {
        bench.write("other.bin", &designed(joint, rate).bytes()).expect("room");
        let other = bench.path("other.bin");
        let lines = programs::run(&program, &[other.to_str().expect("a path")]).expect("a run");
        assert_eq!(lines, ["refused states changed nothing", "a loaded state is equal"], "{joint}, {rate} Hz");
    }
}

/// The wiring check names the reversed signal, with the core's torques.
#[test]
fn wiring_check_matches_core_bitwise() {
    let tables = designed("q1", 10_000);
    let bench = Workbench::new(&LIBRARY, &tables).expect("room");
    let program =
        bench.compile("gcc", &[&programs::folder().join("wiring.c")], &["-std=c99", "-O2"]).expect("a program");
    let lines = programs::run(&program, &[]).expect("a run");
    let expected = [
        "progress 1, all right",
        "progress 1, bad: output_direction",
        "progress 1, bad: motor_direction",
        "progress 1, bad: torque_direction",
    ];
    assert_eq!(lines[..4], expected, "{lines:?}");
    let digest = run::wiring_digest(&tables.words).expect("a run");
    assert_eq!(value_after(&lines, "digest ").expect("a digest"), format!("{digest:016x}"));
}

/// Lines of a program that starts an observer, compiled with a changed header.
fn with_header(text: &str) -> Vec<String> {
    let bench = Workbench::new(&LIBRARY, &designed("q1", 10_000)).expect("room");
    std::fs::create_dir(bench.path("lostmotion")).expect("a folder");
    bench.write("lostmotion/joint.h", text.as_bytes()).expect("a header");
    let source = programs::folder().join("header.c");
    let program = bench.compile("gcc", &[&source], &["-std=c99", "-O2"]).expect("a program");
    programs::run(&program, &[]).expect("a run")
}

/// A program compiled with a header of another layout or version is rejected at start.
#[test]
fn changed_header_rejected() {
    let header = std::fs::read_to_string(library::header()).expect("a header");
    assert_eq!(with_header(&header), ["JOINT_STATUS_OK", "nothing was written"]);
    for (this, other) in [
        ("#define JOINT_ABI_VERSION 1", "#define JOINT_ABI_VERSION 2"),
        ("} JointEstimates;", "  uint32_t added;\n} JointEstimates;"),
        ("} JointTorque;", "  float added;\n} JointTorque;"),
        ("float lead_s;", "double lead_s;"),
    ] {
        assert!(header.contains(this), "{this}");
        assert_eq!(with_header(&header.replace(this, other)), ["JOINT_STATUS_OTHER_HEADER"], "{other}");
    }
}

/// Ignoring a status is a compiler warning.
#[test]
fn ignored_status_warned() {
    let bench = Workbench::new(&LIBRARY, &designed("q1", 10_000)).expect("room");
    let program = "#include <lostmotion/joint.h>\nint main(void) {\n    \
                   joint_observer_step(0, 0);\n    return 0;\n}\n";
    for (compiler, name) in [("gcc", "careless.c"), ("g++", "careless.cpp")] {
        bench.write(name, program.as_bytes()).expect("a file");
        let refused = bench.compile(compiler, &[&bench.path(name)], &["-O2"]).expect_err("a warning").to_string();
        assert!(refused.contains("unused-result") || refused.contains("nodiscard"), "{refused}");
    }
}

/// Environment variable with the number of sequences of wrong calls.
const SEQUENCES_VARIABLE: &str = "C_SEQUENCES";

/// Random wrong calls return a status and change nothing, also under the sanitizers.
#[test]
fn wrong_calls_rejected_without_effect() {
    let sequences = std::env::var(SEQUENCES_VARIABLE).unwrap_or_else(|_| "5000".to_owned());
    let bench = Workbench::new(&LIBRARY, &designed("q1", 10_000)).expect("room");
    let source = programs::folder().join("fuzz.c");
    for (kind, flags) in [
        ("as it is", &["-std=c99", "-O2"][..]),
        ("sanitized", &["-std=c11", "-O1", "-g", "-fsanitize=address,undefined", "-fno-sanitize-recover=all"]),
    ] {
        let program = bench.compile("gcc", &[&source], flags).expect("a program");
        let lines = programs::run(&program, &[&sequences, "7"]).expect("no wrong call is taken, none changes anything");
        println!("{kind}: {sequences} sequences; {}", lines.join("; "));
        let count = |word: &str| value_after(&lines, word).expect("a count").parse::<u64>().expect("a number");
        assert!(count("calls that were right ") > 5000 && count("calls that were refused ") > 5000, "{lines:?}");
    }
}
