//! Object dictionary: one table for server, client and EDS file.

/// Place of an object: index and sub-index.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Address {
    /// Index.
    pub index: u16,
    /// Sub-index.
    pub sub: u8,
}

impl Address {
    /// Address of a sub-index.
    pub const fn new(index: u16, sub: u8) -> Self {
        Self { index, sub }
    }

    /// Row of the dictionary; `None` if no object has this address.
    pub fn entry(self) -> Option<&'static Entry> {
        ENTRIES.get(self.position()?)
    }

    /// Position of the row in the dictionary.
    pub fn position(self) -> Option<usize> {
        ENTRIES.binary_search_by_key(&self, |entry| entry.address).ok()
    }
}

/// Data type of an object.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[allow(missing_docs, reason = "names of the types in CiA 301")]
pub enum Kind {
    Unsigned8,
    Unsigned16,
    Unsigned32,
    Integer8,
    Integer16,
    Integer32,
    Real32,
    VisibleString,
}

impl Kind {
    /// Bytes of a value; 0 for a text.
    pub const fn size(self) -> usize {
        match self {
            Self::Unsigned8 | Self::Integer8 => 1,
            Self::Unsigned16 | Self::Integer16 => 2,
            Self::Unsigned32 | Self::Integer32 | Self::Real32 => 4,
            Self::VisibleString => 0,
        }
    }

    /// Number of the type in CiA 301.
    pub const fn code(self) -> u16 {
        match self {
            Self::Integer8 => 2,
            Self::Integer16 => 3,
            Self::Integer32 => 4,
            Self::Unsigned8 => 5,
            Self::Unsigned16 => 6,
            Self::Unsigned32 => 7,
            Self::Real32 => 8,
            Self::VisibleString => 9,
        }
    }

    /// Number in the bytes of a value; the bits of a float.
    pub const fn number(self, raw: u32) -> i64 {
        match self {
            Self::Integer8 => raw as i8 as i64,
            Self::Integer16 => raw as i16 as i64,
            Self::Integer32 => raw as i32 as i64,
            Self::Unsigned8 => raw as u8 as i64,
            Self::Unsigned16 => raw as u16 as i64,
            Self::Unsigned32 | Self::Real32 | Self::VisibleString => raw as i64,
        }
    }
}

/// Access by a client.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Access {
    /// The value never changes.
    Constant,
    /// The drive changes the value.
    ReadOnly,
    /// A client changes the value.
    ReadWrite,
}

/// Value after power-up.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Initial {
    /// Number.
    Number(i64),
    /// Number plus the node's identifier.
    PlusNode(u32),
    /// Text.
    Text(&'static str),
    /// Quantity or setting of the drive.
    Live,
}

/// Rules of an object.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Rules {
    /// Access by SDO.
    pub access: Access,
    /// True if a PDO may hold the object.
    pub is_mappable: bool,
    /// Value after power-up.
    pub initial: Initial,
    /// Least and largest number.
    pub range: Option<(i64, i64)>,
}

impl Rules {
    const fn new(access: Access, is_mappable: bool, initial: Initial) -> Self {
        Self { access, is_mappable, initial, range: None }
    }

    const fn within(self, low: i64, high: i64) -> Self {
        Self { range: Some((low, high)), ..self }
    }
}

const fn constant(number: i64) -> Rules {
    Rules::new(Access::Constant, false, Initial::Number(number))
}

const fn text(text: &'static str) -> Rules {
    Rules::new(Access::Constant, false, Initial::Text(text))
}

/// Quantity of the drive, for TPDOs.
const READING: Rules = Rules::new(Access::ReadOnly, true, Initial::Live);
/// Property of the drive that does not change in operation.
const PROPERTY: Rules = Rules::new(Access::ReadOnly, false, Initial::Live);
/// Setting of the drive.
const SETTING: Rules = Rules::new(Access::ReadWrite, false, Initial::Live);

/// Configuration that a client may change.
const fn option(number: i64) -> Rules {
    Rules::new(Access::ReadWrite, false, Initial::Number(number))
}

/// Command, for RPDOs.
const fn command(number: i64) -> Rules {
    Rules::new(Access::ReadWrite, true, Initial::Number(number))
}

/// Identifier of a frame.
const fn identifier(access: Access, base: u32) -> Rules {
    Rules::new(access, false, Initial::PlusNode(base))
}

/// Row of the dictionary.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Entry {
    /// Address.
    pub address: Address,
    /// Name in the EDS file.
    pub name: &'static str,
    /// Data type.
    pub kind: Kind,
    /// Rules.
    pub rules: Rules,
}

impl Entry {
    /// Value after power-up of the node.
    pub fn initial(&self, node: u8) -> u32 {
        match self.rules.initial {
            Initial::Number(number) => number as u32,
            Initial::PlusNode(base) => base.wrapping_add(node.into()),
            Initial::Text(_) | Initial::Live => 0,
        }
    }

    /// Entry of a PDO mapping that holds this object.
    pub const fn mapping(&self) -> u32 {
        mapping(self.address, self.kind)
    }
}

const fn mapping(address: Address, kind: Kind) -> u32 {
    (address.index as u32) << 16 | (address.sub as u32) << 8 | (8 * kind.size() as u32)
}

/// Address in an entry of a PDO mapping.
pub const fn mapped_address(mapping: u32) -> Address {
    Address::new((mapping >> 16) as u16, (mapping >> 8) as u8)
}

/// Address constants and rows: name, index, sub-index, name in the EDS file, data type, rules.
macro_rules! rows {
    ($table:ident: $($name:ident $index:literal $sub:literal $text:literal $kind:ident $rules:expr;)*) => {
        $(#[doc = concat!($text, ".")] pub const $name: Address = Address::new($index, $sub);)*
        const $table: &[Entry] =
            &[$(Entry { address: $name, name: $text, kind: Kind::$kind, rules: $rules }),*];
    };
}

rows! { COMMUNICATION:
    DEVICE_TYPE 0x1000 0 "Device type" Unsigned32 constant(0x0002_0192);
    ERROR_REGISTER 0x1001 0 "Error register" Unsigned8 READING;
    ERROR_COUNT 0x1003 0 "Number of errors" Unsigned8 SETTING.within(0, 0);
    ERROR_1 0x1003 1 "Latest error" Unsigned32 PROPERTY;
    ERROR_2 0x1003 2 "Error before" Unsigned32 PROPERTY;
    ERROR_3 0x1003 3 "Second error before" Unsigned32 PROPERTY;
    ERROR_4 0x1003 4 "Third error before" Unsigned32 PROPERTY;
    SYNC_ID 0x1005 0 "COB-ID SYNC" Unsigned32 constant(0x80);
    DEVICE_NAME 0x1008 0 "Manufacturer device name" VisibleString text("Geared joint drive");
    HARDWARE_VERSION 0x1009 0 "Manufacturer hardware version" VisibleString text("1.0");
    SOFTWARE_VERSION 0x100A 0 "Manufacturer software version" VisibleString text("1.0");
    GUARD_TIME 0x100C 0 "Guard time" Unsigned16 option(0);
    LIFE_TIME_FACTOR 0x100D 0 "Life time factor" Unsigned8 option(0);
    EMERGENCY_ID 0x1014 0 "COB-ID EMCY" Unsigned32 identifier(Access::ReadOnly, 0x80);
    CONSUMER_COUNT 0x1016 0 "Number of heartbeat consumers" Unsigned8 constant(1);
    CONSUMER_HEARTBEAT 0x1016 1 "Consumer heartbeat time" Unsigned32 option(0).within(0, 0x7F_FFFF);
    PRODUCER_HEARTBEAT 0x1017 0 "Producer heartbeat time" Unsigned16 option(0);
    IDENTITY_COUNT 0x1018 0 "Number of identity entries" Unsigned8 constant(4);
    VENDOR 0x1018 1 "Vendor-ID" Unsigned32 constant(0);
    PRODUCT_CODE 0x1018 2 "Product code" Unsigned32 constant(1);
    REVISION 0x1018 3 "Revision number" Unsigned32 constant(0x0001_0000);
    SERIAL_NUMBER 0x1018 4 "Serial number" Unsigned32 constant(0);
    BEHAVIOUR_COUNT 0x1029 0 "Number of error behaviours" Unsigned8 constant(1);
    COMMUNICATION_ERROR_BEHAVIOUR 0x1029 1 "Communication error" Unsigned8 option(0).within(0, 2);
    SDO_COUNT 0x1200 0 "Number of SDO entries" Unsigned8 constant(2);
    SDO_REQUEST_ID 0x1200 1 "COB-ID client to server" Unsigned32 identifier(Access::ReadOnly, 0x600);
    SDO_RESPONSE_ID 0x1200 2 "COB-ID server to client" Unsigned32 identifier(Access::ReadOnly, 0x580);
}

rows! { MANUFACTURER:
    MOTOR_TEMPERATURE 0x2001 0 "Winding temperature [0.1 deg C]" Integer16 READING;
    BOARD_TEMPERATURE 0x2002 0 "Power stage temperature [0.1 deg C]" Integer16 READING;
    CALIBRATION 0x2003 0 "Calibration" Unsigned8 SETTING.within(1, 1);
    GAIN_COUNT 0x2010 0 "Number of gains" Unsigned8 constant(8);
    STIFFNESS 0x2010 1 "Stiffness of the parallel law [N m/rad]" Real32 SETTING;
    DAMPING 0x2010 2 "Damping of the parallel law [N m s/rad]" Real32 SETTING;
    INTEGRAL 0x2010 3 "Integral gain of the parallel law [N m/(rad s)]" Real32 SETTING;
    POSITION_GAIN 0x2010 4 "Position gain of the cascade [1/s]" Real32 SETTING;
    VELOCITY_GAIN 0x2010 5 "Velocity gain [N m s/rad]" Real32 SETTING;
    VELOCITY_INTEGRAL 0x2010 6 "Velocity integral gain [N m/rad]" Real32 SETTING;
    INTEGRAL_LIMIT 0x2010 7 "Integral limit of the parallel law [N m]" Real32 SETTING;
    LAW 0x2010 8 "Position loop: 0 parallel, 1 cascade" Unsigned8 SETTING.within(0, 1);
    PROTECTION_COUNT 0x2020 0 "Number of protections" Unsigned8 constant(4);
    MIN_VOLTAGE 0x2020 1 "Least DC link voltage [mV]" Unsigned32 SETTING;
    MAX_VOLTAGE 0x2020 2 "Largest DC link voltage [mV]" Unsigned32 SETTING;
    MAX_TEMPERATURE 0x2020 3 "Largest temperature [0.1 deg C]" Integer16 SETTING;
    OVERSPEED 0x2020 4 "Overspeed [velocity units]" Unsigned32 SETTING;
}

rows! { PROFILE:
    ABORT_CONNECTION_OPTION 0x6007 0 "Abort connection option code" Integer16 option(1).within(0, 3);
    ERROR_CODE 0x603F 0 "Error code" Unsigned16 READING;
    CONTROLWORD 0x6040 0 "Controlword" Unsigned16 command(0);
    STATUSWORD 0x6041 0 "Statusword" Unsigned16 READING;
    QUICK_STOP_OPTION 0x605A 0 "Quick stop option code" Integer16 option(2).within(0, 6);
    SHUTDOWN_OPTION 0x605B 0 "Shutdown option code" Integer16 constant(0);
    DISABLE_OPTION 0x605C 0 "Disable operation option code" Integer16 constant(0);
    HALT_OPTION 0x605D 0 "Halt option code" Integer16 constant(1);
    FAULT_REACTION_OPTION 0x605E 0 "Fault reaction option code" Integer16 constant(0);
    MODE 0x6060 0 "Modes of operation" Integer8 command(0);
    MODE_DISPLAY 0x6061 0 "Modes of operation display" Integer8 READING;
    POSITION_DEMAND 0x6062 0 "Position demand value" Integer32 READING;
    POSITION_INTERNAL 0x6063 0 "Position actual internal value" Integer32 READING;
    POSITION_ACTUAL 0x6064 0 "Position actual value" Integer32 READING;
    FOLLOWING_WINDOW 0x6065 0 "Following error window" Unsigned32 option(0xFFFF_FFFF);
    FOLLOWING_TIMEOUT 0x6066 0 "Following error time out" Unsigned16 option(0);
    POSITION_WINDOW 0x6067 0 "Position window" Unsigned32 option(360);
    VELOCITY_DEMAND 0x606B 0 "Velocity demand value" Integer32 READING;
    VELOCITY_ACTUAL 0x606C 0 "Velocity actual value" Integer32 READING;
    TARGET_TORQUE 0x6071 0 "Target torque" Integer16 command(0);
    MAX_TORQUE 0x6072 0 "Max torque" Unsigned16 Rules::new(Access::ReadWrite, true, Initial::Live);
    TORQUE_DEMAND 0x6074 0 "Torque demand" Integer16 READING;
    RATED_CURRENT 0x6075 0 "Motor rated current" Unsigned32 PROPERTY;
    RATED_TORQUE 0x6076 0 "Motor rated torque" Unsigned32 PROPERTY;
    TORQUE_ACTUAL 0x6077 0 "Torque actual value" Integer16 READING;
    CURRENT_ACTUAL 0x6078 0 "Current actual value" Integer16 READING;
    DC_LINK_VOLTAGE 0x6079 0 "DC link circuit voltage" Unsigned32 READING;
    TARGET_POSITION 0x607A 0 "Target position" Integer32 command(0);
    LIMIT_COUNT 0x607D 0 "Number of position limits" Unsigned8 constant(2);
    MIN_POSITION 0x607D 1 "Min position limit" Integer32 SETTING;
    MAX_POSITION 0x607D 2 "Max position limit" Integer32 SETTING;
    MAX_MOTOR_SPEED 0x6080 0 "Max motor speed" Unsigned32 SETTING;
    PROFILE_VELOCITY 0x6081 0 "Profile velocity" Unsigned32 command(180_000);
    PROFILE_ACCELERATION 0x6083 0 "Profile acceleration" Unsigned32 command(720_000).within(1, 0xFFFF_FFFF);
    PROFILE_DECELERATION 0x6084 0 "Profile deceleration" Unsigned32 command(720_000).within(1, 0xFFFF_FFFF);
    QUICK_STOP_DECELERATION 0x6085 0 "Quick stop deceleration" Unsigned32 option(3_600_000).within(1, 0xFFFF_FFFF);
    RESOLUTION_COUNT 0x608F 0 "Number of resolution entries" Unsigned8 constant(2);
    ENCODER_INCREMENTS 0x608F 1 "Encoder increments" Unsigned32 PROPERTY;
    ENCODER_REVOLUTIONS 0x608F 2 "Motor revolutions" Unsigned32 constant(1);
    GEAR_COUNT 0x6091 0 "Number of gear ratio entries" Unsigned8 constant(2);
    GEAR_MOTOR 0x6091 1 "Motor shaft revolutions" Unsigned32 PROPERTY;
    GEAR_SHAFT 0x6091 2 "Driving shaft revolutions" Unsigned32 PROPERTY;
    FEED_COUNT 0x6092 0 "Number of feed constant entries" Unsigned8 constant(2);
    FEED 0x6092 1 "Feed" Unsigned32 option(360_000).within(1, 0x7FFF_FFFF);
    FEED_SHAFT 0x6092 2 "Shaft revolutions" Unsigned32 constant(1);
    POSITION_OFFSET 0x60B0 0 "Position offset" Integer32 command(0);
    VELOCITY_OFFSET 0x60B1 0 "Velocity offset" Integer32 command(0);
    TORQUE_OFFSET 0x60B2 0 "Torque offset" Integer16 command(0);
    INTERPOLATION_COUNT 0x60C2 0 "Number of interpolation entries" Unsigned8 constant(2);
    INTERPOLATION_TIME 0x60C2 1 "Interpolation time period value" Unsigned8 option(1);
    INTERPOLATION_EXPONENT 0x60C2 2 "Interpolation time index" Integer8 option(-3).within(-6, 0);
    OUTPUT_POSITION_COUNT 0x60E4 0 "Number of additional positions" Unsigned8 constant(1);
    OUTPUT_POSITION 0x60E4 1 "1st additional position actual value" Integer32 READING;
    OUTPUT_VELOCITY_COUNT 0x60E5 0 "Number of additional velocities" Unsigned8 constant(1);
    OUTPUT_VELOCITY 0x60E5 1 "1st additional velocity actual value" Integer32 READING;
    OUTPUT_RESOLUTION_COUNT 0x60E6 0 "Number of additional resolutions" Unsigned8 constant(1);
    OUTPUT_INCREMENTS 0x60E6 1 "1st additional encoder increments" Unsigned32 PROPERTY;
    OUTPUT_REVOLUTION_COUNT 0x60EB 0 "Number of additional revolutions" Unsigned8 constant(1);
    OUTPUT_REVOLUTIONS 0x60EB 1 "1st additional encoder revolutions" Unsigned32 constant(1);
    FOLLOWING_ERROR 0x60F4 0 "Following error actual value" Integer32 READING;
    TARGET_VELOCITY 0x60FF 0 "Target velocity" Integer32 command(0);
    SUPPORTED_MODES 0x6502 0 "Supported drive modes" Unsigned32 constant(0x0385);
}

/// PDOs in each direction.
pub const PDO_COUNT: usize = 4;
/// Bit of a PDO's identifier that turns the PDO off.
pub const PDO_IS_INVALID: u32 = 1 << 31;

/// Direction of a PDO.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Direction {
    /// RPDO: from a client to the drive.
    Receive,
    /// TPDO: from the drive to a client.
    Transmit,
}

impl Direction {
    /// Index of the parameters of the PDO with a number from 0.
    pub const fn parameters(self, number: usize) -> u16 {
        number as u16 + if matches!(self, Self::Receive) { 0x1400 } else { 0x1800 }
    }

    /// Index of the mapping of the PDO with a number from 0.
    pub const fn mapping(self, number: usize) -> u16 {
        self.parameters(number) + 0x200
    }

    /// Identifier of the PDO with a number from 0, without the node's.
    pub const fn base_id(self, number: usize) -> u32 {
        0x100 * number as u32 + if matches!(self, Self::Receive) { 0x200 } else { 0x180 }
    }
}

/// PDO after power-up: transmission type, inhibit time [0.1 ms], event timer [ms], objects or 0. No object is in two
/// PDOs: a client that sends one PDO would send an old value of the object in the other.
struct PdoRow(i64, i64, i64, [u32; 2]);

const RECEIVE: [PdoRow; PDO_COUNT] = [
    PdoRow(255, 0, 0, [mapping(CONTROLWORD, Kind::Unsigned16), mapping(MODE, Kind::Integer8)]),
    PdoRow(255, 0, 0, [mapping(TARGET_POSITION, Kind::Integer32), mapping(VELOCITY_OFFSET, Kind::Integer32)]),
    PdoRow(255, 0, 0, [mapping(TARGET_VELOCITY, Kind::Integer32), mapping(TORQUE_OFFSET, Kind::Integer16)]),
    PdoRow(255, 0, 0, [mapping(TARGET_TORQUE, Kind::Integer16), 0]),
];
const TRANSMIT: [PdoRow; PDO_COUNT] = [
    PdoRow(255, 10, 100, [mapping(STATUSWORD, Kind::Unsigned16), mapping(MODE_DISPLAY, Kind::Integer8)]),
    PdoRow(1, 0, 0, [mapping(POSITION_ACTUAL, Kind::Integer32), mapping(OUTPUT_POSITION, Kind::Integer32)]),
    PdoRow(1, 0, 0, [mapping(VELOCITY_ACTUAL, Kind::Integer32), mapping(TORQUE_ACTUAL, Kind::Integer16)]),
    PdoRow(255, 1000, 1000, [mapping(DC_LINK_VOLTAGE, Kind::Unsigned32), mapping(MOTOR_TEMPERATURE, Kind::Integer16)]),
];

/// Rows of the parameters of a PDO.
const PARAMETER_ROWS: usize = 5;
/// Rows of the mapping of a PDO.
const MAPPING_ROWS: usize = 9;

const fn parameter_row(direction: Direction, number: usize, row: usize) -> Entry {
    let index = direction.parameters(number);
    let PdoRow(transmission, inhibit, event, _) =
        if matches!(direction, Direction::Receive) { &RECEIVE[number] } else { &TRANSMIT[number] };
    let (sub, name, kind, rules) = match row {
        0 => (0, "Highest sub-index supported", Kind::Unsigned8, constant(5)),
        1 => (1, "COB-ID", Kind::Unsigned32, identifier(Access::ReadWrite, direction.base_id(number))),
        2 => (2, "Transmission type", Kind::Unsigned8, option(*transmission)),
        3 => (3, "Inhibit time", Kind::Unsigned16, option(*inhibit)),
        _ => (5, "Event timer", Kind::Unsigned16, option(*event)),
    };
    Entry { address: Address::new(index, sub), name, kind, rules }
}

const fn mapping_row(direction: Direction, number: usize, row: usize) -> Entry {
    let address = Address::new(direction.mapping(number), row as u8);
    let PdoRow(.., objects) =
        if matches!(direction, Direction::Receive) { &RECEIVE[number] } else { &TRANSMIT[number] };
    if row == 0 {
        let rules = option(1 + (objects[1] != 0) as i64).within(0, 8);
        return Entry { address, name: "Number of mapped objects", kind: Kind::Unsigned8, rules };
    }
    let object = if row <= objects.len() { objects[row - 1] as i64 } else { 0 };
    Entry { address, name: "Mapped object", kind: Kind::Unsigned32, rules: option(object) }
}

/// Rows of all PDOs in one direction.
const PDO_ROWS: usize = PDO_COUNT * (PARAMETER_ROWS + MAPPING_ROWS);

const fn pdo_rows(direction: Direction) -> [Entry; PDO_ROWS] {
    let mut rows = [parameter_row(direction, 0, 0); PDO_ROWS];
    let mut number = 0;
    while number < PDO_COUNT {
        let mut row = 0;
        while row < MAPPING_ROWS {
            if row < PARAMETER_ROWS {
                rows[PARAMETER_ROWS * number + row] = parameter_row(direction, number, row);
            }
            rows[PDO_COUNT * PARAMETER_ROWS + MAPPING_ROWS * number + row] = mapping_row(direction, number, row);
            row += 1;
        }
        number += 1;
    }
    rows
}

const PARTS: [&[Entry]; 5] =
    [COMMUNICATION, &pdo_rows(Direction::Receive), &pdo_rows(Direction::Transmit), MANUFACTURER, PROFILE];

/// Rows of the dictionary.
pub const COUNT: usize = COMMUNICATION.len() + 2 * PDO_ROWS + MANUFACTURER.len() + PROFILE.len();

/// Dictionary, sorted by address.
pub static ENTRIES: [Entry; COUNT] = joined();

const fn joined() -> [Entry; COUNT] {
    let mut all = [PARTS[0][0]; COUNT];
    let (mut part, mut at) = (0, 0);
    while part < PARTS.len() {
        let mut row = 0;
        while row < PARTS[part].len() {
            all[at] = PARTS[part][row];
            (row, at) = (row + 1, at + 1);
        }
        part += 1;
    }
    all
}

/// Names of the objects with sub-indices; true for an array, false for a record.
pub const GROUPS: [(u16, &str, bool); 16] = [
    (0x1003, "Pre-defined error field", true),
    (0x1016, "Consumer heartbeat time", true),
    (0x1018, "Identity object", false),
    (0x1029, "Error behaviour", true),
    (0x1200, "SDO server parameter", false),
    (0x2010, "Gains", false),
    (0x2020, "Protections", false),
    (0x607D, "Software position limit", true),
    (0x608F, "Position encoder resolution", true),
    (0x6091, "Gear ratio", true),
    (0x6092, "Feed constant", true),
    (0x60C2, "Interpolation time period", false),
    (0x60E4, "Additional position actual value", true),
    (0x60E5, "Additional velocity actual value", true),
    (0x60E6, "Additional position encoder resolution: increments", true),
    (0x60EB, "Additional position encoder resolution: revolutions", true),
];
