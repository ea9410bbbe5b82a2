//! Small functions with their disassembly by `objdump`, whose counts were found by hand.

use super::longest::{Cost, Longest, Refused, Search};
use super::machine::Machine;
use super::*;
use model_core::gears::certificate::Substeps;

const CODE: u32 = 0x0800_1000;
const DATA: u32 = 0x0800_2000;

/// Longest path through functions from the first one, with a table of two words at [`DATA`] in register 0.
fn longest_of(functions: &[(&str, u32, &[u16])]) -> Result<Longest, Refused> {
    let words: &[u16] = &[6, 0, 0, 0];
    let all: Vec<_> = functions.iter().copied().chain([("TABLE", DATA, words)]).collect();
    let functions = Functions::assembled(&all, 0..0);
    let mut machine = Machine::with_stack(STACK);
    machine.set(0, Some(DATA));
    Search::new(&functions, LOWEST_STACK).run(CODE, machine)
}

fn longest(code: &[u16]) -> Result<Longest, Refused> {
    longest_of(&[("one", CODE, code)])
}

/// Longest path with an unknown value in register 0.
fn longest_of_any(code: &[u16]) -> Result<Longest, Refused> {
    let functions = Functions::assembled(&[("one", CODE, code)], 0..0);
    Search::new(&functions, LOWEST_STACK).run(CODE, Machine::with_stack(STACK))
}

fn instructions(found: Result<Longest, Refused>) -> u32 {
    found.expect("a bound").cost.instructions
}

#[test]
fn a_loop_up_to_a_literal_is_gone_round_so_often() {
    // movs r1, #0; adds r1, #1; cmp r1, #10; bne .-4; bx lr
    let found = longest(&[0x2100, 0x3101, 0x290a, 0xd1fc, 0x4770]).unwrap();
    // Nine of the ten branches are taken.
    assert_eq!(found.cost, Cost { instructions: 1 + 10 * 3 + 1, cycles: 1 + 10 * 2 + 9 * 4 + 1 + 4 });
    assert_eq!(found.loops.into_iter().collect::<Vec<_>>(), [(CODE + 2, 10)]);
}

#[test]
fn loops_within_loops_multiply() {
    // movs r1, #3; movs r2, #4; subs r2, #1; bne .-2; subs r1, #1; bne .-8; bx lr
    let found = longest(&[0x2103, 0x2204, 0x3a01, 0xd1fd, 0x3901, 0xd1fa, 0x4770]).unwrap();
    assert_eq!(found.cost.instructions, 1 + 3 * (1 + 4 * 2 + 2) + 1);
    assert_eq!(found.loops.into_iter().collect::<Vec<_>>(), [(CODE + 2, 3), (CODE + 4, 4)]);
}

#[test]
fn a_loop_that_nothing_known_ends_is_refused() {
    // nop; subs r0, #1; bne .-2; bx lr
    assert_eq!(longest_of_any(&[0xbf00, 0x3801, 0xd1fd, 0x4770]), Err(Refused::Unbounded(CODE + 2)));
    // nop; ldrb r1, [r0]; adds r0, #1; cbz r1, .+4; b .-6; bx lr
    assert_eq!(longest_of_any(&[0xbf00, 0x7801, 0x3001, 0xb101, 0xe7fb, 0x4770]), Err(Refused::Unbounded(CODE + 2)));
    // movs r1, #0; adds r1, #1; b .-2: the counter is never tested.
    assert_eq!(longest(&[0x2100, 0x3101, 0xe7fd]), Err(Refused::Unbounded(CODE + 2)));
    // movs r1, #0; adds r1, #1; cmp r1, r0; bne .-4; bx lr: the limit is unknown.
    assert_eq!(longest_of_any(&[0x2100, 0x3101, 0x4281, 0xd1fc, 0x4770]), Err(Refused::Unbounded(CODE + 2)));
}

#[test]
fn tables_end_loops_and_choose_ways() {
    // ldr r1, [r0]; subs r1, #1; bne .-2; bx lr
    assert_eq!(instructions(longest(&[0x6801, 0x3901, 0xd1fd, 0x4770])), 1 + 6 * 2 + 1);
    assert!(longest_of_any(&[0x6801, 0x3901, 0xd1fd, 0x4770]).is_err());
    // ldr r1, [r0, #4]; cbz r1, .+12; five nops; bx lr
    let chosen = [0x6841, 0xb121, 0xbf00, 0xbf00, 0xbf00, 0xbf00, 0xbf00, 0x4770];
    assert_eq!(instructions(longest(&chosen)), 3);
    assert_eq!(instructions(longest_of_any(&chosen)), 8);
}

#[test]
fn of_a_switch_the_longest_case_counts() {
    // cmp r0, #2; bhi default; tbb [pc, r0]; three cases of 2, 4 and 2 instructions; bx lr
    let switch = [
        0x2802, 0xd80b, 0xe8df, 0xf000, 0x0402, 0x0008, 0xbf00, 0xe005, 0xbf00, 0xbf00, 0xbf00, 0xe001, 0xbf00, 0xe7ff,
        0x4770,
    ];
    let functions = Functions::assembled(&[("one", CODE, &switch)], CODE + 8..CODE + 12);
    let run = |machine| instructions(Search::new(&functions, LOWEST_STACK).run(CODE, machine));
    assert_eq!(run(Machine::with_stack(STACK)), 3 + 4 + 1);
    for (case, length) in [(0, 2), (1, 4), (2, 2)] {
        let mut machine = Machine::with_stack(STACK);
        machine.set(0, Some(case));
        assert_eq!(run(machine), 3 + length + 1, "case {case}");
    }
}

#[test]
fn a_loop_with_two_ways_in_is_refused() {
    // cbz r0, .+4; nop; subs r1, #1; bne .-4; bx lr
    let found = longest_of_any(&[0xb100, 0xbf00, 0x3901, 0xd1fc, 0x4770]);
    assert!(matches!(found, Err(Refused::Irreducible(_))), "{found:?}");
}

#[test]
fn what_a_condition_skips_counts_as_well() {
    // cmp r0, #1; itt eq; addeq r1, #1; addeq r1, #2; bx lr
    assert_eq!(instructions(longest_of_any(&[0x2801, 0xbf04, 0x3101, 0x3102, 0x4770])), 5);
}

#[test]
fn what_a_condition_may_or_may_not_set_is_not_known() {
    // movs r1, #2; cmp r0, #0; it ne; movne r1, #7; subs r1, #1; bne .-2; bx lr
    let register = [0x2102, 0x2800, 0xbf18, 0x2107, 0x3901, 0xd1fd, 0x4770];
    assert_eq!(longest_of_any(&register), Err(Refused::Unbounded(CODE + 8)));
    // Register 0 is known not to be zero, so the condition holds.
    assert_eq!(instructions(longest(&register)), 4 + 7 * 2 + 1);
    // push {r1, lr}; movs r1, #2; str r1, [sp]; movs r2, #7; cmp r0, #0; it ne; strne r2, [sp]; ldr r1, [sp]; subs r1, #1;
    // str r1, [sp]; bne .-6; pop {r1, pc}
    let memory = [0xb502, 0x2102, 0x9100, 0x2207, 0x2800, 0xbf18, 0x9200, 0x9900, 0x3901, 0x9100, 0xd1fb, 0xbd02];
    assert_eq!(longest_of_any(&memory), Err(Refused::Unbounded(CODE + 14)));
    assert_eq!(instructions(longest(&memory)), 7 + 7 * 4 + 1);
    // vmov s0, #1; vmov s1, #2; cmp r0, #0; it ne; vmovne s0, s1; vcmp s0, s1; vmrs; beq .+8; three nops; bx lr
    let single = [
        0xeeb7, 0x0a00, 0xeef0, 0x0a00, 0x2800, 0xbf18, 0xeeb0, 0x0a60, 0xeeb4, 0x0a60, 0xeef1, 0xfa10, 0xd002, 0xbf00,
        0xbf00, 0xbf00, 0x4770,
    ];
    assert_eq!(instructions(longest_of_any(&single)), 12);
    assert_eq!(instructions(longest(&single)), 9);
}

#[test]
fn a_count_that_two_ways_bring_is_the_greater() {
    // movs r1, #2; cbz r0, .+4; movs r1, #7; subs r1, #1; bne .-2; bx lr
    assert_eq!(instructions(longest_of_any(&[0x2102, 0xb100, 0x2107, 0x3901, 0xd1fd, 0x4770])), 3 + 7 * 2 + 1);
}

#[test]
fn a_store_to_anywhere_may_be_to_the_counter() {
    // push {r1, lr}; movs r1, #4; str r1, [sp]; str r1, [sp, #4]; ldr r1, [sp]; subs r1, #1; str r1, [sp]; bne .-6; pop {r1, pc}
    let kept = [0xb502, 0x2104, 0x9100, 0x9101, 0x9900, 0x3901, 0x9100, 0xd1fb, 0xbd02];
    assert_eq!(instructions(longest_of_any(&kept)), 4 + 4 * 4 + 1);
    // str r1, [r0] in place of the second store
    let mut lost = kept;
    lost[3] = 0x6001;
    assert_eq!(longest_of_any(&lost), Err(Refused::Unbounded(CODE + 8)));
}

#[test]
fn calls_stand_in_their_callers_places() {
    // movs r1, #3; push {lr}; bl callee; subs r1, #1; bne .-6; pop {pc}
    let caller: &[u16] = &[0x2103, 0xb500, 0xf000, 0xf806, 0x3901, 0xd1fb, 0xbd00];
    let callee: &[u16] = &[0xbf00, 0x4770];
    let found = |name: &str| longest_of(&[("one", CODE, caller), (name, CODE + 0x14, callee)]);
    assert_eq!(instructions(found("callee")), 2 + 3 * (1 + 2 + 2) + 1);
    assert_eq!(found("core::panicking::panic"), Err(Refused::Stops(CODE + 4)));
    // No function at the target.
    assert_eq!(longest(caller), Err(Refused::Lost(CODE + 4)));
    // bl to itself
    assert_eq!(longest(&[0xf7ff, 0xfffe, 0x4770]), Err(Refused::Recursion(CODE)));
}

#[test]
fn single_precision_constants_are_followed() {
    // vmov s0, #2; vmov s1, #3; vmul s0, s0, s1; vmov s1, #6; vcmp s0, s1; vmrs; beq .+8; three nops; bx lr
    let code = [
        0xeeb0, 0x0a00, 0xeef0, 0x0a08, 0xee20, 0x0a20, 0xeef1, 0x0a08, 0xeeb4, 0x0a60, 0xeef1, 0xfa10, 0xd002, 0xbf00,
        0xbf00, 0xbf00, 0x4770,
    ];
    assert_eq!(instructions(longest(&code)), 8);
}

#[test]
fn a_result_that_is_wanted_at_once_comes_a_cycle_later() {
    let cycles = |code: &[u16]| longest(code).unwrap().cost.cycles;
    // vdiv s0, s0, s1; vadd s0, s0, s1; bx lr
    assert_eq!(cycles(&[0xee80, 0x0a20, 0xee30, 0x0a20, 0x4770]), 14 + 2 + 4);
    // vdiv s0, s0, s1; vadd s2, s1, s1; bx lr
    assert_eq!(cycles(&[0xee80, 0x0a20, 0xee30, 0x1aa0, 0x4770]), 14 + 1 + 4);
}

#[test]
fn what_is_not_known_is_refused() {
    // vadd.f64 d0, d0, d1, which this core does not have
    assert_eq!(longest(&[0xee30, 0x0b01, 0x4770]), Err(Refused::Instruction(CODE)));
    // udf #0
    assert_eq!(longest(&[0xde00]), Err(Refused::Stops(CODE)));
    // bx r3
    assert_eq!(longest(&[0x4718]), Err(Refused::Lost(CODE)));
}

fn searched(most: u32) -> worst_case::Search {
    let mut found = Vec::new();
    for line in ["joint;Q1;3;2;0;1", &format!("class;apart;10;1000;{most};7"), "state;X { y: 1 }"] {
        worst_case::parse(line, &mut found).unwrap();
    }
    found.remove(0)
}

#[test]
fn a_bound_holds_and_is_close_or_the_check_fails() {
    let loops = vec![("gears/light.rs:81".to_owned(), 5)];
    let bound = Bound { name: "Q1".into(), instructions: 4000, cycles: 7000, functions: 6, loops };
    let judged = |most| judge(std::slice::from_ref(&bound), &[searched(most)]);
    assert_eq!(searched(1).parts, Substeps::Corrected(2));
    let line = judged(3700).unwrap().remove(0);
    assert!(
        line.contains("4000 instructions") && line.contains("7000 cycles") && line.contains("1.08 times"),
        "{line}"
    );
    let exceeded = judged(4001).unwrap_err();
    assert!(exceeded.message().contains("4001") && exceeded.message().contains("X { y: 1 }"), "{exceeded}");
    assert!(judged(3000).unwrap_err().message().contains("1.33 times"));
    assert_eq!(exceeded.exit_code(), 1);
}

#[test]
fn a_refusal_names_joint_function_and_help() {
    let functions = Functions::assembled(&[("gears::light::tick", CODE, &[0xbf00])], 0..0);
    let elf = fs::read("/proc/self/exe").unwrap();
    assert!(Source::read(&elf).is_err(), "a program of the host is no image");
    let elf = empty_image();
    let source = Source::read(&elf).unwrap();
    let failure = refusal("Q1", &functions, &source, Refused::Unbounded(CODE));
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
