//! Observers, and controllers of observer and compensation, of many joints over arrays.

use core::f64::consts::TAU;
use std::sync::Arc;

use model_core::compensation::{Command, Compensation, ControlOutput, ImpedancePoint, Motion, Position, Stage};
use model_core::controller::design::ControlRequest;
use model_core::gears::contact_state;
use model_core::observer::{Estimates, MAPPED, Observer, Reading, Samples, Source};
use numpy::ndarray::{ArrayView2, Axis};
use numpy::{PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::exceptions::{PyIndexError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use rayon::prelude::*;
use report::failure::Failure;
use self_cell::self_cell;
use table_blob::{Blob, BlobError};

use crate::columns::{self, BLOCK, Column, PERIODS_PER_CHECK, Quantity, Recorder, Value, block_of, check_shape};
use crate::failure::exception;
use crate::joint::Joint;
use crate::tables::{self, Request, Tables};

/// Observer and, in a controller, compensation on borrowed tables.
struct Unit<'a> {
    observer: Observer<'a, f32, MAPPED>,
    compensation: Option<Compensation<'a, f32>>,
}

self_cell!(
    /// Controller beside its tables.
    struct OwnedUnit {
        owner: Arc<[u64]>,
        #[covariant]
        dependent: Unit,
    }
);

/// Controller of one joint with its tables.
pub struct ControllerOfJoint {
    unit: OwnedUnit,
    /// Ticks of the samples' clock per period.
    ticks: u32,
    /// Present time [ticks].
    time: u32,
    /// Periods by which a set-point is known ahead.
    pub lead: usize,
}

/// Outputs of a period.
pub struct Output {
    estimates: Estimates<f32>,
    control: ControlOutput<f32>,
}

/// Column of an estimate's value.
macro_rules! value {
    ($name:literal, $field:ident) => {
        Quantity { name: $name, kind: "float32", value: |it| Value::Single(it.estimates.$field.value) }
    };
}

/// Column of an estimate's standard deviation.
macro_rules! deviation {
    ($name:literal, $field:ident) => {
        Quantity { name: $name, kind: "float32", value: |it| Value::Single(it.estimates.$field.variance.sqrt()) }
    };
}

/// Column of an estimate's validity.
macro_rules! valid {
    ($name:literal, $field:ident) => {
        Quantity { name: $name, kind: "uint8", value: |it| Value::Code(it.estimates.$field.valid.into()) }
    };
}

/// Recorded quantities of a controller.
pub const QUANTITIES: &[Quantity<Output>] = &[
    Quantity { name: "torque_N_m", kind: "float32", value: |it| Value::Single(it.control.torque) },
    Quantity { name: "trust", kind: "float32", value: |it| Value::Single(it.control.trust) },
    Quantity { name: "demand_N_m", kind: "float32", value: |it| Value::Single(it.control.demand) },
    Quantity { name: "stage", kind: "uint8", value: |it| Value::Code(stage_code(it.control.stage)) },
    Quantity { name: "flank", kind: "uint8", value: |it| Value::Code(contact_state(it.control.flank).code()) },
    Quantity { name: "short_of_torque", kind: "uint8", value: |it| Value::Code(it.control.short_of_torque.into()) },
    Quantity { name: "stepped_back", kind: "uint8", value: |it| Value::Code(it.control.stepped_back.into()) },
    value!("gap_m", gap),
    deviation!("gap_sd_m", gap),
    valid!("gap_valid", gap),
    value!("half_backlash_m", half_backlash),
    deviation!("half_backlash_sd_m", half_backlash),
    valid!("half_backlash_valid", half_backlash),
    value!("mesh_torque_N_m", mesh_torque),
    valid!("mesh_torque_valid", mesh_torque),
    value!("load_torque_N_m", load_torque),
    valid!("load_torque_valid", load_torque),
    value!("compliance_rad_per_N_m", compliance),
    valid!("compliance_valid", compliance),
    value!("skew_s", skew),
    value!("torque_bias_N_m", torque_bias),
    value!("motor_friction_N_m", motor_friction),
    value!("link_inertia_ratio", link_inertia_ratio),
    Quantity { name: "contact", kind: "uint8", value: |it| Value::Code(it.estimates.reported_contact.code()) },
    Quantity { name: "contact_valid", kind: "uint8", value: |it| Value::Code(it.estimates.contact_valid.into()) },
    Quantity { name: "source", kind: "uint8", value: |it| Value::Code(source_code(it.estimates.source)) },
    Quantity {
        name: "motor_angle_rad",
        kind: "float64",
        value: |it| angle(it.estimates.motor.turns, it.estimates.motor.fraction),
    },
    Quantity {
        name: "link_angle_rad",
        kind: "float64",
        value: |it| angle(it.estimates.link.turns, it.estimates.link.fraction),
    },
    Quantity { name: "motor_speed_rad_per_s", kind: "float32", value: |it| Value::Single(it.estimates.motor.speed) },
    Quantity { name: "link_speed_rad_per_s", kind: "float32", value: |it| Value::Single(it.estimates.link.speed) },
];

/// Names and types of the quantities.
pub fn column_types() -> Vec<(&'static str, &'static str)> {
    columns::types(QUANTITIES)
}

fn angle(turns: i32, fraction: f32) -> Value {
    Value::Double(TAU * (f64::from(turns) + f64::from(fraction)))
}

/// Codes of the C header: JOINT_STAGE.
fn stage_code(stage: Stage) -> u8 {
    match stage {
        Stage::Touching => 0,
        Stage::Crossing => 1,
        Stage::Landing => 2,
        Stage::Plain => 3,
        Stage::Off => 4,
        Stage::Reversed => 5,
    }
}

/// Number of encoders in use.
fn source_code(source: Source) -> u8 {
    match source {
        Source::Nothing(_) => 0,
        Source::MotorOnly(_) => 1,
        Source::Both => 2,
    }
}

/// Set-points with a row per period and a column per joint.
pub enum SetPoints<'a> {
    /// Angle zero is held.
    Hold,
    /// A motion of the link: position [rad], speed [rad/s], acceleration [rad/s^2].
    Position(ArrayView2<'a, f64>, [ArrayView2<'a, f32>; 2]),
    /// A spring and damper: position [rad], speed [rad/s], torque [N m], stiffness [N m/rad], damping [N m s/rad].
    Impedance(ArrayView2<'a, f64>, [ArrayView2<'a, f32>; 4]),
}

/// Position of an angle [rad].
fn position(angle: f64) -> Position<f32> {
    let turns = (angle / TAU).round();
    Position { turns: turns as i32, fraction: (angle / TAU - turns) as f32 }
}

impl SetPoints<'_> {
    /// Set-points of a block of joints.
    pub fn block(&self, block: usize, joints: usize) -> SetPoints<'_> {
        match self {
            Self::Hold => SetPoints::Hold,
            Self::Position(angle, rest) => SetPoints::Position(
                block_of(angle, block, joints),
                rest.each_ref().map(|it| block_of(it, block, joints)),
            ),
            Self::Impedance(angle, rest) => SetPoints::Impedance(
                block_of(angle, block, joints),
                rest.each_ref().map(|it| block_of(it, block, joints)),
            ),
        }
    }

    /// Command of a joint in a row. The motion `lead` rows later is known up to the last row of the array.
    #[inline]
    pub fn command(&self, row: usize, joint: usize, lead: Option<usize>) -> Command<f32> {
        match self {
            Self::Hold => Command::HOLD,
            Self::Position(angle, [speed, acceleration]) => {
                let rows = angle.len_of(Axis(0));
                let motion = |row: usize| {
                    let at = [row, joint];
                    Motion { position: position(angle[at]), speed: speed[at], acceleration: acceleration[at] }
                };
                Command::Position {
                    now: motion(row),
                    ahead: lead.map(|lead| row + lead).filter(|row| *row < rows).map(motion),
                }
            }
            Self::Impedance(angle, [speed, torque, stiffness, damping]) => {
                let at = [row, joint];
                Command::Impedance(ImpedancePoint {
                    position: position(angle[at]),
                    speed: speed[at],
                    torque: torque[at],
                    stiffness: stiffness[at],
                    damping: damping[at],
                })
            }
        }
    }
}

/// Set-points borrowed from Python: a position, and two further arrays for a motion or four for an impedance.
pub struct BorrowedSetPoints<'py> {
    position: Option<PyReadonlyArray2<'py, f64>>,
    rest: Vec<PyReadonlyArray2<'py, f32>>,
}

impl<'py> BorrowedSetPoints<'py> {
    /// Checks number and shapes of the arrays.
    pub fn new(
        position: Option<PyReadonlyArray2<'py, f64>>,
        rest: Vec<PyReadonlyArray2<'py, f32>>,
        shape: [usize; 2],
    ) -> PyResult<Self> {
        let has_shape = position.iter().all(|it| it.shape() == shape) && rest.iter().all(|it| it.shape() == shape);
        if !has_shape || ![0, 2, 4].contains(&rest.len()) || position.is_none() != rest.is_empty() {
            return Err(PyValueError::new_err(format!("every set-point array must have the shape {shape:?}")));
        }
        Ok(Self { position, rest })
    }

    /// Views of the arrays.
    pub fn views(&self) -> SetPoints<'_> {
        let view = |index: usize| self.rest[index].as_array();
        match (&self.position, self.rest.len()) {
            (Some(position), 2) => SetPoints::Position(position.as_array(), [view(0), view(1)]),
            (Some(position), _) => SetPoints::Impedance(position.as_array(), [0, 1, 2, 3].map(view)),
            (None, _) => SetPoints::Hold,
        }
    }
}

impl ControllerOfJoint {
    fn new(tables: &Tables, has_compensation: bool) -> Result<Self, BlobError> {
        let unit = OwnedUnit::try_new(tables.words.clone(), |words| {
            let blob = Blob::open(words)?;
            let compensation = if has_compensation { Some(Compensation::new(blob.compensation()?)) } else { None };
            Ok(Unit { observer: Observer::new(blob.observer()?), compensation })
        })?;
        let blob = Blob::open(unit.borrow_owner())?;
        let header = blob.header();
        let lead = (blob.compensation()?.crossing.lead * header.control_rate as f32).round() as usize;
        Ok(Self { ticks: header.clock_rate / header.control_rate, time: 0, lead, unit })
    }

    /// One control period. The samples are those of the present time of the controller's clock, which goes on with each
    /// period whatever clock the source of the samples has.
    #[inline]
    pub fn step(&mut self, samples: &Samples<f32>, command: &Command<f32>) -> Output {
        let time = self.time;
        let reading = |counts| Reading { counts, time };
        let samples = Samples {
            time,
            motor: reading(samples.motor.counts),
            output: samples.output.map(|output| reading(output.counts)),
            torque: samples.torque,
        };
        self.time = time.wrapping_add(self.ticks);
        self.unit.with_dependent_mut(|_, unit| {
            let estimates = *unit.observer.step(&samples);
            let control = unit.compensation.as_mut().map(|it| it.step(&estimates, command)).unwrap_or_default();
            Output { estimates, control }
        })
    }
}

impl Output {
    /// Torque command of the motor [N m].
    pub fn torque(&self) -> f32 {
        self.control.torque
    }
}

/// Observers or controllers of `n` joints.
#[pyclass(module = "lostmotion._native")]
pub struct Controllers {
    /// Controllers in their order.
    pub controllers: Vec<ControllerOfJoint>,
    tables: Vec<Tables>,
    has_compensation: bool,
    /// Control rate [Hz].
    pub rate: u32,
}

impl Controllers {
    fn fresh(py: Python<'_>, tables: &[Tables], has_compensation: bool) -> PyResult<Vec<ControllerOfJoint>> {
        tables::each(py, tables, |it| ControllerOfJoint::new(it, has_compensation))
    }

    fn at(&self, index: usize) -> PyResult<&ControllerOfJoint> {
        self.controllers.get(index).ok_or_else(|| PyIndexError::new_err("no such joint"))
    }
}

/// Recorded samples of a block: counts of the motor, counts of the output and true where they are missing, torque.
type RecordedSamples<'a> =
    (ArrayView2<'a, u32>, Option<ArrayView2<'a, u32>>, Option<ArrayView2<'a, bool>>, ArrayView2<'a, f32>);

#[pymethods]
impl Controllers {
    /// Designs controllers for one joint for all, or for a joint each.
    #[new]
    #[pyo3(signature = (joints, n, rate, bandwidth, output_encoder, compensation))]
    fn new(
        py: Python<'_>,
        joints: Vec<PyRef<'_, Joint>>,
        n: usize,
        rate: Option<u32>,
        bandwidth: Option<f64>,
        output_encoder: bool,
        compensation: bool,
    ) -> PyResult<Self> {
        let rate = tables::rate_of(&joints, rate);
        let control = ControlRequest { bandwidth, output_encoder, ..ControlRequest::USUAL };
        let tables = tables::design(py, &joints, n, Request { rate, control, plant: false })?;
        let controllers = Self::fresh(py, &tables, compensation)?;
        Ok(Self { controllers, tables, has_compensation: compensation, rate })
    }

    /// Number of controllers.
    fn __len__(&self) -> usize {
        self.controllers.len()
    }

    /// Control rate [Hz].
    #[getter]
    fn rate(&self) -> u32 {
        self.rate
    }

    /// Time by which the compensation of each joint wants to know a motion ahead [s].
    #[getter]
    fn leads(&self) -> Vec<f64> {
        self.controllers.iter().map(|it| it.lead as f64 / f64::from(self.rate)).collect()
    }

    /// Returns every controller to its designed state; estimated parameters are lost.
    fn reset(&mut self, py: Python<'_>) -> PyResult<()> {
        self.controllers = Self::fresh(py, &self.tables, self.has_compensation)?;
        Ok(())
    }

    /// Estimated parameters of one joint, as bytes that a board or a C program loads.
    fn save<'py>(&self, py: Python<'py>, index: usize) -> PyResult<Bound<'py, PyBytes>> {
        Ok(PyBytes::new(py, &self.at(index)?.unit.borrow_dependent().observer.save()))
    }

    /// Restores saved parameters of one joint.
    fn load(&mut self, py: Python<'_>, index: usize, memory: &[u8]) -> PyResult<()> {
        self.at(index)?;
        let loaded = self.controllers[index].unit.with_dependent_mut(|_, unit| unit.observer.load(memory));
        loaded.map_err(|error| exception(py, &Failure::new(error.to_string())))
    }

    /// Steps over recorded samples with a row per period and a column per joint; each `every`-th period fills a row of
    /// the arrays in `record`.
    #[allow(clippy::too_many_arguments, reason = "arrays of one call from the Python half, which names them")]
    #[pyo3(signature = (motor_counts, output_counts, missing, torque, position, set_points, preview, every, record))]
    fn step<'py>(
        &mut self,
        py: Python<'py>,
        motor_counts: PyReadonlyArray2<'py, u32>,
        output_counts: Option<PyReadonlyArray2<'py, u32>>,
        missing: Option<PyReadonlyArray2<'py, bool>>,
        torque: PyReadonlyArray2<'py, f32>,
        position: Option<PyReadonlyArray2<'py, f64>>,
        set_points: Vec<PyReadonlyArray2<'py, f32>>,
        preview: bool,
        every: usize,
        record: Vec<(String, Bound<'py, PyAny>)>,
    ) -> PyResult<()> {
        let count = self.controllers.len();
        let shape = [torque.shape()[0], count];
        check_shape("torque", torque.shape(), shape)?;
        check_shape("motor_counts", motor_counts.shape(), shape)?;
        output_counts.iter().try_for_each(|it| check_shape("output_counts", it.shape(), shape))?;
        missing.iter().try_for_each(|it| check_shape("missing", it.shape(), shape))?;
        let set_points = BorrowedSetPoints::new(position, set_points, shape)?;
        let set_points = set_points.views();
        let (motor, torque) = (motor_counts.as_array(), torque.as_array());
        let output = output_counts.as_ref().map(|it| it.as_array());
        let missing = missing.as_ref().map(|it| it.as_array());
        let mut columns = Column::of(QUANTITIES, record, [shape[0] / every, count])?;
        let mut recorders = columns::by_block(&mut columns, count.div_ceil(BLOCK));
        let controllers = &mut self.controllers;
        columns::in_bands(py, shape[0], count, PERIODS_PER_CHECK, |[begin, end]| {
            let blocks = controllers.par_chunks_mut(BLOCK).zip(recorders.par_iter_mut()).enumerate();
            blocks.for_each(|(block, (controllers, recorders))| {
                let joints = controllers.len();
                let output = output.as_ref().map(|it| block_of(it, block, joints));
                let missing = missing.as_ref().map(|it| block_of(it, block, joints));
                let samples = (block_of(&motor, block, joints), output, missing, block_of(&torque, block, joints));
                let set_points = set_points.block(block, joints);
                step_block(controllers, &samples, &set_points, preview, [begin, end, every], recorders);
            });
        })
    }
}

/// Steps the controllers of a block, one after the other.
fn step_block(
    controllers: &mut [ControllerOfJoint],
    (motor, output, missing, torque): &RecordedSamples<'_>,
    set_points: &SetPoints<'_>,
    preview: bool,
    [begin, end, every]: [usize; 3],
    recorders: &mut [Recorder<'_, Output>],
) {
    for (joint, controller) in controllers.iter_mut().enumerate() {
        let lead = preview.then_some(controller.lead);
        for row in begin..end {
            let at = [row, joint];
            let is_missing = missing.as_ref().is_some_and(|missing| missing[at]);
            // The controller stamps the time.
            let reading = |counts| Reading { counts, time: 0 };
            let output = output.as_ref().filter(|_| !is_missing).map(|counts| reading(counts[at]));
            let samples = Samples { time: 0, motor: reading(motor[at]), output, torque: torque[at] };
            let done = controller.step(&samples, &set_points.command(row, joint, lead));
            if (row + 1).is_multiple_of(every) {
                recorders.iter_mut().for_each(|recorder| recorder.write(row / every, joint, &done));
            }
        }
    }
}
