//! Designs the tables of `my_joint.toml` in double precision and writes them as a constant.

use std::error::Error;
use std::path::Path;
use std::{env, fs};

use model_core::controller::design::{ControlRequest, NominalPlant};
use model_core::gears::design::Processor;
use table_blob::{Wanted, design};

fn main() -> Result<(), Box<dyn Error>> {
    println!("cargo::rerun-if-changed=my_joint.toml");
    let joint = joint_file::read(&fs::read_to_string("my_joint.toml")?)?;
    let (parameters, surroundings) = (&joint.parameters, &joint.surroundings);
    let request = ControlRequest::USUAL;
    let words = design(&Wanted {
        plant: Some((parameters, surroundings)), // `None` on a board with a real joint
        nominal: NominalPlant { joint: parameters, surroundings, request },
        processor: Processor::STM32F405,
    })?;
    let out = Path::new(&env::var("OUT_DIR")?).join("my_joint.rs");
    fs::write(out, format!("pub static MY_JOINT: [u64; {}] = {words:?};\n", words.len()))?;
    Ok(())
}
