#![no_std]
//! Parameters of a planetary joint and its surroundings, as plain data in SI: the numbers given by a data sheet or a
//! measurement, and their limits, without derived quantities.
//!
//! The core and the reference simulator both start from this data and derive coefficients of the stiffness wave, phases
//! from teeth, equivalent masses, damping, dead zones and gear losses independently, so that a bug in one shows as a
//! difference.

#![allow(rustdoc::broken_intra_doc_links, reason = "units stand in brackets")]

mod effect;
mod effects;
mod equivalent;
mod joint;
mod mesh;
mod planets;
mod plant;
mod surroundings;
mod validity;

pub use effect::Effect;
pub use effects::{
    Drift, Hysteresis, Payload, PayloadStep, Presliding, SubdivisionalError, TorqueErrors, WidthVariation,
};
pub use equivalent::{EQUIVALENT, EquivalentGear};
pub use joint::{Bodies, Coherence, Compliance, Excitation, Geometry, JointParameters};
pub use mesh::{
    ContactState, DampingLaw, DeadZone, MAX_HARMONICS, MESH_KINDS, Mesh, MeshKind, MeshPhases, StiffnessWave,
};
pub use planets::{MAX_PLANETS, MIN_PLANETS, PerPlanet};
pub use plant::PlantParameters;
pub use surroundings::{AbsoluteEncoder, DEFAULT_SPEED_LIMIT, Friction, Surroundings};
pub use validity::ParameterError;
