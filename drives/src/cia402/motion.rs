//! Operation of the drive: state machine, modes and their set-points, quick stop, faults.

use super::Server;
use super::dictionary as object;
use super::fault;
use super::nmt::Nmt;
use super::sdo::Abort;
use super::state::{Command, State, control, status};
use crate::drive::{self, Drive, ProfileLimits, SetPoint, Target};
use crate::turns::Turns;

/// Mode of operation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(i8)]
pub enum Mode {
    /// No torque.
    None = 0,
    /// Profile position.
    ProfilePosition = 1,
    /// Profile velocity.
    ProfileVelocity = 3,
    /// Cyclic synchronous position.
    CyclicPosition = 8,
    /// Cyclic synchronous velocity.
    CyclicVelocity = 9,
    /// Cyclic synchronous torque.
    CyclicTorque = 10,
}

impl Mode {
    const ALL: [Self; 6] = [
        Self::None,
        Self::ProfilePosition,
        Self::ProfileVelocity,
        Self::CyclicPosition,
        Self::CyclicVelocity,
        Self::CyclicTorque,
    ];

    /// Mode of a code; `None` for a mode that the drive does not support.
    pub fn from_code(code: i8) -> Option<Self> {
        Self::ALL.into_iter().find(|mode| *mode as i8 == code)
    }

    fn has_position(self) -> bool {
        matches!(self, Self::ProfilePosition | Self::CyclicPosition)
    }
}

impl Server {
    /// Mode of operation.
    pub fn mode(&self) -> Mode {
        Mode::from_code(self.stored(object::MODE) as i8).unwrap_or(Mode::None)
    }

    pub(super) fn set_mode(&mut self, raw: u32, drive: &Drive) -> Result<(), Abort> {
        let mode = Mode::from_code(raw as i8).ok_or(Abort::Range)?;
        if mode != self.mode() {
            self.store(object::MODE, u32::from(raw as u8));
            self.preset(drive);
            self.is_changed = true;
        }
        Ok(())
    }

    /// Handles the control word.
    pub(super) fn control(&mut self, word: u16, drive: &mut Drive) {
        let rise = word & !self.control;
        self.control = word;
        if self.state == State::Fault {
            if rise & control::FAULT_RESET != 0 {
                self.reset_fault(drive);
            }
            return;
        }
        self.enter(self.state.after(Command::from_word(word)), drive);
        if self.state == State::OperationEnabled
            && self.mode() == Mode::ProfilePosition
            && rise & control::NEW_SET_POINT != 0
        {
            let target = self.units(drive).to_position(self.signed(object::TARGET_POSITION));
            self.goal = if word & control::RELATIVE != 0 { self.goal.plus(target) } else { target };
        }
    }

    fn enter(&mut self, next: State, drive: &mut Drive) {
        if next == self.state {
            return;
        }
        let was_powered = self.state.is_powered();
        self.state = match (next, self.stored(object::QUICK_STOP_OPTION)) {
            (State::QuickStopActive, 0) => State::SwitchOnDisabled,
            _ => next,
        };
        self.is_changed = true;
        match self.state {
            State::OperationEnabled => {
                self.enabled_at = drive.periods();
                self.preset(drive);
            }
            State::QuickStopActive => {
                self.enabled_at = drive.periods();
                self.forget_targets();
            }
            _ if was_powered => {
                drive.disable();
                self.forget_targets();
            }
            _ => {}
        }
    }

    fn forget_targets(&mut self) {
        self.has_target = false;
        self.store(object::TARGET_VELOCITY, 0);
        self.store(object::TARGET_TORQUE, 0);
    }

    /// Makes the present angle the target, unless a client has set a target.
    fn preset(&mut self, drive: &Drive) {
        let position = drive.feedback().position;
        self.goal = position;
        if !self.has_target {
            self.store(object::TARGET_POSITION, self.units(drive).from_position(position) as u32);
        }
    }

    /// Hands the set-point to the drive, if a frame changed it.
    pub(super) fn follow(&mut self, drive: &mut Drive) {
        if !core::mem::take(&mut self.is_changed) {
            return;
        }
        match self.state {
            State::OperationEnabled => drive.enable(self.set_point(drive)),
            State::QuickStopActive => {
                let is_slow = matches!(self.stored(object::QUICK_STOP_OPTION), 1 | 5);
                let ramp = if is_slow { object::PROFILE_DECELERATION } else { object::QUICK_STOP_DECELERATION };
                drive.enable(self.standstill(ramp, drive));
            }
            _ => {}
        }
    }

    fn set_point(&self, drive: &Drive) -> SetPoint {
        let units = self.units(drive);
        let velocity = |address| units.to_velocity(self.signed(address) as f32);
        let torque = |address| units.to_torque(self.signed(address) as f32);
        let positive = |address| units.to_velocity(self.stored(address) as f32);
        let is_halted = self.control & control::HALT != 0;
        let torque_offset = torque(object::TORQUE_OFFSET);
        match self.mode() {
            Mode::None => SetPoint::Torque { torque: 0.0, max_velocity: f32::INFINITY },
            Mode::ProfilePosition | Mode::ProfileVelocity if is_halted => {
                self.standstill(object::PROFILE_DECELERATION, drive)
            }
            Mode::ProfilePosition => {
                let (up, down) = (positive(object::PROFILE_ACCELERATION), positive(object::PROFILE_DECELERATION));
                let limits = ProfileLimits { velocity: positive(object::PROFILE_VELOCITY), acceleration: up.min(down) };
                let position = within_travel(self.goal.plus(self.position_offset(drive)), drive);
                SetPoint::Position(Target { torque: torque_offset, limits, ..Target::hold(position) })
            }
            Mode::ProfileVelocity => SetPoint::Velocity {
                velocity: velocity(object::TARGET_VELOCITY) + velocity(object::VELOCITY_OFFSET),
                torque: torque_offset,
                max_acceleration: positive(object::PROFILE_ACCELERATION),
                max_torque: f32::INFINITY,
            },
            Mode::CyclicPosition => SetPoint::Position(Target { torque: torque_offset, ..self.cyclic_target(drive) }),
            Mode::CyclicVelocity => SetPoint::Velocity {
                velocity: velocity(object::TARGET_VELOCITY) + velocity(object::VELOCITY_OFFSET),
                torque: torque_offset,
                max_acceleration: f32::INFINITY,
                max_torque: f32::INFINITY,
            },
            Mode::CyclicTorque => {
                SetPoint::Torque { torque: torque(object::TARGET_TORQUE) + torque_offset, max_velocity: f32::INFINITY }
            }
        }
    }

    fn position_offset(&self, drive: &Drive) -> Turns {
        self.units(drive).to_position(self.signed(object::POSITION_OFFSET))
    }

    /// Target on a straight line to the commanded angle within the interpolation time. A speed offset takes the place
    /// of the line's speed: with an offset, the target is the commanded angle at once.
    fn cyclic_target(&self, drive: &Drive) -> Target {
        let units = self.units(drive);
        let commanded = units.to_position(self.signed(object::TARGET_POSITION)).plus(self.position_offset(drive));
        let end = within_travel(commanded, drive);
        let offset = units.to_velocity(self.signed(object::VELOCITY_OFFSET) as f32);
        let time = self.stored(object::INTERPOLATION_TIME) as f32
            * libm::powf(10.0, self.signed(object::INTERPOLATION_EXPONENT) as f32);
        if offset != 0.0 || time < drive.settings().period {
            return Target { velocity: offset, ..Target::hold(end) };
        }
        let now = drive.feedback();
        let start = if self.is_under_way(drive) { now.target } else { now.position };
        let velocity = end.minus(start).to_rad() / time;
        Target { velocity, moves: true, stop: Some(end), ..Target::hold(start) }
    }

    fn standstill(&self, ramp: object::Address, drive: &Drive) -> SetPoint {
        let max_acceleration = self.units(drive).to_velocity(self.stored(ramp) as f32);
        SetPoint::Velocity { velocity: 0.0, torque: 0.0, max_acceleration, max_torque: f32::INFINITY }
    }

    /// Status word.
    pub(super) fn status_word(&self, drive: &Drive) -> u16 {
        let (now, units, mode) = (drive.feedback(), self.units(drive), self.mode());
        let is_enabled = self.state == State::OperationEnabled;
        let is_halted = self.control & control::HALT != 0;
        let error = units.from_position(now.position.minus(self.goal)).unsigned_abs();
        let is_still = now.velocity.abs() < STANDSTILL;
        let (is_reached, bit_12) = match mode {
            Mode::ProfilePosition if is_halted => (is_still, false),
            Mode::ProfilePosition => (
                now.is_trajectory_done && error <= self.stored(object::POSITION_WINDOW),
                self.control & control::NEW_SET_POINT != 0,
            ),
            Mode::ProfileVelocity => (now.is_trajectory_done, is_still),
            Mode::CyclicPosition | Mode::CyclicVelocity | Mode::CyclicTorque => (false, true),
            _ => (false, false),
        };
        let bits = [
            (now.sensors.bus_voltage >= drive.settings().min_voltage, status::VOLTAGE_ENABLED),
            (self.nmt == Nmt::Operational, status::REMOTE),
            (is_enabled && is_reached, status::TARGET_REACHED),
            (is_enabled && now.is_limited, status::INTERNAL_LIMIT),
            (is_enabled && bit_12, status::MODE_BIT_12),
            (is_enabled && self.is_lagging(drive), status::FOLLOWING_ERROR),
        ];
        let without_quick_stop = if self.state == State::SwitchOnDisabled { 0x20 } else { 0 };
        bits.into_iter()
            .filter(|(is_set, _)| *is_set)
            .fold(self.state.bits().1 | without_quick_stop, |word, (_, bit)| word | bit)
    }

    fn is_lagging(&self, drive: &Drive) -> bool {
        let window = self.stored(object::FOLLOWING_WINDOW);
        let now = drive.feedback();
        let error = self.units(drive).from_position(now.target.minus(now.position)).unsigned_abs();
        self.mode().has_position() && window != u32::MAX && error > window
    }

    /// Follows the drive after a period: faults, calibration, end of a quick stop, following error.
    pub(super) fn supervise(&mut self, drive: &mut Drive) {
        self.supervise_following(drive);
        if let Some(fault) = drive.fault() {
            if self.state != State::Fault {
                self.state = State::Fault;
                self.forget_targets();
                let code = self.cause.take().unwrap_or(fault::code(fault));
                self.raise(code);
            }
            return;
        }
        let is_calibrating = matches!(drive.state(), drive::State::Calibrating(_));
        match self.state {
            State::NotReadyToSwitchOn if !is_calibrating => self.state = State::SwitchOnDisabled,
            State::QuickStopActive
                if self.is_under_way(drive)
                    && drive.feedback().is_trajectory_done
                    && self.stored(object::QUICK_STOP_OPTION) < 5 =>
            {
                self.enter(State::SwitchOnDisabled, drive);
            }
            _ => {}
        }
    }

    /// True once the drive ran a period since the operation or the quick stop began: its feedback belongs to it.
    fn is_under_way(&self, drive: &Drive) -> bool {
        self.enabled_at != drive.periods()
    }

    fn supervise_following(&mut self, drive: &mut Drive) {
        if self.state != State::OperationEnabled || !self.is_under_way(drive) || !self.is_lagging(drive) {
            self.on_target = self.now;
        } else if self.now - self.on_target >= 1000 * u64::from(self.stored(object::FOLLOWING_TIMEOUT)) {
            self.cause = Some(fault::FOLLOWING_ERROR);
            drive.declare(drive::Fault::InvalidCommand);
        }
    }

    fn reset_fault(&mut self, drive: &mut Drive) {
        drive.clear_fault();
        self.state = State::SwitchOnDisabled;
        self.is_alone = false;
        self.clear_error();
    }

    /// Reacts to a lost or stopped connection by the abort connection option code. Returns true if the reaction is a
    /// fault, which the next period reports.
    pub(super) fn abort_connection(&mut self, code: u16, drive: &mut Drive) -> bool {
        match self.signed(object::ABORT_CONNECTION_OPTION) {
            1 if self.state.is_powered() => {
                self.cause = Some(code);
                drive.declare(drive::Fault::Watchdog);
                return true;
            }
            2 if self.state.is_powered() => self.enter(State::SwitchOnDisabled, drive),
            3 => self.enter(self.state.after(Command::QuickStop), drive),
            _ => {}
        }
        false
    }
}

/// Speed below which the output stands still [rad/s].
const STANDSTILL: f32 = 0.01;

/// Angle within the travel.
fn within_travel(position: Turns, drive: &Drive) -> Turns {
    let (low, high) = drive.settings().travel;
    let above = low.map_or(position, |low| position.max(low));
    high.map_or(above, |high| above.min(high))
}
