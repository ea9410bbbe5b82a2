//! Result of `joint check` as text: one line for each figure, in the units of data sheets, without colours, so that
//! terminal, file and log are equal.

use std::fmt::Write;

use super::summary::{CheckSummary, EquivalentFigures, GeometryFigures, Masses, MeshFigures};
use joint_file::sheet;
use report::document::{Sheet, terminal};
use report::number::DATA_SHEET;

/// Result for a terminal.
pub fn layout(summary: &CheckSummary) -> String {
    let mut page = Sheet::new(match summary.description.as_str() {
        "" => summary.name.clone(),
        description => format!("{}: {description}", summary.name),
    });
    if let Some(gear) = &summary.equivalent_gear {
        equivalent(&mut page, gear);
    }
    if let Some(geometry) = &summary.geometry {
        gears(&mut page, geometry);
    }
    if let Some(bodies) = &summary.equivalent_masses {
        masses(&mut page, bodies);
    }
    frequencies(&mut page, summary);
    meshes(&mut page, summary);
    output(&mut page, summary);
    if let Some(bandwidth) = &summary.bandwidth {
        bandwidth.rows(&mut page);
    }
    step(&mut page, summary);
    file(&mut page, summary);
    terminal(&page.document())
}

fn equivalent(page: &mut Sheet, gear: &EquivalentFigures) {
    page.heading("Equivalent gear, without teeth");
    page.row("ratio", format!("{:.6} = {} / {} turns", gear.ratio, gear.motor_turns, gear.link_turns));
    let stiffness = gear.stiffness_N_m_per_rad;
    let per_arcmin = stiffness * sheet::ARCMIN;
    page.row("stiffness", format!("{} N m/rad = {} N m/arcmin", digits(stiffness), digits(per_arcmin)));
    let (ratio, damping) = (gear.damping_ratio, gear.damping_N_m_s_per_rad);
    page.row("damping", format!("ratio {}, {} N m s/rad", digits(ratio), digits(damping)));
    page.row("inertia of the gear, at the motor", format!("{} kg m^2", digits(gear.gear_inertia_at_input_kg_m2)));
    let (own, at_link) = (gear.motor_inertia_kg_m2, gear.motor_inertia_at_link_kg_m2);
    page.row("rotor and gear", format!("{} kg m^2, {} kg m^2 at the link", digits(own), digits(at_link)));
    page.row("link", format!("{} kg m^2", digits(gear.link_inertia_kg_m2)));
    page.row("not in it", "preload and hysteresis, as harmonic drives have; errors of teeth");
}

fn gears(page: &mut Sheet, geometry: &GeometryFigures) {
    page.heading("Gears");
    page.row("planets", geometry.planets);
    let teeth = [geometry.sun_teeth, geometry.planet_teeth, geometry.ring_teeth];
    page.row("teeth sun, planet, ring", format!("{}, {}, {}", teeth[0], teeth[1], teeth[2]));
    page.row("working pressure angle", format!("{:.4} deg", geometry.working_pressure_angle_deg));
    let radii = [geometry.sun_base_radius_m, geometry.planet_base_radius_m].map(|radius| 1e3 * radius);
    page.row("base radii sun, planet", format!("{:.4}, {:.4} mm", radii[0], radii[1]));
    page.row("carrier radius r_c", format!("{:.4} mm", 1e3 * geometry.carrier_radius_m));
    page.row("lever r_c cos(alpha)", format!("{:.4} mm", 1e3 * geometry.carrier_base_radius_m));
    page.row("ratio by teeth", format!("{:.6}", geometry.ratio_by_teeth));
    page.row("ratio by radii", format!("{:.6}", geometry.ratio_by_radii));
}

fn masses(page: &mut Sheet, masses: &Masses) {
    page.heading("Equivalent masses, I / r^2 on the line of action");
    page.row("sun", format!("{} kg", digits(masses.sun_kg)));
    page.row("sun with rotor", format!("{} kg", digits(masses.sun_with_rotor_kg)));
    page.row("planet", format!("{} kg", digits(masses.planet_kg)));
    page.row("carrier with planets, M_c", format!("{} kg", digits(masses.carrier_with_planets_kg)));
    page.row("link", if masses.link_kg > 0.0 { format!("{} kg", digits(masses.link_kg)) } else { "none".to_owned() });
}

fn frequencies(page: &mut Sheet, summary: &CheckSummary) {
    let frequencies = &summary.frequencies;
    page.heading("Frequencies, in contact at mean stiffness");
    let omega_n = (frequencies.omega_n_rad_per_s, frequencies.omega_n_Hz);
    let with_teeth = summary.equivalent_gear.is_none();
    page.row(
        if with_teeth { "omega_n (eq. 18)" } else { "omega_n, motor against link" },
        format!("{:.1} rad/s = {:.2} Hz", omega_n.0, omega_n.1),
    );
    if with_teeth {
        page.row("gears alone", hertz(&frequencies.gears_alone_Hz));
    }
    page.row("with rotor and link", hertz(&frequencies.whole_joint_Hz));
}

fn meshes(page: &mut Sheet, summary: &CheckSummary) {
    for mesh in &summary.meshes {
        page.heading(if mesh.kind == "sun_planet" { "Sun-planet meshes" } else { "Ring-planet meshes" });
        page.row("half-backlash b (backlash is 2b)", format!("{} um", per_planet(&mesh.half_backlash_m, 1e6, 3)));
        page.row("mean stiffness", format!("{:.4e} N/m", mesh.mean_stiffness_N_per_m));
        page.row("damping", format!("{} N s/m", digits(mesh.damping_N_s_per_m)));
        page.row(
            "deflection at rated torque",
            format!("{} um beyond b", digits(1e6 * mesh.deflection_at_rated_torque_m)),
        );
        phases(page, mesh);
    }
    page.row("damping law", summary.damping_law);
}

fn phases(page: &mut Sheet, mesh: &MeshFigures) {
    let [stiffness, error] =
        [&mesh.stiffness_phase_periods, &mesh.error_phase_periods].map(|list| per_planet(list, 1.0, 4));
    if stiffness == error {
        page.row("mesh phases", format!("{stiffness} of a period"));
    } else {
        page.row("phases of stiffness", format!("{stiffness} of a period"));
        page.row("phases of error", format!("{error} of a period"));
    }
}

fn output(page: &mut Sheet, summary: &CheckSummary) {
    let output = &summary.output;
    page.heading("At the output");
    let torques = (output.rated_torque_N_m, output.balancing_drive_torque_N_m);
    let input = if summary.equivalent_gear.is_some() { "motor" } else { "sun" };
    page.row("rated torque", format!("{} N m, {} N m at the {input}", digits(torques.0), digits(torques.1)));
    if let Some(force) = output.mesh_force_N {
        page.row("force of one mesh", format!("{} N", digits(force)));
        page.row("gap coordinate, 4b", format!("{} um", digits(1e6 * output.gap_m)));
    }
    page.row("lost motion", angle(output.lost_motion_rad, output.lost_motion_arcmin));
    page.row(&format!("lost motion at the {input}"), format!("{:.3} mrad", 1e3 * output.lost_motion_at_sun_rad));
    page.row("wind-up at rated torque", angle(output.wind_up_rad, output.wind_up_arcmin));
    if summary.equivalent_gear.is_none() {
        let parts = [output.wind_up_of_teeth_rad, output.wind_up_of_compliance_rad].map(|part| 1e3 * part);
        page.row("  teeth, compliance", format!("{:.4}, {:.4} mrad", parts[0], parts[1]));
    }
    if output.self_locking {
        page.row("self-locking", "the efficiency is below 0.5: torque at the link alone does not turn the motor");
    }
}

fn step(page: &mut Sheet, summary: &CheckSummary) {
    let step = &summary.fixed_step;
    page.heading(&format!("Fixed step on {}", step.board));
    let longest = 1e6 * step.longest_step_s;
    page.row("longest stable step", format!("{longest:.1} us ({} Hz)", step.lowest_rate_Hz));
    let recommended = 1e6 * step.recommended_step_s;
    page.row("recommended step, at most", format!("{recommended:.1} us ({} Hz)", step.recommended_rate_Hz));
    page.row("step asked for", format!("{:.1} us ({} Hz)", 1e6 / f64::from(step.rate_Hz), step.rate_Hz));
    let phase = step.fastest_mode_phase_rad;
    let (substeps, method) = (step.substeps, step.method);
    page.row("at contact changes", format!("{substeps} {method} sub-steps, {phase:.2} rad of the fastest mode each"));
    page.row("tables", format!("{} bytes of flash, digest {}", step.table_bytes, step.digest));
    if let Some(verdicts) = &step.verdicts {
        verdicts.rows(page);
    }
}

fn file(page: &mut Sheet, summary: &CheckSummary) {
    let numbers = &summary.numbers;
    page.heading("Joint file");
    let mut text = format!("{}, {} of them assumed", numbers.stated, numbers.assumed);
    if numbers.without_source > 0 {
        let _ = write!(text, ", {} without a source", numbers.without_source);
    }
    page.row("numbers", text);
    if summary.warnings.is_empty() {
        page.row("warnings", "none");
    }
    for warning in &summary.warnings {
        page.row(&format!("warning, line {}", warning.line), &warning.message);
        page.row("", format!("remedy: {}", warning.help));
    }
}

fn angle(radians: f64, arcmin: f64) -> String {
    format!("{:.4} mrad = {arcmin:.3} arcmin", 1e3 * radians)
}

/// Frequencies as text, with equal neighbours counted: "2881.84 (2x)".
fn hertz(frequencies: &[f64]) -> String {
    let shown: Vec<String> = frequencies.iter().map(|frequency| format!("{frequency:.2}")).collect();
    let groups = shown.chunk_by(|one, other| one == other);
    let texts: Vec<String> = groups
        .map(|group| if group.len() > 1 { format!("{} ({}x)", group[0], group.len()) } else { group[0].clone() })
        .collect();
    texts.join(", ") + " Hz"
}

/// One value if all are equal, else all values.
fn per_planet(values: &[f64], factor: f64, decimals: usize) -> String {
    let shown: Vec<String> = values.iter().map(|value| format!("{:.decimals$}", factor * value)).collect();
    match shown.first() {
        Some(first) if shown.iter().all(|value| value == first) => first.clone(),
        _ => shown.join(", "),
    }
}

fn digits(value: f64) -> String {
    DATA_SHEET.write(value)
}
