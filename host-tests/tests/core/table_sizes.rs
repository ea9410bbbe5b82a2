//! Flash used by the tables of a joint. RAM is measured in a run: see `joint hil`.

use model_core::gears::Tables;

/// Bytes in a KiB.
const KIB: usize = 1024;

/// Tables of 3, 4 and 5 planets take at most 16, 32 and 64 KiB.
#[test]
fn tables_fit_their_flash_budget() {
    let sizes = [size_of::<Tables<f32, 3>>(), size_of::<Tables<f32, 4>>(), size_of::<Tables<f32, 5>>()];
    println!("tables of 3, 4 and 5 planets: {sizes:?} B");
    assert!(sizes[0] <= 16 * KIB && sizes[1] <= 32 * KIB && sizes[2] <= 64 * KIB, "{sizes:?}");
}
