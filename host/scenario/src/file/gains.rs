//! Reads the impedance in `[controller]`, with defaults for missing keys.

use super::section::Section;
use crate::controller::Gains;

/// Reads the impedance, if the test needs one.
pub(super) fn read(controller: &Section<'_>, needed: bool) -> Option<Gains> {
    const KEYS: [&str; 4] = ["stiffness_N_m_per_rad", "damping_N_m_s_per_rad", "rate_Hz", "feed_forward_kg_m2"];
    if !needed {
        for name in KEYS.into_iter().filter(|name| controller.has(name)) {
            let help = "write mode = \"impedance\", or leave it out";
            controller.notes.error(controller.place(name), format!("`{name}` belongs to an impedance"), help);
        }
        return None;
    }
    let [stiffness, damping, rate, inertia] = KEYS.map(|name| controller.number(name));
    let usual = Gains::default();
    Some(Gains {
        stiffness: stiffness.unwrap_or(usual.stiffness),
        damping: damping.unwrap_or(usual.damping),
        rate: rate.unwrap_or(usual.rate),
        inertia,
    })
}
