//! Costs of the library on a board: flash and RAM of linked programs that use a part of it, and instructions and stack
//! of each call, counted on the emulator.

use std::process::Command;

use board::device::board::Board;
use board::device::tool;
use joint_file::JointFile;
use report::failure::{Failure, Outcome};

use crate::library::{Library, Target};
use crate::programs::{self, MACHINES, Machine, Workbench};
use crate::tables;

/// Uses of the library, with their names in `bindings/c/programs/size.c`; the empty use comes first.
const USES: [(&str, &str); 6] = [
    ("NOTHING", "nothing"),
    ("OBSERVER_WITHOUT_MAPS", "observer without maps"),
    ("OBSERVER", "observer with maps"),
    ("CONTROL_WITHOUT_MAPS", "observer without maps, compensation"),
    ("CONTROL", "observer with maps, compensation"),
    ("PLANT", "plant"),
];

/// Memory of a use, including its tables.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct MemoryUse {
    /// Name of the use.
    pub what: &'static str,
    /// Code and constants [B].
    pub flash: u64,
    /// Objects, samples and results [B].
    pub ram: u64,
}

/// Instructions of a call.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct CallCost {
    /// Name of the function.
    pub name: String,
    /// Mean.
    pub mean: u64,
    /// Maximum.
    pub max: u64,
}

/// Stack of a call.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct StackUse {
    /// Name of the function.
    pub name: String,
    /// Stack below the caller's stack pointer, including arguments on the stack [B].
    pub bytes: u64,
}

/// Emulated machine that stands for a target.
pub fn machine_for(target: Target) -> Option<Machine> {
    MACHINES.into_iter().find(|machine| machine.target == target)
}

/// Counts of SysTick in a thousand instructions of 64 ns each: its clock is 168 MHz, 20 MHz or 25 MHz.
fn systick_counts(machine: Machine) -> u32 {
    match machine.name {
        "netduinoplus2" => 10_752,
        "mps2-an505" => 1280,
        _ => 1600,
    }
}

/// Memory of each use, in excess of a program without the library, with tables for the use.
pub fn memory(library: &Library, joint: &JointFile, machine: Machine) -> Outcome<Vec<MemoryUse>> {
    let [control, whole] = [false, true].map(|plant| {
        let tables = tables::for_tests(joint, plant, &Board::emulated())?;
        Workbench::new(library, &tables)
    });
    let (control, whole) = (control?, whole?);
    let source = programs::folder().join("size.c");
    let mut sizes = Vec::new();
    for (name, what) in USES {
        let bench = if name == "PLANT" { &whole } else { &control };
        let elf = bench.compile_for(machine, &[&source], &[&format!("-D{name}"), "-Os"])?;
        let output = tool::capture_output(Command::new(machine.target.tool("size")).arg(&elf))?;
        let row: Vec<u64> = output
            .lines()
            .nth(1)
            .unwrap_or_default()
            .split_whitespace()
            .take(3)
            .map_while(|it| it.parse().ok())
            .collect();
        let [text, data, bss] =
            row.try_into().map_err(|_| Failure::new(format!("unexpected output of `size`: {output}")))?;
        sizes.push((what, text + data, data + bss));
    }
    let empty = sizes.first().copied().unwrap_or_default();
    let excess =
        |(what, flash, ram): &(&'static str, u64, u64)| MemoryUse { what, flash: flash - empty.1, ram: ram - empty.2 };
    Ok(sizes.iter().skip(1).map(excess).collect())
}

/// Instructions of each call. `measuring` is for a library that also exports the core's own steps.
pub fn calls(bench: &Workbench, machine: Machine, measuring: bool) -> Outcome<Vec<CallCost>> {
    let source = programs::folder().join("costs.c");
    let counts = format!("-DCOUNTS_PER_THOUSAND={}u", systick_counts(machine));
    let mut flags = vec![counts.as_str(), "-O2"];
    flags.extend(measuring.then_some("-DMEASURING"));
    let elf = bench.compile_for(machine, &[&source], &flags)?;
    let parse = |line: &String| {
        let mut fields = line.strip_prefix("cost;")?.split(';');
        let name = fields.next()?.to_owned();
        Some(CallCost { name, mean: fields.next()?.parse().ok()?, max: fields.next()?.parse().ok()? })
    };
    programs::run_on(machine, &elf)?
        .iter()
        .map(|line| parse(line).ok_or_else(|| Failure::new(format!("unexpected output on {}: {line}", machine.name))))
        .collect()
}

/// Stack of each call.
pub fn stacks(bench: &Workbench, machine: Machine) -> Outcome<Vec<StackUse>> {
    let source = programs::folder().join("stack.c");
    let elf = bench.compile_for(machine, &[&source], &["-O2"])?;
    let parse = |line: &String| {
        let (name, bytes) = line.strip_prefix("stack;")?.split_once(';')?;
        // Zero means that the stack exceeds the searched range.
        Some(StackUse { name: name.to_owned(), bytes: bytes.parse().ok().filter(|bytes| *bytes > 0)? })
    };
    programs::run_on(machine, &elf)?
        .iter()
        .map(|line| parse(line).ok_or_else(|| Failure::new(format!("unexpected output on {}: {line}", machine.name))))
        .collect()
}

/// Costs of a library.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Costs {
    /// Memory by use.
    pub memory: Vec<MemoryUse>,
    /// Instructions of each call that was counted.
    pub calls: Vec<CallCost>,
    /// Stack of each call.
    pub stacks: Vec<StackUse>,
}

impl Costs {
    /// Measures the costs on the machine that stands for the library's target.
    pub fn measure(library: &Library, joint: &JointFile, machine: Machine) -> Outcome<Self> {
        let tables = tables::for_tests(joint, true, &Board::emulated())?;
        let bench = Workbench::new(library, &tables)?;
        Ok(Self {
            memory: memory(library, joint, machine)?,
            calls: calls(&bench, machine, false)?,
            stacks: stacks(&bench, machine)?,
        })
    }
}

/// Costs as Markdown, shared by the archive and the docs.
pub fn section(costs: &Costs, joint: &JointFile, machine: Machine) -> String {
    let mut text = format!(
        "\nMemory that a program takes beyond one without the library: tables of joint {} are in flash, objects, samples and results\n\
         in RAM. Linked with `-Wl,--gc-sections`.\n\n| use | flash [B] | RAM [B] |\n|---|---|---|\n",
        joint.parameters.name
    );
    for use_of in &costs.memory {
        text += &format!("| {} | {} | {} |\n", use_of.what, use_of.flash, use_of.ram);
    }
    text += &format!(
        "\nInstructions of a call over three seconds of a closed loop at {} Hz, and the most stack below its caller. EMULATED:\n\
         counted on `{}` of the emulator, never on silicon.\n\n\
         | function | instructions, mean | most | stack [B] |\n|---|---|---|---|\n",
        joint.surroundings.control_rate, machine.name
    );
    for stack in &costs.stacks {
        let counted = costs.calls.iter().find(|call| call.name == stack.name);
        let [mean, max] =
            counted.map_or(["".to_owned(), "".to_owned()], |it| [it.mean, it.max].map(|it| it.to_string()));
        text += &format!("| `{}` | {mean} | {max} | {} |\n", stack.name, stack.bytes);
    }
    text
}
