//! Random joints as joint files: each is read back unchanged. They are drawn more widely than joints are built, with inconsistent masses,
//! so the files set `coherence = "warn"`.

use joint_file::Severity;
use parameters::{DampingLaw, DeadZone, Excitation, JointParameters, Mesh, MeshPhases, PerPlanet, StiffnessWave};
use proptest::prelude::*;

use crate::random::{config, joint};

fn list(values: &PerPlanet, scale: f64) -> String {
    format!("{:?}", values.iter().map(|value| value * scale).collect::<Vec<f64>>())
}

fn mesh(name: &str, mesh: &Mesh) -> String {
    let wave = match mesh.stiffness_wave {
        StiffnessWave::Harmonic { stiffness_ratio } => format!("stiffness_ratio = {stiffness_ratio:e}"),
        StiffnessWave::Rectangular { stiffness_ratio, contact_ratio, order } => format!(
            "stiffness_wave = \"rectangular\"\nstiffness_ratio = {stiffness_ratio:e}\ncontact_ratio = {contact_ratio}\n\
             order = {order}"
        ),
    };
    let phases = match &mesh.phases {
        MeshPhases::Given { stiffness, error } => [list(stiffness, 1.0), list(error, 1.0)],
        MeshPhases::FromTeeth { stiffness, error } => [format!("{stiffness:?}"), format!("{error:?}")],
    };
    format!(
        "[mesh.{name}]\nmean_stiffness_N_per_m = {:e}\n{wave}\ndamping_ratio = {:e}\nhalf_backlash_um = {}\n\
         transmission_error_um = {}\nstiffness_phase_rad = {}\nerror_phase_rad = {}\n",
        mesh.mean_stiffness,
        mesh.damping_ratio,
        list(&mesh.half_backlash, 1e6),
        list(&mesh.transmission_error, 1e6),
        phases[0],
        phases[1]
    )
}

fn file(joint: &JointParameters) -> String {
    let (geometry, bodies) = (&joint.geometry, &joint.bodies);
    let compliance = joint.compliance.map_or(String::new(), |compliance| {
        format!(
            "[compliance]\nstiffness_N_m_per_rad = {:e}\ndamping_ratio = {:e}\n",
            compliance.stiffness, compliance.damping_ratio
        )
    });
    let excitation = match joint.excitation {
        Excitation::Angle => "mode = \"angle\"".to_owned(),
        Excitation::Time { mesh_frequency } => format!("mode = \"time\"\nmesh_frequency_rad_per_s = {mesh_frequency}"),
    };
    let law = if joint.damping_law == DampingLaw::Contact { "contact" } else { "paper" };
    assert_eq!(joint.dead_zone, DeadZone::Sharp);
    format!(
        "name = \"random\"\ncoherence = \"warn\"\nrated_output_torque_N_m = {}\n[geometry]\nplanets = {}\nsun_teeth = {}\n\
         planet_teeth = {}\nring_teeth = {}\nworking_pressure_angle_deg = {}\nsun_base_radius_mm = {}\n\
         planet_base_radius_mm = {}\ncarrier_radius_mm = {}\n[bodies]\nsun_equivalent_mass_kg = {:e}\n\
         planet_equivalent_mass_kg = {:e}\nplanet_mass_kg = {}\ncarrier_inertia_over_radius_squared_kg = {:e}\n\
         rotor_inertia_kg_m2 = {:e}\nlink_inertia_kg_m2 = {:e}\n{compliance}[contact]\ndamping_law = \"{law}\"\n\
         [excitation]\n{excitation}\n{}{}",
        joint.rated_output_torque,
        geometry.planets,
        geometry.sun_teeth,
        geometry.planet_teeth,
        geometry.ring_teeth,
        geometry.working_pressure_angle.to_degrees(),
        1e3 * geometry.sun_base_radius,
        1e3 * geometry.planet_base_radius,
        1e3 * geometry.carrier_radius,
        bodies.sun_equivalent_mass,
        bodies.planet_equivalent_mass,
        bodies.planet_mass,
        bodies.carrier_inertia_over_radius_squared,
        joint.rotor_inertia,
        joint.link_inertia,
        mesh("sun_planet", &joint.sun_planet),
        mesh("ring_planet", &joint.ring_planet),
    )
}

proptest! {
    #![proptest_config(config(1000))]

    /// The reader accepts any random joint as a file.
    #[test]
    fn random_joints_are_accepted_as_files(mut joint in joint()) {
        // A file states amplitudes and has a least backlash of its own.
        for mesh in [&mut joint.sun_planet, &mut joint.ring_planet] {
            mesh.transmission_error.iter_mut().for_each(|error| *error = error.abs());
            mesh.half_backlash.iter_mut().filter(|b| **b < 0.5e-6).for_each(|b| *b = 0.0);
            mesh.damping_ratio = mesh.damping_ratio.max(1e-12);
        }
        if let Excitation::Time { mesh_frequency } = &mut joint.excitation {
            *mesh_frequency = mesh_frequency.max(1e-3);
        }
        let text = file(&joint);
        let read = joint_file::read(&text);
        let errors = |problems: &[joint_file::Problem]| {
            problems.iter().filter(|problem| problem.severity == Severity::Error).map(ToString::to_string).collect::<Vec<_>>()
        };
        prop_assert!(read.is_ok(), "{:?}\n{text}", read.as_ref().map_err(|problems| errors(problems)));
        let read = read.expect("a joint").parameters;
        prop_assert!((read.bodies.sun_equivalent_mass / joint.bodies.sun_equivalent_mass - 1.0).abs() < 1e-12);
        prop_assert_eq!(read.geometry.planets, joint.geometry.planets);
    }
}
