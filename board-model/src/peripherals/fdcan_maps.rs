//! Registers of the FDCAN of STM32G4 (RM0440 44) and STM32H743 (RM0433 56): common offsets, and those of each chip with
//! the division of its message RAM.

use super::fdcan_ram::{Fifo, Part, Parts};
use crate::register::{Register, Registers, bit};

pub(super) const DBTP: u32 = 0x0c;
pub(super) const CCCR: u32 = 0x18;
pub(super) const NBTP: u32 = 0x1c;
pub(super) const ECR: u32 = 0x40;
pub(super) const PSR: u32 = 0x44;
pub(super) const TDCR: u32 = 0x48;
pub(super) const IR: u32 = 0x50;
pub(super) const IE: u32 = 0x54;
pub(super) const ILS: u32 = 0x58;
pub(super) const ILE: u32 = 0x5c;
/// RXGFC of STM32G4, GFC of STM32H743: the bits for frames that no filter has passed are the same.
pub(super) const GFC: u32 = 0x80;

/// What differs between the chips.
#[derive(Debug)]
pub struct Map {
    /// Registers.
    pub table: &'static [Register],
    /// Status and acknowledgement of receive FIFO 0.
    pub receive: [u32; 2],
    /// Transmit FIFO: status, pending requests, requests.
    pub send: [u32; 3],
    /// Flags of a full FIFO 0, of a lost frame and of bus-off in IR.
    pub flags: [u32; 3],
    /// Register that divides the clock, if the peripheral has one.
    pub divider: Option<u32>,
    /// Registers that can be changed during the initialisation only, beside those of the bit timing.
    pub settings: &'static [u32],
    /// Settings that the model does not have, or that errata forbid.
    pub missing: &'static [Missing],
    /// Size of the message RAM [byte].
    pub ram: u32,
    /// Division of the message RAM.
    pub parts: fn(&Registers) -> Parts,
    /// Sections of initialisation, bit timing, message RAM, and FIFOs.
    pub sections: [&'static str; 4],
}

/// Setting that must not be made: register, bits, and why.
#[derive(Debug)]
pub struct Missing {
    pub(super) register: u32,
    pub(super) mask: u32,
    pub(super) what: &'static str,
    pub(super) section: &'static str,
}

const fn missing(register: u32, mask: u32, what: &'static str) -> Missing {
    Missing { register, mask, what, section: "modes that the model does not have" }
}

const QUEUE: &str = "a transmit queue, which does not keep the order";
const FILTERS: &str = "filters of the message RAM";

/// Registers common to both.
const COMMON: [Register; 14] = [
    Register::new("FDCAN_DBTP", DBTP, 0x0000_0a33, 0x009f_1fff),
    Register::new("FDCAN_TEST", 0x10, 0, 0),
    Register::new("FDCAN_RWD", 0x14, 0, 0xffff),
    Register::new("FDCAN_CCCR", CCCR, 1, 0xf3ff),
    Register::new("FDCAN_NBTP", NBTP, 0x0600_0a03, 0xffff_ff7f),
    Register::new("FDCAN_TSCC", 0x20, 0, 0x000f_0003),
    Register::new("FDCAN_TSCV", 0x24, 0, 0xffff).special(0xffff),
    Register::new("FDCAN_TOCC", 0x28, 0xffff_0000, 0xffff_0007),
    Register::new("FDCAN_ECR", ECR, 0, 0x00ff_ffff).special(0x00ff_ffff),
    Register::new("FDCAN_PSR", PSR, 0x707, 0x007f_7fff).special(0x007f_7fff),
    Register::new("FDCAN_TDCR", TDCR, 0, 0x7f7f),
    Register::new("FDCAN_ILE", ILE, 0, 3),
    Register::new("FDCAN_TXFQS", 0xc4, 0, 0x003f_1f3f).special(0x003f_1f3f),
    Register::new("FDCAN_TOCV", 0x2c, 0xffff, 0xffff).special(0xffff),
];

const G4_OWN: [Register; 15] = [
    Register::new("FDCAN_IR", IR, 0, 0x00ff_ffff).special(0x00ff_ffff),
    Register::new("FDCAN_IE", IE, 0, 0x00ff_ffff),
    Register::new("FDCAN_ILS", ILS, 0, 0x7f),
    Register::new("FDCAN_RXGFC", GFC, 0, 0x0f1f_033f),
    Register::new("FDCAN_XIDAM", 0x84, 0x1fff_ffff, 0x1fff_ffff),
    Register::new("FDCAN_RXF0S", 0x90, 0, 0x0303_030f).special(0x0303_030f),
    Register::new("FDCAN_RXF0A", 0x94, 0, 7),
    Register::new("FDCAN_RXF1S", 0x98, 0, 0x0303_030f).special(0x0303_030f),
    Register::new("FDCAN_TXBC", 0xc0, 0, bit(24)),
    Register::new("FDCAN_TXBRP", 0xc8, 0, 7).special(7),
    Register::new("FDCAN_TXBAR", 0xcc, 0, 7).special(7),
    Register::new("FDCAN_TXBTO", 0xd4, 0, 7).special(7),
    Register::new("FDCAN_TXBTIE", 0xdc, 0, 7),
    Register::new("FDCAN_TXEFS", 0xe4, 0, 0x0303_0307).special(0x0303_0307),
    Register::new("FDCAN_CKDIV", 0x100, 0, 0xf),
];
static G4_TABLE: [Register; 29] = joined(COMMON, G4_OWN);

/// STM32G4: fixed division of the message RAM (44.3.3).
pub static G4: Map = Map {
    table: &G4_TABLE,
    receive: [0x90, 0x94],
    send: [0xc4, 0xc8, 0xcc],
    flags: [1, 2, 19],
    divider: Some(0x100),
    settings: &[GFC, 0xc0, 0x100],
    missing: &[missing(GFC, 0x0f1f_0000, FILTERS), missing(0xc0, bit(24), QUEUE)],
    ram: 0x350,
    parts: |_| Parts {
        receive: Fifo { start: 0xb0, depth: 3, element: 72 },
        send: Fifo { start: 0x278, depth: 3, element: 72 },
        all: [Part::default(); 7],
    },
    sections: ["RM0440 44.3.2", "RM0440 44.3.1, 44.4.3, 44.4.7", "RM0440 44.3.3", "RM0440 44.3.6"],
};

const SIDFC: u32 = 0x84;
const XIDFC: u32 = 0x88;
const RXF0C: u32 = 0xa0;
const RXBC: u32 = 0xac;
const RXF1C: u32 = 0xb0;
const RXESC: u32 = 0xbc;
const TXBC: u32 = 0xc0;
const TXESC: u32 = 0xc8;
const TXEFC: u32 = 0xf0;

const H7_OWN: [Register; 30] = [
    Register::new("FDCAN_IR", IR, 0, 0x3fcf_ffff).special(0x3fcf_ffff),
    Register::new("FDCAN_IE", IE, 0, 0x3fff_ffff),
    Register::new("FDCAN_ILS", ILS, 0, 0x3fff_ffff),
    Register::new("FDCAN_GFC", GFC, 0, 0x3f),
    Register::new("FDCAN_SIDFC", SIDFC, 0, 0x00ff_fffc),
    Register::new("FDCAN_XIDFC", XIDFC, 0, 0x00ff_fffc),
    Register::new("FDCAN_XIDAM", 0x90, 0x1fff_ffff, 0x1fff_ffff),
    Register::new("FDCAN_NDAT1", 0x98, 0, u32::MAX).special(u32::MAX),
    Register::new("FDCAN_NDAT2", 0x9c, 0, u32::MAX).special(u32::MAX),
    Register::new("FDCAN_RXF0C", RXF0C, 0, 0xff7f_fffc),
    Register::new("FDCAN_RXF0S", 0xa4, 0, 0x033f_3f7f).special(0x033f_3f7f),
    Register::new("FDCAN_RXF0A", 0xa8, 0, 0x3f),
    Register::new("FDCAN_RXBC", RXBC, 0, 0xfffc),
    Register::new("FDCAN_RXF1C", RXF1C, 0, 0xff7f_fffc),
    Register::new("FDCAN_RXF1S", 0xb4, 0, 0xc37f_7f7f).special(0xc37f_7f7f),
    Register::new("FDCAN_RXF1A", 0xb8, 0, 0x3f),
    Register::new("FDCAN_RXESC", RXESC, 0, 0x777),
    Register::new("FDCAN_TXBC", TXBC, 0, 0x7f3f_fffc),
    Register::new("FDCAN_TXESC", TXESC, 0, 7),
    Register::new("FDCAN_TXBRP", 0xcc, 0, u32::MAX).special(u32::MAX),
    Register::new("FDCAN_TXBAR", 0xd0, 0, u32::MAX).special(u32::MAX),
    Register::new("FDCAN_TXBCR", 0xd4, 0, u32::MAX).special(u32::MAX),
    Register::new("FDCAN_TXBTO", 0xd8, 0, u32::MAX).special(u32::MAX),
    Register::new("FDCAN_TXBCF", 0xdc, 0, u32::MAX).special(u32::MAX),
    Register::new("FDCAN_TXBTIE", 0xe0, 0, u32::MAX),
    Register::new("FDCAN_TXBCIE", 0xe4, 0, u32::MAX),
    Register::new("FDCAN_TXEFC", TXEFC, 0, 0x3f3f_fffc),
    Register::new("FDCAN_TXEFS", 0xf4, 0, 0x031f_1f3f).special(0x031f_1f3f),
    Register::new("FDCAN_TXEFA", 0xf8, 0, 0x1f),
    Register::new("FDCAN_HPMS", 0x94, 0, 0xffff).special(0xffff),
];
static H7_TABLE: [Register; 44] = joined(COMMON, H7_OWN);

/// STM32H743: the message RAM of both peripherals, divided by registers; without time-triggered operation.
pub static H7: Map = Map {
    table: &H7_TABLE,
    receive: [0xa4, 0xa8],
    send: [0xc4, 0xcc, 0xd0],
    flags: [2, 3, 25],
    divider: None,
    settings: &[GFC, SIDFC, XIDFC, RXF0C, RXBC, RXF1C, RXESC, TXBC, TXESC, TXEFC],
    missing: &[
        missing(SIDFC, 0x00ff_0000, FILTERS),
        missing(XIDFC, 0x00ff_0000, FILTERS),
        missing(RXF0C, bit(31), "overwriting of FIFO 0"),
        missing(TXBC, bit(30), QUEUE),
        Missing {
            register: TXBC,
            mask: 0x003f_0000,
            what: "dedicated transmit buffers beside the FIFO, which may invert the order",
            section: "ES0392, FDCAN",
        },
    ],
    ram: 0x2800,
    parts: divide,
    sections: ["RM0433 56.3", "RM0433 56.5.3, 56.5.7", "RM0433 56.3, message RAM", "RM0433 56.3, FIFO"],
};

/// Data bytes of an element by the code of its size.
const SIZES: [u32; 8] = [8, 12, 16, 20, 24, 32, 48, 64];

/// Division of the message RAM by the registers of STM32H743, which hold addresses of words with two zeros behind.
fn divide(registers: &Registers) -> Parts {
    let start = |register| registers.get(register) & 0xfffc;
    let size = |register, low| 8 + SIZES[registers.field(register, low, 3) as usize];
    let part = |name, register, (low, bits): (u32, u32), most: u32, each: u32| {
        let count = registers.field(register, low, bits);
        Part { name, start: start(register), bytes: count * each, count, most }
    };
    let dedicated = registers.field(TXBC, 16, 6);
    let all = [
        part("standard filters", SIDFC, (16, 8), 128, 4),
        part("extended filters", XIDFC, (16, 8), 64, 8),
        part("receive FIFO 0", RXF0C, (16, 7), 64, size(RXESC, 0)),
        part("receive FIFO 1", RXF1C, (16, 7), 64, size(RXESC, 4)),
        part("dedicated transmit buffers", TXBC, (16, 6), 32, size(TXESC, 0)),
        Part {
            start: start(TXBC) + dedicated * size(TXESC, 0),
            ..part("transmit FIFO", TXBC, (24, 6), 32, size(TXESC, 0))
        },
        part("transmit events", TXEFC, (16, 6), 32, 8),
    ];
    let fifo =
        |Part { start, count, most, .. }: Part, element| Fifo { start, depth: count.min(most) as usize, element };
    Parts { receive: fifo(all[2], size(RXESC, 0)), send: fifo(all[5], size(TXESC, 0)), all }
}

/// Two tables as one.
const fn joined<const A: usize, const B: usize, const C: usize>(
    first: [Register; A],
    second: [Register; B],
) -> [Register; C] {
    assert!(A + B == C, "the sum");
    let mut all = [first[0]; C];
    let mut place = 0;
    while place < C {
        all[place] = if place < A { first[place] } else { second[place - A] };
        place += 1;
    }
    all
}
