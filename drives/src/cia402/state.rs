//! State machine of the profile: states, commands of the control word, status word.

/// State of the drive, with its bits in the status word.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u16)]
pub enum State {
    /// Initialisation, or calibration.
    NotReadyToSwitchOn = 0x00,
    /// No torque; waits for a shutdown command.
    SwitchOnDisabled = 0x40,
    /// No torque.
    ReadyToSwitchOn = 0x21,
    /// Power stage ready, no torque.
    SwitchedOn = 0x23,
    /// Control by the mode of operation.
    OperationEnabled = 0x27,
    /// Ramp to a standstill, and standstill.
    QuickStopActive = 0x07,
    /// Reaction to a fault.
    FaultReactionActive = 0x0F,
    /// No torque until a fault reset.
    Fault = 0x08,
}

/// Command in the low four bits of the control word.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Command {
    /// Takes the torque off.
    DisableVoltage,
    /// Stops on a ramp.
    QuickStop,
    /// Leads to ready to switch on.
    Shutdown,
    /// Leads to switched on.
    SwitchOn,
    /// Leads to operation enabled.
    EnableOperation,
}

/// Bits of the control word.
pub mod control {
    /// Profile position: takes a new target over.
    pub const NEW_SET_POINT: u16 = 1 << 4;
    /// Profile position: the target is relative to the last one.
    pub const RELATIVE: u16 = 1 << 6;
    /// Resets a fault, at its rise.
    pub const FAULT_RESET: u16 = 1 << 7;
    /// Stops on the profile's ramp.
    pub const HALT: u16 = 1 << 8;
}

/// Bits of the status word beside the state.
pub mod status {
    /// Bus voltage present.
    pub const VOLTAGE_ENABLED: u16 = 1 << 4;
    /// Node operational.
    pub const REMOTE: u16 = 1 << 9;
    /// Target reached.
    pub const TARGET_REACHED: u16 = 1 << 10;
    /// A limit cut the torque.
    pub const INTERNAL_LIMIT: u16 = 1 << 11;
    /// Profile position: set-point acknowledged. Profile velocity: standstill. Cyclic modes: follows the target.
    pub const MODE_BIT_12: u16 = 1 << 12;
    /// Position modes: following error.
    pub const FOLLOWING_ERROR: u16 = 1 << 13;
}

impl State {
    const ALL: [Self; 8] = [
        Self::NotReadyToSwitchOn,
        Self::SwitchOnDisabled,
        Self::ReadyToSwitchOn,
        Self::SwitchedOn,
        Self::OperationEnabled,
        Self::QuickStopActive,
        Self::FaultReactionActive,
        Self::Fault,
    ];

    /// Bits of the status word that tell the state: mask and value. Bit 5, no quick stop, tells some states only.
    pub const fn bits(self) -> (u16, u16) {
        let with_bit_5 =
            matches!(self, Self::ReadyToSwitchOn | Self::SwitchedOn | Self::OperationEnabled | Self::QuickStopActive);
        (if with_bit_5 { 0x6F } else { 0x4F }, self as u16)
    }

    /// State in a status word.
    pub fn from_status(word: u16) -> Option<Self> {
        Self::ALL.into_iter().find(|state| word & state.bits().0 == state.bits().1)
    }

    /// State after a command; a command without a transition changes nothing.
    pub fn after(self, command: Command) -> Self {
        use Command as C;
        match (self, command) {
            (Self::SwitchOnDisabled, C::Shutdown) => Self::ReadyToSwitchOn,
            (Self::ReadyToSwitchOn | Self::SwitchedOn, C::DisableVoltage | C::QuickStop) => Self::SwitchOnDisabled,
            (Self::OperationEnabled | Self::QuickStopActive, C::DisableVoltage) => Self::SwitchOnDisabled,
            (Self::OperationEnabled, C::QuickStop) => Self::QuickStopActive,
            (Self::SwitchedOn | Self::OperationEnabled, C::Shutdown) => Self::ReadyToSwitchOn,
            (Self::ReadyToSwitchOn | Self::OperationEnabled, C::SwitchOn) => Self::SwitchedOn,
            (Self::ReadyToSwitchOn | Self::SwitchedOn | Self::QuickStopActive, C::EnableOperation) => {
                Self::OperationEnabled
            }
            _ => self,
        }
    }

    /// True if the drive may apply a torque.
    pub fn is_powered(self) -> bool {
        matches!(self, Self::OperationEnabled | Self::QuickStopActive)
    }
}

impl Command {
    /// Command of a control word.
    pub const fn from_word(word: u16) -> Self {
        match word & 0xF {
            15 => Self::EnableOperation,
            7 => Self::SwitchOn,
            6 | 14 => Self::Shutdown,
            low if low & 2 == 0 => Self::DisableVoltage,
            _ => Self::QuickStop,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn status_bits_are_those_of_canopen() {
        // SW_MASK of canopen 2.4.1 with the other bits at one.
        let cases = [
            (State::SwitchOnDisabled, 0xFFF0),
            (State::ReadyToSwitchOn, 0xFFB1),
            (State::SwitchedOn, 0xFFB3),
            (State::OperationEnabled, 0xFFB7),
            (State::QuickStopActive, 0xFF97),
            (State::Fault, 0xFFB8),
            (State::FaultReactionActive, 0xFFBF),
            (State::NotReadyToSwitchOn, 0xFFB0),
        ];
        for (state, word) in cases {
            assert_eq!(State::from_status(word), Some(state), "{word:#x}");
        }
        assert_eq!(State::from_status(0x0001), None);
    }

    #[test]
    fn every_control_word_is_a_command() {
        let commands: std::vec::Vec<_> = (0..16).map(Command::from_word).collect();
        let expected = |word: usize| match word {
            15 => Command::EnableOperation,
            7 => Command::SwitchOn,
            6 | 14 => Command::Shutdown,
            2 | 3 | 10 | 11 => Command::QuickStop,
            _ => Command::DisableVoltage,
        };
        assert!(commands.iter().enumerate().all(|(word, command)| *command == expected(word)), "{commands:?}");
    }

    #[test]
    fn transitions_are_those_of_the_profile() {
        use Command as C;
        use State as S;
        let table = [
            (
                S::SwitchOnDisabled,
                [
                    S::SwitchOnDisabled,
                    S::SwitchOnDisabled,
                    S::ReadyToSwitchOn,
                    S::SwitchOnDisabled,
                    S::SwitchOnDisabled,
                ],
            ),
            (
                S::ReadyToSwitchOn,
                [S::SwitchOnDisabled, S::SwitchOnDisabled, S::ReadyToSwitchOn, S::SwitchedOn, S::OperationEnabled],
            ),
            (
                S::SwitchedOn,
                [S::SwitchOnDisabled, S::SwitchOnDisabled, S::ReadyToSwitchOn, S::SwitchedOn, S::OperationEnabled],
            ),
            (
                S::OperationEnabled,
                [S::SwitchOnDisabled, S::QuickStopActive, S::ReadyToSwitchOn, S::SwitchedOn, S::OperationEnabled],
            ),
            (
                S::QuickStopActive,
                [S::SwitchOnDisabled, S::QuickStopActive, S::QuickStopActive, S::QuickStopActive, S::OperationEnabled],
            ),
            (S::Fault, [S::Fault; 5]),
            (S::NotReadyToSwitchOn, [S::NotReadyToSwitchOn; 5]),
        ];
        let commands = [C::DisableVoltage, C::QuickStop, C::Shutdown, C::SwitchOn, C::EnableOperation];
        for (state, after) in table {
            assert_eq!(commands.map(|command| state.after(command)), after, "{state:?}");
        }
    }
}
