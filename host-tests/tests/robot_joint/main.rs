//! probe
use contest::case::Case;
use contest::curve::{Field, Scalar};
use contest::method::Method;
use contest::run::AS_DESIGNED;
use host_tests::scenarios::case_r;
use std::time::Instant;

#[test]
fn probe() {
    for (name, case) in [("brief", case_r::brief(case_r::case_r().joint)), ("whole", case_r::case_r())] {
        let t = Instant::now();
        println!("windows {}", case.windows.len());
        let field = Field::new(Case::of_robot_joint("R", "", case), 1).unwrap();
        println!("{name} reference {:?}", t.elapsed());
        for (m, steps) in [
            (Method::Realtime, AS_DESIGNED),
            (Method::PaperEtd1, 1),
            (Method::PaperEtd1, 3),
            (Method::RungeKutta4, 3),
            (Method::RungeKutta4, 8),
            (Method::RungeKutta4, 32),
            (Method::Euler, 7),
            (Method::TwoMassSpring, 1),
            (Method::TwoMassSpring, 16),
            (Method::TwoMassRestitution, 16),
            (Method::TwoMassRestitution, 64),
        ] {
            let t = Instant::now();
            let s = steps.max(1);
            let e = field
                .point(m, Scalar::Single, 10_000 * s, if m == Method::Realtime { AS_DESIGNED } else { 1 })
                .unwrap()
                .errors;
            println!(
                "{:30} {steps:3} rms {:.2e} worst {:.2e} peak {:.3}  {:?}",
                m.name(),
                e.link_rms,
                e.link_worst,
                e.peak_force,
                t.elapsed()
            );
        }
        let e = field.point(Method::Realtime, Scalar::Double, 10_000, AS_DESIGNED).unwrap().errors;
        println!("double rms {:.2e} worst {:.2e} peak {:.3}", e.link_rms, e.link_worst, e.peak_force);
    }
}
