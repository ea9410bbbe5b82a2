#![no_std]
//! What a planetary joint and its surroundings are, as plain data in SI: every number that a data sheet or a
//! measurement gives and the limits of each, and nothing that follows from them.
//!
//! The core and the reference that judges it are both built from this data, each by its own laws: coefficients of the
//! stiffness wave, phases from teeth, equivalent masses, damping, dead zones and gear losses stand on either side, so
//! that a mistake in one shows against the other.

#![allow(rustdoc::broken_intra_doc_links, reason = "units stand in brackets")]

mod effect;
mod effects;
mod equivalent;
mod joint;
mod mesh;
mod planets;
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
pub use surroundings::{AbsoluteEncoder, DEFAULT_SPEED_LIMIT, Friction, Surroundings};
pub use validity::ParameterError;
