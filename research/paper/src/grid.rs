//! Lists and grids of half-backlash on the command line: `0,10,60,120` and `0:150:0.5`, in micrometres.

use report::failure::{Failure, Outcome};

/// Largest number of points of a diagram, limited by time and by the picture's resolution.
const POINTS_MAX: f64 = 20_000.0;

/// Largest number of attractors in a report.
const VALUES_MAX: usize = 24;

/// Largest half-backlash of any gear [um].
const HALF_BACKLASH_MAX: f64 = 10_000.0;

/// Micrometres in a metre: dividing by it gives the number nearest to the text, multiplying by 1e-6 would not.
const MICROMETRES: f64 = 1e6;

/// Reads `0,10,60,120` [um] in metres.
pub fn list(text: &str) -> Outcome<Vec<f64>> {
    let failed = |what: String| {
        Failure::new(format!("--b {text}: {what}"))
            .with_help("write values of half-backlash in um, such as --b 0,10,60,120")
    };
    let values: Vec<f64> =
        text.split(',').map(|part| value(part).map(|b| b / MICROMETRES).map_err(failed)).collect::<Outcome<_>>()?;
    if values.len() > VALUES_MAX {
        return Err(failed(format!("{} values; a report holds at most {VALUES_MAX}", values.len())));
    }
    Ok(values)
}

/// Reads `0:150:0.5` [um] in metres, both ends included.
pub fn grid(text: &str) -> Outcome<Vec<f64>> {
    let failed = |what: String| {
        let help = "write from:to:step of half-backlash in um, such as --grid 0:150:0.5";
        Failure::new(format!("--grid {text}: {what}")).with_help(help)
    };
    let parts: Vec<&str> = text.split(':').collect();
    let [from, to, step] = parts[..] else { return Err(failed("not of the form from:to:step".to_owned())) };
    let [from, to, step] = [value(from).map_err(failed)?, value(to).map_err(failed)?, value(step).map_err(failed)?];
    if step == 0.0 || to < from {
        return Err(failed("it contains no point".to_owned()));
    }
    // The margin keeps the last point of a step that divides the range in decimals.
    let steps = ((to - from) / step + 1e-9).floor();
    if steps + 1.0 > POINTS_MAX {
        return Err(failed(format!("{:.0} points; at most {POINTS_MAX} can be shown", steps + 1.0)));
    }
    Ok((0..=steps as u32).map(|index| (from + f64::from(index) * step) / MICROMETRES).collect())
}

/// One value in micrometres.
fn value(text: &str) -> Result<f64, String> {
    match text.trim().parse::<f64>() {
        Ok(value) if value.is_finite() && value < 0.0 => Err(format!("`{}` is negative", text.trim())),
        Ok(value) if value <= HALF_BACKLASH_MAX => Ok(value),
        Ok(value) if value > HALF_BACKLASH_MAX => {
            Err(format!("`{}` um is above the limit of {HALF_BACKLASH_MAX} um", text.trim()))
        }
        _ => Err(format!("`{}` is not a number", text.trim())),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A grid includes both ends.
    #[test]
    fn grid_includes_both_ends() {
        let grid = grid("0:150:0.5").expect("a good grid");
        assert_eq!(grid.len(), 301);
        assert!((grid[300] - 150e-6).abs() < 1e-15);
        assert_eq!(super::grid("60:60:1").expect("one point").len(), 1);
    }

    /// Invalid grids are rejected with a remedy.
    #[test]
    fn invalid_grid_is_rejected() {
        for text in
            ["0:150:0", "150:0:1", "0:150:-1", "0:150", "0:150:0.5:1", "a:b:c", "0:150:1e-9", "0:nan:1", "0:1e9:1"]
        {
            let failure = grid(text).expect_err(text);
            assert!(failure.message().contains(text) && failure.help().is_some(), "{failure}");
            assert_eq!(failure.exit_code(), 2);
        }
        assert!(grid("0:150:0.000001").expect_err("too many").message().contains("150000001 points"));
    }

    /// Invalid lists are rejected with a remedy.
    #[test]
    fn invalid_list_is_rejected() {
        assert_eq!(list("0, 10,60").expect("a good list").len(), 3);
        for text in ["", "1,,2", "-1", "inf", "1;2", &["1"; 25].join(",")] {
            assert!(list(text).expect_err(text).help().is_some());
        }
    }
}
