//! Plants under their controllers: the closed loop of many joints over arrays.

use numpy::ndarray::ArrayView2;
use numpy::{PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use rayon::prelude::*;

use crate::columns::{self, BLOCK, Column, PERIODS_PER_CHECK, Recorder, block_of, check_shape};
use crate::controllers::{self, BorrowedSetPoints, ControllerOfJoint, Controllers, Output, SetPoints};
use crate::plants::{self, PlantOfJoint, PlantState, Plants};

/// Joint-periods between two looks at Python's signals. A closed-loop period takes 8 times as long as a plant's: 2.0 us,
/// measured as for [`PERIODS_PER_CHECK`].
const PERIODS_PER_CHECK_OF_BOTH: usize = PERIODS_PER_CHECK / 8;

/// Recorders of a block: those of the plants, those of the controllers.
type Recorders<'a> = (Vec<Recorder<'a, PlantState>>, Vec<Recorder<'a, Output>>);

/// Runs plants under controllers, with set-points and load torques that have a row per period and a column per joint.
/// Each `every`-th period fills a row of the arrays: the controllers' outputs of the period, the plants' state after it.
#[pyfunction]
#[allow(clippy::too_many_arguments, reason = "arrays of one call from the Python half, which names them")]
#[pyo3(signature = (plants, controllers, position, set_points, load, preview, every, record, record_controllers))]
pub fn run<'py>(
    py: Python<'py>,
    mut plants: PyRefMut<'py, Plants>,
    mut controllers: PyRefMut<'py, Controllers>,
    position: Option<PyReadonlyArray2<'py, f64>>,
    set_points: Vec<PyReadonlyArray2<'py, f32>>,
    load: PyReadonlyArray2<'py, f32>,
    preview: bool,
    every: usize,
    record: Vec<(String, Bound<'py, PyAny>)>,
    record_controllers: Vec<(String, Bound<'py, PyAny>)>,
) -> PyResult<()> {
    let count = plants.plants.len();
    if controllers.controllers.len() != count {
        let text = format!("{count} plants and {} controllers", controllers.controllers.len());
        return Err(PyValueError::new_err(text));
    }
    let shape = [load.shape()[0], count];
    check_shape("load", load.shape(), shape)?;
    let set_points = BorrowedSetPoints::new(position, set_points, shape)?;
    let (set_points, load) = (set_points.views(), load.as_array());
    let (plants, controllers) = (&mut plants.plants, &mut controllers.controllers);
    let mut of_plants = Column::of(plants::QUANTITIES, record, [shape[0] / every, count])?;
    let mut of_controllers = Column::of(controllers::QUANTITIES, record_controllers, [shape[0] / every, count])?;
    let blocks = count.div_ceil(BLOCK);
    let of_plants = columns::by_block(&mut of_plants, blocks);
    let mut recorders: Vec<Recorders<'_>> =
        of_plants.into_iter().zip(columns::by_block(&mut of_controllers, blocks)).collect();
    columns::in_bands(py, shape[0], count, PERIODS_PER_CHECK_OF_BOTH, |[begin, end]| {
        let joints = plants.par_chunks_mut(BLOCK).zip(controllers.par_chunks_mut(BLOCK));
        joints.zip(recorders.par_iter_mut()).enumerate().for_each(|(block, ((plants, controllers), recorders))| {
            let load = block_of(&load, block, plants.len());
            let inputs = (set_points.block(block, plants.len()), load);
            run_block(plants, controllers, &inputs, preview, [begin, end, every], recorders);
        });
    })
}

fn run_block(
    plants: &mut [PlantOfJoint],
    controllers: &mut [ControllerOfJoint],
    (set_points, load): &(SetPoints<'_>, ArrayView2<'_, f32>),
    preview: bool,
    [begin, end, every]: [usize; 3],
    (of_plants, of_controllers): &mut Recorders<'_>,
) {
    for (joint, (plant, controller)) in plants.iter_mut().zip(controllers).enumerate() {
        let lead = preview.then_some(controller.lead);
        for row in begin..end {
            let done = controller.step(&plant.samples(), &set_points.command(row, joint, lead));
            plant.advance(done.torque(), load[[row, joint]]);
            if (row + 1).is_multiple_of(every) {
                let row = row / every;
                of_controllers.iter_mut().for_each(|recorder| recorder.write(row, joint, &done));
                if !of_plants.is_empty() {
                    let state = plant.state();
                    of_plants.iter_mut().for_each(|recorder| recorder.write(row, joint, &state));
                }
            }
        }
    }
}
