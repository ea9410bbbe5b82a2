//! The Python module `lostmotion._native`: joints, plants, observers and controllers over arrays of numpy, and the
//! host's commands as functions. No model lives here: the step, the observer and the compensation are `model-core`, the
//! tables those of `joint tables`, files are read by the crates of the host.
//!
//! `failure` turns failures into exceptions, `work` runs long work beside Ctrl-C, `joint` reads joints, `tables` designs
//! for them, `columns` are the arrays, `plants` and `controllers` step over arrays, `closed_loop` both together,
//! `commands` are identification, tests, data sheets and logs.

mod closed_loop;
mod columns;
mod commands;
mod controllers;
mod failure;
mod joint;
mod plants;
mod tables;
mod work;

use pyo3::prelude::*;

/// Compiled half of the package `lostmotion`.
#[pymodule]
mod _native {
    use super::*;

    #[pymodule_export]
    use crate::closed_loop::run;
    #[pymodule_export]
    use crate::commands::{check, identify, joint_from_data_sheet, log_columns, run_command, run_tests};
    #[pymodule_export]
    use crate::controllers::Controllers;
    #[pymodule_export]
    use crate::joint::Joint;
    #[pymodule_export]
    use crate::plants::Plants;

    /// Adds what the macro cannot export.
    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        module.add("__version__", env!("CARGO_PKG_VERSION"))?;
        module.add("PRESETS", joint_file::PRESETS.to_vec())?;
        module.add("PLANT_COLUMNS", plants::column_types())?;
        module.add("CONTROLLER_COLUMNS", controllers::column_types())
    }
}
