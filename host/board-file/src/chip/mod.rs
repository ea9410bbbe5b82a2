//! Chips that images can be built for, and their data.

mod facts;

pub use facts::{ImageSize, Slot};

use model_core::gears::design::Processor;

use crate::pin::Pin;
use crate::pll::Pll;
use facts::{Facts, Package, Variant};

pub(crate) use facts::{CanUnit, SerialUnit, SpiUnit, TimerUnit};

/// Help for an unsupported chip: the C library is built for a core, not for a chip.
pub const OTHER_CHIPS: &str = "the C library serves any chip with a Cortex-M4F, M7 or M33 beside the firmware that it has: \
                               docs/in-your-firmware.md; a new chip for the firmware: docs/add-a-chip.md";

/// Declares the chips, one per line with its name and the file of its data.
macro_rules! chips {
    ($($(#[$what:meta])* $name:ident => $file:ident,)+) => {
        $(mod $file;)+

        /// A chip.
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        pub enum Chip {
            $($(#[$what])* $name,)+
        }

        impl Chip {
            /// Every chip.
            pub const ALL: [Self; [$(stringify!($name)),+].len()] = [$(Self::$name),+];

            pub(crate) fn facts(self) -> &'static Facts {
                match self {
                    $(Self::$name => &$file::FACTS,)+
                }
            }
        }
    };
}

chips! {
    /// STM32F405: Cortex-M4F at 168 MHz.
    Stm32f405 => f405,
    /// STM32G474: Cortex-M4F at 170 MHz.
    Stm32g474 => g474,
    /// STM32G431: STM32G474 with less memory.
    Stm32g431 => g431,
    /// STM32H743: Cortex-M7 at 400 MHz.
    Stm32h743 => h743,
}

impl Chip {
    /// Name, equal to the firmware's feature.
    pub fn name(self) -> &'static str {
        self.facts().name
    }

    /// Family of chips with the same registers; the firmware has one file per family.
    pub fn family(self) -> &'static str {
        self.facts().family
    }

    /// Finds a chip by its name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|chip| chip.name() == name)
    }

    /// Core clock [Hz]; the tick rate must divide it.
    pub fn core_rate(self) -> u32 {
        self.facts().core_rate
    }

    /// Clock, cycles per instruction and share of the period offered to the step.
    pub fn processor(self) -> Processor {
        self.facts().processor
    }

    /// Frequency of the internal oscillator, which is the clock after a reset [Hz].
    pub fn internal_oscillator(self) -> u32 {
        self.facts().internal_oscillator
    }

    /// Size of the linked image of joint Q1 in a role, as named by `--role`.
    pub fn image_size(self, role: &str) -> Option<ImageSize> {
        self.facts().images.iter().copied().find(|image| image.role == role)
    }

    /// Returns whether the firmware supports the chip as an SPI slave.
    pub fn has_spi_slave(self) -> bool {
        self.facts().spi.is_ok()
    }

    /// Lowest and highest frequency of a crystal, or of an external clock signal [Hz].
    pub fn oscillator_limits(self, crystal: bool) -> (u32, u32) {
        if crystal { self.facts().crystal } else { self.facts().signal }
    }

    /// PLL settings that make the core clock from a frequency [Hz]; `None` if the core clock cannot be made exactly.
    ///
    /// ```
    /// use board_file::{Chip, Pll};
    /// // 8 MHz / 4 x 168 / 2 = 168 MHz.
    /// assert_eq!(Chip::Stm32f405.pll(8_000_000), Some(Pll { divider: 4, factor: 168, range: 0 }));
    /// assert_eq!(Chip::Stm32f405.pll(14_745_600), None);
    /// ```
    pub fn pll(self, frequency: u32) -> Option<Pll> {
        self.facts().pll.settings(frequency)
    }

    /// PLL settings for the internal oscillator.
    ///
    /// # Panics
    /// Never: a test checks every chip.
    pub fn internal_pll(self) -> Pll {
        self.pll(self.internal_oscillator()).expect("every chip makes its core clock of its own oscillator")
    }
}

/// Chip as ordered: with its memory and, if the order name contains it, its package.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Part {
    pub chip: Chip,
    variant: &'static Variant,
    package: &'static Package,
}

impl Part {
    /// Parses an order name up to the letter of the flash size, optionally with the letter of the package and the digit
    /// of the temperature range: STM32G431CB, STM32G431CBU, STM32G431CBU6.
    pub fn from_order_name(order_name: &str) -> Option<Self> {
        let mut all =
            Chip::ALL.into_iter().flat_map(|chip| chip.facts().variants.iter().map(move |variant| (chip, variant)));
        let (chip, variant) = all.find(|(_, variant)| order_name.starts_with(variant.name))?;
        let mut rest = order_name[variant.name.len()..].chars();
        let package = match rest.next() {
            None => variant.packages.first(),
            Some(letter) => variant.packages.iter().find(|package| package.letter == letter),
        }?;
        let temperature_range = rest.next().is_none_or(|digit| "367".contains(digit));
        (temperature_range && rest.next().is_none()).then_some(Self { chip, variant, package })
    }

    /// Order names of all supported chips, without a package.
    pub fn names() -> Vec<&'static str> {
        Chip::ALL.into_iter().flat_map(|chip| chip.facts().variants).map(|variant| variant.name).collect()
    }

    /// Help for an unknown order name. A name is suggested only within one part number of one maker: chips whose names
    /// differ by a letter have other registers, memory and pins.
    pub fn unknown_name_help(order_name: &str) -> String {
        let typed = order_name.trim().to_uppercase();
        let claim_line_pin = |variant: &&str| {
            Chip::ALL.iter().any(|chip| {
                let line = chip.name().to_uppercase();
                typed.starts_with(&line) && variant.starts_with(&line)
            })
        };
        let known = Self::names();
        let line: Vec<&str> = known.iter().copied().filter(claim_line_pin).collect();
        match line.iter().find(|variant| typed.starts_with(**variant)) {
            Some(variant) => format!(
                "did you mean \"{variant}\"? it is written in capitals, up to the letter of the flash size or with those of \
                 package and temperature range behind it"
            ),
            None if !line.is_empty() => {
                format!(
                    "write one of {}, with the letter of the flash size as it is printed on the chip",
                    line.join(", ")
                )
            }
            None => format!(
                "firmware exists for {}; a chip of another number or maker is not compatible, even with the same pins",
                known.join(", ")
            ),
        }
    }

    /// Name of the chip in debug probes: the order name with its package and an x for the temperature range.
    pub fn probe_name(&self) -> String {
        format!("{}{}x", self.variant.name, self.package.letter)
    }

    /// Sizes of flash that a board file may state, the chip's own size last [KiB].
    pub fn flash_kib(&self) -> &'static [u32] {
        self.variant.flash_kib
    }

    /// Returns whether the package brings out a pin.
    pub fn has(&self, pin: Pin) -> bool {
        self.package.has(pin)
    }

    /// Pins of the package, as text.
    pub fn pins(&self) -> String {
        let ports = self.package.pins.iter().map(|(letter, pins)| {
            let mut spans: Vec<(u32, u32)> = Vec::new();
            for number in (0..16).filter(|number| pins >> number & 1 == 1) {
                match spans.last_mut() {
                    Some((_, last)) if *last + 1 == number => *last = number,
                    _ => spans.push((number, number)),
                }
            }
            let words = spans.iter().map(|(first, last)| match last - first {
                0 => format!("P{letter}{first}"),
                _ => format!("P{letter}{first} to P{letter}{last}"),
            });
            words.collect::<Vec<_>>().join(", ")
        });
        ports.collect::<Vec<_>>().join(", ")
    }

    /// Order name with its package.
    pub fn name(&self) -> String {
        format!("{}{}", self.variant.name, self.package.letter)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pin::Alternate;

    const MHZ: u32 = 1_000_000;

    /// Every chip makes its core clock exactly from common crystals and from its internal oscillator.
    #[test]
    fn plls_make_core_clock_exactly() {
        for chip in Chip::ALL {
            let (mut refused, internal) = (Vec::new(), chip.internal_oscillator());
            for frequency in [8, 12, 16, 24, 25, 26].map(|mega| mega * MHZ).into_iter().chain([internal]) {
                let Some(Pll { divider, factor, .. }) = chip.pll(frequency) else {
                    refused.push(frequency / MHZ);
                    continue;
                };
                let limits = &chip.facts().pll;
                let core = u64::from(frequency) * u64::from(factor);
                assert_eq!(core % u64::from(2 * divider), 0, "{chip:?} from {frequency}");
                assert_eq!(core / u64::from(2 * divider), u64::from(chip.core_rate()), "{chip:?} from {frequency}");
                let input = f64::from(frequency) / f64::from(divider);
                assert!((f64::from(limits.input.0)..=f64::from(limits.input.1)).contains(&input), "{chip:?}: {input}");
                assert!((limits.divider.0..=limits.divider.1).contains(&divider));
                assert!((limits.factor.0..=limits.factor.1).contains(&factor));
            }
            // 340 MHz are 170 x 26 / 13 MHz, and 2 MHz are below the input range of the G4's PLL.
            let wanted: &[u32] = if chip.core_rate() == 170 * MHZ { &[26] } else { &[] };
            assert_eq!(refused, wanted, "{chip:?}");
            assert_eq!(Some(chip.internal_pll()), chip.pll(internal), "{chip:?}");
        }
    }

    /// A PLL gets its preferred input frequency, or the highest one that works.
    #[test]
    fn plls_prefer_configured_input() {
        let of = |chip: Chip, mega: u32| {
            let Pll { divider, factor, range } = chip.pll(mega * MHZ).expect("it can be made");
            (divider, factor, range)
        };
        assert_eq!(
            [8, 12, 16, 24, 25, 26].map(|mega| of(Chip::Stm32f405, mega)),
            [(4, 168, 0), (6, 168, 0), (8, 168, 0), (12, 168, 0), (25, 336, 0), (13, 168, 0)]
        );
        assert_eq!(
            [8, 12, 16, 24, 25].map(|mega| of(Chip::Stm32g474, mega)),
            [(2, 85, 0), (3, 85, 0), (4, 85, 0), (6, 85, 0), (5, 68, 0)]
        );
        assert_eq!(
            [8, 12, 16, 24, 25, 26, 64].map(|mega| of(Chip::Stm32h743, mega)),
            [(2, 200, 2), (3, 200, 2), (4, 200, 2), (6, 200, 2), (2, 64, 3), (13, 400, 1), (16, 200, 2)]
        );
    }

    /// Frequencies that cannot make the core clock exactly have no settings.
    #[test]
    fn pll_rejects_inexact_frequency() {
        for frequency in [0, 1, 11_059_200, 14_745_600, 32_768, u32::MAX] {
            for chip in Chip::ALL {
                assert_eq!(chip.pll(frequency), None, "{chip:?} from {frequency}");
            }
        }
    }

    /// Every pin of a peripheral is brought out by some package of the chip.
    #[test]
    fn unit_pins_exist_in_some_package() {
        for chip in Chip::ALL {
            let facts = chip.facts();
            let serial = facts.serial.iter().flat_map(|unit| [unit.send, unit.receive]);
            let spi = facts.spi.unwrap_or_default().iter();
            let spi = spi.flat_map(|unit| [unit.select, unit.clock, unit.out, unit.input]);
            let packages = || facts.variants.iter().flat_map(|variant| variant.packages);
            for Alternate { pin, function } in serial.chain(spi).flatten() {
                // No package of the STM32G431 has port G apart from PG10; its table is shared with the STM32G474.
                let missing = !packages().any(|package| package.has(*pin));
                assert!(!missing || (chip == Chip::Stm32g431 && pin.letter() == 'G'), "{chip:?} {pin}");
                assert!(*function < 16);
            }
            for pin in facts.oscillator_pins.iter().chain(&facts.boot_pin) {
                assert!(packages().all(|package| package.has(*pin)), "{chip:?} {pin}");
            }
        }
    }

    /// Every pin of a CAN peripheral or timer is brought out by some package and listed once.
    #[test]
    fn unused_line_pins_exist_once() {
        for chip in Chip::ALL {
            let facts = chip.facts();
            let can = facts.can.iter().flat_map(|unit| [unit.send, unit.receive]);
            let can = can.map(|list| list.iter().map(|alternate| alternate.pin).collect::<Vec<_>>());
            let timers = facts.timers.iter().flat_map(|unit| [unit.a.to_vec(), unit.b.to_vec()]);
            for list in can.chain(timers) {
                for (at, pin) in list.iter().enumerate() {
                    let mut packages = facts.variants.iter().flat_map(|variant| variant.packages);
                    assert!(packages.any(|package| package.has(*pin)), "{chip:?} {pin}");
                    assert!(!list[..at].contains(pin), "{chip:?} {pin}");
                }
            }
        }
    }

    /// No pin occurs twice in the list of a peripheral.
    #[test]
    fn unit_pins_listed_once() {
        for chip in Chip::ALL {
            let facts = chip.facts();
            let serial = facts.serial.iter().flat_map(|unit| [unit.send, unit.receive]);
            let spi = facts.spi.unwrap_or_default().iter();
            for list in serial.chain(spi.flat_map(|unit| [unit.select, unit.clock, unit.out, unit.input])) {
                for (at, one) in list.iter().enumerate() {
                    assert!(list[..at].iter().all(|other| other.pin != one.pin), "{chip:?} {}", one.pin);
                }
            }
        }
    }

    /// Order names are parsed with and without package and temperature range.
    #[test]
    fn order_names_parsed_with_package() {
        let probe = |name: &str| Part::from_order_name(name).map(|part| part.probe_name());
        assert_eq!(probe("STM32F405RG").as_deref(), Some("STM32F405RGTx"));
        assert_eq!(probe("STM32F405RGT6").as_deref(), Some("STM32F405RGTx"));
        assert_eq!(probe("STM32G431CB").as_deref(), Some("STM32G431CBTx"));
        assert_eq!(probe("STM32G431CBU6").as_deref(), Some("STM32G431CBUx"));
        assert_eq!(probe("STM32H743ZI").as_deref(), Some("STM32H743ZITx"));
        for name in ["", "STM32F405", "STM32F405RGU6", "STM32F407VG", "stm32f405rg", "STM32F405RGT6TR", "STM32G474RC"] {
            assert_eq!(probe(name), None, "{name}");
        }
    }

    /// The pins of packages agree with the data sheets.
    #[test]
    fn packages_match_data_sheets() {
        let part = |name: &str| Part::from_order_name(name).expect("a known name");
        assert_eq!(part("STM32F405RG").pins(), "PA0 to PA15, PB0 to PB15, PC0 to PC15, PD2, PH0 to PH1");
        assert_eq!(
            part("STM32G431CBU").pins(),
            "PA0 to PA15, PB0 to PB15, PC4, PC6, PC10 to PC11, PC13 to PC15, PF0 to PF1"
        );
        let pin = |name: &str| name.parse().expect("a pin");
        assert!(!part("STM32G431CBT").has(pin("PC4")) && part("STM32G474CEU").has(pin("PC4")));
        assert!(!part("STM32F405OG").has(pin("PC1")) && !part("STM32F405OG").has(pin("PD13")));
    }

    /// The slots lie at the end of the stated flash, or in the second bank.
    #[test]
    fn slots_at_end_of_flash() {
        let slots = |chip: Chip, kib: u32| (chip.facts().slots)(kib << 10).map(|slot| (slot.address, slot.bytes));
        assert_eq!(slots(Chip::Stm32f405, 1024), [(0x080c_0000, 0x2_0000), (0x080e_0000, 0x2_0000)]);
        assert_eq!(slots(Chip::Stm32f405, 512), [(0x0804_0000, 0x2_0000), (0x0806_0000, 0x2_0000)]);
        assert_eq!(slots(Chip::Stm32g474, 512), [(0x0807_e000, 0x800), (0x0807_f000, 0x800)]);
        assert_eq!(slots(Chip::Stm32g431, 128), [(0x0801_f000, 0x800), (0x0801_f800, 0x800)]);
        assert_eq!(slots(Chip::Stm32h743, 2048), [(0x0810_0000, 0x2_0000), (0x0812_0000, 0x2_0000)]);
    }
}
