//! Supply and temperatures of a virtual drive.
//!
//! Equations, with the winding's current i = torque / kt and resistance R:
//!
//! - electrical power: P = torque speed + R i^2;
//! - bus: V = V_0 - R_s I, I = P / V, with the internal resistance R_s of the supply; regenerated current raises V;
//! - winding: C dT/dt = R i^2 - (T - T_a) / R_th; the power stage is heated by a share of it.

use super::Sensors;
use super::settings::Settings;
use crate::scale::limit;

/// Thermal resistance of the winding to the surroundings [K/W]. Assumed, without a data sheet: an outrunner of 80 mm on
/// an aluminium housing that loses 25 W at 50 K.
const THERMAL_RESISTANCE: f32 = 2.0;
/// Thermal time constant of the winding [s]. Assumed, without a data sheet; of the order of a minute, so that an
/// overload lasts long enough for a client to see the temperature rise.
const THERMAL_TIME: f32 = 60.0;
/// Temperature rise of the power stage over that of the winding [-]. Assumed.
const BOARD_SHARE: f32 = 0.5;
/// Temperature rise of the winding under the rated torque [K]. Assumed; sets the resistance of the winding.
pub const RATED_RISE: f32 = 50.0;
/// Internal resistance of the supply with its leads [ohm]. Assumed: 12 cells of 3 milliohms and 14 milliohms of leads.
const SUPPLY_RESISTANCE: f32 = 0.05;

/// Supply and temperatures.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct VirtualPower {
    /// Voltage of the supply without a load [V].
    pub supply_voltage: f32,
    /// Temperature of the surroundings [deg C].
    pub ambient: f32,
    bus_voltage: f32,
    bus_current: f32,
    motor_temperature: f32,
    board_temperature: f32,
}

impl VirtualPower {
    /// Supply without a load, everything at the temperature of the surroundings.
    pub fn new(supply_voltage: f32) -> Self {
        Self {
            supply_voltage,
            ambient: 25.0,
            bus_voltage: supply_voltage,
            bus_current: 0.0,
            motor_temperature: 25.0,
            board_temperature: 25.0,
        }
    }

    /// Resistance of a winding that is `RATED_RISE` above the surroundings at a torque [ohm].
    pub fn resistance(rated_torque: f32, torque_constant: f32) -> f32 {
        let current = rated_torque / torque_constant.max(f32::MIN_POSITIVE);
        RATED_RISE / THERMAL_RESISTANCE / (current * current).max(f32::MIN_POSITIVE)
    }

    /// Advances by a control period under a torque [N m] at a speed of the rotor [rad/s].
    pub fn step(&mut self, settings: &Settings, torque: f32, velocity: f32) {
        let current = settings.current(torque);
        let loss = settings.resistance * current * current;
        let power = torque * velocity + loss;
        // The voltage of the period before avoids a quadratic equation; the supply changes slowly against a period.
        self.bus_current = if self.bus_voltage > 1.0 { power / self.bus_voltage } else { 0.0 };
        let most = self.supply_voltage / SUPPLY_RESISTANCE;
        self.bus_current = limit(self.bus_current, most);
        self.bus_voltage = (self.supply_voltage - SUPPLY_RESISTANCE * self.bus_current).max(0.0);
        let heat = THERMAL_RESISTANCE * loss;
        let approach = (settings.period / THERMAL_TIME).min(1.0);
        self.motor_temperature += approach * (self.ambient + heat - self.motor_temperature);
        self.board_temperature += approach * (self.ambient + BOARD_SHARE * heat - self.board_temperature);
    }

    /// Sets the temperature of the winding [deg C].
    pub fn set_motor_temperature(&mut self, temperature: f32) {
        self.motor_temperature = temperature;
    }

    /// Fills in the readings of supply and temperatures.
    pub fn read(&self, sensors: &mut Sensors) {
        sensors.bus_voltage = self.bus_voltage;
        sensors.bus_current = self.bus_current;
        sensors.motor_temperature = self.motor_temperature;
        sensors.board_temperature = self.board_temperature;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rated_torque_heats_by_the_rated_rise() {
        let torque_constant = 0.1;
        let settings = Settings {
            torque_constant,
            resistance: VirtualPower::resistance(2.0, torque_constant),
            period: 0.1,
            ..Settings::default()
        };
        let mut power = VirtualPower::new(48.0);
        (0..10_000).for_each(|_| power.step(&settings, 2.0, 0.0));
        let mut sensors = Sensors::default();
        power.read(&mut sensors);
        assert!((sensors.motor_temperature - 25.0 - RATED_RISE).abs() < 0.5, "{}", sensors.motor_temperature);
        assert!((sensors.board_temperature - 25.0 - 0.5 * RATED_RISE).abs() < 0.5);
    }

    #[test]
    fn regeneration_raises_the_bus() {
        let mut power = VirtualPower::new(48.0);
        (0..10).for_each(|_| power.step(&Settings::default(), -1.0, 300.0));
        let mut sensors = Sensors::default();
        power.read(&mut sensors);
        assert!(sensors.bus_voltage > 48.1 && sensors.bus_current < 0.0, "{sensors:?}");
    }
}
