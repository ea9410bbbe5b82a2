#![cfg_attr(target_os = "none", no_std, no_main)]
#![allow(unsafe_op_in_unsafe_fn, reason = "the framework writes its tasks so")]
//! Role `drive`: a joint behind a finished drive on a CAN bus. Joint, drive and identifier are fixed when the image is
//! built; the bus is its only interface. The work of the tick is `firmware::drive`. The tick runs below the receive
//! interrupt: `firmware::can`.

#[cfg(all(target_os = "none", not(has_can)))]
compile_error!("the board's file has no [can]");

/// Application with the receive interrupt of the CAN peripheral.
macro_rules! app {
    ($received:ident) => {
        #[rtic::app(device = firmware::board::pac)]
        mod app {
            use cortex_m::peripheral::SCB;
            use firmware::board::{self, Started, Watchdog};
            use firmware::can::{Received, Receiving};
            use firmware::clock;
            use firmware::drive::DriveTick;
            use firmware::tables::{PLANETS, TABLES};
            use model_core::virtual_joint::VirtualJoint;
            use virtual_drive::VirtualDrive;

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
                receiving: Receiving<'static, board::can::Receiver>,
            }

            #[local]
            struct Local {
                drive: DriveTick<'static, ThisMaker, board::can::Sender, PLANETS>,
                watchdog: Watchdog,
            }

            #[init(local = [received: Received = Received::new()])]
            fn init(cx: init::Context) -> (Shared, Local) {
                let mut core = cx.core;
                let started = board::start(cx.device, &mut core);
                let (receiver, sender) = started.open_can();
                let Started { watchdog, .. } = started;
                let (receiving, inbox) = cx.local.received.split(receiver);
                let joint = VirtualJoint::new(&TABLES, &control::SURROUNDINGS);
                let drive = VirtualDrive::new(joint, &design::DESIGN, design::ID);
                let drive = DriveTick::new(drive, sender, inbox);
                clock::start(&mut core.SYST);
                (Shared { receiving }, Local { drive, watchdog })
            }

            /// Begins a control period and requests its tick, at the priority of `receive`: a frame arrives either before
            /// the period or after its beginning.
            #[task(binds = SysTick, priority = 16, shared = [receiving])]
            fn begin_period(cx: begin_period::Context) {
                clock::in_tick(|_| cx.shared.receiving.begin_period());
                SCB::set_pendsv();
            }

            /// Runs a control period, and the next one if it has begun meanwhile.
            #[task(binds = PendSV, priority = 15, local = [drive])]
            fn tick(cx: tick::Context) {
                if cx.local.drive.tick() {
                    SCB::set_pendsv();
                }
            }

            /// Takes received frames from the peripheral, before its FIFO overflows in a long tick.
            #[task(binds = $received, priority = 16, shared = [receiving])]
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
