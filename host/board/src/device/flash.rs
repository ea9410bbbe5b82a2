//! Writes an image to a real board: with probe-rs through a debug probe, or with dfu-util over USB to the chip's boot
//! loader.

use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};

use object::{Object, ObjectSegment};

use super::board::Board;
use super::tool;
use report::failure::{Failure, Outcome};

const PROBE: &str = "probe-rs";
const DFU: &str = "dfu-util";
/// USB identity of the boot loader of every supported chip.
const BOOT_LOADER_USB_ID: &str = "0483:df11";
/// Start address of flash.
const FLASH_START: u64 = 0x0800_0000;

/// Writes an image to the board behind the debug probe and starts it. probe-rs shows its own progress.
pub fn by_probe(elf: &Path, board: &Board) -> Outcome<()> {
    let program = tool::find(PROBE).ok_or_else(|| probe_missing(elf, board))?;
    let chip = board.description.probe_name.as_str();
    let run = |arguments: &[&str], elf: Option<&Path>| {
        let mut command = Command::new(&program);
        command.args(arguments).args(["--chip", chip]).args(elf);
        run_tool(command, PROBE, "is the debug probe plugged in? `probe-rs list` shows what is there")
    };
    run(&["download"], Some(elf))?;
    run(&["reset"], None)
}

/// Writes an image over USB and starts it. dfu-util shows its own progress; the flat_binary binary that it needs is written
/// beside the image.
pub fn by_dfu(elf: &Path, board: &Board) -> Outcome<()> {
    let binary = elf.with_extension("bin");
    let bytes = flat_binary(elf)?;
    fs::write(&binary, bytes).map_err(|error| Failure::new(format!("{}: {error}", binary.display())))?;
    let program = tool::find(DFU).ok_or_else(|| dfu_missing(&binary, board))?;
    let mut command = Command::new(program);
    command
        .args(["--device", BOOT_LOADER_USB_ID, "--alt", "0", "--dfuse-address", "0x08000000:leave", "--download"])
        .arg(&binary);
    run_tool(
        command,
        DFU,
        "is the board on USB, and was it started with BOOT0 high? `dfu-util --list` shows what is there",
    )
}

fn run_tool(mut command: Command, name: &str, help: &str) -> Outcome<()> {
    let status =
        command.stdin(Stdio::null()).status().map_err(|error| Failure::new(format!("cannot run {name}: {error}")))?;
    match status.success() {
        true => Ok(()),
        false => Err(Failure::new(format!("{name} failed ({status})")).with_help(help)),
    }
}

/// Contents of flash from its first to its last used byte; gaps hold 0xff, the erased value.
fn flat_binary(elf: &Path) -> Outcome<Vec<u8>> {
    let refused = |why: String| Failure::new(format!("{}: {why}", elf.display()));
    let text = fs::read(elf).map_err(|error| refused(error.to_string()))?;
    let file = object::File::parse(&*text).map_err(|error| refused(error.to_string()))?;
    let mut bytes = Vec::new();
    for segment in file.segments() {
        let data = segment.data().map_err(|error| refused(error.to_string()))?;
        let place = load_address(&file, segment.address()).checked_sub(FLASH_START).map(|place| place as usize);
        // Initial values of RAM have a load address in flash; segments without data are skipped.
        let Some(place) = place.filter(|place| !data.is_empty() && *place < 1 << 24) else { continue };
        bytes.resize(bytes.len().max(place + data.len()), 0xff);
        bytes[place..place + data.len()].copy_from_slice(data);
    }
    Ok(bytes)
}

/// Load address of the segment at a virtual address.
fn load_address(file: &object::File<'_>, address: u64) -> u64 {
    use object::read::elf::ProgramHeader;
    let object::File::Elf32(elf) = file else { return address };
    let headers = elf.elf_program_headers();
    let header = headers.iter().find(|header| u64::from(header.p_vaddr(elf.endian())) == address);
    header.map_or(address, |header| header.p_paddr(elf.endian()).into())
}

fn probe_missing(elf: &Path, board: &Board) -> Failure {
    Failure::new(format!("{PROBE}, which writes images to boards, is not on the search path")).with_help(format!(
        "get it: cargo install {PROBE}-tools --locked (https://probe.rs/docs/getting-started/installation)\n\
         or write {} to the {} by a tool of your own",
        elf.display(),
        board.description.probe_name
    ))
}

fn dfu_missing(binary: &Path, board: &Board) -> Failure {
    Failure::new(format!("{DFU}, which writes images over USB, is not on the search path")).with_help(format!(
        "get it: it is the package {DFU} of most distributions\n\
         or write {} to the {} at 0x08000000 by a tool of your own",
        binary.display(),
        board.description.probe_name
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Without the tool the help names its installation and the file to write by other means.
    #[test]
    fn missing_flash_tool_shows_both_remedies() {
        let nucleo = Board::load("nucleo-g474re").unwrap();
        let probe = probe_missing(Path::new("images/q1.elf"), &nucleo);
        let dfu = dfu_missing(Path::new("images/q1.bin"), &nucleo);
        for (failure, words) in [
            (probe, ["cargo install probe-rs-tools", "images/q1.elf", "STM32G474RETx"]),
            (dfu, ["package dfu-util", "images/q1.bin", "STM32G474RETx"]),
        ] {
            let help = failure.help().unwrap();
            assert!(words.into_iter().all(|word| help.contains(word)), "{help}");
            assert_eq!(failure.exit_code(), 2);
        }
    }

    /// The failure names the file that is no ELF file.
    #[test]
    fn missing_elf_named() {
        assert!(flat_binary(Path::new("/no/image.elf")).unwrap_err().message().contains("/no/image.elf"));
    }
}
