//! Checks of the teeth: backlash and transmission error against the module, deflection and stress at rated torque,
//! damping.

use model_core::gears::Kinematics;
use parameters::{MESH_KINDS, MeshKind};

use super::judge::{Judge, Limits, UNLIMITED, figure};
use super::units;
use crate::contents::JointFile;

/// Backlash 2b over the module: worn and printed teeth reach 0.3; at 1.5 cos(20 deg) no tooth is left.
const BACKLASH_LIMITS: Limits = Limits::above(0.35, 1.4);
/// Amplitude of the transmission error over the module: 0.04 for the coarsest gears of ISO 1328.
const TRANSMISSION_ERROR_LIMITS: Limits = Limits::above(0.06, 0.5);
/// Least transmission error of real gears, except 0 [m].
const TRANSMISSION_ERROR_MIN: f64 = 2e-8;
/// Deflection of a mesh at rated torque over the module: 1e-4 to 5e-3 for teeth.
const DEFLECTION_LIMITS: Limits = Limits { odd: (2e-6, 0.06), possible: (1e-8, 0.5) };
/// Mean stiffness over a face width of ten sun radii [N/m^2]: steel teeth have 1.4e10 to 2e10 (ISO 6336-1).
const STIFFNESS_LIMITS: Limits = Limits::above(2e10, 2e11);
/// Stress of a tooth, three times its force over module and a face width of ten sun radii [Pa]; no material carries
/// 1e9.
const STRESS_LIMITS: Limits = Limits::above(3e8, 1e9);
/// Damping ratio of a mesh: above the range it hardly rings, below it no material damps so little; 0 disables damping.
const DAMPING_LIMITS: Limits = Limits { odd: (5e-4, 0.35), possible: (0.0, 1.0) };

pub(super) fn check(file: &JointFile, judge: &Judge<'_>) {
    let geometry = &file.parameters.geometry;
    let pitch_radius = geometry.sun_base_radius / geometry.working_pressure_angle.cos();
    let module = 2.0 * pitch_radius / f64::from(geometry.sun_teeth);
    let widest = 10.0 * pitch_radius;
    let force = file.parameters.rated_output_torque / (2.0 * geometry.planets as f64 * geometry.carrier_base_radius());
    for kind in MESH_KINDS {
        let mesh = file.parameters.mesh(kind);
        let of = |name: &str| keys(kind, name);

        let backlash = 2.0 * mesh.half_backlash.iter().copied().fold(0.0, f64::max);
        let named = [of("half_backlash_um"), of("backlash_um"), of("lost_motion_arcmin")].concat();
        let named: Vec<&str> = named.iter().map(String::as_str).collect();
        judge.check_figure(&named, backlash / module, BACKLASH_LIMITS, |_, key| {
            let message = format!(
                "`{key}`: a backlash 2b of {} mm is {} of the module of {} mm; {} of it leaves no tooth",
                figure(1e3 * backlash),
                figure(backlash / module),
                figure(1e3 * module),
                figure(BACKLASH_LIMITS.possible.1)
            );
            let help = match key {
                "lost_motion_arcmin" => {
                    "gears have 2b of 0.03 to 0.15 of the module; it is in arcmin: 1 deg is 60 arcmin"
                }
                _ => "gears have 2b of 0.03 to 0.15 of the module; b is half of the backlash; 40 um are 0.04 mm",
            };
            (message, help.into())
        });

        let error = mesh.transmission_error.iter().map(|error| error.abs()).fold(0.0, f64::max);
        let named = of("transmission_error_um");
        let named: Vec<&str> = named.iter().map(String::as_str).collect();
        judge.check_figure(&named, error / module, TRANSMISSION_ERROR_LIMITS, |_, key| {
            let message = format!(
                "`{key}`: an amplitude of {} mm is {} of the module of {} mm",
                figure(1e3 * error),
                figure(error / module),
                figure(1e3 * module)
            );
            (message, "gears have 0.001 to 0.02 of the module; it is in um: 3 um are 0.003 mm".into())
        });
        if error > 0.0 {
            judge.check_figure(
                &named,
                error,
                Limits { odd: (TRANSMISSION_ERROR_MIN, UNLIMITED), possible: (0.0, UNLIMITED) },
                |_, key| {
                    let message =
                        format!("`{key}`: an amplitude of {} um is finer than any gear's", figure(1e6 * error));
                    (
                        message,
                        format!("likely typed in mm: {0} mm are {0}e3 um; 0 if there is none", figure(1e6 * error)),
                    )
                },
            );
        }
        if backlash > 0.0 {
            judge.check_figure(&named, error / backlash, Limits::above(4.0, UNLIMITED), |_, key| {
                let message = format!(
                    "`{key}`: an amplitude of {} um exceeds a backlash 2b of {} um as the gears turn",
                    figure(1e6 * error),
                    figure(1e6 * backlash)
                );
                (
                    message,
                    "one of the two is off: the error is half of its peak to peak, b is half of the backlash".into(),
                )
            });
        }

        let stiffness = mesh.mean_stiffness;
        let named = of("mean_stiffness_N_per_m");
        let named: Vec<&str> = named.iter().map(String::as_str).collect();
        let bent = force / stiffness;
        // A tiny rated torque deflects nothing; the stiffness then has its own check.
        let deflection = Limits { odd: (0.0, DEFLECTION_LIMITS.odd.1), possible: (0.0, DEFLECTION_LIMITS.possible.1) };
        judge.check_figure(&named, bent / module, deflection, |_, key| {
            let message = format!(
                "`{key}`: at rated torque the teeth give by {} mm, and the module is {} mm",
                figure(1e3 * bent),
                figure(1e3 * module)
            );
            (message, units::likely(units::MESH_STIFFNESS_SLIPS, stiffness, bent / module, -1, (1e-5, 0.02), "N/m"))
        });
        judge.check_figure(&named, stiffness / widest, STIFFNESS_LIMITS, |_, key| {
            let message = format!(
                "`{key}`: steel teeth have 2e10 N/m for each metre of face width; {} N/m would need {} mm on a sun of \
                 {} mm pitch radius",
                figure(stiffness),
                figure(1e3 * stiffness / STIFFNESS_LIMITS.odd.1),
                figure(1e3 * pitch_radius)
            );
            (message, units::likely(units::MESH_STIFFNESS_SLIPS, stiffness, stiffness / widest, 1, (1e8, 1e10), "N/m"))
        });

        let named = of("damping_ratio");
        let named: Vec<&str> = named.iter().map(String::as_str).collect();
        if mesh.damping_ratio > 0.0 {
            judge.check_figure(&named, mesh.damping_ratio, DAMPING_LIMITS, |too_much, key| {
                let what = if too_much { "teeth that hardly ring" } else { "teeth that ring almost undamped" };
                let message = format!("`{key}` of [mesh] = {}: {what}", mesh.damping_ratio);
                (message, "0.03 to 0.1 is usual of gear meshes: 5 % is 0.05; 0 for no damping".into())
            });
        }
    }
    let stress = 3.0 * force / (module * widest);
    judge.check_figure(&["rated_output_torque_N_m", "geometry.module_mm"], stress, STRESS_LIMITS, |_, key| {
        let message = format!(
            "`{key}` = {}: {} N on a tooth of module {} mm, more than steel carries at any face width",
            figure(file.parameters.rated_output_torque),
            figure(force),
            figure(1e3 * module)
        );
        let torque = file.parameters.rated_output_torque;
        (message, units::likely(units::TORQUE_SLIPS, torque, stress, 1, (1e5, 3e8), "N m"))
    });
}

/// Key of the meshes of one kind, in the places where the file may state it.
fn keys(kind: MeshKind, name: &str) -> Vec<String> {
    let family = match kind {
        MeshKind::SunPlanet => "mesh.sun_planet",
        MeshKind::RingPlanet => "mesh.ring_planet",
    };
    vec![format!("{family}.{name}"), format!("mesh.{name}")]
}
