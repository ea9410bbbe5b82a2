//! An AS5047P encoder read over SPI with the chip as master. No image that ships does that: the driver's code runs on
//! this host, over a bus made of the registers of the modelled chip, accessed as its manual says; the core stands
//! still.

use std::cell::RefCell;
use std::rc::Rc;

use board::device::board::Chip;
use embedded_hal::spi::{ErrorKind, ErrorType, Operation, SpiDevice};
use firmware::encoder::{As5047p, CountSource, EncoderFault};

use super::clean;
use crate::as5047p::{self, LOST, TOO_STRONG, TOO_WEAK, WELL};
use crate::boards::Subject;
use crate::talk::Shared;
use crate::wires::{MICROSECOND, Pin, Time};

const CR1: u32 = 0x00;
const CR2: u32 = 0x04;
const SR: u32 = 0x08;
const DR: u32 = 0x0c;
/// Control period: 10 kHz.
const PERIOD: Time = 100 * MICROSECOND;
/// Limit of readings before a fault is reported: the driver reads the diagnostics every 26 ms at this rate.
const PATIENCE: usize = 300;
/// Limit of reads of a status register.
const LOOKS: usize = 1000;
/// Cycles of one read of a status register.
const LOOK: u32 = 8;
/// More than 350 ns, the encoder's minimum between select and clock, and between frames [cycles at 16 MHz].
const SETTLE: u32 = 8;

/// Registers and pins of the SPI on a chip that runs at its clock after a reset, 16 MHz.
struct Place {
    spi: u32,
    registers: u32,
    select: Pin,
    /// Register writes that switch clocks on and set pins up: select as a high output, the others as alternate
    /// functions.
    set_up: &'static [(u32, u32)],
}

fn place(chip: Chip) -> Option<Place> {
    match chip {
        Chip::Stm32f405 => Some(Place {
            spi: 1,
            registers: 0x4001_3000,
            select: Pin('A', 4),
            set_up: &[
                (0x4002_3830, 1 << 20 | 1),
                (0x4002_3844, 1 << 12),
                (0x4002_0018, 1 << 4),
                (0x4002_0020, 0x5550_0000),
                (0x4002_0000, 0xa800_0000 | 0b1010_1001 << 8),
            ],
        }),
        Chip::Stm32g474 | Chip::Stm32g431 => Some(Place {
            spi: 2,
            registers: 0x4000_3800,
            select: Pin('B', 12),
            set_up: &[
                (0x4002_104c, 1 << 1),
                (0x4002_1058, 1 << 14 | 1 << 10),
                (0x4800_0418, 1 << 12),
                (0x4800_0424, 0x5550_0000),
                (0x4800_0400, 0x00ff_febf | 0b1010_1001 << 24),
            ],
        }),
        Chip::Stm32h743 => None,
    }
}

/// SPI bus as a polling master: RM0090 28.3.3, RM0440 39.4.9.
struct Bus<'a> {
    board: Shared<'a>,
    place: Place,
}

impl Bus<'_> {
    fn write(&mut self, address: u32, size: u32, value: u32) {
        let mut board = self.board.borrow_mut();
        let machine = board.machine_mut();
        machine.write(address, size, value.into());
        machine.count(1);
        machine.settle();
    }

    fn status(&mut self) -> u32 {
        let mut board = self.board.borrow_mut();
        let machine = board.machine_mut();
        machine.count(LOOK);
        machine.settle();
        machine.read(self.place.registers + SR, 4) as u32
    }

    fn wait(&mut self, mask: u32, wanted: u32) -> Result<(), ErrorKind> {
        (0..LOOKS).any(|_| self.status() & mask == wanted).then_some(()).ok_or(ErrorKind::Other)
    }

    /// Configures mode 1, 8 bits, four cycles per bit (4 MHz), select by software.
    fn open(&mut self) {
        for (address, value) in self.place.set_up {
            self.board.borrow_mut().machine_mut().set_up(*address, *value);
        }
        let registers = self.place.registers;
        if registers == 0x4000_3800 {
            // RXNE after a byte.
            self.write(registers + CR2, 4, 0x1700);
        }
        self.write(registers + CR1, 4, 1 << 9 | 1 << 8 | 1 << 3 | 1 << 2 | 1);
        self.write(registers + CR1, 4, 1 << 9 | 1 << 8 | 1 << 6 | 1 << 3 | 1 << 2 | 1);
    }

    fn select(&mut self, low: bool) {
        let Pin(port, number) = self.place.select;
        let base = if self.place.spi == 1 { 0x4002_0000 } else { 0x4800_0000 };
        let address = base + 0x400 * (port as u32 - 'A' as u32) + 0x18;
        self.write(address, 4, 1 << (number + if low { 16 } else { 0 }));
        let mut board = self.board.borrow_mut();
        let machine = board.machine_mut();
        machine.count(SETTLE);
        machine.settle();
    }

    fn exchange(&mut self, byte: u8) -> Result<u8, ErrorKind> {
        self.wait(2, 2)?;
        self.write(self.place.registers + DR, 1, byte.into());
        self.wait(1, 1)?;
        Ok(self.board.borrow_mut().machine_mut().read(self.place.registers + DR, 1) as u8)
    }
}

impl ErrorType for Bus<'_> {
    type Error = ErrorKind;
}

impl SpiDevice for Bus<'_> {
    fn transaction(&mut self, operations: &mut [Operation<'_, u8>]) -> Result<(), ErrorKind> {
        self.select(true);
        let mut outcome = Ok(());
        for operation in operations {
            let Operation::TransferInPlace(bytes) = operation else { return Err(ErrorKind::Other) };
            for byte in bytes.iter_mut() {
                match self.exchange(*byte) {
                    Ok(answer) => *byte = answer,
                    Err(why) => outcome = Err(why),
                }
            }
        }
        // Not busy: the last bit must end before select.
        outcome = outcome.and(self.wait(1 << 7, 0));
        self.select(false);
        outcome
    }
}

/// Driver on the bus, with its control periods.
struct Reader<'a> {
    driver: As5047p<Bus<'a>>,
    board: Shared<'a>,
    period: u32,
}

impl Reader<'_> {
    /// Reads the encoder at the beginning of a period.
    fn read(&mut self) -> Result<u32, EncoderFault> {
        self.period += 1;
        let reading = self.driver.read(self.period).map(|reading| reading.counts);
        let mut board = self.board.borrow_mut();
        board.machine_mut().pass(PERIOD);
        board.machine_mut().settle();
        reading
    }

    fn encoder(&self, change: impl FnOnce(&mut as5047p::As5047p)) {
        self.board.borrow_mut().machine_mut().wires.encoder.as_mut().map(change);
    }

    /// Reads until a reading equals the wanted one.
    fn until(&mut self, wanted: Result<u32, EncoderFault>) -> Result<(), String> {
        let found: Vec<_> = (0..PATIENCE).map(|_| self.read()).take_while(|found| *found != wanted).collect();
        match found.len() {
            PATIENCE => Err(format!("{wanted:?} is not read within {PATIENCE} readings, but {:?}", found.last())),
            _ => Ok(()),
        }
    }
}

/// Angles are read; faults of the magnet, a missing encoder and a disturbed line are reported by name.
pub fn is_read(subject: &Subject) -> Result<String, String> {
    let place = place(subject.board.chip()).ok_or("the SPI of this chip is not modelled")?;
    let mut board = subject.start()?;
    let machine = board.machine_mut();
    machine.settle();
    machine.wires.encoder = Some(as5047p::As5047p::new(place.spi, place.select));
    let board = Rc::new(RefCell::new(board));
    let mut bus = Bus { board: Rc::clone(&board), place };
    bus.open();
    board.borrow_mut().machine_mut().pass(PERIOD);
    let mut reader = Reader { driver: As5047p::new(bus), board: Rc::clone(&board), period: 0 };
    // The first frame answers no request.
    if reader.read() != Err(EncoderFault::Pending) {
        return Err("the first reading is one already".into());
    }
    let mut angles = 0;
    // A frame requests the value that the encoder holds at its end.
    let mut held = 0;
    for angle in (0..1 << 14).step_by(37) {
        reader.encoder(|encoder| encoder.angle = angle);
        match reader.read() {
            Ok(read) if read == held => angles += 1,
            other => return Err(format!("{other:?} is read where the encoder holds {held}")),
        }
        held = u32::from(angle);
    }
    for (diagnostics, fault) in [
        (TOO_WEAK, EncoderFault::MagnetTooWeak),
        (TOO_STRONG, EncoderFault::MagnetTooStrong),
        (LOST, EncoderFault::MagnetLost),
    ] {
        reader.encoder(|encoder| encoder.diagnostics = diagnostics);
        reader.until(Err(fault))?;
        reader.encoder(|encoder| encoder.diagnostics = WELL);
        reader.until(Ok(held))?;
    }
    reader.encoder(|encoder| encoder.disturbed = 1 << 5);
    reader.until(Err(EncoderFault::Parity))?;
    reader.encoder(|encoder| encoder.disturbed = 0);
    reader.until(Ok(held))?;
    let taken = board.borrow_mut().machine_mut().wires.encoder.take();
    reader.until(Err(EncoderFault::Missing))?;
    board.borrow_mut().machine_mut().wires.encoder = taken;
    reader.until(Ok(held))?;
    clean(&board.borrow())?;
    Ok(format!("{angles} angles, five faults by name, {} readings", reader.period))
}
