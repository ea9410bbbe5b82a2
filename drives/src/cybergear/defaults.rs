//! Settings as the makers' drives have them ex works.

use super::model::Model;
use crate::drive::{Expiry, Law, Settings};

/// Settings with the maker's law, thresholds and reaction to a timeout; no timeout, as ex works. The bus voltage of
/// CyberGear keeps its thresholds: the manual has none.
pub fn settings(model: Model, settings: Settings) -> Settings {
    let sheet = model.sheet();
    let (min_voltage, max_voltage) =
        if model.is_robstride() { (12.0, 60.0) } else { (settings.min_voltage, settings.max_voltage) };
    Settings {
        law: Law::Cascade,
        watchdog: None,
        expiry: Expiry::Disable,
        max_temperature: sheet.max_temperature,
        // Neither maker reduces the torque of a warm winding.
        derating_temperature: sheet.max_temperature,
        min_voltage,
        max_voltage,
        ..settings
    }
}
