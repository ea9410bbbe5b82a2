//! Does the certificate hold? Predicted against measured, on random joints and motions that nothing was fitted to.

mod motion;
mod random;

use model_core::design::Pace;

#[test]
fn table() {
    let seed: u64 = std::env::var("SEED").map_or(1, |s| s.parse().unwrap());
    let count: u32 = std::env::var("COUNT").map_or(10, |s| s.parse().unwrap());
    let mut chance = random::Chance::new(seed);
    for index in 0..count {
        let case = chance.case();
        let pace = Pace::new(&case.joint);
        let rate = (pace.phase(1, case.substeps) / case.phase).ceil() as u32;
        let outcome = match case.joint.geometry.planets { 3 => motion::follow::<3>(&case, rate), 4 => motion::follow::<4>(&case, rate), _ => motion::follow::<5>(&case, rate) };
        let modes = model_core::design::modes::natural_frequencies(&case.joint);
        let j = &case.joint;
        let omega_n = model_core::scales::Scales::new(j).frequency;
        let way = match j.excitation { model_core::joint::Excitation::Time{mesh_frequency} => mesh_frequency, _ => case.speed * f64::from(j.geometry.ring_teeth) };
        println!("ROW,{index},{},{:?},{},{},{rate},{:.4e},{:.4e},{:.4e},{:.4},{:.4},{:?},{:.3e},{:.3e},{:.3},{:.3},{}", j.geometry.planets, j.damping_law, j.compliance.is_some() as u8, case.substeps, pace.phase(rate,case.substeps), omega_n/f64::from(rate), way/f64::from(rate),
          j.sun_planet.stiffness_wave.swing(), j.sun_planet.damping_ratio.max(j.ring_planet.damping_ratio), modes.iter().map(|m| (m/omega_n*1000.0).round()/1000.0).collect::<Vec<_>>().iter().map(|m|m.to_string()).collect::<Vec<_>>().join(";"),
          j.sun_planet.half_backlash[0], case.deflection, case.drive[1]/case.drive[0], j.sun_planet.transmission_error[0]/case.deflection,
          outcome.map_or("chaos,".into(), |o| format!("{},{:.4e}", if o.holds {"hold"} else {"lose"}, o.error)));
    }
}
