//! The design: its exponentials against 50 digits, and whether its certificate holds.

mod certificate;
mod precise_integration;
