//! Likely unit of a mistyped value: another unit than the key's that makes the value usual.

use super::judge::figure;

/// Unit of a mistyped value: factor to the key's unit, and improbability of the mistake, as a logarithm.
pub(super) struct Slip {
    pub unit: &'static str,
    pub factor: f64,
    pub improbability: f64,
}

const fn slip(unit: &'static str, factor: f64, improbability: f64) -> Slip {
    Slip { unit, factor, improbability }
}

/// Slips of torsional stiffness, from N m/rad, as in data sheets and drawings.
pub(super) const STIFFNESS_SLIPS: &[Slip] = &[
    slip("N m/arcmin", 3437.75, 0.0),
    slip("N m/deg", 57.295_78, 0.5),
    slip("kN m/rad", 1e3, 0.5),
    slip("1e4 N m/rad", 1e4, 1.0),
    slip("N m/turn, over 2 pi", 1.0 / std::f64::consts::TAU, 2.0),
    slip("turns, times 2 pi", std::f64::consts::TAU, 2.0),
    slip("N mm/rad", 1e-3, 0.5),
    slip("N m/rad times 57.3 once too often", 1.0 / 57.295_78, 1.0),
    slip("N m/rad times 3437.75 once too often", 1.0 / 3437.75, 1.0),
    slip("N m/rad times 1e4 once too often", 1e-4, 1.5),
];

/// Names the one or two units that bring a figure nearest to the middle of `usual`: the factor acts on the value, and
/// the figure goes with its `power`. Without one, names the key's unit.
pub(super) fn likely(slips: &[Slip], value: f64, judged: f64, power: i32, usual: (f64, f64), key_unit: &str) -> String {
    let middle = (usual.0 * usual.1).sqrt();
    let score = |slip: &&Slip| (judged * slip.factor.powi(power) / middle).ln().abs() + slip.improbability;
    let fits = slips.iter().filter(|slip| {
        let figure = judged * slip.factor.powi(power);
        usual.0 <= figure && figure <= usual.1
    });
    let mut fits: Vec<&Slip> = fits.collect();
    fits.sort_by(|one, other| score(one).total_cmp(&score(other)));
    let describe = |slip: &&Slip| {
        format!("typed in {}: {} of it are {} {key_unit}", slip.unit, figure(value), figure(value * slip.factor))
    };
    match fits.iter().take(2).map(describe).collect::<Vec<_>>()[..] {
        [] => format!("give it in {key_unit}"),
        [ref one] => format!("likely {one}"),
        [ref one, ref other, ..] => format!("likely {one}; or {other}"),
    }
}

/// Slips of masses.
pub(super) const MASS_SLIPS: &[Slip] = &[slip("g", 1e-3, 0.0), slip("t", 1e3, 1.0)];

/// Slips of moments of inertia.
pub(super) const INERTIA_SLIPS: &[Slip] = &[
    slip("kg cm^2", 1e-4, 0.0),
    slip("g cm^2", 1e-7, 0.0),
    slip("g m^2", 1e-3, 0.5),
    slip("kg mm^2", 1e-6, 0.2),
    slip("kg m^2 times 1e-4 once too often", 1e4, 0.5),
    slip("kg m^2 times 1e-3 once too often", 1e3, 0.5),
];

/// Slips of moments of inertia at the input, in kg cm^2.
pub(super) const INERTIA_AT_INPUT_SLIPS: &[Slip] = &[
    slip("g cm^2", 1e-3, 0.0),
    slip("g mm^2", 1e-5, 0.2),
    slip("kg mm^2", 1e-2, 0.2),
    slip("kg m^2", 1e4, 0.0),
    slip("g m^2", 10.0, 1.0),
];

/// Slips of torques.
pub(super) const TORQUE_SLIPS: &[Slip] =
    &[slip("mN m", 1e-3, 0.0), slip("N cm", 1e-2, 0.2), slip("kN m", 1e3, 0.2), slip("N mm once too often", 1e3, 0.5)];

/// Slips of stiffness along the line of action.
pub(super) const MESH_STIFFNESS_SLIPS: &[Slip] =
    &[slip("N/mm", 1e3, 0.0), slip("N/um", 1e6, 0.0), slip("kN/m", 1e3, 1.0), slip("mN/m", 1e-3, 0.5)];
