//! What build systems want to know of the archive: CMake, pkg-config, Arduino and Zephyr. The first two are run by tests; the
//! other two keep to Arduino's library specification and to the schema of Zephyr's `scripts/zephyr_module.py`.

use crate::library::Target;

/// Names and texts of all of them.
pub fn all(target: Target, version: &str) -> Vec<(&'static str, String)> {
    let with_version = |text: &str| text.replace("@VERSION@", version);
    let mut files = vec![
        ("CMakeLists.txt", CMAKE_LISTS.to_owned()),
        ("lib/cmake/joint/jointConfig.cmake", CMAKE_CONFIG.to_owned()),
        ("lib/cmake/joint/jointConfigVersion.cmake", with_version(CMAKE_CONFIG_VERSION)),
        ("lib/pkgconfig/joint.pc", with_version(PKG_CONFIG)),
        ("library.properties", with_version(ARDUINO)),
        ("zephyr/module.yml", ZEPHYR_MODULE.to_owned()),
        ("zephyr/CMakeLists.txt", zephyr_lists(target)),
        ("test/CMakeLists.txt", test_lists(target)),
    ];
    if let Some(linker_script) = linker_script(target) {
        files.push(("test/board/toolchain.cmake", toolchain(target, linker_script)));
    }
    files
}

/// Where Arduino looks for a library that is compiled already: `src/{build.mcu}`, whatever the flags of the floating-point unit.
pub fn arduino_folder(target: Target) -> Option<&'static str> {
    match target {
        Target::M4f => Some("src/cortex-m4"),
        Target::M7 => Some("src/cortex-m7"),
        Target::Host => None,
    }
}

/// Of the emulated machine that the test program is for.
pub fn linker_script(target: Target) -> Option<&'static str> {
    match target {
        Target::M4f => Some("netduinoplus2.ld"),
        Target::M7 => Some("mps2.ld"),
        Target::Host => None,
    }
}

const CMAKE_LISTS: &str = "# For add_subdirectory and FetchContent: gives the target joint::joint.
cmake_minimum_required(VERSION 3.13)
include(\"${CMAKE_CURRENT_LIST_DIR}/lib/cmake/joint/jointConfig.cmake\")
";

const CMAKE_CONFIG: &str = "# find_package(joint CONFIG REQUIRED), with this archive in CMAKE_PREFIX_PATH: the static library is joint::joint; for a host
# the shared one is joint::shared.
get_filename_component(joint_root \"${CMAKE_CURRENT_LIST_DIR}/../../..\" ABSOLUTE)
if(NOT TARGET joint::joint)
  add_library(joint::joint STATIC IMPORTED GLOBAL)
  set_target_properties(joint::joint PROPERTIES
    IMPORTED_LOCATION \"${joint_root}/lib/libjoint.a\"
    INTERFACE_INCLUDE_DIRECTORIES \"${joint_root}/include\")
  if(EXISTS \"${joint_root}/lib/libjoint.so\")
    add_library(joint::shared SHARED IMPORTED GLOBAL)
    set_target_properties(joint::shared PROPERTIES
      IMPORTED_LOCATION \"${joint_root}/lib/libjoint.so\"
      IMPORTED_NO_SONAME TRUE
      INTERFACE_INCLUDE_DIRECTORIES \"${joint_root}/include\")
  endif()
endif()
";

/// Before 1.0 another minor version may differ in anything.
const CMAKE_CONFIG_VERSION: &str = "set(PACKAGE_VERSION \"@VERSION@\")
if(PACKAGE_FIND_VERSION VERSION_EQUAL PACKAGE_VERSION)
  set(PACKAGE_VERSION_EXACT TRUE)
  set(PACKAGE_VERSION_COMPATIBLE TRUE)
elseif(PACKAGE_FIND_VERSION VERSION_LESS PACKAGE_VERSION)
  string(REGEX MATCH \"^[0-9]+[.][0-9]+\" joint_line \"${PACKAGE_VERSION}\")
  string(REGEX MATCH \"^[0-9]+[.][0-9]+\" joint_wanted_line \"${PACKAGE_FIND_VERSION}\")
  if(joint_line STREQUAL joint_wanted_line)
    set(PACKAGE_VERSION_COMPATIBLE TRUE)
  endif()
endif()
";

const PKG_CONFIG: &str = "prefix=${pcfiledir}/../..
Name: joint
Description: Observer, compensation and plant of a geared joint with backlash
Version: @VERSION@
Cflags: -I${prefix}/include
Libs: -L${prefix}/lib -ljoint
";

const ARDUINO: &str = "name=joint
version=@VERSION@
author=The authors of joint
maintainer=The authors of joint
sentence=Observer and compensation of a geared joint with backlash.
paragraph=Where the teeth are, from encoder counts and motor torque, and a torque that takes the lost motion out.
category=Device Control
url=
architectures=stm32
precompiled=full
ldflags=-ljoint
includes=joint.h
";

const ZEPHYR_MODULE: &str = "name: joint
build:
  cmake: zephyr
";

fn zephyr_lists(target: Target) -> String {
    let (option, mend) = match target {
        Target::M4f | Target::M7 => {
            ("CONFIG_FP_HARDABI", "it is for the hard-float ABI, so set CONFIG_FPU=y and CONFIG_FP_HARDABI=y")
        }
        Target::Host => ("CONFIG_64BIT", "it is for a host of 64 bits, so build for native_sim/native/64"),
    };
    format!(
        "if(NOT {option})\n  message(FATAL_ERROR \"the joint library cannot be linked here: {mend}\")\nendif()\n\
         zephyr_include_directories(../include)\n\
         zephyr_library_import(joint ${{CMAKE_CURRENT_LIST_DIR}}/../lib/libjoint.a)\n"
    )
}

/// The test program as a project of its own, which finds the library beside it.
fn test_lists(target: Target) -> String {
    let rest = match target {
        Target::Host => "host.c)\n",
        Target::M4f | Target::M7 => "board/start.c)\n",
    };
    format!(
        "cmake_minimum_required(VERSION 3.13)\nproject(test_joint C)\nset(CMAKE_C_STANDARD 99)\n\
         find_package(joint CONFIG REQUIRED PATHS \"${{CMAKE_CURRENT_LIST_DIR}}/..\" NO_CMAKE_FIND_ROOT_PATH)\n\
         add_executable(test_joint test_joint.c test_tables.c {rest}\
         target_link_libraries(test_joint PRIVATE joint::joint)\n"
    )
}

fn toolchain(target: Target, linker_script: &str) -> String {
    let flags = target.c_flags().join(" ");
    format!(
        "# For the emulated machine; a board's own project brings its own.\nset(CMAKE_SYSTEM_NAME Generic)\n\
         set(CMAKE_SYSTEM_PROCESSOR arm)\nset(CMAKE_C_COMPILER arm-none-eabi-gcc)\nset(CMAKE_CXX_COMPILER arm-none-eabi-g++)\n\
         set(CMAKE_TRY_COMPILE_TARGET_TYPE STATIC_LIBRARY)\nset(CMAKE_C_FLAGS_INIT \"{flags} -O2\")\n\
         set(CMAKE_CXX_FLAGS_INIT \"{flags} -O2\")\n\
         set(CMAKE_EXE_LINKER_FLAGS_INIT\n  \
         \"-nostartfiles -Wl,--gc-sections -L${{CMAKE_CURRENT_LIST_DIR}} -T ${{CMAKE_CURRENT_LIST_DIR}}/{linker_script}\")\n"
    )
}
