//! The header is what the sources say, and clean in every C and C++ that firmware is written in.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use cbindgen::{Builder, Config, Language, Style};

/// Set to write the header anew.
const WRITE: &str = "UPDATE_HEADER";
/// In the order in which a reader wants them.
const SOURCES: [&str; 8] = ["status", "tables", "estimates", "wiring", "observer", "compensation", "probe", "plant"];
/// What is asked of the header.
const FLAGS: [&str; 6] = ["-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Werror", "-fsyntax-only"];
const C: [&str; 3] = ["c99", "c11", "c17"];
const CPP: [&str; 3] = ["c++14", "c++17", "c++20"];
/// Whose storage the caller owns.
const OBJECTS: [&str; 5] = ["Observer", "Compensation", "Probe", "Plant", "Wiring"];

fn package() -> PathBuf {
    env!("CARGO_MANIFEST_DIR").into()
}

const HEAD: &str = include_str!("head.h");

/// Size and alignment of the objects, asserted where the header is read.
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
    format!(
        "/* Size and alignment of the storage that the caller owns. */\n\
         #if defined(__cplusplus)\n\
         #define JOINT_ASSERT(holds, name) static_assert(holds, #name)\n\
         #elif defined(__STDC_VERSION__) && __STDC_VERSION__ >= 201112L\n\
         #define JOINT_ASSERT(holds, name) _Static_assert(holds, #name)\n\
         #else\n\
         #define JOINT_ASSERT(holds, name) typedef char name[(holds) ? 1 : -1]\n\
         #endif\n\
         {sizes}\
         #if defined(__cplusplus)\n{aligned}#else\n{aligned_c}#endif\n\
         #undef JOINT_ASSERT\n\n#endif /* JOINT_H */\n"
    )
}

fn header() -> String {
    let config = Config {
        language: Language::C,
        style: Style::Both,
        cpp_compat: true,
        usize_is_size_t: true,
        header: Some(format!("{}\n\n#ifndef JOINT_H\n#define JOINT_H", HEAD.trim_end())),
        trailer: Some(tail().trim_end().into()),
        line_length: 110,
        documentation: true,
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
fn the_header_is_what_the_sources_say() {
    let (path, found) = (package().join("include/joint.h"), header());
    if std::env::var_os(WRITE).is_some() {
        fs::write(&path, &found).expect("a header that can be written");
    }
    let committed = fs::read_to_string(&path).unwrap_or_default();
    assert!(
        committed == found,
        "bindings/c/include/joint.h is not what the sources say: {WRITE}=1 cargo test -p c-bindings --test header"
    );
}

#[test]
fn the_header_is_clean_in_every_c_and_c_plus_plus() {
    let folder = tempfile::tempdir().expect("a folder");
    let source = folder.path().join("only_the_header.c");
    // Twice: the guard works.
    fs::write(
        &source,
        "#include \"joint.h\"\n#include \"joint.h\"\nint main(void) { return joint_status_name(0) == 0; }\n",
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
    println!("{compiled} of 12 compilers and standards are here, and clean");
    assert!(compiled >= 3, "no C compiler is here");
}

/// Whether there is such a compiler, which must then have nothing to say.
fn is_clean(compiler: &str, language: &str, standard: &str, source: &Path) -> bool {
    let mut command = Command::new(compiler);
    command.args(FLAGS).arg(format!("-std={standard}")).args(["-x", language, "-I"]).arg(package().join("include"));
    match command.arg(source).output() {
        Ok(output) => {
            let said = String::from_utf8_lossy(&output.stderr);
            assert!(output.status.success(), "{compiler} -std={standard}:\n{said}");
            true
        }
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => false,
        Err(error) => panic!("{compiler}: {error}"),
    }
}
