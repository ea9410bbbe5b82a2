//! The figures of a run as text for a terminal. Nothing is computed here but units.

use std::fmt::Write as _;

use super::figures::Figures;
use super::scheme::SchemeName;

/// The summary, ending with a newline.
pub fn summary(figures: &Figures) -> String {
    let mut text = String::new();
    // Writing to a string cannot fail.
    let _ = write_head(&mut text, figures);
    let _ = write_meshes(&mut text, figures);
    let _ = write_motion(&mut text, figures);
    let _ = write_schemes(&mut text, figures);
    text
}

fn write_head(text: &mut String, figures: &Figures) -> std::fmt::Result {
    let rate = f64::from(figures.tick_rate_Hz);
    writeln!(
        text,
        "{} by scheme {} ({}): {} of {} ticks at {} Hz, {:.4} s; {}, from {}",
        figures.joint,
        figures.scheme,
        figures.scalar,
        figures.ticks,
        figures.of_ticks,
        figures.tick_rate_Hz,
        f64::from(figures.ticks) / rate,
        figures.torques,
        figures.start
    )?;
    if let Some(time) = figures.diverged_at_s {
        writeln!(text, "DIVERGED at {time:.6} s: at this rate the scheme does not hold this motion")?;
    }
    writeln!(text, "figures are counted from {:.4} s on", figures.settle_s)
}

fn write_meshes(text: &mut String, figures: &Figures) -> std::fmt::Result {
    writeln!(
        text,
        "\n{:<14} {:>8} {:>8} {:>8} {:>10} {:>10} {:>10} {:>11}",
        "mesh", "drive", "parted", "back", "impacts", "rms", "p-p", "peak force"
    )?;
    for mesh in &figures.meshes {
        let one = &mesh.figures;
        writeln!(
            text,
            "{:<14} {:>6.2} % {:>6.2} % {:>6.2} % {:>8.1}/s {:>7.3} um {:>7.3} um {:>9.1} N",
            mesh.name,
            100.0 * one.drive_side_share,
            100.0 * one.separated_share,
            100.0 * one.back_side_share,
            one.impacts_per_s,
            1e6 * one.deflection_rms_m,
            1e6 * one.deflection_peak_to_peak_m,
            one.peak_force_N
        )?;
    }
    Ok(())
}

fn write_motion(text: &mut String, figures: &Figures) -> std::fmt::Result {
    writeln!(text)?;
    match figures.period {
        Some(1) => writeln!(text, "period           1 mesh period")?,
        Some(period) => writeln!(text, "period           {period} mesh periods")?,
        None => writeln!(text, "period           none within 32 mesh periods")?,
    }
    if let Some(ratio) = figures.non_fundamental_over_fundamental {
        writeln!(text, "spectrum         beside the mesh frequency: {ratio:.4} of what is at it")?;
    }
    if let Some(energy) = &figures.energy {
        writeln!(
            text,
            "energy           residual {:.3e} J, {:.2e} of the {:.3e} J dissipated",
            energy.residual_J, energy.residual_over_dissipated, energy.dissipated_J
        )?;
    }
    Ok(())
}

fn write_schemes(text: &mut String, figures: &Figures) -> std::fmt::Result {
    let (Some(schemes), Some(until)) = (&figures.schemes, figures.compared_until_s) else { return Ok(()) };
    writeln!(
        text,
        "\nerror against the reference, RMS over the motion's standard deviation, up to {until:.4} s where the motion\n\
         can be predicted; cost is processor time for a simulated second, over that of `{}`\n",
        SchemeName::Realtime.name()
    )?;
    writeln!(
        text,
        "{:<10} {:>12} {:>12} {:>12} {:>9} {:>10}",
        "scheme", "deflections", "gap", "link offset", "cost", "sub-steps"
    )?;
    for row in schemes {
        let errors = row.errors.map(|error| match error {
            _ if row.scheme == SchemeName::Reference.name() => "-".to_owned(),
            Some(error) => format!("{error:.2e}"),
            None => "diverged".to_owned(),
        });
        let substeps = row.substeps.map_or_else(|| "its own".to_owned(), |count| count.to_string());
        writeln!(
            text,
            "{:<10} {:>12} {:>12} {:>12} {:>9.2} {:>10}",
            row.scheme, errors[0], errors[1], errors[2], row.cost_ratio, substeps
        )?;
    }
    Ok(())
}
