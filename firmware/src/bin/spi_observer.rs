#![cfg_attr(target_os = "none", no_std, no_main)]
#![allow(unsafe_op_in_unsafe_fn, reason = "the framework writes its tasks so")]
//! Observer and compensation as an SPI slave of a motor controller on another chip: each transfer receives samples and
//! sends the answer to the samples before. Without host: the joint is fixed when the image is built.

#[cfg(all(target_os = "none", not(has_spi_slave)))]
compile_error!("the board's file has no [spi_slave]");

/// Application with the interrupt of the chip select.
#[cfg(all(target_os = "none", has_spi_slave))]
macro_rules! app {
    ($select:ident) => {
        #[rtic::app(device = firmware::board::pac)]
        mod app {
            use firmware::board::dma_slave::DmaSlave;
            use firmware::board::{self, Started, ThisSpi, Watchdog, pac};
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
                let Started { watchdog, .. } = board::start(cx.device, &mut core);
                // SAFETY: the board has set up its clock, and keeps neither the slave's SPI, DMA nor EXTI; of the ports only other
                // pins are its own.
                let device = unsafe { pac::Peripherals::steal() };
                let bus = DmaSlave::start(device, cx.local.received, cx.local.sent);
                let controller = Direct(
                    Controller::with_tables(&control::OBSERVER, &control::COMPENSATION)
                        .with_probe(control::PROBE.as_ref()),
                );
                (Shared { slave: SpiSlave::new(bus, controller) }, Local { watchdog })
            }

            /// Handles the end of a transfer: the master has released chip select.
            #[task(binds = $select, priority = 16, shared = [slave])]
            fn serve_master(cx: serve_master::Context) {
                cx.shared.slave.serve();
            }

            /// Feeds the watchdog. A master may be silent for any time; an interrupt that never ends would starve the
            /// watchdog.
            #[idle(local = [watchdog])]
            fn idle(cx: idle::Context) -> ! {
                loop {
                    cx.local.watchdog.feed();
                }
            }
        }
    };
}

#[cfg(all(target_os = "none", select_line = "0"))]
app!(EXTI0);
#[cfg(all(target_os = "none", select_line = "1"))]
app!(EXTI1);
#[cfg(all(target_os = "none", select_line = "2"))]
app!(EXTI2);
#[cfg(all(target_os = "none", select_line = "3"))]
app!(EXTI3);
#[cfg(all(target_os = "none", select_line = "4"))]
app!(EXTI4);
#[cfg(all(
    target_os = "none",
    any(select_line = "5", select_line = "6", select_line = "7", select_line = "8", select_line = "9")
))]
app!(EXTI9_5);
#[cfg(all(
    target_os = "none",
    any(
        select_line = "10",
        select_line = "11",
        select_line = "12",
        select_line = "13",
        select_line = "14",
        select_line = "15"
    )
))]
app!(EXTI15_10);

/// Empty on a host: this image is for a board.
#[cfg(not(target_os = "none"))]
fn main() {}
