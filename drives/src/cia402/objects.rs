//! Objects of the server: quantities and settings of the drive behind the dictionary.

use core::f32::consts::TAU;

use super::Server;
use super::dictionary::{self as object, Access, Address, ENTRIES, Entry, Initial, Kind, PDO_COUNT, PDO_IS_INVALID};
use super::nmt::Monitor;
use super::pdo;
use super::sdo::{Abort, Objects, Value};
use super::state::State;
use super::units::Units;
use crate::drive::{Drive, Law};
use crate::scale::round;
use crate::turns::Turns;

/// Server and drive for the time of a request.
pub(super) struct Bound<'b> {
    pub server: &'b mut Server,
    pub drive: &'b mut Drive,
}

impl Objects for Bound<'_> {
    fn read(&self, address: Address) -> Result<Value, Abort> {
        let entry = entry_of(address)?;
        if let Initial::Text(text) = entry.rules.initial {
            return Ok(Value::Text(text));
        }
        let raw = self.server.read(address, self.drive).ok_or(Abort::NoData)?;
        Ok(Value::Raw(raw, entry.kind.size()))
    }

    fn write(&mut self, address: Address, data: [u8; 4], size: Option<usize>) -> Result<(), Abort> {
        let wanted = entry_of(address)?.kind.size();
        match size.unwrap_or(wanted) {
            _ if entry_of(address)?.rules.access != Access::ReadWrite => Err(Abort::ReadOnly),
            size if size > wanted => Err(Abort::TooLong),
            size if size < wanted => Err(Abort::TooShort),
            _ => self.server.write(address, u32::from_le_bytes(data), self.drive),
        }
    }
}

fn entry_of(address: Address) -> Result<&'static Entry, Abort> {
    let is_index = |entry: &Entry| entry.address.index == address.index;
    address.entry().ok_or_else(|| if ENTRIES.iter().any(is_index) { Abort::NoSubIndex } else { Abort::NoObject })
}

impl Server {
    /// Stored value.
    pub(super) fn stored(&self, address: Address) -> u32 {
        address.position().and_then(|position| self.values.get(position)).copied().unwrap_or(0)
    }

    /// Stored value with its sign.
    pub(super) fn signed(&self, address: Address) -> i32 {
        let kind = address.entry().map_or(Kind::Integer32, |entry| entry.kind);
        kind.number(self.stored(address)) as i32
    }

    pub(super) fn store(&mut self, address: Address, raw: u32) {
        if let Some(value) = address.position().and_then(|position| self.values.get_mut(position)) {
            *value = raw;
        }
    }

    /// Units of the present settings.
    pub(super) fn units(&self, drive: &Drive) -> Units {
        Units {
            per_turn: self.stored(object::FEED),
            rated_torque: self.rated_torque(drive) * drive.settings().ratio.to_f32(),
        }
    }

    /// Rated torque of the motor [N m].
    fn rated_torque(&self, drive: &Drive) -> f32 {
        self.rated_torque.unwrap_or(drive.settings().torque_limit)
    }

    fn rated_current(&self, drive: &Drive) -> f32 {
        drive.settings().current(self.rated_torque(drive))
    }

    /// Value of a number; `None` if there is none at present.
    pub(super) fn read(&self, address: Address, drive: &Drive) -> Option<u32> {
        let (now, units) = (drive.feedback(), self.units(drive));
        let position = |position: Turns| Some(units.from_position(position) as u32);
        let velocity = |velocity: f32| Some(units.from_velocity(velocity) as u32);
        let torque = |torque: f32| Some(units.from_torque(torque) as u32);
        let tenths = |value: f32| Some(round(10.0 * value) as i16 as u32);
        match address {
            object::ERROR_REGISTER => Some(self.error_register().into()),
            object::ERROR_COUNT => Some(self.history.count().into()),
            Address { index: 0x1003, sub } => self.history.get(sub).map(u32::from),
            object::ERROR_CODE => Some(self.error.into()),
            object::STATUSWORD => Some(self.status_word(drive).into()),
            object::MODE_DISPLAY => Some(self.stored(object::MODE)),
            object::POSITION_DEMAND => position(now.target),
            object::POSITION_INTERNAL => {
                Some(now.motor_position.to_counts(drive.settings().motor_counts_per_turn) as u32)
            }
            object::POSITION_ACTUAL => position(now.position),
            object::OUTPUT_POSITION => position(now.output_position?),
            object::FOLLOWING_ERROR => position(now.target.minus(now.position)),
            object::VELOCITY_DEMAND => velocity(now.target_velocity),
            object::VELOCITY_ACTUAL => velocity(now.velocity),
            object::OUTPUT_VELOCITY => now.output_position.and_then(|_| velocity(now.output_velocity)),
            object::TORQUE_DEMAND => torque(now.demand),
            object::TORQUE_ACTUAL => torque(now.torque),
            object::CURRENT_ACTUAL => {
                let share = now.current / self.rated_current(drive).max(f32::MIN_POSITIVE);
                Some(round(1000.0 * share) as i16 as u32)
            }
            object::DC_LINK_VOLTAGE => Some(round(1000.0 * now.sensors.bus_voltage) as u32),
            object::MOTOR_TEMPERATURE => tenths(now.sensors.motor_temperature),
            object::BOARD_TEMPERATURE => tenths(now.sensors.board_temperature),
            object::CALIBRATION => Some(drive.is_calibrated().into()),
            _ => self.read_setting(address, drive),
        }
    }

    fn read_setting(&self, address: Address, drive: &Drive) -> Option<u32> {
        let (settings, units) = (drive.settings(), self.units(drive));
        let (gains, (motor, shaft)) = (&settings.gains, settings.ratio.parts());
        let thousandths = |value: f32| Some(round(1000.0 * value) as u32);
        let bound = |bound: Option<Turns>, none: i32| Some(bound.map_or(none, |at| units.from_position(at)) as u32);
        match address {
            object::RATED_TORQUE => thousandths(self.rated_torque(drive)),
            object::RATED_CURRENT => thousandths(self.rated_current(drive)),
            object::MAX_TORQUE => {
                let most = round(1000.0 * settings.torque_limit / self.rated_torque(drive).max(f32::MIN_POSITIVE));
                Some((most as u16).into())
            }
            object::MAX_MOTOR_SPEED => Some(round(settings.max_velocity * settings.ratio.to_f32() * 60.0 / TAU) as u32),
            object::MIN_POSITION => bound(settings.travel.0, i32::MIN),
            object::MAX_POSITION => bound(settings.travel.1, i32::MAX),
            object::ENCODER_INCREMENTS => Some(settings.motor_counts_per_turn),
            object::OUTPUT_INCREMENTS => settings.output_counts_per_turn,
            object::GEAR_MOTOR => Some(motor.into()),
            object::GEAR_SHAFT => Some(shaft.into()),
            object::STIFFNESS => Some(gains.stiffness.to_bits()),
            object::DAMPING => Some(gains.damping.to_bits()),
            object::INTEGRAL => Some(gains.integral.to_bits()),
            object::POSITION_GAIN => Some(gains.position.to_bits()),
            object::VELOCITY_GAIN => Some(gains.velocity.to_bits()),
            object::VELOCITY_INTEGRAL => Some(gains.velocity_integral.to_bits()),
            object::INTEGRAL_LIMIT => Some(settings.integral_limit.to_bits()),
            object::LAW => Some((settings.law == Law::Cascade).into()),
            object::MIN_VOLTAGE => thousandths(settings.min_voltage),
            object::MAX_VOLTAGE => thousandths(settings.max_voltage),
            object::MAX_TEMPERATURE => Some(round(10.0 * settings.max_temperature) as i16 as u32),
            object::OVERSPEED => Some(round(settings.overspeed / TAU * units.per_turn as f32) as u32),
            _ => address.position().and_then(|position| self.values.get(position)).copied(),
        }
    }

    /// Writes a number by SDO or PDO.
    pub(super) fn write(&mut self, address: Address, raw: u32, drive: &mut Drive) -> Result<(), Abort> {
        let entry = address.entry().ok_or(Abort::NoObject)?;
        if entry.rules.access != Access::ReadWrite {
            return Err(Abort::ReadOnly);
        }
        check_range(entry, raw)?;
        match address {
            object::CONTROLWORD => self.control(raw as u16, drive),
            object::MODE => return self.set_mode(raw, drive),
            object::TARGET_POSITION | object::TARGET_VELOCITY | object::TARGET_TORQUE => self.has_target = true,
            object::ERROR_COUNT => self.history.clear(),
            object::CALIBRATION => return self.calibrate(drive),
            object::QUICK_STOP_OPTION if !matches!(raw, 0..=2 | 5 | 6) => return Err(Abort::Range),
            object::CONSUMER_HEARTBEAT => {
                self.heartbeat = Monitor::NONE;
                self.return_from_loss(true);
            }
            Address { index: 0x1400..=0x1403 | 0x1800..=0x1803, sub } => self.check_parameter(address, sub, raw)?,
            Address { index: 0x1600..=0x1603 | 0x1A00..=0x1A03, .. } => self.check_mapping(address, raw)?,
            _ => self.write_setting(address, raw, drive)?,
        }
        self.is_changed |= self.stored(address) != raw;
        self.store(address, raw);
        Ok(())
    }

    /// Changes a setting of the drive; other objects are left alone.
    fn write_setting(&self, address: Address, raw: u32, drive: &mut Drive) -> Result<(), Abort> {
        let (units, rated_torque) = (self.units(drive), self.rated_torque(drive));
        let position = |none: i32| (raw as i32 != none).then(|| units.to_position(raw as i32));
        let unless_largest = |value: f32| if raw == u32::MAX { f32::INFINITY } else { value };
        let tenths = |raw: u32| f32::from(raw as i16) / 10.0;
        let gain = || Some(f32::from_bits(raw)).filter(|gain| gain.is_finite() && *gain >= 0.0).ok_or(Abort::Range);
        let settings = drive.settings_mut();
        let ratio = settings.ratio.to_f32();
        match address {
            object::MAX_TORQUE => settings.torque_limit = raw as f32 / 1000.0 * rated_torque,
            object::MAX_MOTOR_SPEED => settings.max_velocity = unless_largest(raw as f32 / 60.0 * TAU / ratio),
            object::MIN_POSITION => settings.travel.0 = position(i32::MIN),
            object::MAX_POSITION => settings.travel.1 = position(i32::MAX),
            object::STIFFNESS => settings.gains.stiffness = gain()?,
            object::DAMPING => settings.gains.damping = gain()?,
            object::INTEGRAL => settings.gains.integral = gain()?,
            object::POSITION_GAIN => settings.gains.position = gain()?,
            object::VELOCITY_GAIN => settings.gains.velocity = gain()?,
            object::VELOCITY_INTEGRAL => settings.gains.velocity_integral = gain()?,
            object::INTEGRAL_LIMIT => settings.integral_limit = gain()?,
            object::LAW => settings.law = if raw & 1 == 1 { Law::Cascade } else { Law::Parallel },
            object::MIN_VOLTAGE => settings.min_voltage = raw as f32 / 1000.0,
            object::MAX_VOLTAGE => settings.max_voltage = raw as f32 / 1000.0,
            object::MAX_TEMPERATURE => settings.max_temperature = tenths(raw),
            object::OVERSPEED => settings.overspeed = unless_largest(units.to_velocity(raw as f32)),
            _ => {}
        }
        Ok(())
    }

    fn calibrate(&mut self, drive: &mut Drive) -> Result<(), Abort> {
        if self.state != State::SwitchOnDisabled {
            return Err(Abort::State);
        }
        drive.calibrate();
        self.state = State::NotReadyToSwitchOn;
        Ok(())
    }

    /// Checks a communication parameter of a PDO. The identifier of a valid PDO is fixed.
    fn check_parameter(&self, address: Address, sub: u8, raw: u32) -> Result<(), Abort> {
        let id = |raw: u32| raw & 0x3FFF_FFFF;
        let before = self.stored(address);
        match sub {
            1 if id(raw) > 0x7FF => Err(Abort::Range),
            1 if (before | raw) & PDO_IS_INVALID == 0 && id(before) != id(raw) => Err(Abort::Range),
            2 if !pdo::is_transmission(raw) => Err(Abort::Range),
            _ => Ok(()),
        }
    }

    /// Checks a change of a mapping: the PDO is off, and entries change while their number is zero.
    fn check_mapping(&self, address: Address, raw: u32) -> Result<(), Abort> {
        let parameters = Address::new(address.index - 0x200, 1);
        let is_off = self.stored(parameters) & PDO_IS_INVALID != 0;
        let count = self.stored(Address::new(address.index, 0));
        if !is_off || address.sub > 0 && count > 0 {
            return Err(Abort::Unsupported);
        }
        if address.sub > 0 {
            return if raw == 0 { Ok(()) } else { check_mapped(address.index, raw) };
        }
        let mut length = 0;
        for sub in 1..=raw.min(8) as u8 {
            let mapping = self.stored(Address::new(address.index, sub));
            check_mapped(address.index, mapping)?;
            length += pdo::size_of_mapping(mapping);
        }
        if length > 8 { Err(Abort::MappingTooLong) } else { Ok(()) }
    }

    /// Objects of a mapping.
    pub(super) fn mappings(&self, index: u16) -> heapless::Vec<u32, 8> {
        let count = self.stored(Address::new(index, 0)).min(8) as u8;
        let mut mappings = heapless::Vec::new();
        // To collect them could panic.
        (1..=count).for_each(|sub| mappings.push(self.stored(Address::new(index, sub))).unwrap_or(()));
        mappings
    }
}

/// Checks that a PDO can hold an object.
fn check_mapped(index: u16, mapping: u32) -> Result<(), Abort> {
    let entry = object::mapped_address(mapping).entry().ok_or(Abort::NoObject)?;
    let is_receive = index < 0x1600 + PDO_COUNT as u16;
    let is_written = entry.rules.access == Access::ReadWrite;
    let fits = entry.rules.is_mappable && entry.mapping() == mapping && (is_written || !is_receive);
    fits.then_some(()).ok_or(Abort::NotMappable)
}

fn check_range(entry: &Entry, raw: u32) -> Result<(), Abort> {
    let number = entry.kind.number(raw);
    match entry.rules.range {
        Some((low, _)) if number < low => Err(Abort::TooLow),
        Some((_, high)) if number > high => Err(Abort::TooHigh),
        _ => Ok(()),
    }
}
