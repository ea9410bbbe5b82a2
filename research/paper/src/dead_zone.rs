//! Figs 4 and 5: the sharp dead zone, eq. 13 as corrected and as printed, and the distance between them by sharpness. The functions used by
//! the model are the core's; the printed one exists only here.

use model_core::gears::dead_zone::{sharp, smoothed};

use super::record::{DeadZoneError, DeadZoneFigure, Smoothed};

/// Half-backlash over b_c: 60 um, Fig. 7.
const HALF_BACKLASH: f64 = 6.0;

/// Sharpnesses of the drawn curves: visibly round, slightly round, and the value recommended by the paper.
const DRAWN: [f64; 3] = [0.5, 2.0, 1000.0];

/// Sharpness recommended by the paper.
pub const PAPERS_SHARPNESS: f64 = 1000.0;

/// Points of a curve on either side of zero.
const HALF_POINTS: i32 = 600;

/// Eq. 13 exactly as printed: x + (1/2)(t1 - t2) - (b/2)(t1 + t2), the first bracket without its factor x.
pub fn printed(deflection: f64, half_backlash: f64, sharpness: f64) -> f64 {
    let above = (sharpness * (deflection - half_backlash)).tanh();
    let below = (sharpness * (deflection + half_backlash)).tanh();
    deflection + 0.5 * (above - below) - 0.5 * half_backlash * (above + below)
}

/// Data of the figure.
pub fn figure() -> DeadZoneFigure {
    let b = HALF_BACKLASH;
    let deflection: Vec<f64> =
        (-HALF_POINTS..=HALF_POINTS).map(|index| 2.0 * b * f64::from(index) / f64::from(HALF_POINTS)).collect();
    let curve = |f: &dyn Fn(f64) -> f64| deflection.iter().map(|x| f(*x)).collect::<Vec<f64>>();
    DeadZoneFigure {
        half_backlash: b,
        sharp: curve(&|x| sharp(x, b)),
        smoothed: DRAWN
            .iter()
            .map(|&sharpness| Smoothed { sharpness, force: curve(&|x| smoothed(x, b, sharpness)) })
            .collect(),
        printed: curve(&|x| printed(x, b, PAPERS_SHARPNESS)),
        errors: (-4..=16).map(|quarter| error(10f64.powf(f64::from(quarter) / 4.0))).collect(),
        deflection,
    }
}

fn error(sharpness: f64) -> DeadZoneError {
    let largest = |f: &dyn Fn(f64) -> f64| {
        // The corrected form has its largest error within a few widths 1/s of a corner, the printed one all over the gap.
        let near_corner = (-4000..=4000).map(|i| HALF_BACKLASH + f64::from(i) * 1e-3 / sharpness);
        let everywhere = (-1000..=1000).map(|i| f64::from(i) * 2e-3 * HALF_BACKLASH);
        near_corner.chain(everywhere).map(|x| (f(x) - sharp(x, HALF_BACKLASH)).abs()).fold(0.0, f64::max)
    };
    DeadZoneError {
        sharpness,
        corrected: largest(&|x| smoothed(x, HALF_BACKLASH, sharpness)),
        printed: largest(&|x| printed(x, HALF_BACKLASH, sharpness)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The error of the corrected form falls with sharpness, that of the printed one does not.
    #[test]
    fn only_corrected_form_converges() {
        let figure = figure();
        for error in figure.errors.iter().filter(|error| error.sharpness >= 2.0) {
            let scaled = error.sharpness * error.corrected;
            assert!((0.138..0.1405).contains(&scaled), "{scaled} at {}", error.sharpness);
            assert!(error.printed > 0.9, "{}", error.printed);
        }
        let centre = figure.deflection.len() / 2;
        assert_eq!(figure.deflection[centre], 0.0);
        assert_eq!(figure.printed[centre], -1.0, "as printed the gap carries a force");
        assert_eq!(figure.sharp[centre], 0.0);
    }
}
