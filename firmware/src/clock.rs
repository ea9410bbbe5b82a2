//! SysTick as the timer of the ticks and as the clock for the processor load. The board sets up its clock source.

use core::sync::atomic::AtomicU32;
use core::sync::atomic::Ordering::Relaxed;

use cortex_m::peripheral::syst::SystClkSource;
use cortex_m::peripheral::{SCB, SYST};

use crate::board::CORE_RATE;
use crate::tables::TABLES;
use crate::timing_monitor::TickTimer;

/// Timer counts between two ticks.
pub const PERIOD: u32 = CORE_RATE / TABLES.tick_rate;

const _: () = assert!(PERIOD * TABLES.tick_rate == CORE_RATE, "the tick rate must divide the core clock");
const _: () = assert!(PERIOD <= 1 << 24, "SysTick has 24 bits");

/// Ticks since power-up.
static TICKS: AtomicU32 = AtomicU32::new(0);
/// Time spent in interrupts [timer counts].
static BUSY: AtomicU32 = AtomicU32::new(0);

/// Starts the ticks.
pub fn start(systick: &mut SYST) {
    systick.set_clock_source(SystClkSource::Core);
    systick.set_reload(PERIOD - 1);
    systick.clear_current();
    systick.enable_counter();
    systick.enable_interrupt();
}

/// SysTick as seen from its own interrupt.
#[derive(Debug, Clone, Copy)]
pub struct TickClock;

impl TickTimer for TickClock {
    fn since_expiry(&self) -> u32 {
        let elapsed = elapsed();
        if SCB::is_pendst_pending() { PERIOD + self::elapsed() } else { elapsed }
    }
}

/// Counts since the last expiry. At the expiry the counter reads 0, then restarts from the reload value.
fn elapsed() -> u32 {
    match SYST::get_current() {
        0 => 0,
        left => PERIOD - left,
    }
}

/// Runs the tick's work in its interrupt.
pub fn in_tick(work: impl FnOnce(&TickClock)) {
    TICKS.store(TICKS.load(Relaxed).wrapping_add(1), Relaxed);
    work(&TickClock);
    BUSY.fetch_add(TickClock.since_expiry(), Relaxed);
}

/// Runs the work of an interrupt below the tick's priority and counts its time as busy.
pub fn in_interrupt(work: impl FnOnce()) {
    let start = Instant::now();
    work();
    BUSY.fetch_add(start.own_time(), Relaxed);
}

/// Time since power-up [ms]; wraps after days.
pub fn milliseconds() -> u32 {
    TICKS.load(Relaxed) / (TABLES.tick_rate / 1000).max(1)
}

/// Time since power-up [us].
pub fn microseconds() -> u64 {
    u64::from(TICKS.load(Relaxed)) * 1_000_000 / u64::from(TABLES.tick_rate)
}

/// Instant for time measurements.
#[derive(Debug, Clone, Copy)]
struct Instant {
    counts: u32,
    busy: u32,
}

impl Instant {
    /// Current instant, read below the tick's priority: an intervening tick causes another read, at most twice.
    fn now() -> Self {
        let mut counts = 0;
        for _ in 0..3 {
            let before = TICKS.load(Relaxed);
            counts = before.wrapping_mul(PERIOD).wrapping_add(elapsed());
            if TICKS.load(Relaxed) == before {
                break;
            }
        }
        Self { counts, busy: BUSY.load(Relaxed) }
    }

    /// Time since this instant, less the time of interrupts.
    fn own_time(self) -> u32 {
        let now = Self::now();
        let taken = now.busy.wrapping_sub(self.busy);
        now.counts.wrapping_sub(self.counts).saturating_sub(taken)
    }
}

/// Meter of idle processor time.
#[derive(Debug)]
pub struct IdleMeter {
    last: Instant,
    total: u64,
    idle: u64,
}

impl IdleMeter {
    /// Starts a measurement.
    pub fn start() -> Self {
        Self { last: Instant::now(), total: 0, idle: 0 }
    }

    /// Sleeps until the next interrupt; this time counts as idle, less the time of interrupts.
    pub fn sleep(&mut self) {
        let start = Instant::now();
        cortex_m::asm::wfi();
        self.idle += u64::from(start.own_time());
        self.pass();
    }

    /// Updates the measurement. To be called at least once per half wrap of 32 bits of counts (some ten seconds).
    pub fn pass(&mut self) {
        let now = Instant::now();
        self.total += u64::from(now.counts.wrapping_sub(self.last.counts));
        self.last = now;
    }

    /// Returns idle time in thousandths of all time; restarts the measurement if `reset` is set.
    pub fn permille(&mut self, reset: bool) -> u16 {
        self.pass();
        let share = (self.idle * 1000).checked_div(self.total).unwrap_or(0);
        if reset {
            self.total = 0;
            self.idle = 0;
        }
        share.min(1000) as u16
    }
}
