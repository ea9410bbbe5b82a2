//! Work of a build script: it reads a joint file and prints the tables of the fixed step as Rust source, with their certificate in front;
//! `joint budget` measures their error. A mistake in the file is reported with its place underlined.
//!
//! `cargo run -p examples --example design_and_print_tables -- joints/q1.toml 20000 > tables.rs`

use std::env;
use std::error::Error;
use std::path::Path;
use std::process;

use joint_file::named;
use model_core::gears::design::{Effort, Processor, certificate, rust_source};
use model_core::gears::{Kinematics, Scales};

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = env::args().skip(1);
    let file = arguments.next().unwrap_or("q1".into());
    let tick_rate_hz: u32 = arguments.next().map_or(Ok(20_000), |typed| typed.parse())?;
    let loaded = named::load(Path::new(&file)).unwrap_or_else(|failure| {
        failure.show();
        process::exit(failure.exit_code().into())
    });
    let joint = loaded.file.parameters;

    let processor = Processor::STM32F405;
    let promise = certificate(&joint, tick_rate_hz, Effort::Within(processor))?;
    let scales = Scales::new(&joint);
    let lost_motion_mrad = 2e3 * joint.sun_planet.half_backlash[0] / joint.geometry.carrier_base_radius();
    println!("// {} at {tick_rate_hz} Hz on an STM32F405", joint.name);
    println!("// ratio {}, lost motion {lost_motion_mrad:.2} mrad", joint.geometry.ratio_by_teeth());
    println!("// omega_n {:.0} rad/s, {} in a tick", scales.frequency, promise.substeps);
    println!("// at most {} instructions a tick", promise.instructions.bound);
    println!("// {} bytes of flash, {} bytes of RAM", promise.table_bytes, promise.model_bytes);
    println!("// stable from {} Hz on\n", promise.lowest_rate);
    print!("{}", rust_source(&joint, tick_rate_hz)?);
    Ok(())
}
