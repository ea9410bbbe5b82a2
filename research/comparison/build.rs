//! Links SUNDIALS for the feature `cvode`.

use std::path::Path;
use std::{env, fs};

/// CVODE and its dependencies; version 7 and later also need `core`.
const LIBRARIES: [&str; 3] = ["sundials_cvode", "sundials_nvecserial", "sundials_sunnonlinsolfixedpoint"];

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-env-changed=SUNDIALS_LIBRARY_DIR");
    if env::var_os("CARGO_FEATURE_CVODE").is_none() {
        return;
    }
    let given = env::var("SUNDIALS_LIBRARY_DIR").ok();
    if let Some(folder) = &given {
        println!("cargo::rustc-link-search=native={folder}");
    }
    for library in LIBRARIES {
        println!("cargo::rustc-link-lib=dylib={library}");
    }
    let usual = ["/usr/lib", "/usr/lib64", "/usr/local/lib", "/usr/lib/x86_64-linux-gnu", "/usr/lib/aarch64-linux-gnu"];
    if given.as_deref().into_iter().chain(usual).any(has_core) {
        println!("cargo::rustc-link-lib=dylib=sundials_core");
    }
}

fn has_core(folder: &str) -> bool {
    fs::exists(Path::new(folder).join("libsundials_core.so")).unwrap_or(false)
}
