//! Columns of many joints: arrays of numpy with a row per recorded period and a column per joint, split between the
//! cores by joints and written in place.

use numpy::ndarray::{ArrayView2, ArrayViewMut2, Axis, Slice};
use numpy::{PyReadwriteArray2, PyUntypedArray, PyUntypedArrayMethods};
use pyo3::exceptions::{PyKeyError, PyValueError};
use pyo3::prelude::*;

/// Joints of one block, which one core steps. Small enough for four cores to share a few dozen joints, large enough for
/// the rows of neighbouring blocks to share few cache lines.
pub const BLOCK: usize = 16;
/// Joint-periods between two looks at Python's signals: 26 ms of plants on one core. A period of Q1 takes 0.26 us of
/// processor time, measured on an x86-64 server.
pub const PERIODS_PER_CHECK: usize = 100_000;

/// Value of a column.
#[derive(Debug, Clone, Copy)]
pub enum Value {
    /// A number as the core has it.
    Single(f32),
    /// An angle over any number of turns.
    Double(f64),
    /// Counts.
    Counts(u32),
    /// A code or a flag.
    Code(u8),
}

/// Quantity by name, with the type of numpy and the way to read it from `S`.
pub struct Quantity<S> {
    /// Name, with the unit.
    pub name: &'static str,
    /// Type of numpy: `float32`, `float64`, `uint32` or `uint8`.
    pub kind: &'static str,
    /// Value of a state.
    pub value: fn(&S) -> Value,
}

/// Names and types of quantities, for the Python half, which makes the arrays.
pub fn types<S>(quantities: &[Quantity<S>]) -> Vec<(&'static str, &'static str)> {
    quantities.iter().map(|it| (it.name, it.kind)).collect()
}

/// Array borrowed from Python, of any type.
pub enum Borrowed<'py> {
    Single(PyReadwriteArray2<'py, f32>),
    Double(PyReadwriteArray2<'py, f64>),
    Counts(PyReadwriteArray2<'py, u32>),
    Code(PyReadwriteArray2<'py, u8>),
}

/// View of a part of an array.
pub enum View<'a> {
    Single(ArrayViewMut2<'a, f32>),
    Double(ArrayViewMut2<'a, f64>),
    Counts(ArrayViewMut2<'a, u32>),
    Code(ArrayViewMut2<'a, u8>),
}

/// Columns of a block of joints.
pub fn block_of<'a, T>(array: &'a ArrayView2<'_, T>, block: usize, joints: usize) -> ArrayView2<'a, T> {
    array.slice_axis(Axis(1), Slice::from(block * BLOCK..block * BLOCK + joints))
}

/// Runs all periods in bands, each without Python's lock, and looks at Python's signals after each band. `run` receives
/// the first period of a band and the one after its last; `checked` is the number of joint-periods in a band.
pub fn in_bands(
    py: Python<'_>,
    periods: usize,
    joints: usize,
    checked: usize,
    mut run: impl FnMut([usize; 2]) + Send,
) -> PyResult<()> {
    let band = (checked / joints.max(1)).max(1);
    for begin in (0..periods).step_by(band) {
        py.detach(|| fp_mode::standard(|| run([begin, (begin + band).min(periods)])));
        py.check_signals()?;
    }
    Ok(())
}

/// Refuses an array of another shape.
pub fn check_shape(name: &str, given: &[usize], shape: [usize; 2]) -> PyResult<()> {
    if given == shape {
        return Ok(());
    }
    Err(PyValueError::new_err(format!("{name} has the shape {given:?}, not {shape:?} (periods, joints)")))
}

/// Column to be recorded.
pub struct Column<'py, S: 'static> {
    quantity: &'static Quantity<S>,
    array: Borrowed<'py>,
}

impl<'py, S> Column<'py, S> {
    /// Columns for arrays by name, each of the same rows and joints.
    pub fn of(
        quantities: &'static [Quantity<S>],
        arrays: Vec<(String, Bound<'py, PyAny>)>,
        shape: [usize; 2],
    ) -> PyResult<Vec<Self>> {
        let column = |(name, array): (String, Bound<'py, PyAny>)| {
            let quantity = quantities.iter().find(|it| it.name == name);
            let quantity = quantity.ok_or_else(|| PyKeyError::new_err(name.clone()))?;
            check_shape(&name, array.cast::<PyUntypedArray>()?.shape(), shape)?;
            let array = match quantity.kind {
                "float32" => Borrowed::Single(array.extract()?),
                "float64" => Borrowed::Double(array.extract()?),
                "uint32" => Borrowed::Counts(array.extract()?),
                _ => Borrowed::Code(array.extract()?),
            };
            Ok(Self { quantity, array })
        };
        arrays.into_iter().map(column).collect()
    }

    /// Views of each block of joints.
    pub fn blocks(&mut self) -> Vec<Recorder<'_, S>> {
        fn split<'a, T: numpy::Element>(
            array: &'a mut PyReadwriteArray2<'_, T>,
            view: fn(ArrayViewMut2<'a, T>) -> View<'a>,
        ) -> Vec<View<'a>> {
            let mut parts = Vec::new();
            let mut rest = array.as_array_mut();
            while rest.len_of(Axis(1)) > BLOCK {
                let (block, others) = rest.split_at(Axis(1), BLOCK);
                parts.push(view(block));
                rest = others;
            }
            parts.push(view(rest));
            parts
        }
        let views = match &mut self.array {
            Borrowed::Single(array) => split(array, View::Single),
            Borrowed::Double(array) => split(array, View::Double),
            Borrowed::Counts(array) => split(array, View::Counts),
            Borrowed::Code(array) => split(array, View::Code),
        };
        let read = self.quantity.value;
        views.into_iter().map(|view| Recorder { view, read }).collect()
    }
}

/// Column of one block.
pub struct Recorder<'a, S> {
    view: View<'a>,
    read: fn(&S) -> Value,
}

impl<S> Recorder<'_, S> {
    /// Writes the value of one joint of the block into a row.
    #[inline]
    pub fn write(&mut self, row: usize, joint: usize, state: &S) {
        let at = [row, joint];
        match ((self.read)(state), &mut self.view) {
            (Value::Single(value), View::Single(view)) => view[at] = value,
            (Value::Double(value), View::Double(view)) => view[at] = value,
            (Value::Counts(value), View::Counts(view)) => view[at] = value,
            (Value::Code(value), View::Code(view)) => view[at] = value,
            // `Column::of` has matched array and quantity.
            _ => {}
        }
    }
}

/// Recorders of each block: one list of blocks, with a recorder per column in each.
pub fn by_block<'a, S>(columns: &'a mut [Column<'_, S>], blocks: usize) -> Vec<Vec<Recorder<'a, S>>> {
    let mut all: Vec<Vec<Recorder<'a, S>>> = (0..blocks).map(|_| Vec::new()).collect();
    for column in columns {
        all.iter_mut().zip(column.blocks()).for_each(|(block, recorder)| block.push(recorder));
    }
    all
}
