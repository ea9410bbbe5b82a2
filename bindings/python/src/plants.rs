//! Plants of many joints, stepped over arrays on all cores. The step is that of the board, with the board's tables.

use core::f64::consts::TAU;
use std::sync::Arc;

use c_plant::{Motion, Plant};
use model_core::controller::design::ControlRequest;
use model_core::observer::Samples;
use numpy::ndarray::ArrayView2;
use numpy::{PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use rayon::prelude::*;
use self_cell::self_cell;
use table_blob::{Blob, BlobError};

use crate::columns::{self, BLOCK, Column, PERIODS_PER_CHECK, Quantity, Recorder, Value, block_of, check_shape};
use crate::joint::Joint;
use crate::tables::{self, Request, Tables};

self_cell!(
    /// Plant beside its tables.
    struct OwnedPlant {
        owner: Arc<[u64]>,
        #[covariant]
        dependent: Plant,
    }
);

/// Plant of one joint with its tables.
pub struct PlantOfJoint {
    plant: OwnedPlant,
    ratio: f64,
}

/// State of a plant after a period.
pub struct PlantState {
    motion: Motion,
    speeds: [f32; 2],
    samples: Samples<f32>,
    ratio: f64,
}

impl PlantState {
    /// Angle of the rigid-body carrier [rad].
    fn carrier(&self) -> f64 {
        let (turns, fraction) = self.motion.carrier;
        TAU * (f64::from(turns) + f64::from(fraction) / f64::powi(2.0, 32))
    }
}

/// Recorded quantities of a plant.
pub const QUANTITIES: &[Quantity<PlantState>] = &[
    Quantity { name: "motor_counts", kind: "uint32", value: |it| Value::Counts(it.samples.motor.counts) },
    Quantity {
        name: "output_counts",
        kind: "uint32",
        value: |it| Value::Counts(it.samples.output.map_or(0, |output| output.counts)),
    },
    Quantity {
        name: "motor_angle_rad",
        kind: "float64",
        value: |it| Value::Double(it.ratio * it.carrier() + f64::from(it.motion.offsets[0])),
    },
    Quantity {
        name: "link_angle_rad",
        kind: "float64",
        value: |it| Value::Double(it.carrier() + f64::from(it.motion.offsets[1])),
    },
    Quantity { name: "motor_speed_rad_per_s", kind: "float32", value: |it| Value::Single(it.speeds[0]) },
    Quantity { name: "link_speed_rad_per_s", kind: "float32", value: |it| Value::Single(it.speeds[1]) },
    Quantity { name: "gap_m", kind: "float32", value: |it| Value::Single(it.motion.gap_and_wind_up[0]) },
    Quantity { name: "wind_up_m", kind: "float32", value: |it| Value::Single(it.motion.gap_and_wind_up[1]) },
    Quantity { name: "air_gap_torque_N_m", kind: "float32", value: |it| Value::Single(it.motion.torques[0]) },
    Quantity { name: "drive_torque_N_m", kind: "float32", value: |it| Value::Single(it.motion.torques[1]) },
    Quantity { name: "load_torque_N_m", kind: "float32", value: |it| Value::Single(it.motion.torques[2]) },
    Quantity { name: "sun_contact", kind: "uint8", value: |it| Value::Code(it.motion.contacts[0][0].code()) },
];

/// Names and types of the quantities.
pub fn column_types() -> Vec<(&'static str, &'static str)> {
    columns::types(QUANTITIES)
}

impl PlantOfJoint {
    fn new(tables: &Tables) -> Result<Self, BlobError> {
        let plant = OwnedPlant::try_new(tables.words.clone(), |words| Plant::new(&Blob::open(words)?))?;
        Ok(Self { plant, ratio: tables.ratio })
    }

    /// Advances by one period under a torque command and a torque that brakes the link [N m].
    #[inline]
    pub fn advance(&mut self, torque: f32, load: f32) {
        self.plant.with_dependent_mut(|_, plant| plant.advance(torque, load));
    }

    /// Present measurements.
    #[inline]
    pub fn samples(&self) -> Samples<f32> {
        self.plant.borrow_dependent().samples()
    }

    /// Present state.
    pub fn state(&self) -> PlantState {
        let plant = self.plant.borrow_dependent();
        PlantState { motion: plant.motion(), speeds: plant.speeds(), samples: plant.samples(), ratio: self.ratio }
    }
}

/// Plants of `n` joints.
#[pyclass(module = "lostmotion._native")]
pub struct Plants {
    /// Plants in their order.
    pub plants: Vec<PlantOfJoint>,
    tables: Vec<Tables>,
    rate: u32,
}

#[pymethods]
impl Plants {
    /// Designs plants of one joint for all, or of a joint each.
    #[new]
    fn new(py: Python<'_>, joints: Vec<PyRef<'_, Joint>>, n: usize, rate: Option<u32>) -> PyResult<Self> {
        let rate = tables::rate_of(&joints, rate);
        let tables = tables::design(py, &joints, n, Request { rate, control: ControlRequest::USUAL, plant: true })?;
        Ok(Self { plants: tables::each(py, &tables, PlantOfJoint::new)?, tables, rate })
    }

    /// Number of plants.
    fn __len__(&self) -> usize {
        self.plants.len()
    }

    /// Control rate [Hz].
    #[getter]
    fn rate(&self) -> u32 {
        self.rate
    }

    /// Returns every plant to rest at angle zero.
    fn reset(&mut self, py: Python<'_>) -> PyResult<()> {
        self.plants = tables::each(py, &self.tables, PlantOfJoint::new)?;
        Ok(())
    }

    /// Digests over every bit of the gears' states.
    fn digests(&self) -> Vec<u64> {
        self.plants.iter().map(|it| it.plant.borrow_dependent().digest()).collect()
    }

    /// Bytes of the tables of a plant.
    fn tables<'py>(&self, py: Python<'py>, index: usize) -> Option<Bound<'py, PyBytes>> {
        let bytes: Vec<u8> = self.tables.get(index)?.words.iter().flat_map(|word| word.to_le_bytes()).collect();
        Some(PyBytes::new(py, &bytes))
    }

    /// Writes the present state into arrays with one row.
    fn state<'py>(&self, record: Vec<(String, Bound<'py, PyAny>)>) -> PyResult<()> {
        let mut columns = Column::of(QUANTITIES, record, [1, self.plants.len()])?;
        let blocks = self.plants.len().div_ceil(BLOCK);
        for (plants, mut recorders) in self.plants.chunks(BLOCK).zip(columns::by_block(&mut columns, blocks)) {
            for (joint, plant) in plants.iter().enumerate() {
                let state = plant.state();
                recorders.iter_mut().for_each(|recorder| recorder.write(0, joint, &state));
            }
        }
        Ok(())
    }

    /// Steps every plant under torques with a row per period and a column per plant; each `every`-th period fills a row
    /// of the arrays in `record`.
    fn step<'py>(
        &mut self,
        py: Python<'py>,
        torque: PyReadonlyArray2<'py, f32>,
        load: PyReadonlyArray2<'py, f32>,
        every: usize,
        record: Vec<(String, Bound<'py, PyAny>)>,
    ) -> PyResult<()> {
        let count = self.plants.len();
        let shape = [torque.shape()[0], count];
        check_shape("torque", torque.shape(), shape)?;
        check_shape("load", load.shape(), shape)?;
        let (torque, load) = (torque.as_array(), load.as_array());
        let mut columns = Column::of(QUANTITIES, record, [shape[0] / every, count])?;
        let mut recorders = columns::by_block(&mut columns, count.div_ceil(BLOCK));
        let plants = &mut self.plants;
        columns::in_bands(py, shape[0], count, PERIODS_PER_CHECK, |[begin, end]| {
            let blocks = plants.par_chunks_mut(BLOCK).zip(recorders.par_iter_mut()).enumerate();
            blocks.for_each(|(block, (plants, recorders))| {
                let inputs = [&torque, &load].map(|it| block_of(it, block, plants.len()));
                step_block(plants, &inputs, [begin, end, every], recorders);
            });
        })
    }
}

/// Steps the plants of a block, one after the other, so that each stays in the cache.
fn step_block(
    plants: &mut [PlantOfJoint],
    [torque, load]: &[ArrayView2<'_, f32>; 2],
    [begin, end, every]: [usize; 3],
    recorders: &mut [Recorder<'_, PlantState>],
) {
    for (joint, plant) in plants.iter_mut().enumerate() {
        for row in begin..end {
            plant.advance(torque[[row, joint]], load[[row, joint]]);
            if (row + 1).is_multiple_of(every) && !recorders.is_empty() {
                let state = plant.state();
                recorders.iter_mut().for_each(|recorder| recorder.write(row / every, joint, &state));
            }
        }
    }
}
