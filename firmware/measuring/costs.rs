#![cfg_attr(target_os = "none", no_std, no_main)]
//! Counts the instructions of two steps of known course, for every joint of this image: contact holds, and all teeth
//! are separated.

#[cfg(target_os = "none")]
mod measurement {
    use core::hint::black_box;

    use cortex_m_rt::entry;
    use firmware::measuring::{self, InstructionCounter, Visitor, measured};
    use model_core::gears::{Model, Relative, State, Tables, Torques};

    /// Deflection of every mesh by its load [b_c], larger than the differences between backlashes.
    const DEFLECTION: f32 = 20.0;
    const NONE: Torques<f32> = Torques { drive: 0.0, load: 0.0 };

    struct Costs {
        counter: InstructionCounter,
    }

    #[inline(never)]
    fn step<const N: usize>(model: &mut Model<'_, f32, N>, torques: Torques<f32>) {
        model.step(torques);
    }

    impl Visitor for Costs {
        fn joint<const N: usize>(&mut self, name: &str, tables: &'static Tables<f32, N>) {
            let holding = self.one(tables, loaded(tables));
            let apart = self.one(tables, (adrift(), NONE));
            measuring::print_line(format_args!(
                "{name};{};{};{holding};{apart}",
                tables.substeps, tables.verlet.substeps
            ));
        }
    }

    impl Costs {
        fn one<const N: usize>(
            &self,
            tables: &'static Tables<f32, N>,
            (state, torques): (State<f32, N>, Torques<f32>),
        ) -> u32 {
            let mut model = Model::new(tables);
            model.set_state(state);
            // The second step continues from the first, as in a run.
            model.step(torques);
            self.counter.count(|| step(black_box(&mut model), black_box(torques)))
        }
    }

    /// Within the gaps, every body in motion.
    fn adrift<const N: usize>() -> State<f32, N> {
        let relative = |size: f32| Relative {
            planets: core::array::from_fn(|i| size * (i + 1) as f32),
            gap: 2.0 * size,
            wind_up: 0.0,
        };
        State { position: relative(1e-3), rate: relative(1e-4), ..State::REST }
    }

    /// In balance under a load, approximately where backlashes differ.
    fn loaded<const N: usize>(tables: &Tables<f32, N>) -> (State<f32, N>, Torques<f32>) {
        let [sun, ring] = &tables.meshes;
        let (units, rigid, mobility) = (&tables.units, &tables.rigid, &tables.mobility);
        let force = tables.springs[0].stiffness * DEFLECTION;
        let drive = N as f32 * mobility.sun * force / units.drive;
        let load = drive * rigid.drive / rigid.load;
        let wind_up = match mobility.wind_up > 0.0 {
            true => units.load_on_link * load / (mobility.link * mobility.wind_up_stiffness),
            false => 0.0,
        };
        let planets = core::array::from_fn(|i| sun[i].half_backlash + DEFLECTION);
        let far = ring
            .iter()
            .zip(planets)
            .fold(0.0, |far: f32, (mesh, planet): (_, f32)| far.max(planet + mesh.half_backlash));
        let gap = far + force / tables.springs[1].stiffness;
        (State { position: Relative { planets, gap, wind_up }, ..State::REST }, Torques { drive, load })
    }

    #[entry]
    fn main() -> ! {
        // Always available: the only user in this image, called once.
        if let Some(core) = cortex_m::Peripherals::take() {
            measured::visit(&mut Costs { counter: InstructionCounter::start(core.SYST) });
        }
        measuring::finish()
    }
}

/// Empty on a host.
#[cfg(not(target_os = "none"))]
fn main() {}
