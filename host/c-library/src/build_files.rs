//! Files of the archive for build systems: CMake, pkg-config, Arduino, PlatformIO and Zephyr. Tests run the first two;
//! the others follow the library specifications of Arduino and PlatformIO and the schema of Zephyr's
//! `scripts/zephyr_module.py`.

use crate::library::Target;

/// Names and texts of all files for a target.
pub fn all(target: Target, version: &str) -> Vec<(&'static str, String)> {
    let with_version = |text: &str| text.replace("@VERSION@", version);
    let mut files = vec![
        ("CMakeLists.txt", CMAKE_LISTS.to_owned()),
        ("lib/cmake/lostmotion/lostmotionConfig.cmake", CMAKE_CONFIG.to_owned()),
        ("lib/cmake/lostmotion/lostmotionConfigVersion.cmake", with_version(CMAKE_CONFIG_VERSION)),
        ("lib/pkgconfig/lostmotion.pc", with_version(PKG_CONFIG)),
        ("library.properties", with_version(ARDUINO)),
        ("library.json", with_version(PLATFORMIO)),
        ("platformio.py", PLATFORMIO_SCRIPT.to_owned()),
        ("zephyr/module.yml", ZEPHYR_MODULE.to_owned()),
        ("zephyr/CMakeLists.txt", zephyr_lists(target)),
        ("test/CMakeLists.txt", test_lists(target)),
    ];
    if target == Target::Host {
        files.push(("lib/pkgconfig/lostmotion-shared.pc", with_version(PKG_CONFIG_SHARED)));
    } else {
        files.push(("test/board/toolchain.cmake", toolchain(target)));
    }
    files
}

/// Folder in which Arduino looks for a precompiled library: `src/{build.mcu}`, regardless of the flags of the
/// floating-point unit.
pub fn arduino_folder(target: Target) -> Option<&'static str> {
    match target {
        Target::M4f => Some("src/cortex-m4"),
        Target::M33 => Some("src/cortex-m33"),
        Target::M7 => Some("src/cortex-m7"),
        Target::Host => None,
    }
}

/// Linker script of the emulated machine on which the test program runs.
pub fn linker_script(target: Target) -> Option<&'static str> {
    match target {
        Target::M4f => Some("netduinoplus2.ld"),
        Target::M33 => Some("mps2-an505.ld"),
        Target::M7 => Some("mps2.ld"),
        Target::Host => None,
    }
}

const CMAKE_LISTS: &str = "# For add_subdirectory and FetchContent: gives the target lostmotion::joint.
cmake_minimum_required(VERSION 3.13)
include(\"${CMAKE_CURRENT_LIST_DIR}/lib/cmake/lostmotion/lostmotionConfig.cmake\")
";

const CMAKE_CONFIG: &str = "# find_package(lostmotion CONFIG REQUIRED), with this archive in CMAKE_PREFIX_PATH: the static library is lostmotion::joint;
# for a host the shared one is lostmotion::joint_shared.
get_filename_component(lostmotion_root \"${CMAKE_CURRENT_LIST_DIR}/../../..\" ABSOLUTE)
if(NOT TARGET lostmotion::joint)
  add_library(lostmotion::joint STATIC IMPORTED GLOBAL)
  set_target_properties(lostmotion::joint PROPERTIES
    IMPORTED_LOCATION \"${lostmotion_root}/lib/liblostmotion.a\"
    INTERFACE_INCLUDE_DIRECTORIES \"${lostmotion_root}/include\")
  if(EXISTS \"${lostmotion_root}/lib/liblostmotion.so.0\")
    add_library(lostmotion::joint_shared SHARED IMPORTED GLOBAL)
    set_target_properties(lostmotion::joint_shared PROPERTIES
      IMPORTED_LOCATION \"${lostmotion_root}/lib/liblostmotion.so.0\"
      IMPORTED_SONAME \"liblostmotion.so.0\"
      INTERFACE_INCLUDE_DIRECTORIES \"${lostmotion_root}/include\")
  endif()
endif()
";

/// Before version 1.0 every minor version may be incompatible.
const CMAKE_CONFIG_VERSION: &str = "set(PACKAGE_VERSION \"@VERSION@\")
if(PACKAGE_FIND_VERSION VERSION_EQUAL PACKAGE_VERSION)
  set(PACKAGE_VERSION_EXACT TRUE)
  set(PACKAGE_VERSION_COMPATIBLE TRUE)
elseif(PACKAGE_FIND_VERSION VERSION_LESS PACKAGE_VERSION)
  string(REGEX MATCH \"^[0-9]+[.][0-9]+\" lostmotion_line \"${PACKAGE_VERSION}\")
  string(REGEX MATCH \"^[0-9]+[.][0-9]+\" lostmotion_wanted_line \"${PACKAGE_FIND_VERSION}\")
  if(lostmotion_line STREQUAL lostmotion_wanted_line)
    set(PACKAGE_VERSION_COMPATIBLE TRUE)
  endif()
endif()
";

/// The archive is named as a file: if a shared library lies beside it, `-l` would select the shared one, and the
/// program would not start.
const PKG_CONFIG: &str = "prefix=${pcfiledir}/../..
Name: lostmotion
Description: Observer, compensation and plant of a geared joint with backlash, static library
Version: @VERSION@
Cflags: -I${prefix}/include
Libs: ${prefix}/lib/liblostmotion.a
";

/// The path is stored in the program, so that the loader finds the library from any working folder.
const PKG_CONFIG_SHARED: &str = "prefix=${pcfiledir}/../..
Name: lostmotion-shared
Description: Observer, compensation and plant of a geared joint with backlash, shared library
Version: @VERSION@
Cflags: -I${prefix}/include
Libs: -L${prefix}/lib -Wl,-rpath,${prefix}/lib -llostmotion
";

const ARDUINO: &str = "name=lostmotion
version=@VERSION@
author=The authors of joint
maintainer=The authors of joint
sentence=Observer and compensation of a geared joint with backlash.
paragraph=Where the teeth are, from encoder counts and motor torque, and a torque that takes the lost motion out.
category=Device Control
url=
architectures=stm32
precompiled=full
ldflags=-llostmotion
includes=lostmotion.h
";

/// Header in the root of `src`, where Arduino looks for the headers of a sketch.
pub const ARDUINO_HEADER: &str = "/* For Arduino, which finds a library by a header in this folder. MIT OR Apache-2.0. */\n\
#ifndef LOSTMOTION_H\n#define LOSTMOTION_H\n#include \"lostmotion/joint.h\"\n#endif\n";

const PLATFORMIO: &str = "{
  \"name\": \"lostmotion\",
  \"version\": \"@VERSION@\",
  \"description\": \"Observer and compensation of a geared joint with backlash\",
  \"license\": \"MIT OR Apache-2.0\",
  \"headers\": [\"lostmotion/joint.h\"],
  \"frameworks\": \"*\",
  \"platforms\": \"*\",
  \"build\": {
    \"includeDir\": \"include\",
    \"srcDir\": \"include\",
    \"srcFilter\": [\"-<*>\"],
    \"extraScript\": \"platformio.py\",
    \"libArchive\": false
  }
}
";

/// Script that links the library, since PlatformIO has no key for a precompiled one.
const PLATFORMIO_SCRIPT: &str =
    "# Links the library of this archive: PlatformIO runs this file with the environment of the build.
Import(\"env\")
env.Append(LIBPATH=[env.Dir(\"lib\").srcnode().abspath], LIBS=[\"lostmotion\"])
";

const ZEPHYR_MODULE: &str = "name: lostmotion
build:
  cmake: zephyr
";

fn zephyr_lists(target: Target) -> String {
    let (option, remedy) = match target {
        Target::M4f | Target::M33 | Target::M7 => {
            ("CONFIG_FP_HARDABI", "it is for the hard-float ABI, so set CONFIG_FPU=y and CONFIG_FP_HARDABI=y")
        }
        Target::Host => ("CONFIG_64BIT", "it is for a host of 64 bits, so build for native_sim/native/64"),
    };
    format!(
        "if(NOT {option})\n  message(FATAL_ERROR \"liblostmotion cannot be linked here: {remedy}\")\nendif()\n\
         zephyr_include_directories(../include)\n\
         zephyr_library_import(lostmotion ${{CMAKE_CURRENT_LIST_DIR}}/../lib/liblostmotion.a)\n"
    )
}

/// CMake project of the test program, which finds the library beside it.
fn test_lists(target: Target) -> String {
    let (sources, options) = match linker_script(target) {
        None => ("host.c", String::new()),
        Some(script) => (
            "board/start.c",
            format!(
                "# Start-up code and memory of the emulated machine; a board's own project has its own.\n\
                 target_link_options(test_joint PRIVATE -nostartfiles -Wl,--gc-sections\n  \
                 -L${{CMAKE_CURRENT_LIST_DIR}}/board -T ${{CMAKE_CURRENT_LIST_DIR}}/board/{script})\n"
            ),
        ),
    };
    format!(
        "cmake_minimum_required(VERSION 3.13)\nproject(test_joint C)\nset(CMAKE_C_STANDARD 99)\n\
         find_package(lostmotion CONFIG REQUIRED PATHS \"${{CMAKE_CURRENT_LIST_DIR}}/..\" NO_CMAKE_FIND_ROOT_PATH)\n\
         add_executable(test_joint test_joint.c test_tables.c {sources})\n\
         target_link_libraries(test_joint PRIVATE lostmotion::joint)\n{options}"
    )
}

/// CMake toolchain file with compiler and processor only; a project has its own linker script.
fn toolchain(target: Target) -> String {
    let flags = target.c_flags().join(" ");
    format!(
        "# Compiler and processor of this target, for any project.\nset(CMAKE_SYSTEM_NAME Generic)\n\
         set(CMAKE_SYSTEM_PROCESSOR arm)\nset(CMAKE_C_COMPILER arm-none-eabi-gcc)\nset(CMAKE_CXX_COMPILER arm-none-eabi-g++)\n\
         set(CMAKE_TRY_COMPILE_TARGET_TYPE STATIC_LIBRARY)\nset(CMAKE_C_FLAGS_INIT \"{flags} -O2\")\n\
         set(CMAKE_CXX_FLAGS_INIT \"{flags} -O2\")\n"
    )
}
