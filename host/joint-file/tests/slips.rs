//! Slips within the bounds of each single key: units, thousandths, an extra factor. Each gives an error or a warning
//! that leads to it. Undetectable slips are discussed in docs/reference/joint-file.md. Realistic joints give no
//! warning.

use joint_file::{PRESETS, Problem, Severity, change, preset, read, value};

/// Change of a value.
#[derive(Debug, Clone, Copy)]
enum Slip {
    Times(f64),
    Set(&'static str),
}
use Severity::{Error, Warning};
use Slip::{Set, Times};

/// Preset, changed key, change, severity, and words of message and help.
type Row = (&'static str, &'static str, Slip, Severity, &'static [&'static str]);

const SLIPS: &[Row] = &[
    // Masses against sizes.
    ("q1", "sun_equivalent_mass_kg", Times(250.0), Error, &["sun_equivalent_mass_kg", "a sun of 7.50 mm", "in steel"]),
    ("d2", "sun_equivalent_mass_kg", Times(1e3), Error, &["sun_equivalent_mass_kg", "typed in g"]),
    ("s1", "sun_equivalent_mass_kg", Times(1e-3), Warning, &["sun_equivalent_mass_kg", "foil", "typed in t"]),
    ("l1", "sun_equivalent_mass_kg", Times(1e3), Error, &["sun_equivalent_mass_kg", "typed in g"]),
    ("q1", "sun_inertia_kg_m2", Set("0.0099"), Error, &["sun_inertia_kg_m2", "kg cm^2", "9.90e-7 kg m^2"]),
    ("q1", "planet_equivalent_mass_kg", Times(1e3), Error, &["planet_equivalent_mass_kg", "in steel"]),
    ("d2", "planet_equivalent_mass_kg", Times(3.0), Error, &["planet_mass_kg", "cannot have", "0.57"]),
    ("s1", "planet_equivalent_mass_kg", Times(1e-3), Warning, &["planet_equivalent_mass_kg", "foil"]),
    ("q1", "planet_mass_kg", Times(1e3), Error, &["planet_mass_kg", "typed in g"]),
    ("l1", "planet_mass_kg", Times(1e-3), Error, &["planet_mass_kg", "cannot have an equivalent mass"]),
    ("l1", "carrier_inertia_over_radius_squared_kg", Times(1e3), Error, &["carrier_inertia", "typed in g"]),
    ("q1", "carrier_inertia_kg_m2", Set("0.67"), Error, &["carrier_inertia_kg_m2", "kg cm^2", "6.70e-5 kg m^2"]),
    ("d2", "carrier_equivalent_mass_kg", Times(1e3), Error, &["carrier_equivalent_mass_kg", "typed in g"]),
    ("q1", "rotor_inertia_kg_m2", Times(1e4), Warning, &["rotor_inertia_kg_m2", "kg cm^2", "2.50e-4 kg m^2"]),
    ("l1", "rotor_inertia_kg_m2", Times(1e4), Warning, &["rotor_inertia_kg_m2", "kg cm^2"]),
    ("s1", "rotor_inertia_kg_m2", Times(1e-4), Warning, &["rotor_inertia_kg_m2", "once too often"]),
    ("q1", "link_inertia_kg_m2", Times(1e4), Warning, &["link_inertia_kg_m2", "kg cm^2", "0.150 kg m^2"]),
    ("d2", "link_inertia_kg_m2", Times(1e-4), Warning, &["link_inertia_kg_m2", "once too often"]),
    // Sizes.
    ("q1", "module_mm", Times(10.0), Warning, &["planet_equivalent_mass_kg", "foil", "module or radii are wrong"]),
    ("d2", "module_mm", Times(0.1), Error, &["in steel", "module or radii are wrong"]),
    ("l1", "working_pressure_angle_deg", Set("44"), Warning, &["not a usual pressure angle of teeth"]),
    ("q1", "working_pressure_angle_deg", Set("40"), Warning, &["working_pressure_angle_deg", "20 is usual"]),
    // The stiffness behind the carrier.
    ("q1", "compliance.stiffness_N_m_per_rad", Set("3"), Error, &["deg", "typed in N m/arcmin", "10313 N m/rad"]),
    ("s1", "compliance.stiffness_N_m_per_rad", Set("2.65"), Error, &["typed in N m/arcmin", "N m/rad"]),
    ("d2", "compliance.stiffness_N_m_per_rad", Set("10"), Error, &["typed in N m/arcmin", "34378 N m/rad"]),
    ("q1", "compliance.stiffness_N_m_per_rad", Times(1.0 / 57.3), Warning, &["typed in N m/deg"]),
    ("d2", "compliance.stiffness_N_m_per_rad", Times(1e-3), Error, &["typed in kN m/rad"]),
    ("q1", "compliance.stiffness_N_m_per_rad", Times(1e3), Error, &["typed in N mm/rad"]),
    ("s1", "compliance.stiffness_N_m_per_rad", Times(3437.75), Error, &["3437.75 once too often"]),
    ("q1", "compliance.stiffness_N_m_per_rad", Times(1e-4), Error, &["stiffness_N_m_per_rad", "twist by"]),
    ("q1", "compliance.stiffness_N_m_per_rad", Times(57.3), Warning, &["57.3 once too often"]),
    ("q1", "compliance.damping_ratio", Set("0.5"), Warning, &["damping_ratio", "[compliance]", "2 % is 0.02"]),
    // Teeth.
    ("q1", "mean_stiffness_N_per_m", Times(1e-3), Error, &["mean_stiffness_N_per_m", "typed in N/mm"]),
    ("l1", "mean_stiffness_N_per_m", Times(1e-3), Error, &["mean_stiffness_N_per_m", "typed in N/mm"]),
    ("d2", "mean_stiffness_N_per_m", Times(1e3), Error, &["mean_stiffness_N_per_m", "2e10", "mN/m"]),
    ("q1", "mesh.damping_ratio", Set("0.5"), Warning, &["damping_ratio", "5 % is 0.05"]),
    ("q1", "half_backlash_um", Times(20.0), Error, &["half_backlash_um", "module of 1.00 mm", "no tooth"]),
    ("s1", "half_backlash_um", Times(60.0), Warning, &["half_backlash_um", "module"]),
    ("q1", "backlash_um", Set("900"), Warning, &["backlash_um", "0.900 of the module"]),
    ("q1", "transmission_error_um", Times(1e-3), Warning, &["transmission_error_um", "mm"]),
    ("d2", "transmission_error_um", Times(200.0), Error, &["transmission_error_um", "of the module of 1.25 mm"]),
    ("s1", "transmission_error_um", Times(8.0), Warning, &["transmission_error_um", "backlash 2b"]),
    // Torques.
    ("q1", "rated_output_torque_N_m", Times(1e3), Error, &["rated torque is 12000 N m", "balances"]),
    ("l1", "rated_output_torque_N_m", Times(1e-3), Error, &["drive_torque_N_m", "rated torque"]),
    ("d2", "drive_torque_N_m", Times(1.0 / 6.0), Warning, &["drive_torque_N_m", "= 10.0 balances"]),
    ("q1", "motor_torque_limit_N_m", Times(1e3), Error, &["motor_torque_limit_N_m", "typed in mN m"]),
    ("q1", "motor_coulomb_friction_N_m", Times(1e3), Error, &["motor_coulomb_friction_N_m", "typed in mN m"]),
    ("d2", "cogging_torque_N_m", Times(1e3), Error, &["cogging_torque_N_m", "typed in mN m"]),
    ("s1", "load_coulomb_friction_N_m", Times(1e3), Error, &["load_coulomb_friction_N_m", "typed in mN m"]),
    ("q1", "motor_viscous_friction_N_m_s_per_rad", Times(1e3), Warning, &["motor_viscous", "rad/s"]),
    ("d2", "load_viscous_friction_N_m_s_per_rad", Times(1e3), Warning, &["load_viscous", "rad/s"]),
    ("q1", "gravity_torque_N_m", Times(9.81), Error, &["gravity_torque_N_m", "9.81"]),
    ("d2", "gravity_torque_N_m", Times(1e3), Error, &["gravity_torque_N_m", "typed in mN m"]),
    ("q1", "efficiency", Set("0.15"), Warning, &["efficiency", "0.850"]),
    ("q1", "load_stribeck_rise_ratio", Set("5"), Warning, &["load_stribeck_rise_ratio", "20 % is 0.2"]),
    ("s1", "load_stribeck_speed_rad_per_s", Times(57.3), Warning, &["load_stribeck_speed", "deg/s"]),
    ("q1", "torque_noise_ratio", Set("0.5"), Warning, &["torque_noise_ratio", "1.5 % is 0.015"]),
    // Encoders, times and rates.
    ("q1", "output_encoder.bits", Set("10"), Warning, &["bits", "lost motion of 3.78 mrad"]),
    ("s1", "motor_encoder.bits", Set("8"), Warning, &["motor encoder", "one count"]),
    ("d2", "output_encoder.once_per_turn_error_deg", Times(57.3), Warning, &["once_per_turn_error_deg", "degrees"]),
    ("q1", "output_encoder.skew_us", Times(1e-3), Warning, &["skew_us", "0.05 ms"]),
    ("q1", "control_rate_Hz", Set("10"), Warning, &["control_rate_Hz", "10 kHz are 10e3 Hz"]),
    ("d2", "current_lag_ms", Times(1e-3), Warning, &["current_lag_ms", "in ms"]),
    ("s1", "current_lag_ms", Times(200.0), Warning, &["current_lag_ms", "in ms"]),
    ("q1", "control_delay_periods", Set("100"), Warning, &["control_delay_periods", "counts periods"]),
];

fn slipped(name: &str, key: &str, slip: Slip) -> String {
    let text = preset(name).expect("a preset");
    let new = match slip {
        Set(new) => new.to_owned(),
        Times(factor) => {
            let old: f64 = value(text, key).expect("a key").expect("a stated value").parse().expect("a number");
            format!("{:?}", old * factor)
        }
    };
    change(text, key, &new).expect("a known key")
}

/// All problems and warnings of a text.
fn said(text: &str) -> Vec<Problem> {
    read(text).map_or_else(|problems| problems.0, |file| file.warnings)
}

/// Every slip is reported with the severity and the words of its row.
#[test]
fn slips_are_named_with_likely_unit() {
    assert!(SLIPS.len() >= 40);
    let mut missed = Vec::new();
    for (name, key, slip, severity, words) in SLIPS {
        let all = said(&slipped(name, key, *slip));
        let named = |problem: &Problem| {
            let text = format!("{} {}", problem.message, problem.help);
            problem.severity == *severity && words.iter().all(|word| text.contains(word))
        };
        if !all.iter().any(named) {
            missed.push(format!("{name} {key} {slip:?}: {words:?} {severity:?}\n  {all:#?}"));
        }
    }
    assert!(missed.is_empty(), "{} slips pass:\n{}", missed.len(), missed.join("\n"));
}

/// The file's `coherence = "warn"` turns an impossible figure into a warning.
#[test]
fn coherence_warn_accepts_impossible() {
    let text = slipped("q1", "planet_mass_kg", Times(1e3));
    let file = read(&format!("coherence = \"warn\"\n{text}")).expect("warnings only");
    assert!(file.warnings.iter().any(|warning| warning.message.contains("planet_mass_kg")), "{:?}", file.warnings);
}

#[test]
fn presets_raise_no_alarm() {
    for name in PRESETS {
        let file = read(preset(name).expect("a preset")).expect("a joint");
        let known =
            |message: &str| ["not coaxial", "the ratio is", "r_c cos(alpha)"].iter().any(|word| message.contains(word));
        assert!(file.warnings.iter().all(|warning| known(&warning.message)), "{name}: {:#?}", file.warnings);
    }
}

/// Reproducible pseudo-random numbers (Knuth's MMIX).
struct Random(u64);

impl Random {
    fn part(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.part()
    }

    /// Uniform over orders of magnitude.
    fn about(&mut self, low: f64, high: f64) -> f64 {
        low * (high / low).powf(self.part())
    }

    fn whole(&mut self, low: u32, high: u32) -> u32 {
        low + (f64::from(high - low + 1) * self.part()) as u32
    }
}

/// Realistic joint: 3 to 5 planets, module 0.3 to 3 mm, steel, aluminium or plastic, bored or solid.
fn plausible(random: &mut Random) -> String {
    let (planets, sun, planet) = loop {
        let (planets, sun, planet) = (random.whole(3, 5), random.whole(12, 40), random.whole(12, 60));
        let clear = f64::from(sun + planet) * (std::f64::consts::PI / f64::from(planets)).sin() > f64::from(planet + 2);
        if (2 * (sun + planet)).is_multiple_of(planets) && clear {
            break (planets, sun, planet);
        }
    };
    let ring = sun + 2 * planet;
    let module = random.about(0.3, 3.0);
    // Density, tooth stiffness per face width, and allowed stress.
    let (density, stiffness, stress) =
        [(7850.0, 1.4e10, 2e8), (2700.0, 5e9, 6e7), (1400.0, 2.5e8, 2e7), (1050.0, 1.5e8, 1e7)]
            [random.whole(0, 3) as usize];
    let pi = std::f64::consts::PI;
    let [r_sun, r_planet] = [sun, planet].map(|teeth| 0.5e-3 * module * f64::from(teeth));
    let carrier = r_sun + r_planet;
    let width = random.between(4.0, 15.0) * 1e-3 * module;
    let cosine = 20_f64.to_radians().cos();
    let disc = |radius: f64, width: f64| 0.5 * density * pi * width * radius.powi(4);
    // Bored: a third to all of the inertia and mass remains in the rim.
    let solid = random.between(0.35, 1.0);
    let sun_inertia = disc(r_sun, width * random.between(1.0, 3.0)) * random.between(0.5, 1.0);
    let planet_inertia = disc(r_planet, width) * solid;
    let pin = random.between(0.0, 0.6);
    let planet_mass = density * pi * r_planet.powi(2) * width * (solid + pin);
    let carrier_inertia = disc(1.1 * carrier, width * random.between(0.1, 1.5));
    let force = stress * width * module * 1e-3 / 3.0 * random.about(0.1, 1.0);
    let rated = force * 2.0 * f64::from(planets) * carrier * cosine;
    let ratio = 1.0 + f64::from(ring) / f64::from(sun);
    let drive = rated / ratio;
    // The shafts twist by 1 to 40 minutes of arc; the rotor accelerates like a motor's.
    let shafts = rated / (random.about(1.0, 40.0) * pi / 10_800.0);
    let rotor = drive / random.about(1e3, 1e5);
    let link = rotor * ratio * ratio * random.about(0.1, 30.0);
    let backlash = module * random.about(0.01, 0.15) * 1e3;
    let error = module * random.about(0.001, 0.02) * 1e3;
    let share = |random: &mut Random| random.about(0.002, 0.08);
    let (motor_dry, cogging, load_dry) = (drive * share(random), drive * share(random), rated * share(random));
    let speed = random.about(5.0, 30.0);
    let (motor_viscous, load_viscous) = (0.05 * drive / (speed * ratio), 0.05 * rated / speed);
    let weight = rated * random.between(-0.7, 0.7);
    format!(
        "name = \"random\"\nrated_output_torque_N_m = {rated:e}\n[geometry]\nplanets = {planets}\nsun_teeth = {sun}\n\
         planet_teeth = {planet}\nring_teeth = {ring}\nmodule_mm = {module}\nworking_pressure_angle_deg = 20.0\n[bodies]\n\
         sun_inertia_kg_m2 = {sun_inertia:e}\nplanet_inertia_kg_m2 = {planet_inertia:e}\nplanet_mass_kg = {planet_mass:e}\n\
         carrier_inertia_kg_m2 = {carrier_inertia:e}\nrotor_inertia_kg_m2 = {rotor:e}\nlink_inertia_kg_m2 = {link:e}\n\
         [compliance]\nstiffness_N_m_per_rad = {shafts:e}\ndamping_ratio = {}\n[mesh]\nmean_stiffness_N_per_m = {:e}\n\
         stiffness_ratio = 0.15\ndamping_ratio = {}\nbacklash_um = {backlash}\ntransmission_error_um = {error}\n\
         [drive_train]\nmotor_coulomb_friction_N_m = {motor_dry:e}\ncogging_torque_N_m = {cogging:e}\n\
         load_coulomb_friction_N_m = {load_dry:e}\nload_stribeck_rise_ratio = 0.3\nefficiency = {}\n\
         motor_viscous_friction_N_m_s_per_rad = {motor_viscous:e}\nload_viscous_friction_N_m_s_per_rad = {load_viscous:e}\n\
         gravity_torque_N_m = {weight}\ncontrol_rate_Hz = {}\ncurrent_lag_ms = 0.2\ncontrol_delay_periods = 1.0\n\
         [drive_train.motor_encoder]\nbits = {}\n[drive_train.output_encoder]\nbits = {}\n",
        random.about(0.01, 0.2),
        stiffness * width,
        random.about(0.02, 0.2),
        random.between(0.8, 0.98),
        random.whole(1, 40) * 1000,
        random.whole(13, 20),
        random.whole(15, 20),
    )
}

/// A thousand random realistic joints give no warning.
#[test]
fn random_realistic_joints_raise_no_alarm() {
    let mut random = Random(1);
    let mut alarms = Vec::new();
    for index in 0..1000 {
        let text = plausible(&mut random);
        let said: Vec<Problem> =
            said(&text).into_iter().filter(|problem| !problem.message.contains("at the tips")).collect();
        if !said.is_empty() {
            alarms.push(format!("{index}: {said:#?}\n{text}"));
        }
    }
    assert!(alarms.is_empty(), "{} alarms, such as\n{}", alarms.len(), alarms[..alarms.len().min(4)].join("\n"));
}
