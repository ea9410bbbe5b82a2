//! The reference: the integrator alone, the joint against closed forms, printed figures, another integrator's data and conservation laws,
//! and the drive train around it.

mod drive_train;
mod excitation;
mod formulations;
mod invariants;
mod known_trajectories;
mod lin_parker;
mod linear_oracles;
mod mesh_forces;
mod one_degree_of_freedom;
mod planets_and_regimes;
