//! Network management: states, commands, heartbeat and guarding.

/// State of a node.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
pub enum Nmt {
    /// Before the boot-up frame.
    Initialising = 0,
    /// No service but network management.
    Stopped = 4,
    /// All services.
    Operational = 5,
    /// All services but PDOs.
    PreOperational = 127,
}

impl Nmt {
    /// State in a heartbeat, whose highest bit is the toggle of a guarding answer.
    pub const fn from_code(code: u8) -> Option<Self> {
        Some(match code & 0x7F {
            0 => Self::Initialising,
            4 => Self::Stopped,
            5 => Self::Operational,
            127 => Self::PreOperational,
            _ => return None,
        })
    }

    /// True if SDO and EMCY are in service.
    pub const fn is_configurable(self) -> bool {
        matches!(self, Self::Operational | Self::PreOperational)
    }
}

/// Command of the network's master.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
pub enum NmtCommand {
    /// Leads to operational.
    Start = 1,
    /// Leads to stopped.
    Stop = 2,
    /// Leads to pre-operational.
    EnterPreOperational = 128,
    /// Restarts the drive.
    ResetNode = 129,
    /// Restarts the communication.
    ResetCommunication = 130,
}

impl NmtCommand {
    /// Command of a code.
    pub const fn from_code(code: u8) -> Option<Self> {
        Some(match code {
            1 => Self::Start,
            2 => Self::Stop,
            128 => Self::EnterPreOperational,
            129 => Self::ResetNode,
            130 => Self::ResetCommunication,
            _ => return None,
        })
    }
}

/// Monitoring of a master that sends heartbeats or guarding requests. The first one starts it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Monitor {
    seen: Option<u64>,
    is_lost: bool,
}

impl Monitor {
    /// Without a sign of life yet.
    pub const NONE: Self = Self { seen: None, is_lost: false };

    /// Notes a sign of life at a time [us]; returns true if the master was lost.
    pub fn feed(&mut self, now: u64) -> bool {
        self.seen = Some(now);
        core::mem::take(&mut self.is_lost)
    }

    /// Returns true once, when the silence is longer than a time [ms]; 0 turns the monitoring off.
    pub fn expires(&mut self, now: u64, timeout: u32) -> bool {
        let silence = self.seen.map_or(0, |seen| now.saturating_sub(seen));
        let expires = timeout > 0 && silence > 1000 * u64::from(timeout);
        if expires {
            *self = Self { seen: None, is_lost: true };
        }
        expires
    }
}
