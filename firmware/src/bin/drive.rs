#![cfg_attr(target_os = "none", no_std, no_main)]
#![allow(unsafe_op_in_unsafe_fn, reason = "the framework writes its tasks so")]
//! Role `drive`: a joint behind a finished drive on a CAN bus. Joint, drive and identifier are fixed when the image is
//! built; the bus is its only interface. The work of the tick is `firmware::drive`.

#[cfg(all(target_os = "none", not(has_can)))]
compile_error!("the board's file has no [can]");

/// Application with the receive interrupt of the CAN peripheral.
macro_rules! app {
    ($received:ident) => {
        #[rtic::app(device = firmware::board::pac)]
        mod app {
            use drives::Drive;
            use drives::drive::VirtualPower;
            use firmware::board::{self, CanLine, Started, Watchdog};
            use firmware::can::{Received, Receiving};
            use firmware::clock;
            use firmware::drive::DriveTick;
            use firmware::tables::{PLANETS, TABLES};
            use model_core::virtual_joint::VirtualJoint;
            use virtual_drive::maker::Maker;

            #[allow(
                dead_code,
                clippy::excessive_precision,
                reason = "generated numbers; the drive has a law of its own"
            )]
            mod control {
                include!(concat!(env!("OUT_DIR"), "/control.rs"));
            }

            #[allow(clippy::unreadable_literal, reason = "generated numbers")]
            mod design {
                include!(concat!(env!("OUT_DIR"), "/drive.rs"));
            }

            use design::ThisMaker;

            #[shared]
            struct Shared {
                #[lock_free]
                receiving: Receiving<'static, <CanLine as board::CanHalves>::Receiver>,
            }

            #[local]
            struct Local {
                drive: DriveTick<'static, <ThisMaker as Maker>::Server, <CanLine as board::CanHalves>::Sender, PLANETS>,
                watchdog: Watchdog,
            }

            #[init(local = [received: Received = Received::new()])]
            fn init(cx: init::Context) -> (Shared, Local) {
                let mut core = cx.core;
                let started = board::start(cx.device, &mut core);
                let (receiver, sender) = started.open_can();
                let Started { watchdog, .. } = started;
                let (receiving, inbox) = cx.local.received.split(receiver);
                let settings =
                    ThisMaker::settings(design::DESIGN.settings(ThisMaker::PEAK_CURRENT, ThisMaker::SUPPLY, true));
                let drive = DriveTick::new(
                    VirtualJoint::new(&TABLES, &control::SURROUNDINGS),
                    Drive::new(settings),
                    ThisMaker::server(design::ID, &settings),
                    VirtualPower::new(ThisMaker::SUPPLY),
                    sender,
                    inbox,
                );
                clock::start(&mut core.SYST);
                (Shared { receiving }, Local { drive, watchdog })
            }

            /// Runs a control period, at the highest priority.
            #[task(binds = SysTick, priority = 16, local = [drive])]
            fn tick(cx: tick::Context) {
                clock::in_tick(|_| cx.local.drive.tick());
            }

            /// Takes received frames from the peripheral.
            #[task(binds = $received, priority = 2, shared = [receiving])]
            fn receive(cx: receive::Context) {
                cx.shared.receiving.service();
            }

            /// Feeds the watchdog, only while ticks occur.
            #[idle(local = [watchdog])]
            fn idle(cx: idle::Context) -> ! {
                let mut last = clock::milliseconds();
                loop {
                    let now = clock::milliseconds();
                    if now != last {
                        last = now;
                        cx.local.watchdog.feed();
                    }
                    cortex_m::asm::wfi();
                }
            }
        }
    };
}

#[cfg(all(target_os = "none", can = "can1"))]
app!(CAN1_RX0);
#[cfg(all(target_os = "none", can = "can2"))]
app!(CAN2_RX0);
#[cfg(all(target_os = "none", can = "fdcan1"))]
app!(FDCAN1_IT0);
#[cfg(all(target_os = "none", can = "fdcan2"))]
app!(FDCAN2_IT0);
#[cfg(all(target_os = "none", can = "fdcan3"))]
app!(FDCAN3_IT0);

/// Empty on a host: this image is for a board.
#[cfg(not(target_os = "none"))]
fn main() {}
