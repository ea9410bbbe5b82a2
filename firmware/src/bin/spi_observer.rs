#![cfg_attr(target_os = "none", no_std, no_main)]
//! Observer and compensation as a slave on SPI, beside a motor controller on another chip: each transfer brings samples and
//! takes the answer to those before. There is no host: the joint is fixed when the image is built.

#[cfg(target_os = "none")]
#[rtic::app(device = firmware::board::pac)]
mod app {
    use firmware::board::dma_slave::DmaSlave;
    use firmware::board::{Board, Started, ThisBoard, ThisSpi, Watchdog, pac};
    use firmware::port::Direct;
    use firmware::port::spi::{FRAME_BYTES, Frame};
    use firmware::port::spi_slave::SpiSlave;
    use model_core::controller::Controller;

    #[allow(
        dead_code,
        clippy::excessive_precision,
        reason = "generated numbers; surroundings and digest are of no use here"
    )]
    mod control {
        include!(concat!(env!("OUT_DIR"), "/control.rs"));
    }

    #[shared]
    struct Shared {
        #[lock_free]
        slave: SpiSlave<DmaSlave<ThisSpi>, Direct<'static>>,
    }

    #[local]
    struct Local {
        watchdog: Watchdog,
    }

    #[init(local = [received: Frame = [0; FRAME_BYTES], sent: Frame = [0; FRAME_BYTES]])]
    fn init(cx: init::Context) -> (Shared, Local) {
        let mut core = cx.core;
        let Started { watchdog, .. } = ThisBoard::start(cx.device, &mut core);
        // SAFETY: the board has set up clock and serial line, and keeps neither the slave's SPI, DMA nor EXTI; of the
        // ports only other pins are its own.
        let device = unsafe { pac::Peripherals::steal() };
        let bus = DmaSlave::start(device, cx.local.received, cx.local.sent);
        let controller =
            Direct(Controller::new(&control::OBSERVER, &control::COMPENSATION).with_probe(control::PROBE.as_ref()));
        (Shared { slave: SpiSlave::new(bus, controller) }, Local { watchdog })
    }

    /// The master has let go of the chip select of STM32F405.
    #[cfg(feature = "stm32f405")]
    #[task(binds = EXTI4, priority = 16, shared = [slave])]
    fn exti4(cx: exti4::Context) {
        cx.shared.slave.serve();
    }

    /// The master has let go of the chip select of STM32G474.
    #[cfg(feature = "stm32g474")]
    #[task(binds = EXTI15_10, priority = 16, shared = [slave])]
    fn exti15_10(cx: exti15_10::Context) {
        cx.shared.slave.serve();
    }

    /// A master may be silent for as long as it likes; an interrupt that never ends would starve the watchdog.
    #[idle(local = [watchdog])]
    fn idle(cx: idle::Context) -> ! {
        loop {
            cx.local.watchdog.feed();
        }
    }
}

/// There is nothing to do on a host: this image is for a board.
#[cfg(not(target_os = "none"))]
fn main() {}
