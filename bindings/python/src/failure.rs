//! Failures as the exception `lostmotion.JointError`, with the places of the problems and the remedy.

use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::PyType;
use report::failure::{Failure, Outcome};

/// Problem of a file: line and column from one, message, remedy.
type Problem = (usize, usize, String, Option<String>);

/// Exception of a failure.
pub fn exception(py: Python<'_>, failure: &Failure) -> PyErr {
    static ERROR: PyOnceLock<Py<PyType>> = PyOnceLock::new();
    let problems: Vec<Problem> =
        failure.places().into_iter().map(|it| (it.line, it.column, it.message, it.help)).collect();
    let arguments = (failure.message(), failure.full_help(), problems, failure.exit_code());
    match ERROR.import(py, "lostmotion._errors", "JointError").and_then(|error| error.call1(arguments)) {
        Ok(error) => PyErr::from_value(error),
        Err(error) => error,
    }
}

/// Result of an outcome.
pub fn result<T>(py: Python<'_>, outcome: Outcome<T>) -> PyResult<T> {
    outcome.map_err(|failure| exception(py, &failure))
}
