//! The design: its exponentials against 50 digits, whether its certificate holds, and sub-steps that a processor has time for.

mod certificate;
mod light_planets;
mod precise_integration;
