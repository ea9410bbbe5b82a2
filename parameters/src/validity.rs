//! Validity of parameters: lists of the right length, physical signs, finite numbers. The reader of joint files checks the
//! coherence of the geometry; the design of the tables checks limits that follow from the laws of the gears.

use core::fmt;

use crate::equivalent::{EQUIVALENT, EquivalentGear};
use crate::joint::{Excitation, JointParameters};
use crate::mesh::{DampingLaw, DeadZone, MAX_HARMONICS, MESH_KINDS, MeshPhases, StiffnessWave};
use crate::planets::{MAX_PLANETS, MIN_PLANETS};

/// Error of joint parameters.
#[derive(Debug, Clone, PartialEq)]
pub enum ParameterError {
    /// Number of planets outside 3 to 5.
    PlanetCount {
        /// Number of planets given.
        given: usize,
    },
    /// List without exactly one value for each planet.
    ListLength {
        /// Name of the list.
        what: &'static str,
        /// Length of the list.
        given: usize,
        /// Number of planets.
        planets: usize,
    },
    /// Quantity outside its range, or not a number.
    OutOfRange {
        /// Name of the quantity.
        what: &'static str,
        /// Value of the quantity in SI.
        given: f64,
        /// Condition on the quantity.
        must_be: &'static str,
    },
    /// Equivalent gear with properties that only gears with teeth have.
    NotEquivalent,
}

impl fmt::Display for ParameterError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::PlanetCount { given } => write!(formatter, "{given} planets: the model is made for 3, 4 or 5"),
            Self::ListLength { what, given, planets } => {
                write!(formatter, "{what} has {given} values for {planets} planets: give one for each")
            }
            Self::OutOfRange { what, given, must_be } => write!(formatter, "{what} is {given}: it must be {must_be}"),
            Self::NotEquivalent => formatter.write_str(
                "an equivalent gear has no ripple, no transmission error, no compliance beside its own, a sharp dead zone \
                 and the damping law `contact`",
            ),
        }
    }
}

impl core::error::Error for ParameterError {}

/// Range of physical quantities in SI, which every joint meets; values outside would not fit into f32 tables.
const SMALLEST: f64 = 1e-12;
const LARGEST: f64 = 1e12;

fn positive(what: &'static str, given: f64) -> Result<(), ParameterError> {
    let good = (SMALLEST..=LARGEST).contains(&given);
    good.then_some(()).ok_or(ParameterError::OutOfRange { what, given, must_be: "between 1e-12 and 1e12 (SI units)" })
}

fn not_negative(what: &'static str, given: f64) -> Result<(), ParameterError> {
    let good = (0.0..=LARGEST).contains(&given);
    good.then_some(()).ok_or(ParameterError::OutOfRange { what, given, must_be: "zero or more, and finite" })
}

fn finite(what: &'static str, given: f64) -> Result<(), ParameterError> {
    let good = (-LARGEST..=LARGEST).contains(&given);
    good.then_some(()).ok_or(ParameterError::OutOfRange { what, given, must_be: "a finite number" })
}

impl JointParameters {
    /// Checks that every number is in the range of a joint and that every list has one value for each planet.
    pub fn validate(&self) -> Result<(), ParameterError> {
        if let Some(gear) = self.equivalent_gear() {
            return self.validate_equivalent(&gear);
        }
        let geometry = &self.geometry;
        let planets = geometry.planets;
        if !(MIN_PLANETS..=MAX_PLANETS).contains(&planets) {
            return Err(ParameterError::PlanetCount { given: planets });
        }
        positive("the sun's base radius", geometry.sun_base_radius)?;
        positive("the planets' base radius", geometry.planet_base_radius)?;
        positive("the carrier radius", geometry.carrier_radius)?;
        let angle = geometry.working_pressure_angle;
        if !(0.0..1.2).contains(&angle) {
            let must_be = "an angle from 0 to 1.2 rad";
            return Err(ParameterError::OutOfRange { what: "the working pressure angle", given: angle, must_be });
        }
        let bodies = &self.bodies;
        positive("the sun's equivalent mass", bodies.sun_equivalent_mass)?;
        positive("the planets' equivalent mass", bodies.planet_equivalent_mass)?;
        not_negative("the planets' mass", bodies.planet_mass)?;
        positive("the carrier's inertia over radius squared", bodies.carrier_inertia_over_radius_squared)?;
        not_negative("the rotor inertia", self.rotor_inertia)?;
        not_negative("the link inertia", self.link_inertia)?;
        positive("the characteristic length", self.characteristic_length)?;
        if let Some(compliance) = &self.compliance {
            positive("the torsional stiffness", compliance.stiffness)?;
            not_negative("the torsional damping ratio", compliance.damping_ratio)?;
            positive("the link inertia behind a compliance", self.link_inertia)?;
        }
        match self.excitation {
            Excitation::Time { mesh_frequency } => not_negative("the mesh frequency", mesh_frequency)?,
            Excitation::Angle => positive("the ring's number of teeth", geometry.ring_teeth.into())?,
        }
        if let DeadZone::Tanh { sharpness } = self.dead_zone {
            positive("the sharpness of the dead zone", sharpness)?;
        }
        for kind in MESH_KINDS {
            let mesh = self.mesh(kind);
            positive("a mean mesh stiffness", mesh.mean_stiffness)?;
            not_negative("a mesh damping ratio", mesh.damping_ratio)?;
            let lists = [
                ("the list of half-backlashes", &mesh.half_backlash),
                ("the list of errors", &mesh.transmission_error),
            ];
            let phases = match &mesh.phases {
                MeshPhases::Given { stiffness, error } => [Some(stiffness), Some(error)],
                MeshPhases::FromTeeth { .. } => [None, None],
            };
            let lists = lists.into_iter().chain(phases.into_iter().flatten().map(|list| ("a list of phases", list)));
            for (what, list) in lists {
                if list.len() != planets {
                    return Err(ParameterError::ListLength { what, given: list.len(), planets });
                }
            }
            for i in 0..planets {
                not_negative("a half-backlash", mesh.half_backlash[i])?;
                finite("a transmission error", mesh.transmission_error[i])?;
                let (stiffness, error) = match &mesh.phases {
                    MeshPhases::Given { stiffness, error } => (stiffness[i], error[i]),
                    MeshPhases::FromTeeth { stiffness, error } => (*stiffness, *error),
                };
                finite("a stiffness phase", stiffness)?;
                finite("an error phase", error)?;
            }
            let order = mesh.stiffness_wave.order();
            if !(1..=MAX_HARMONICS).contains(&order) {
                let given = order as f64;
                return Err(ParameterError::OutOfRange {
                    what: "the order of the stiffness wave",
                    given,
                    must_be: "1 to 8",
                });
            }
        }
        Ok(())
    }

    /// Checks the quantities of an equivalent gear, and that the parameters contain no property that only teeth have.
    fn validate_equivalent(&self, gear: &EquivalentGear) -> Result<(), ParameterError> {
        let [over, under] = gear.ratio;
        if under == 0 || over <= under {
            let (given, must_be) = (f64::from(over) / f64::from(under), "above 1: motor turns over link turns");
            return Err(ParameterError::OutOfRange { what: "the ratio of an equivalent gear", given, must_be });
        }
        for mesh in MESH_KINDS.map(|kind| self.mesh(kind)) {
            let lists = [
                ("the list of half-backlashes", &mesh.half_backlash),
                ("the list of errors", &mesh.transmission_error),
            ];
            for (what, list) in lists {
                if list.len() != EQUIVALENT {
                    return Err(ParameterError::ListLength { what, given: list.len(), planets: EQUIVALENT });
                }
            }
        }
        not_negative("the lost motion", gear.lost_motion)?;
        positive("the stiffness of an equivalent gear", gear.stiffness)?;
        not_negative("the damping ratio of an equivalent gear", gear.damping_ratio)?;
        not_negative("the inertia of an equivalent gear", gear.inertia_at_input)?;
        not_negative("the rotor inertia", self.rotor_inertia)?;
        positive("the inertia of rotor and equivalent gear", gear.inertia_at_input + self.rotor_inertia)?;
        positive("the link inertia behind an equivalent gear", self.link_inertia)?;
        positive("the characteristic length", self.characteristic_length)?;
        // All other parameters of planetary gears must be zero or default; otherwise the core and the reference could treat
        // them differently.
        let same = [&self.sun_planet, &self.ring_planet]
            .into_iter()
            .all(|mesh| mesh.transmission_error[0] == 0.0 && mesh.stiffness_wave == NO_RIPPLE);
        let alike = self.sun_planet == self.ring_planet && self.compliance.is_none();
        let contact = self.damping_law == DampingLaw::Contact && self.dead_zone == DeadZone::Sharp;
        if same && alike && contact { Ok(()) } else { Err(ParameterError::NotEquivalent) }
    }
}

const NO_RIPPLE: StiffnessWave = StiffnessWave::Harmonic { stiffness_ratio: 0.0 };
