//! Compares sizes of images with those from which `joint board check` predicts, `images` in `host/board-file/src/chip`.

use board::device::board::Chip;
use board::device::image::Image;
use report::failure::{Failure, Outcome};

/// Relative tolerance of a size; boards and compilers differ by at most 2 % (measured on the presets).
const TOLERANCE: f64 = 0.05;

/// Fails if the size of an image differs from its chip's entry for the role, as named by `--role`.
pub fn check(chip: Chip, role: &str, image: &Image) -> Outcome<()> {
    let Some(known) = chip.image_size(role) else { return Ok(()) };
    let found = [image.flash_bytes, image.ram_bytes];
    let differs = |(known, found): (u32, u64)| (found as f64 / f64::from(known) - 1.0).abs() > TOLERANCE;
    if ![(known.flash, found[0]), (known.ram, found[1])].into_iter().any(differs) {
        return Ok(());
    }
    let [flash, ram] = found;
    let chip = chip.name();
    Err(Failure::check_failed(format!(
        "image of role {role} for {chip}: {flash} B of flash and {ram} B of RAM, but {} B and {} B are predicted",
        known.flash, known.ram
    ))
    .with_help(format!("enter these sizes into `images` of {chip} in host/board-file/src/chip")))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A size 10 % off its entry fails, one 2 % off does not.
    #[test]
    fn wrong_size_prediction_found() {
        let chip = Chip::ALL[0];
        let known = chip.image_size("plant").expect("it was linked");
        let image = |flash_bytes: u64| Image {
            elf: "plant.elf".into(),
            sha256: String::new(),
            flash_bytes,
            ram_bytes: known.ram.into(),
            compiler: String::new(),
            flags: String::new(),
        };
        let flash = u64::from(known.flash);
        check(chip, "plant", &image(flash + flash / 50)).expect("as predicted");
        let failure = check(chip, "plant", &image(flash + flash / 10)).expect_err("a tenth more");
        assert!(failure.message().contains("predicted"), "{failure}");
        assert_eq!(failure.exit_code(), 1);
        check(chip, "no such role", &image(1)).expect("nothing is predicted");
    }
}
