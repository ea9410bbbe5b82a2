//! Tables of joints, as `joint tables` writes them: plants and controllers in Python step over the words that a board
//! or a C program has in flash.

use std::sync::Arc;

use board::device::board::Board;
use c_library::tables::{make, nominal};
use model_core::controller::design::ControlRequest;
use model_core::gears::Kinematics;
use pyo3::prelude::*;
use rayon::prelude::*;
use report::failure::{Failure, Outcome};
use table_blob::{Blob, BlobError};

use crate::failure::result;
use crate::joint::Joint;
use crate::work;

/// Requirements on the tables.
#[derive(Debug, Clone, Copy)]
pub struct Request {
    /// Control rate [Hz].
    pub rate: u32,
    /// Requirements on the controller.
    pub control: ControlRequest,
    /// True for tables with a plant.
    pub plant: bool,
}

/// Tables of one joint.
#[derive(Debug, Clone)]
pub struct Tables {
    /// Words of the blob.
    pub words: Arc<[u64]>,
    /// Motor turns per turn of the link.
    pub ratio: f64,
}

/// Control rate: the given one, or that of the first joint file [Hz].
pub fn rate_of(joints: &[PyRef<'_, Joint>], rate: Option<u32>) -> u32 {
    rate.unwrap_or_else(|| joints[0].0.file.surroundings.control_rate)
}

/// Objects on the tables of each joint.
pub fn each<T>(py: Python<'_>, tables: &[Tables], make: impl Fn(&Tables) -> Result<T, BlobError>) -> PyResult<Vec<T>> {
    let made: Result<Vec<T>, BlobError> = tables.iter().map(make).collect();
    result(py, made.map_err(unusable))
}

/// Failure of tables that do not open; they were made here.
fn unusable(error: BlobError) -> Failure {
    Failure::new(format!("the tables cannot be used: {error:?}"))
}

/// Tables of `n` joints: one joint for all, or a joint each. Equal objects share their tables; distinct joints are
/// designed on all cores.
pub fn design(py: Python<'_>, joints: &[PyRef<'_, Joint>], n: usize, request: Request) -> PyResult<Vec<Tables>> {
    let mut distinct: Vec<(usize, joint_file::named::Loaded)> = Vec::new();
    let place = |distinct: &mut Vec<(usize, joint_file::named::Loaded)>, joint: &PyRef<'_, Joint>| {
        let object = joint.as_ptr().addr();
        distinct.iter().position(|(known, _)| *known == object).unwrap_or_else(|| {
            distinct.push((object, joint.0.clone()));
            distinct.len() - 1
        })
    };
    let places: Vec<usize> = joints.iter().map(|joint| place(&mut distinct, joint)).collect();
    let designed = work::run(py, move || {
        distinct.par_iter().map(|(_, loaded)| tables_of(loaded, request)).collect::<Outcome<Vec<Tables>>>()
    })?;
    Ok((0..n).map(|index| designed[places[index % places.len()]].clone()).collect())
}

/// Remedies for tables that cannot be designed; those of `joint tables` are options of the command line.
const HELP_OF_PLANT: &str = "`Joint.figures()` has the limits that follow from the file; pass another `rate=`";
const HELP_OF_CONTROLLER: &str =
    "`Joint.figures()` has the limits that follow from the file; pass another `rate=` or `bandwidth=`";

fn tables_of(loaded: &joint_file::named::Loaded, request: Request) -> Outcome<Tables> {
    let mut joint = loaded.file.clone();
    joint.surroundings.control_rate = request.rate;
    let made =
        make(&joint, &nominal(&joint, request.control), request.plant, &Board::emulated()).map_err(|failure| {
            let help = if request.plant { HELP_OF_PLANT } else { HELP_OF_CONTROLLER };
            failure.with_help(help).while_doing(format_args!("tables of {}", loaded.name))
        })?;
    let tables = Tables { words: made.words.into(), ratio: joint.parameters.geometry.ratio_by_teeth() };
    Blob::open(&tables.words).map_err(unusable)?;
    Ok(tables)
}
