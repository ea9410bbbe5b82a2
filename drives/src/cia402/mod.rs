//! CiA 402 servo drive on CANopen: classical CAN, 11-bit identifiers, usually 1 Mbit/s.
//!
//! Documents: CiA 301 (CANopen application layer, 4.2), CiA 306 (EDS), CiA 402-2 and -3 (drives, equal to IEC
//! 61800-7-201 and -301). Client that served as a judge: canopen 2.4.1 with `BaseNode402`.
//!
//! | identifier, with the node n | frame | data, little-endian |
//! |---|---|---|
//! | 0 | network management | command, node or 0 for all |
//! | 0x80 | SYNC | none, or a counter |
//! | 0x80 + n | emergency | code 16, error register 8, 40 bits zero |
//! | 0x200, 0x300, 0x400, 0x500 + n | RPDO 1 to 4 | by the mapping |
//! | 0x180, 0x280, 0x380, 0x480 + n | TPDO 1 to 4 | by the mapping |
//! | 0x600 + n, 0x580 + n | SDO request, response | command 8, index 16, sub-index 8, data 32; [`sdo`] |
//! | 0x700 + n | boot-up, heartbeat, guarding answer | state 8 |
//!
//! Mapping after power-up, with the transmission type in brackets: RPDO 1 control word and mode, 2 target position and
//! velocity offset, 3 target velocity and torque offset, 4 target torque (all 255); TPDO 1 status word and mode (255),
//! 2 position by the motor encoder and position by the output encoder (1), 3 velocity and torque (1), 4 voltage and
//! winding temperature (255). CiA 402-3 maps the control word into each RPDO; here no object is in two PDOs, because
//! `BaseNode402` sends one RPDO at a time and would send an old control word in the others.
//!
//! Objects, their types and values after power-up: [`dictionary`], and `joint-drive.eds` beside it.
//!
//! Units: positions of both encoders in units of 1/6092h:01 turn of the output, after power-up 0.001 degrees; speeds in
//! units/s, accelerations in units/s^2; torques in thousandths of the motor's rated torque 6076h [mN m], which is the
//! motor's largest torque at power-up unless the host states another one; currents in thousandths of 6075h [mA];
//! voltage in mV; temperatures in 0.1 deg C; gains as floats in SI units of the output. 6063h holds counts of the motor
//! encoder.
//!
//! Encoders: motor encoder in 6064h, 6063h, 606Ch; output encoder in 60E4h:01, 60E5h:01, with its counts in 60E6h:01.
//!
//! Watchdog: heartbeats of the node in 1016h:01, guarding requests (100Ch times 100Dh), and RPDOs whose event timer is
//! not zero. If one is late, the CAN controller goes off the bus, or the node is stopped or reset, 6007h decides over an
//! enabled drive: 0 nothing, 1 fault, 2 disable voltage, 3 quick stop. Life guarding, heartbeat and bus-off change the
//! network state by 1029h:01. Bus-off is reported as 8140h once the controller has returned.
//!
//! Targets: an enabled drive without a target holds its angle. Target position, velocity and torque are those since the
//! drive was last disabled; until a client writes one, the position is the present angle, the others are zero.
//!
//! Limits of this implementation: no block transfer, no LSS, no TIME, no storage (1010h), no SYNC producer; RPDO and
//! TPDO types 0 to 240 and 253 to 255; modes 1, 3, 8, 9, 10. Profile position takes each set-point at once; its ramps
//! both have the smaller of 6083h and 6084h. Options 605Bh, 605Ch and 605Eh take the torque off. The position offset
//! acts in modes 1 and 8. An error of 1003h has no additional information. Settings of the drive (gains, limits)
//! outlast a reset of the node.

pub mod client;
pub mod dictionary;
pub mod fault;
mod motion;
mod network;
pub mod nmt;
mod objects;
pub mod pdo;
mod process;
pub mod sdo;
pub mod state;
pub mod units;

use crate::bus::CanServer;
use crate::drive::{Drive, Expiry, Law, Settings};
use crate::frame::{Frame, Kind, Send, standard};
use crate::turns::Turns;
use dictionary::{COUNT, ENTRIES, PDO_COUNT};
use heapless::Vec;
pub use motion::Mode;
use nmt::{Monitor, Nmt};
use objects::Bound;
use state::State;

/// Settings of a CiA 402 drive: cascade of position and velocity loop, monitoring by the server.
pub fn settings(settings: Settings) -> Settings {
    Settings { law: Law::Cascade, watchdog: None, expiry: Expiry::Disable, ..settings }
}

/// Drive on a CANopen bus.
#[derive(Debug, Clone)]
pub struct Server {
    node: u8,
    /// Rated torque of the motor [N m].
    rated_torque: Option<f32>,
    /// Time since power-up [us].
    now: u64,
    nmt: Nmt,
    /// Time at which the initialisation began [us].
    initialised_from: u64,
    /// Stored values, in the order of the dictionary.
    values: [u32; COUNT],
    state: State,
    /// Last control word.
    control: u16,
    /// Target of the profile position mode.
    goal: Turns,
    /// True once a client wrote a target for the present operation.
    has_target: bool,
    /// True while the drive's set-point is older than the objects.
    is_changed: bool,
    /// Control period in which the operation or the quick stop began.
    enabled_at: u32,
    /// Last time without a following error [us].
    on_target: u64,
    /// Present error code.
    error: u16,
    /// Error code of the fault that the server declared.
    cause: Option<u16>,
    history: fault::History,
    emergencies: Vec<u16, 4>,
    transfer: sdo::Transfer,
    receive: [pdo::Receive; PDO_COUNT],
    transmit: [pdo::Transmit; PDO_COUNT],
    heartbeat: Monitor,
    guarding: Monitor,
    /// True while the master is lost.
    is_alone: bool,
    toggle: bool,
    heartbeat_sent: u64,
}

impl Server {
    /// Drive with a node identifier, 1 to 127; others give the nearest.
    pub fn new(node: u8) -> Self {
        let mut server = Self { node: node.clamp(1, 127), ..Self::BLANK };
        server.set_initial_values(|_| true);
        server
    }

    /// State at power-up, without the node and the values of the objects.
    const BLANK: Self = Self {
        node: 0,
        rated_torque: None,
        now: 0,
        nmt: Nmt::Initialising,
        initialised_from: 0,
        values: [0; COUNT],
        state: State::NotReadyToSwitchOn,
        control: 0,
        goal: Turns::ZERO,
        has_target: false,
        is_changed: false,
        enabled_at: 0,
        on_target: 0,
        error: 0,
        cause: None,
        history: fault::History::EMPTY,
        emergencies: Vec::new(),
        transfer: sdo::Transfer::Idle,
        receive: [pdo::Receive::NONE; PDO_COUNT],
        transmit: [pdo::Transmit::NONE; PDO_COUNT],
        heartbeat: Monitor::NONE,
        guarding: Monitor::NONE,
        is_alone: false,
        toggle: false,
        heartbeat_sent: 0,
    };

    /// Restarts the node in its place: the tick has no stack for a second server.
    #[inline(never)]
    fn restart(&mut self) {
        let Self { node, rated_torque, now, .. } = *self;
        *self = Self { node, rated_torque, now, initialised_from: now, ..Self::BLANK };
        self.set_initial_values(|_| true);
    }

    /// Gives the objects for which a condition holds their values at power-up.
    fn set_initial_values(&mut self, is_reset: impl Fn(&dictionary::Entry) -> bool) {
        let node = self.node;
        let reset = self.values.iter_mut().zip(&ENTRIES).filter(|(_, entry)| is_reset(entry));
        reset.for_each(|(value, entry)| *value = entry.initial(node));
    }

    /// States the rated torque of the motor [N m]. Without it, 1000 thousandths are the motor's largest torque.
    pub fn with_rated_torque(self, rated_torque: f32) -> Self {
        Self { rated_torque: Some(rated_torque).filter(|torque| *torque > 0.0), ..self }
    }

    /// Node identifier.
    pub fn node(&self) -> u8 {
        self.node
    }

    /// State of the network management.
    pub fn nmt(&self) -> Nmt {
        self.nmt
    }

    /// State of the profile.
    pub fn state(&self) -> State {
        self.state
    }

    /// Present error code; 0 without an error.
    pub fn error_code(&self) -> u16 {
        self.error
    }

    fn error_register(&self) -> u8 {
        fault::register(self.error)
    }

    /// Notes an error and reports it.
    fn raise(&mut self, code: u16) {
        self.error = code;
        self.history.push(code);
        self.report(code);
    }

    fn clear_error(&mut self) {
        self.error = 0;
        self.report(0);
    }

    fn report(&mut self, code: u16) {
        // Beyond four errors in a period, the later ones stand in the list of errors only.
        let _ = self.emergencies.push(code);
    }

    fn send(&self, base: u16, data: &[u8], send: Send<'_>) {
        if let Some(frame) = Frame::classic(standard(base + u16::from(self.node)), data) {
            send(frame);
        }
    }

    fn send_emergencies(&mut self, send: Send<'_>) {
        for code in core::mem::take(&mut self.emergencies) {
            if self.nmt.is_configurable() {
                let [low, high] = code.to_le_bytes();
                self.send(0x80, &[low, high, self.error_register(), 0, 0, 0, 0, 0], send);
            }
        }
    }

    fn answer_sdo(&mut self, frame: &Frame, drive: &mut Drive, send: Send<'_>) {
        let Some(bytes) = frame.bytes::<8>().filter(|_| self.nmt.is_configurable()) else { return };
        let mut transfer = core::mem::take(&mut self.transfer);
        let answer = transfer.answer(&bytes, &mut Bound { server: self, drive });
        self.transfer = transfer;
        if let Some(answer) = answer {
            self.send(0x580, &answer.encode(sdo::Side::Response), send);
        }
    }
}

impl CanServer for Server {
    fn receive(&mut self, frame: &Frame, drive: &mut Drive, send: Send<'_>) {
        let Some(id) = frame.standard_id() else { return };
        let data = frame.data();
        match frame.kind {
            Kind::Flexible(_) => return,
            Kind::Remote => return self.answer_remote(id, drive, send),
            Kind::Classic => {}
        }
        let is_operational = self.nmt == Nmt::Operational;
        let (master, _) = self.consumer();
        match id {
            0 => self.manage(data, drive),
            0x80 if is_operational => {
                self.apply_pdos(None, drive);
                self.due_pdos(pdo::Trigger::Sync, None, drive).for_each(&mut *send);
            }
            id if id == 0x600 + u16::from(self.node) => self.answer_sdo(frame, drive, send),
            id if master > 0 && id == 0x700 + master => {
                let was_lost = self.heartbeat.feed(self.now);
                self.return_from_loss(was_lost);
            }
            _ if is_operational => self.receive_pdo(id, data, drive),
            _ => {}
        }
        self.follow(drive);
        self.send_emergencies(send);
    }

    fn tick(&mut self, drive: &mut Drive, send: Send<'_>) {
        self.rated_torque.get_or_insert(drive.settings().torque_limit);
        self.now += (drive.settings().period * 1e6 + 0.5) as u64;
        self.send_heartbeat(send);
        self.supervise(drive);
        self.monitor(drive);
        self.follow(drive);
        self.send_emergencies(send);
        if self.nmt == Nmt::Operational {
            self.due_pdos(pdo::Trigger::Time, None, drive).for_each(&mut *send);
        }
    }

    fn bus_off(&mut self, is_off: bool, drive: &mut Drive, send: Send<'_>) {
        if is_off {
            self.lose_connection(fault::BUS_OFF, drive);
        } else {
            self.return_from_loss(true);
        }
        self.send_emergencies(send);
    }
}

#[cfg(test)]
mod eds;
#[cfg(test)]
mod tests;
