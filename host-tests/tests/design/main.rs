//! The design: its exponentials against 50 digits, its certificate, and the number of sub-steps that a processor can afford.

mod certificate;
mod light_planets;
mod precise_integration;
