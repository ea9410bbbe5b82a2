//! Unrolled loop over the planets. On a core with few registers a loop spends its time on addresses: the sub-step of three
//! planets takes about a seventh more instructions (EMULATED, Cortex-M4F).

/// Repeats a block for every planet `$i` of `$n`, at most five.
macro_rules! each_planet {
    ($n:expr, $i:ident => $act:block) => {
        const { assert!($n <= 5) };
        each_planet!(@ $n, $i => $act, 0 1 2 3 4);
    };
    (@ $n:expr, $i:ident => $act:block, $($at:literal)*) => {
        $(if $n > $at {
            let $i = $at;
            $act
        })*
    };
}
pub(crate) use each_planet;
