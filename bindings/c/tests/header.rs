//! The committed header equals the one generated from the sources, and compiles without warnings in every C and C++
//! used for firmware.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use cbindgen::{Builder, Config, Language, Style};

/// Environment variable that makes the test write the header.
const WRITE: &str = "UPDATE_HEADER";
/// Sources in the order of the header's sections.
const SOURCES: [&str; 9] =
    ["version", "status", "tables", "estimates", "wiring", "observer", "compensation", "probe", "plant"];
/// Flags under which the header must compile.
const FLAGS: [&str; 6] = ["-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Werror", "-fsyntax-only"];
const C: [&str; 3] = ["c99", "c11", "c17"];
const CPP: [&str; 3] = ["c++14", "c++17", "c++20"];
/// Objects in the caller's storage.
const OBJECTS: [&str; 5] = ["Observer", "Compensation", "Probe", "Plant", "Wiring"];

fn package() -> PathBuf {
    env!("CARGO_MANIFEST_DIR").into()
}

const HEAD: &str = include_str!("head.h");

/// Assertions of size and alignment of the objects, evaluated where the header is included.
fn tail() -> String {
    let align =
        |name: &&str| format!("JOINT_ASSERT(alignof(Joint{name}) == 8, joint_{}_alignment);\n", name.to_lowercase());
    let size = |name: &&str| {
        let (upper, lower) = (name.to_uppercase(), name.to_lowercase());
        format!("JOINT_ASSERT(sizeof(Joint{name}) == 8 * JOINT_{upper}_WORDS, joint_{lower}_size);\n")
    };
    let sizes: String = OBJECTS.iter().map(size).collect();
    let aligned: String = OBJECTS.iter().map(align).collect();
    let aligned_c: String = OBJECTS
        .iter()
        .map(|name| {
            let lower = name.to_lowercase();
            format!(
                "struct joint_{lower}_aligned {{ char first; Joint{name} object; }};\n\
                 JOINT_ASSERT(offsetof(struct joint_{lower}_aligned, object) == 8, joint_{lower}_alignment);\n"
            )
        })
        .collect();
    let (abi, starts) = (abi(), starts());
    format!(
        "{abi}\n{starts}\n/* Size and alignment of the storage that the caller owns. */\n\
         #if defined(__cplusplus)\n\
         #define JOINT_ASSERT(holds, name) static_assert(holds, #name)\n\
         #elif defined(__STDC_VERSION__) && __STDC_VERSION__ >= 201112L\n\
         #define JOINT_ASSERT(holds, name) _Static_assert(holds, #name)\n\
         #else\n\
         #define JOINT_ASSERT(holds, name) typedef char name[(holds) ? 1 : -1]\n\
         #endif\n\
         {sizes}\
         #if defined(__cplusplus)\n{aligned}#else\n{aligned_c}#endif\n\
         #undef JOINT_ASSERT\n\n#endif /* LOSTMOTION_JOINT_H */\n"
    )
}

/// Attribute for functions whose status must not be ignored.
const MUST_USE: &str = "#if defined(__cplusplus) && __cplusplus >= 201703L
#define JOINT_MUST_USE [[nodiscard]]
#elif defined(__GNUC__)
#define JOINT_MUST_USE __attribute__((warn_unused_result))
#else
#define JOINT_MUST_USE
#endif";

/// Structs of the header, in the order of the library's sum.
const STRUCTS: [&str; 18] = [
    "TablesFacts",
    "Reading",
    "Samples",
    "Estimate",
    "Shaft",
    "Estimates",
    "Motion",
    "Impedance",
    "Torque",
    "Probed",
    "PlantOutputs",
    "WiringStep",
    "WiringVerdicts",
    "Observer",
    "Compensation",
    "Probe",
    "Plant",
    "Wiring",
];

/// Definition of the sum over the version and the sizes of all structs, evaluated by the caller's compiler.
fn abi() -> String {
    let folded = STRUCTS
        .iter()
        .fold("(uint32_t)JOINT_ABI_VERSION".to_owned(), |sum, name| format!("JOINT_FOLD( \\\n  {sum}, Joint{name})"));
    format!(
        "/* Version of what crosses the boundary, and sizes of all structs as this compiler has them. The library refuses to start\n   \
         an object for a header whose sum differs: it would write beyond the caller's structs. */\n\
         #define JOINT_FOLD(sum, type) (31u * (sum) + (uint32_t)sizeof(type))\n#define JOINT_ABI {folded}\n"
    )
}

/// Inline functions for callers, which add the header's constants to the arguments.
fn starts() -> String {
    const STARTS: [(&str, &str, &str); 6] = [
        (
            "observer_start",
            "Observer",
            "Starts an observer with maps of the encoders' errors. `bytes` is sizeof(JointObserver). The tables must stay as they are\n   for as long as it is used.",
        ),
        (
            "observer_start_without_maps",
            "Observer",
            "Starts an observer without maps of the encoders' errors: for ideal encoders, or where flash is short.",
        ),
        (
            "compensation_start",
            "Compensation",
            "Starts a compensation. `bytes` is sizeof(JointCompensation). The tables must stay as they are for as long as it is used.",
        ),
        (
            "probe_start",
            "Probe",
            "Starts a width probe. `bytes` is sizeof(JointProbe). The load is to be held, and the motor at rest.",
        ),
        (
            "plant_start",
            "Plant",
            "Starts a plant, at rest. `bytes` is sizeof(JointPlant). The tables must stay as they are for as long as it is used.",
        ),
        (
            "wiring_start",
            "Wiring",
            "Starts a wiring check. `bytes` is sizeof(JointWiring). The joint is to be at rest, and free to turn by a few degrees at\n   the output.",
        ),
    ];
    let facts = "/* Looks at tables: whether they are sound, and what they were made for. `facts` may be NULL. */\n\
                 JOINT_MUST_USE static inline JointStatus joint_tables_facts(const uint64_t *tables, size_t tables_bytes,\n    \
                 JointTablesFacts *facts) {\n  \
                 return joint_tables_facts_checked(tables, tables_bytes, facts, JOINT_ABI);\n}\n";
    let start = |(name, object, text): &(&str, &str, &str)| {
        format!(
            "\n/* {text} */\nJOINT_MUST_USE static inline JointStatus joint_{name}(Joint{object} *object, size_t bytes,\n    \
             const uint64_t *tables, size_t tables_bytes) {{\n  \
             return joint_{name}_checked(object, bytes, tables, tables_bytes, JOINT_ABI);\n}}\n"
        )
    };
    format!("{facts}{}", STARTS.iter().map(start).collect::<String>())
}

fn header() -> String {
    let config = Config {
        language: Language::C,
        style: Style::Both,
        cpp_compat: true,
        usize_is_size_t: true,
        header: Some(format!(
            "{}\n\n#ifndef LOSTMOTION_JOINT_H\n#define LOSTMOTION_JOINT_H\n\n{MUST_USE}",
            HEAD.trim_end()
        )),
        trailer: Some(tail().trim_end().into()),
        line_length: 110,
        documentation: true,
        function: cbindgen::FunctionConfig { must_use: Some("JOINT_MUST_USE".into()), ..Default::default() },
        enumeration: cbindgen::EnumConfig {
            prefix_with_name: true,
            rename_variants: cbindgen::RenameRule::ScreamingSnakeCase,
            ..Default::default()
        },
        no_includes: true,
        sys_includes: vec!["stddef.h".into(), "stdint.h".into()],
        documentation_style: cbindgen::DocumentationStyle::C99,
        ..Config::default()
    };
    let sources = SOURCES.iter().map(|name| package().join(format!("src/{name}.rs")));
    let builder = sources.fold(Builder::new().with_config(config), |builder, source| builder.with_src(source));
    let mut text = Vec::new();
    builder.generate().expect("sources that a header can be written of").write(&mut text);
    String::from_utf8(text).expect("a text")
}

#[test]
fn header_matches_sources() {
    let (path, found) = (package().join("include/lostmotion/joint.h"), header());
    if std::env::var_os(WRITE).is_some() {
        fs::write(&path, &found).expect("a header that can be written");
    }
    let committed = fs::read_to_string(&path).unwrap_or_default();
    assert!(
        committed == found,
        "bindings/c/include/lostmotion/joint.h differs from the sources: run {WRITE}=1 cargo test -p c-bindings --test header"
    );
}

#[test]
fn header_compiles_without_warnings() {
    let folder = tempfile::tempdir().expect("a folder");
    let source = folder.path().join("only_the_header.c");
    // Included twice to test the guard.
    fs::write(
        &source,
        "#include <lostmotion/joint.h>\n#include <lostmotion/joint.h>\nint main(void) { return joint_status_name(0) == 0; }\n",
    )
    .expect("a file");
    let mut compiled = 0;
    for (compilers, language, standards) in [(["gcc", "clang"], "c", C), (["g++", "clang++"], "c++", CPP)] {
        for (compiler, standard) in compilers.iter().flat_map(|it| standards.iter().map(move |standard| (it, standard)))
        {
            compiled += usize::from(is_clean(compiler, language, standard, &source));
        }
    }
    // The first compiler of each language comes with every toolchain that links Rust; `joint hil --check` asks for all.
    println!("{compiled} of 12 compilers and standards found, all without warnings");
    assert!(compiled >= 3, "no C compiler found");
}

/// Returns whether the compiler exists; fails if it reports anything.
fn is_clean(compiler: &str, language: &str, standard: &str, source: &Path) -> bool {
    let mut command = Command::new(compiler);
    command.args(FLAGS).arg(format!("-std={standard}")).args(["-x", language, "-I"]).arg(package().join("include"));
    match command.arg(source).output() {
        Ok(output) => {
            let output_text = String::from_utf8_lossy(&output.stderr);
            assert!(output.status.success(), "{compiler} -std={standard}:\n{output_text}");
            true
        }
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => false,
        Err(error) => panic!("{compiler}: {error}"),
    }
}
