//! Sizes, masses and stiffnesses derived from a data sheet, a material and the teeth.

use joint_file::sheet::{self, ARCMIN};
use parameters::{Bodies, Coherence, Geometry};
use report::failure::{Failure, Outcome};

use crate::arguments::DataSheet;
use crate::teeth::{self, Teeth};

/// Modules by ISO 54, first and second series [mm].
const MODULES: [f64; 26] = [
    0.2, 0.25, 0.3, 0.35, 0.4, 0.45, 0.5, 0.55, 0.6, 0.7, 0.8, 0.9, 1.0, 1.125, 1.25, 1.5, 1.75, 2.0, 2.25, 2.5, 3.0,
    4.0, 5.0, 6.0, 8.0, 10.0,
];
/// Face widths in modules, the usual one first; wider ones if the teeth alone would be softer than the sheet's joint.
const FACE_WIDTHS: [f64; 4] = [10.0, 12.0, 15.0, 20.0];
/// Modules from the ring's pitch circle to its outside, both sides together: root of 1.25 and rim of 2.
const RIM_MODULES: f64 = 6.5;
/// Form factor: root stress over force by module and face width; 3 holds for 17 teeth and more.
const FORM_FACTOR: f64 = 3.0;
/// Thickness of the carrier's disc over the face width.
const CARRIER_THICKNESS: f64 = 0.5;

/// Sizes of a joint.
#[derive(Debug, Clone, PartialEq)]
pub struct Sizes {
    /// Teeth and planets.
    pub teeth: Teeth,
    /// Module [mm].
    pub module_mm: f64,
    /// Origin of the module.
    pub module_from: String,
    /// Face width [mm].
    pub width_mm: f64,
    /// Mean stiffness of a mesh [N/m].
    pub mean_stiffness: f64,
    /// Masses of sun, planets and carrier by size and material.
    pub bodies: Bodies,
    /// Carrier's thickness [mm].
    pub carrier_mm: f64,
    /// Share of the teeth in the compliance at the output [-].
    pub teeth_share: f64,
}

/// Gears of a data sheet.
#[derive(Debug, Clone, PartialEq)]
pub enum Gears {
    /// A planetary stage.
    Planetary(Sizes),
    /// Gears without teeth, described by the sheet alone.
    Equivalent,
}

impl Gears {
    /// Finds teeth, sizes and stiffnesses of a planetary stage.
    pub fn derive(sheet: &DataSheet) -> Outcome<Self> {
        if sheet.equivalent { Ok(Self::Equivalent) } else { sizes(sheet).map(Self::Planetary) }
    }

    /// Motor turns per turn of the link.
    pub fn ratio(&self, sheet: &DataSheet) -> f64 {
        match self {
            Self::Planetary(sizes) => sizes.teeth.ratio(),
            Self::Equivalent => sheet.ratio,
        }
    }

    /// Inertia of the gears at their input: from the sheet, from sizes and material, or half of the rotor's [kg m^2].
    pub fn inertia_at_input(&self, sheet: &DataSheet) -> f64 {
        match (sheet.gear_inertia, self) {
            (Some(inertia), _) => 1e-4 * inertia,
            (None, Self::Planetary(sizes)) => {
                sheet::inertia_at_input(&sizes.bodies, &geometry(&sizes.teeth, sizes.module_mm))
            }
            (None, Self::Equivalent) => 0.5e-4 * sheet.rotor_inertia,
        }
    }

    /// Warning for undercut teeth.
    pub fn undercut(&self) -> Option<String> {
        match self {
            Self::Planetary(sizes) => sizes.teeth.undercut(),
            Self::Equivalent => None,
        }
    }
}

/// Pressure angle of all gears [deg].
pub const PRESSURE_ANGLE_DEG: f64 = 20.0;

/// Finds teeth, sizes and stiffnesses.
fn sizes(sheet: &DataSheet) -> Outcome<Sizes> {
    let teeth = teeth::find(sheet.ratio, sheet.ratio_tolerance, sheet.planets.unwrap_or(3))?;
    let (module_mm, module_from) = module(sheet, &teeth)?;
    let geometry = geometry(&teeth, module_mm);
    let material = sheet.material();
    let total = sheet.stiffness / ARCMIN;
    let of_width = |wide: f64| {
        let width = wide * 1e-3 * module_mm;
        let mean_stiffness = rounded(material.stiffness_per_width() * width);
        let teeth_share = total * sheet::teeth_compliance(&geometry, [mean_stiffness; 2]);
        (width, mean_stiffness, teeth_share)
    };
    let stiff = FACE_WIDTHS.into_iter().map(of_width).find(|(_, _, share)| *share < 1.0);
    let Some((width, mean_stiffness, teeth_share)) = stiff else {
        let (_, _, share) = of_width(FACE_WIDTHS[FACE_WIDTHS.len() - 1]);
        let message = format!(
            "{} teeth of module {module_mm} mm alone have a stiffness of {:.3} N m/arcmin, but the sheet states \
                 {}",
            material.word(),
            sheet.stiffness / share,
            sheet.stiffness
        );
        let help = "give a larger --outer-diameter-mm, --material steel, or --stiffness-Nm-per-arcmin in N m/arcmin";
        return Err(Failure::new(message).with_help(help));
    };
    let of_metre = material.density() * width;
    Ok(Sizes {
        teeth,
        module_mm,
        module_from,
        width_mm: 1e3 * width,
        mean_stiffness,
        bodies: sheet::discs(&geometry, [of_metre, of_metre, CARRIER_THICKNESS * of_metre]),
        carrier_mm: 1e3 * CARRIER_THICKNESS * width,
        teeth_share,
    })
}

/// Geometry as the reader of joint files derives it from a module.
fn geometry(teeth: &Teeth, module_mm: f64) -> Geometry {
    let angle = PRESSURE_ANGLE_DEG.to_radians();
    let radius = |teeth: u32| 0.5e-3 * module_mm * f64::from(teeth);
    Geometry {
        planets: teeth.planets as usize,
        sun_teeth: teeth.sun,
        planet_teeth: teeth.planet,
        ring_teeth: teeth.ring,
        working_pressure_angle: angle,
        sun_base_radius: radius(teeth.sun) * angle.cos(),
        planet_base_radius: radius(teeth.planet) * angle.cos(),
        carrier_radius: radius(teeth.sun + teeth.planet),
        coherence: Coherence::Required,
    }
}

/// Largest module that fits the outer diameter, or smallest that carries the rated torque.
fn module(sheet: &DataSheet, teeth: &Teeth) -> Outcome<(f64, String)> {
    if let Some(diameter) = sheet.outer_diameter_mm {
        let outside = f64::from(teeth.ring) + RIM_MODULES;
        let fits = MODULES.into_iter().rev().find(|module| module * outside <= diameter);
        let from = format!("{diameter} mm outer diameter over {outside} modules of ring and rim");
        return fits.map(|module| (module, from)).ok_or_else(|| {
            Failure::new(format!("a ring of {} teeth does not fit {diameter} mm at any module", teeth.ring)).with_help(
                format!("{:.0} mm fit module {}; or give a smaller --ratio", outside * MODULES[0] + 0.5, MODULES[0]),
            )
        });
    }
    let stress = |module: f64| {
        let geometry = geometry(teeth, module);
        let force = sheet.rated_torque * sheet::force_per_torque(&geometry);
        FORM_FACTOR * force / (FACE_WIDTHS[0] * (1e-3 * module).powi(2))
    };
    let allowed = sheet.material().stress();
    let carries = MODULES.into_iter().find(|module| stress(*module) <= allowed);
    let from = format!(
        "the rated torque: at most {} MPa at the root of a {} tooth of {} modules face width",
        allowed / 1e6,
        sheet.material().word(),
        FACE_WIDTHS[0]
    );
    carries.map(|module| (module, from)).ok_or_else(|| {
        let what = format!("no module carries {} N m with teeth of {}", sheet.rated_torque, sheet.material().word());
        Failure::new(what).with_help("--rated-torque-Nm is in N m; or give --outer-diameter-mm")
    })
}

/// Rounds to four significant digits: derived and assumed values are no more precise.
pub fn rounded(value: f64) -> f64 {
    format!("{value:.3e}").parse().unwrap_or(value)
}
