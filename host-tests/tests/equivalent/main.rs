//! Equivalent gears: the core against the independent reference on random joints, both against closed forms and balances, and rejected
//! joints.

mod balances;
mod closed_forms;
mod random;
mod reference_and_core;
mod refused;
