// Application of every role, included by its binary: tasks, priorities, and the queue ends that each task holds. The
// module `role` of the binary defines the role; the code is in the library.

/// Application with the given interrupt of the serial line.
macro_rules! app {
    ($serial:ident) => {
        #[rtic::app(device = firmware::board::pac)]
        mod app {
            use firmware::board::{self, Chip, Output, Started, ThisChip, Watchdog};
            use firmware::clock::{self, IdleMeter, PERIOD};
            use firmware::tick_handler::TickHandler;
            use firmware::conversation::{Conversation, LogEnd};
            use firmware::identity::{self, StartUp};
            use firmware::kept_memory::KeptMemory;
            use firmware::learnt;
            use firmware::logger::{self, LogQueue};
            use firmware::queues::{Progress, Queues};
            use firmware::serial::{Line, Serial};
            use firmware::status_light::{Pattern, StatusLight};
            use firmware::tables::TABLES;
            use firmware::timing_report::Resources;
            use firmware::work::Work;
            use firmware::{panic_message, stack};
            use link::messages::MemoryState;

            use crate::role::{DIGEST, RoleProtocol, RoleWork, work};

            #[shared]
            struct Shared {
                #[lock_free]
                serial: Serial<'static, <ThisChip as Chip>::Port>,
            }

            #[local]
            struct Local {
                control: TickHandler<'static, Output, RoleWork>,
                conversation: Conversation<'static, RoleProtocol>,
                progress: &'static Progress,
                light: StatusLight<Output>,
                watchdog: Watchdog,
                kept: KeptMemory<<ThisChip as Chip>::Slots>,
            }

            #[init(local = [queues: Queues<RoleProtocol> = Queues::new(), line: Line = Line::new(), log: LogQueue = LogQueue::new()])]
            fn init(cx: init::Context) -> (Shared, Local) {
                let last_panic = panic_message::take();
                let mut core = cx.core;
                let started = board::start(cx.device, &mut core);
                let port = started.open_serial();
                let Started { clock, enable, light, slots, watchdog, watchdog_reset, .. } = started;
                let (tick_end, idle_end) = cx.local.queues.split();
                let progress = idle_end.progress;
                let (serial, line_end) = cx.local.line.split(port, board::wake_serial);
                let log_end = LogEnd { bytes: logger::start(cx.local.log), lost: logger::lost_bytes };

                let mut work = work();
                let mut kept = KeptMemory::open(slots);
                let remembered = remember(&mut work, &mut kept);
                let timer_rate = board::CORE_RATE;
                let start_up = StartUp { board: board::NAME, timer_rate, clock, last_panic, watchdog_reset, memory: remembered };
                let hello = identity::hello::<RoleProtocol>(start_up, DIGEST);
                defmt::info!("{=str} on {=str}, {=u32} Hz", hello.joint.as_str(), board::NAME, TABLES.tick_rate);

                let control = TickHandler::new(work, enable, PERIOD, tick_end, line_end.heard());
                let conversation = Conversation::new(hello, PERIOD, idle_end, line_end, log_end);
                clock::start(&mut core.SYST);
                let light = StatusLight::new(light);
                (Shared { serial }, Local { control, conversation, progress, light, watchdog, kept })
            }

            /// Loads the parameters saved in flash. Not inlined, so that its stack is released.
            #[inline(never)]
            fn remember(work: &mut RoleWork, kept: &mut KeptMemory<<ThisChip as Chip>::Slots>) -> MemoryState {
                let judged = kept.load().map(|memory| work.remember(&memory));
                match judged {
                    Some(Err(error)) => defmt::warn!("what was kept is not used: {}", defmt::Display2Format(&error)),
                    Some(Ok(())) => defmt::info!("what was learnt in earlier runs is at hand"),
                    None if kept.is_damaged() => {
                        defmt::warn!("what was kept cannot be read");
                        return MemoryState::Damaged;
                    }
                    None => {}
                }
                learnt::memory_state(judged)
            }

            /// Runs the role's tick, at the highest priority.
            #[task(binds = SysTick, priority = 16, local = [control])]
            fn tick(cx: tick::Context) {
                clock::in_tick(|timer| cx.local.control.tick(timer));
                board::look_at_serial();
            }

            /// Serves the serial line.
            #[task(binds = $serial, priority = 2, shared = [serial])]
            fn serve_line(cx: serve_line::Context) {
                clock::in_interrupt(|| cx.shared.serial.service());
            }

            /// Runs the conversation with the host, the light and the watchdog, which is fed only while ticks occur.
            #[idle(local = [conversation, progress, light, watchdog, kept])]
            fn idle(cx: idle::Context) -> ! {
                use core::sync::atomic::Ordering::Relaxed;
                let idle::LocalResources { conversation, progress, light, watchdog, kept, .. } = cx.local;
                let mut meter = IdleMeter::start();
                let mut last_tick = progress.ticks.load(Relaxed);
                loop {
                    let busy = conversation.poll(&mut |reset| Resources {
                        idle_permille: meter.permille(reset),
                        static_ram: stack::static_ram(),
                        stack_used: stack::deepest(),
                    });
                    conversation.serve_flash(kept, |write| watchdog.while_writing(write));
                    light.show(Pattern::of(progress), clock::milliseconds());
                    let tick = progress.ticks.load(Relaxed);
                    if tick != last_tick {
                        last_tick = tick;
                        watchdog.feed();
                    }
                    if busy { meter.pass() } else { meter.sleep() }
                }
            }
        }
    };
}

#[cfg(serial = "usart1")]
app!(USART1);
#[cfg(serial = "usart2")]
app!(USART2);
#[cfg(serial = "usart3")]
app!(USART3);
#[cfg(serial = "uart4")]
app!(UART4);
#[cfg(serial = "uart5")]
app!(UART5);
#[cfg(serial = "usart6")]
app!(USART6);
#[cfg(serial = "uart7")]
app!(UART7);
#[cfg(serial = "uart8")]
app!(UART8);
