//! Small functions with their disassembly by `objdump`, whose counts were found by hand.

use super::longest::{Cost, LongestPath, NoBound, PathSearch};
use super::machine::Machine;
use super::*;
use model_core::gears::certificate::Substeps;

const CODE: u32 = 0x0800_1000;
const DATA: u32 = 0x0800_2000;

/// Longest path through functions from the first one, with a table of two words at [`DATA`] in register 0.
fn longest_of(functions: &[(&str, u32, &[u16])]) -> Result<LongestPath, NoBound> {
    let words: &[u16] = &[6, 0, 0, 0];
    let all: Vec<_> = functions.iter().copied().chain([("TABLE", DATA, words)]).collect();
    let functions = Functions::assembled(&all, 0..0);
    let mut machine = Machine::with_stack(STACK_TOP);
    machine.set(0, Some(DATA));
    PathSearch::new(&functions, STACK_BOTTOM).run(CODE, machine)
}

fn longest(code: &[u16]) -> Result<LongestPath, NoBound> {
    longest_of(&[("one", CODE, code)])
}

/// Longest path with an unknown value in register 0.
fn longest_of_any(code: &[u16]) -> Result<LongestPath, NoBound> {
    let functions = Functions::assembled(&[("one", CODE, code)], 0..0);
    PathSearch::new(&functions, STACK_BOTTOM).run(CODE, Machine::with_stack(STACK_TOP))
}

fn instructions(found: Result<LongestPath, NoBound>) -> u32 {
    found.expect("a bound").cost.instructions
}

/// A loop up to a literal runs as often as the literal says.
#[test]
fn loop_to_literal_counted() {
    // movs r1, #0; adds r1, #1; cmp r1, #10; bne .-4; bx lr
    let found = longest(&[0x2100, 0x3101, 0x290a, 0xd1fc, 0x4770]).unwrap();
    // Nine of the ten branches are taken.
    assert_eq!(found.cost, Cost { instructions: 1 + 10 * 3 + 1, cycles: 1 + 10 * 2 + 9 * 4 + 1 + 4 });
    assert_eq!(found.loops.into_iter().collect::<Vec<_>>(), [(CODE + 2, 10)]);
}

/// Rounds of nested loops multiply.
#[test]
fn nested_loops_multiply() {
    // movs r1, #3; movs r2, #4; subs r2, #1; bne .-2; subs r1, #1; bne .-8; bx lr
    let found = longest(&[0x2103, 0x2204, 0x3a01, 0xd1fd, 0x3901, 0xd1fa, 0x4770]).unwrap();
    assert_eq!(found.cost.instructions, 1 + 3 * (1 + 4 * 2 + 2) + 1);
    assert_eq!(found.loops.into_iter().collect::<Vec<_>>(), [(CODE + 2, 3), (CODE + 4, 4)]);
}

/// Loops whose end depends on unknown values, or that have none, are rejected.
#[test]
fn loop_without_known_end_rejected() {
    // nop; subs r0, #1; bne .-2; bx lr
    assert_eq!(longest_of_any(&[0xbf00, 0x3801, 0xd1fd, 0x4770]), Err(NoBound::UnboundedLoop(CODE + 2)));
    // nop; ldrb r1, [r0]; adds r0, #1; cbz r1, .+4; b .-6; bx lr
    assert_eq!(
        longest_of_any(&[0xbf00, 0x7801, 0x3001, 0xb101, 0xe7fb, 0x4770]),
        Err(NoBound::UnboundedLoop(CODE + 2))
    );
    // movs r1, #0; adds r1, #1; b .-2: the counter is never tested.
    assert_eq!(longest(&[0x2100, 0x3101, 0xe7fd]), Err(NoBound::UnboundedLoop(CODE + 2)));
    // movs r1, #0; adds r1, #1; cmp r1, r0; bne .-4; bx lr: the limit is unknown.
    assert_eq!(longest_of_any(&[0x2100, 0x3101, 0x4281, 0xd1fc, 0x4770]), Err(NoBound::UnboundedLoop(CODE + 2)));
}

/// Values of constant tables end loops and decide branches.
#[test]
fn table_values_resolve_branches() {
    // ldr r1, [r0]; subs r1, #1; bne .-2; bx lr
    assert_eq!(instructions(longest(&[0x6801, 0x3901, 0xd1fd, 0x4770])), 1 + 6 * 2 + 1);
    assert!(longest_of_any(&[0x6801, 0x3901, 0xd1fd, 0x4770]).is_err());
    // ldr r1, [r0, #4]; cbz r1, .+12; five nops; bx lr
    let chosen = [0x6841, 0xb121, 0xbf00, 0xbf00, 0xbf00, 0xbf00, 0xbf00, 0x4770];
    assert_eq!(instructions(longest(&chosen)), 3);
    assert_eq!(instructions(longest_of_any(&chosen)), 8);
}

/// An unknown switch counts its longest case, a known one its own.
#[test]
fn switch_counts_longest_case() {
    // cmp r0, #2; bhi default; tbb [pc, r0]; three cases of 2, 4 and 2 instructions; bx lr
    let switch = [
        0x2802, 0xd80b, 0xe8df, 0xf000, 0x0402, 0x0008, 0xbf00, 0xe005, 0xbf00, 0xbf00, 0xbf00, 0xe001, 0xbf00, 0xe7ff,
        0x4770,
    ];
    let functions = Functions::assembled(&[("one", CODE, &switch)], CODE + 8..CODE + 12);
    let run = |machine| instructions(PathSearch::new(&functions, STACK_BOTTOM).run(CODE, machine));
    assert_eq!(run(Machine::with_stack(STACK_TOP)), 3 + 4 + 1);
    for (case, length) in [(0, 2), (1, 4), (2, 2)] {
        let mut machine = Machine::with_stack(STACK_TOP);
        machine.set(0, Some(case));
        assert_eq!(run(machine), 3 + length + 1, "case {case}");
    }
}

/// A loop with two entries is rejected.
#[test]
fn loop_with_two_entries_rejected() {
    // cbz r0, .+4; nop; subs r1, #1; bne .-4; bx lr
    let found = longest_of_any(&[0xb100, 0xbf00, 0x3901, 0xd1fc, 0x4770]);
    assert!(matches!(found, Err(NoBound::IrreducibleLoop(_))), "{found:?}");
}

/// Instructions in an `it` block count even if they are skipped.
#[test]
fn skipped_instructions_counted() {
    // cmp r0, #1; itt eq; addeq r1, #1; addeq r1, #2; bx lr
    assert_eq!(instructions(longest_of_any(&[0x2801, 0xbf04, 0x3101, 0x3102, 0x4770])), 5);
}

/// A result that depends on an unknown condition is unknown, in registers, memory and single-precision registers.
#[test]
fn conditional_results_unknown() {
    // movs r1, #2; cmp r0, #0; it ne; movne r1, #7; subs r1, #1; bne .-2; bx lr
    let register = [0x2102, 0x2800, 0xbf18, 0x2107, 0x3901, 0xd1fd, 0x4770];
    assert_eq!(longest_of_any(&register), Err(NoBound::UnboundedLoop(CODE + 8)));
    // Register 0 is known not to be zero, so the condition holds.
    assert_eq!(instructions(longest(&register)), 4 + 7 * 2 + 1);
    // push {r1, lr}; movs r1, #2; str r1, [sp]; movs r2, #7; cmp r0, #0; it ne; strne r2, [sp]; ldr r1, [sp]; subs r1, #1;
    // str r1, [sp]; bne .-6; pop {r1, pc}
    let memory = [0xb502, 0x2102, 0x9100, 0x2207, 0x2800, 0xbf18, 0x9200, 0x9900, 0x3901, 0x9100, 0xd1fb, 0xbd02];
    assert_eq!(longest_of_any(&memory), Err(NoBound::UnboundedLoop(CODE + 14)));
    assert_eq!(instructions(longest(&memory)), 7 + 7 * 4 + 1);
    // vmov s0, #1; vmov s1, #2; cmp r0, #0; it ne; vmovne s0, s1; vcmp s0, s1; vmrs; beq .+8; three nops; bx lr
    let single = [
        0xeeb7, 0x0a00, 0xeef0, 0x0a00, 0x2800, 0xbf18, 0xeeb0, 0x0a60, 0xeeb4, 0x0a60, 0xeef1, 0xfa10, 0xd002, 0xbf00,
        0xbf00, 0xbf00, 0x4770,
    ];
    assert_eq!(instructions(longest_of_any(&single)), 12);
    assert_eq!(instructions(longest(&single)), 9);
}

/// At a join the larger count is kept.
#[test]
fn join_keeps_larger_count() {
    // movs r1, #2; cbz r0, .+4; movs r1, #7; subs r1, #1; bne .-2; bx lr
    assert_eq!(instructions(longest_of_any(&[0x2102, 0xb100, 0x2107, 0x3901, 0xd1fd, 0x4770])), 3 + 7 * 2 + 1);
}

/// A store to an unknown address makes all memory unknown.
#[test]
fn store_to_unknown_address_clears_memory() {
    // push {r1, lr}; movs r1, #4; str r1, [sp]; str r1, [sp, #4]; ldr r1, [sp]; subs r1, #1; str r1, [sp]; bne .-6; pop {r1, pc}
    let kept = [0xb502, 0x2104, 0x9100, 0x9101, 0x9900, 0x3901, 0x9100, 0xd1fb, 0xbd02];
    assert_eq!(instructions(longest_of_any(&kept)), 4 + 4 * 4 + 1);
    // str r1, [r0] in place of the second store
    let mut lost = kept;
    lost[3] = 0x6001;
    assert_eq!(longest_of_any(&lost), Err(NoBound::UnboundedLoop(CODE + 8)));
}

/// A call counts at every place of the call; panics, unknown targets and recursion are rejected.
#[test]
fn calls_inlined() {
    // movs r1, #3; push {lr}; bl callee; subs r1, #1; bne .-6; pop {pc}
    let caller: &[u16] = &[0x2103, 0xb500, 0xf000, 0xf806, 0x3901, 0xd1fb, 0xbd00];
    let callee: &[u16] = &[0xbf00, 0x4770];
    let found = |name: &str| longest_of(&[("one", CODE, caller), (name, CODE + 0x14, callee)]);
    assert_eq!(instructions(found("callee")), 2 + 3 * (1 + 2 + 2) + 1);
    assert_eq!(found("core::panicking::panic"), Err(NoBound::ReachablePanic(CODE + 4)));
    // No function at the target.
    assert_eq!(longest(caller), Err(NoBound::UnknownTarget(CODE + 4)));
    // bl to itself
    assert_eq!(longest(&[0xf7ff, 0xfffe, 0x4770]), Err(NoBound::Recursion(CODE)));
}

/// Arithmetic of known single-precision values decides a comparison.
#[test]
fn single_precision_constants_followed() {
    // vmov s0, #2; vmov s1, #3; vmul s0, s0, s1; vmov s1, #6; vcmp s0, s1; vmrs; beq .+8; three nops; bx lr
    let code = [
        0xeeb0, 0x0a00, 0xeef0, 0x0a08, 0xee20, 0x0a20, 0xeef1, 0x0a08, 0xeeb4, 0x0a60, 0xeef1, 0xfa10, 0xd002, 0xbf00,
        0xbf00, 0xbf00, 0x4770,
    ];
    assert_eq!(instructions(longest(&code)), 8);
}

/// A floating-point result used by the next instruction costs one more cycle.
#[test]
fn dependent_float_result_costs_cycle() {
    let cycles = |code: &[u16]| longest(code).unwrap().cost.cycles;
    // vdiv s0, s0, s1; vadd s0, s0, s1; bx lr
    assert_eq!(cycles(&[0xee80, 0x0a20, 0xee30, 0x0a20, 0x4770]), 14 + 2 + 4);
    // vdiv s0, s0, s1; vadd s2, s1, s1; bx lr
    assert_eq!(cycles(&[0xee80, 0x0a20, 0xee30, 0x1aa0, 0x4770]), 14 + 1 + 4);
}

/// Unknown instructions, traps and jumps to unknown registers are rejected.
#[test]
fn unknown_instructions_rejected() {
    // vadd.f64 d0, d0, d1, which this core does not have
    assert_eq!(longest(&[0xee30, 0x0b01, 0x4770]), Err(NoBound::UnknownInstruction(CODE)));
    // udf #0
    assert_eq!(longest(&[0xde00]), Err(NoBound::ReachablePanic(CODE)));
    // bx r3
    assert_eq!(longest(&[0x4718]), Err(NoBound::UnknownTarget(CODE)));
}

fn searched(most: u32) -> worst_case::SearchResult {
    let mut found = Vec::new();
    for line in ["joint;Q1;3;2;0;1", &format!("class;apart;10;1000;{most};7"), "state;X { y: 1 }"] {
        worst_case::parse(line, &mut found).unwrap();
    }
    found.remove(0)
}

/// A bound that a state exceeds, or that is 1.33 times the worst state, fails the check.
#[test]
fn exceeded_or_loose_bound_fails() {
    let loops = vec![("gears/light.rs:81".to_owned(), 5)];
    let bound = Bound { name: "Q1".into(), instructions: 4000, cycles: 7000, functions: 6, loops };
    let checked = |most| check(std::slice::from_ref(&bound), &[searched(most)]);
    assert_eq!(searched(1).parts, Substeps::Corrected(2));
    let line = checked(3700).unwrap().remove(0);
    assert!(
        line.contains("4000 instructions") && line.contains("7000 cycles") && line.contains("1.08 times"),
        "{line}"
    );
    let exceeded = checked(4001).unwrap_err();
    assert!(exceeded.message().contains("4001") && exceeded.message().contains("X { y: 1 }"), "{exceeded}");
    assert!(checked(3000).unwrap_err().message().contains("1.33 times"));
    assert_eq!(exceeded.exit_code(), 1);
}

/// The failure names joint and function and has a help.
#[test]
fn missing_bound_names_joint_and_function() {
    let functions = Functions::assembled(&[("gears::light::tick", CODE, &[0xbf00])], 0..0);
    let elf = fs::read("/proc/self/exe").unwrap();
    assert!(Source::read(&elf).is_err(), "a program of the host is no image");
    let elf = empty_image();
    let source = Source::read(&elf).unwrap();
    let failure = refusal("Q1", &functions, &source, NoBound::UnboundedLoop(CODE));
    assert!(failure.message().contains("joint Q1") && failure.message().contains("gears::light::tick"), "{failure}");
    assert!(failure.help().is_some());
    assert_eq!(failure.exit_code(), 1);
}

/// Header of a 32-bit ELF file without any section.
fn empty_image() -> Vec<u8> {
    let mut elf = vec![0; 52];
    elf[..7].copy_from_slice(&[0x7f, b'E', b'L', b'F', 1, 1, 1]);
    elf[16] = 2;
    elf[18] = 40;
    elf[20] = 1;
    elf[40] = 52;
    elf
}
