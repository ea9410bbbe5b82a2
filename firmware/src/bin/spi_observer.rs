#![cfg_attr(target_os = "none", no_std, no_main)]
//! Observer and compensation as a slave on SPI, beside a motor controller on another chip: each transfer brings samples and
//! takes the answer to those before. No talk with a host: what the joint is was settled when the image was built.

#[cfg(target_os = "none")]
#[rtic::app(device = firmware::board::pac)]
mod app {
    use firmware::board::spi_slave::DmaSlave;
    use firmware::board::{Board, Started, ThisBoard, Watchdog, pac};
    use firmware::port::Direct;
    use firmware::port::spi::{FRAME_BYTES, Frame};
    use firmware::port::spi_slave::SpiSlave;
    use model_core::realtime::controller::Controller;

    #[allow(
        dead_code,
        clippy::excessive_precision,
        reason = "generated numbers; surroundings and digest are of no use here"
    )]
    mod control {
        include!(concat!(env!("OUT_DIR"), "/control.rs"));
    }

    #[shared]
    struct Shared {}

    #[local]
    struct Local {
        slave: SpiSlave<DmaSlave, Direct<'static>>,
        watchdog: Watchdog,
    }

    #[init(local = [received: Frame = [0; FRAME_BYTES], sent: Frame = [0; FRAME_BYTES]])]
    fn init(cx: init::Context) -> (Shared, Local) {
        let mut core = cx.core;
        let Started { watchdog, .. } = ThisBoard::start(cx.device, &mut core);
        // SAFETY: the board has set up clock and serial line, and keeps neither SPI1, DMA2 nor EXTI; of the ports only other
        // pins are its own.
        let device = unsafe { pac::Peripherals::steal() };
        let bus = DmaSlave::start(device, cx.local.received, cx.local.sent);
        let controller =
            Direct(Controller::new(&control::OBSERVER, &control::COMPENSATION).with_probe(control::PROBE.as_ref()));
        (Shared {}, Local { slave: SpiSlave::new(bus, controller), watchdog })
    }

    /// The master has let go of the chip select.
    #[task(binds = EXTI4, priority = 16, local = [slave])]
    fn transferred(cx: transferred::Context) {
        cx.local.slave.serve();
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
