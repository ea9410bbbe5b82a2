//! Firmware images: built for a joint, a board and a role, each under its own file name so that images of several
//! joints can lie side by side. The tables in an image are made by the firmware's build script.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};

use board_file::Can;
use joint_file::named;
use link::messages::Role;
use model_core::controller::design::ControlRequest;
use object::{Object, ObjectSegment};
use parameters::JointParameters;
use sha2::{Digest, Sha256};
use virtual_drive::maker::{MOTEUS, Name, ODRIVE3};

use super::Say;
use super::board::Board;
use super::compile::{FIRMWARE_PACKAGE, PROFILE, compile, write_atomically};
pub use super::role::{DRIVE, role_name};
use super::sources;
use super::tick_time::{RateCheck, default_control_rate};
use super::toolchain::{TARGET_FLAGS, Toolchain};
use report::digest::{hexadecimal, sha256};
use report::failure::{Failure, Outcome};
use report::workspace::workspace;

/// Default rate of fixed steps [Hz].
pub const DEFAULT_TICK_RATE: u32 = 20_000;
/// Default control rate of the roles `observer` and `loop` [Hz].
pub const CONTROL_RATE: u32 = 10_000;
/// Default control rate of an SPI slave, at which transfer and step fit one after the other [Hz].
pub const SPI_RATE: u32 = 5000;
/// Binary of the SPI slave.
const SPI_BINARY: &str = "spi_observer";
/// Binary of a drive on CAN.
const DRIVE_BINARY: &str = DRIVE;
/// Feature that the binary of a drive needs.
const DRIVE_FEATURE: &str = ",can";
/// Inline threshold for boards with little flash. A lower level of optimisation would leave checks that can panic in
/// the loops of the tick.
const LOW_INLINE_THRESHOLD: &str = " -Cllvm-args=-inline-threshold=100";
/// Upper bound on the size of any image [byte].
const LARGEST_IMAGE: u32 = 256 << 10;
/// Start address of flash on every board. RAM begins at [`RAM_START`].
const FLASH_START: u64 = 0x0800_0000;
const RAM_START: u64 = 0x2000_0000;

/// Words of the error about an image that does not fit the board.
pub const TOO_LARGE: &str = "too large for the board";

/// A finished image.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Image {
    /// The ELF file.
    pub elf: PathBuf,
    /// SHA-256 of the ELF file, 64 hexadecimal digits.
    pub sha256: String,
    /// Flash used: code, constants and initial values [byte].
    pub flash_bytes: u64,
    /// RAM used by statics [byte].
    pub ram_bytes: u64,
    /// `rustc --version` of the compiler.
    pub compiler: String,
    /// Flags that change code: profile, target, board.
    pub flags: String,
}

/// Builds the image of a joint unless it is up to date. Rejects an image whose worst tick exceeds the period unless
/// `forced`. A relative `joint_file` is relative to the working folder.
pub fn build_image(
    toolchain: &Toolchain,
    joint_file: &Path,
    board: &Board,
    role: Role,
    tick_rate: u32,
    forced: bool,
    say: Say<'_>,
) -> Outcome<Image> {
    let joint_file = absolute_path(joint_file)?;
    let forced = check_fit(&joint_file, board, Some(role), tick_rate, forced, say)?;
    let place = file_name(&joint_file, board, role_name(role), tick_rate);
    let control = Control { forced, ..Control::with_defaults(tick_rate) };
    let what = What { binary: binary_name(role), control: &control, drive: None };
    build(toolchain, [&joint_file; 2], board, &what, &place, say)
}

/// Rejects a joint file that the board cannot be built for; `role` is `None` for the role `drive`. Returns whether the
/// image needs `forced`.
fn check_fit(
    joint_file: &Path,
    board: &Board,
    role: Option<Role>,
    rate: u32,
    forced: bool,
    say: Say<'_>,
) -> Outcome<bool> {
    let parameters = named::load(joint_file)?.file.parameters;
    let rate_check = match role {
        Some(role) => RateCheck::new(&parameters, board, role),
        None => RateCheck::drive(&parameters, board),
    };
    let forced = rate_check.check_unless_forced(rate, forced)?;
    if forced {
        let report = if role.is_some() { "; the board reports `forced` in its identity" } else { "" };
        say(&format!("built by force: the worst tick at {rate} Hz takes too long for {}{report}", board.name()));
    }
    Ok(forced)
}

/// Settings of a controller's image, in addition to the joint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Control {
    /// Control rate, equal to the tick rate [Hz].
    pub rate: u32,
    /// Bandwidth of the loop [rad/s]; if `None`, derived from the joint that the controller assumes.
    pub bandwidth: Option<f64>,
    /// Limit of the torque through the teeth in position mode, referred to the link [N m]; if `None`, the default of
    /// the firmware's build.
    pub peak_torque: Option<f64>,
    /// True if the observer reads the output encoder.
    pub output_encoder: bool,
    /// True if built although the worst tick exceeds the period.
    pub forced: bool,
}

impl Control {
    /// Requirements at a rate, with the defaults of the firmware's build.
    pub fn with_defaults(rate: u32) -> Self {
        let ControlRequest { bandwidth, peak_torque, output_encoder } = ControlRequest::USUAL;
        Self { rate, bandwidth, peak_torque, output_encoder, forced: false }
    }

    /// Returns the requirements that the firmware's build designs the controller to.
    pub fn request(&self) -> ControlRequest {
        let Self { bandwidth, peak_torque, output_encoder, .. } = *self;
        ControlRequest { bandwidth, peak_torque, output_encoder }
    }
}

/// Builds the image of a role with a controller from the texts of two joint files: the true joint, and the joint as
/// told to the controller. Each pair has its own files beside the images.
pub fn build_control_image(
    toolchain: &Toolchain,
    [truth, told]: [&str; 2],
    board: &Board,
    role: Role,
    control: &Control,
    say: Say<'_>,
) -> Outcome<Image> {
    let digest = Sha256::digest(format!("{truth}{told}{control:?}"));
    let name = hexadecimal(&digest[..6]);
    let folder = toolchain.target_directory().join("images/control");
    let [truth_file, told_file] = ["truth", "told"].map(|which| folder.join(format!("{name}-{which}.toml")));
    write_atomically(&folder, &truth_file, truth.as_bytes())?;
    write_atomically(&folder, &told_file, told.as_bytes())?;
    let forced = check_fit(&truth_file, board, Some(role), control.rate, control.forced, say)?;
    let control = &Control { forced, ..*control };
    let place = format!("control-{name}-{}-{}.elf", board.name(), role_name(role));
    let what = What { binary: binary_name(role), control, drive: None };
    build(toolchain, [&truth_file, &told_file], board, &what, &place, say)
}

/// Builds observer and compensation of a joint as an SPI slave, for a board with an SPI slave.
pub fn build_spi_slave(
    toolchain: &Toolchain,
    joint_file: &Path,
    board: &Board,
    rate: u32,
    forced: bool,
    say: Say<'_>,
) -> Outcome<Image> {
    if !board.has_spi_slave() {
        let message = format!("{} is no slave on SPI: its board file has no [spi_slave]", board.name());
        let presets = Board::presets()?;
        let able: Vec<&str> = presets.iter().filter(|board| board.has_spi_slave()).map(Board::name).collect();
        return Err(Failure::new(message).with_help(format!(
            "use one of {}; every board can run --role observer, beside a motor controller on the same chip or on a serial line; {}",
            able.join(", "),
            board_file::OTHER_CHIPS
        )));
    }
    let joint_file = absolute_path(joint_file)?;
    let control = Control {
        forced: check_fit(&joint_file, board, Some(Role::Observer), rate, forced, say)?,
        ..Control::with_defaults(rate)
    };
    let place = file_name(&joint_file, board, SPI_BINARY, rate);
    let what = What { binary: SPI_BINARY, control: &control, drive: None };
    build(toolchain, [&joint_file; 2], board, &what, &place, say)
}

/// Drive of an image in role `drive`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct DriveOnBus {
    /// Maker, by its word.
    pub maker: Name,
    /// Identifier of the drive on its bus.
    pub id: u8,
}

/// Default control rate of a drive on CAN [Hz]: that of the role `loop`, which runs the same joint beside more work.
pub fn default_drive_rate(joint: &JointParameters, board: &Board) -> u32 {
    default_control_rate(joint, board, Role::Loop)
}

/// Builds a joint behind a drive on CAN, for a board whose file has `[can]`. Says if the board has no transceiver.
pub fn build_drive(
    toolchain: &Toolchain,
    joint_file: &Path,
    board: &Board,
    drive: &DriveOnBus,
    rate: u32,
    forced: bool,
    say: Say<'_>,
) -> Outcome<Image> {
    let DriveOnBus { maker, id } = *drive;
    let can = board.description.can_line().map_err(|why| no_drive(board, why))?;
    if maker.is_flexible && can.data_bitrate.is_none() {
        let why = match can.is_flexible() {
            true => "its board file has no `data_bitrate` in [can]".to_owned(),
            false => format!("{} is classical CAN", can.unit),
        };
        return Err(Failure::new(format!("{} cannot be a {} drive: {why}", board.name(), maker.word))
            .with_help("use a drive on classical CAN, or a board with FDCAN and a second bit rate"));
    }
    if id == 0 || id > maker.max_id {
        return Err(Failure::new(format!("identifier {id} is out of range for a {} drive", maker.word))
            .with_help(format!("write 1 to {}", maker.max_id)));
    }
    for sentence in [can.missing_transceiver(), board.description.inaccurate_can_clock()].into_iter().flatten() {
        say(&format!("{}: {sentence}", board.name()));
    }
    let joint_file = absolute_path(joint_file)?;
    let control =
        Control { forced: check_fit(&joint_file, board, None, rate, forced, say)?, ..Control::with_defaults(rate) };
    let place = file_name(&joint_file, board, &format!("{DRIVE_BINARY}-{}-{id}", maker.word), rate);
    let what = What { binary: DRIVE_BINARY, drive: Some(*drive), control: &control };
    build(toolchain, [&joint_file; 2], board, &what, &place, say)
}

/// Maker of a drive on a CAN line if none is named.
pub fn usual_maker(can: &Can) -> Name {
    if can.data_bitrate.is_some() { MOTEUS } else { ODRIVE3 }
}

/// Failure of a board that cannot be a drive on CAN.
fn no_drive(board: &Board, why: &str) -> Failure {
    let presets = Board::presets().unwrap_or_default();
    let able: Vec<&str> =
        presets.iter().filter(|board| board.description.can_line().is_ok()).map(Board::name).collect();
    Failure::new(format!("{} is no drive on CAN: {why}", board.name()))
        .with_help(format!("use one of {}, or add [can] to the file", able.join(", ")))
}

/// Absolute path of a joint file.
fn absolute_path(joint_file: &Path) -> Outcome<PathBuf> {
    joint_file.canonicalize().map_err(|error| {
        Failure::new(format!("joint file {}: {error}", joint_file.display())).with_help("name a file that can be read")
    })
}

/// Binary of an image with its settings.
struct What<'w> {
    binary: &'w str,
    control: &'w Control,
    /// Drive of the role `drive`.
    drive: Option<DriveOnBus>,
}

fn build(
    toolchain: &Toolchain,
    [truth, told]: [&Path; 2],
    board: &Board,
    &What { binary, control, drive }: &What<'_>,
    name: &str,
    say: Say<'_>,
) -> Outcome<Image> {
    let ControlRequest { bandwidth, peak_torque, output_encoder } = control.request();
    let rate = control.rate.to_string();
    let [bandwidth, peak_torque] =
        [bandwidth, peak_torque].map(|asked| asked.map_or_else(String::new, |asked| asked.to_string()));
    let [motor_only, forced] = [!output_encoder, control.forced].map(|yes| if yes { "1" } else { "0" });
    let own_flags = if has_room_for_all(board) { "" } else { LOW_INLINE_THRESHOLD };
    let mut target_flags = toolchain.target_flags();
    target_flags.push(own_flags);
    let (maker, id) = drive.map_or_else(Default::default, |drive| (drive.maker.word, drive.id.to_string()));
    let features = board.chip().name().to_owned() + if drive.is_some() { DRIVE_FEATURE } else { "" };
    let environment: [(&str, &OsStr); 11] = [
        ("JOINT_DRIVE", maker.as_ref()),
        ("JOINT_DRIVE_ID", id.as_ref()),
        (TARGET_FLAGS, &target_flags),
        ("BOARD_FILE", board.file.as_os_str()),
        ("JOINT_FILE", truth.as_os_str()),
        ("JOINT_TOLD", told.as_os_str()),
        ("JOINT_TICK_RATE", rate.as_ref()),
        ("JOINT_BANDWIDTH", bandwidth.as_ref()),
        ("JOINT_PEAK_TORQUE", peak_torque.as_ref()),
        ("JOINT_MOTOR_ONLY", motor_only.as_ref()),
        ("JOINT_FORCED", forced.as_ref()),
    ];
    let images = toolchain.target_directory().join("images");
    let place = images.join(name);
    let elf = sources::up_to_date(
        toolchain,
        &images,
        &place,
        [truth, told, &board.file],
        &format!("{binary}{maker}{id}{}{control:?}{own_flags}", board.file.display()),
        || {
            compile(toolchain, FIRMWARE_PACKAGE, binary, &features, &environment, say)
                .map_err(|failure| size_failure(&failure, board).unwrap_or(failure))
        },
    )?;
    let (flash_bytes, ram_bytes) =
        sizes(&elf).map_err(|error| Failure::new(format!("{}: {error}", place.display())))?;
    Ok(Image {
        elf: place,
        sha256: sha256(&elf),
        flash_bytes,
        ram_bytes,
        compiler: toolchain.compiler().to_owned(),
        flags: format!(
            "profile {PROFILE} (opt-level 3, fat LTO{}), {}, board {}",
            own_flags,
            toolchain.flags(),
            board.name()
        ),
    })
}

/// Extracts the linker's one-line message about an image that is too large for the board.
fn size_failure(failure: &Failure, board: &Board) -> Option<Failure> {
    let line = failure.message().lines().find(|line| line.contains(TOO_LARGE))?;
    let what = line.rsplit("error: ").next().unwrap_or(line).trim();
    Some(Failure::new(what).with_help(format!(
        "use a role that needs less (`--role plant` is the smallest), or a board with more memory: `joint board check {}` \
         lists the memory of this one; {}",
        board.argument,
        board_file::OTHER_CHIPS
    )))
}

/// Path of a preset in the workspace's `joints` folder.
pub fn preset_file(name: &str) -> PathBuf {
    workspace().join("joints").join(format!("{name}.toml"))
}

/// File of a joint named on the command line, for the firmware's build: a path, or a preset by its `name`.
pub fn joint_file(file: &Path, name: &str) -> PathBuf {
    if file.is_file() { file.to_owned() } else { preset_file(name) }
}

/// Firmware binary of a role. The role `loop` has another name because `loop` is a keyword.
fn binary_name(role: Role) -> &'static str {
    match role {
        Role::Loop => "whole_loop",
        other => role_name(other),
    }
}

/// Returns whether a board has enough flash for the images of all roles.
pub fn has_room_for_all(board: &Board) -> bool {
    board.description.image_bytes() > LARGEST_IMAGE
}

/// File name from joint, board, role, and the tick rate unless it is the default. A digest of the path tells apart
/// files of one name in different folders.
fn file_name(joint_file: &Path, board: &Board, role: &str, tick_rate: u32) -> String {
    let joint = joint_file.file_stem().unwrap_or_default().to_string_lossy();
    let [joint_origin, board_origin] = [(joint_file, "joints"), (&board.file, "boards")].map(folder_suffix);
    let rate = if tick_rate == DEFAULT_TICK_RATE { String::new() } else { format!("-{tick_rate}hz") };
    format!("{joint}{joint_origin}-{}{board_origin}-{role}{rate}.elf", board.name())
}

/// Suffix that tells a file from others of its name; empty for files in a preset folder of the workspace.
fn folder_suffix((file, presets): (&Path, &str)) -> String {
    let presets = workspace().join(presets);
    let presets = presets.canonicalize().unwrap_or(presets);
    if file.parent() == Some(&presets) {
        return String::new();
    }
    let digest = Sha256::digest(file.as_os_str().as_encoded_bytes());
    format!("-{:02x}{:02x}", digest[0], digest[1])
}

/// Bytes in flash (loaded segments) and in RAM (all segments at RAM addresses).
fn sizes(elf: &[u8]) -> Result<(u64, u64), object::Error> {
    let file = object::File::parse(elf)?;
    let mut sizes = (0, 0);
    for segment in file.segments() {
        let loaded = segment.file_range().1;
        if segment.address() >= RAM_START {
            sizes.1 += segment.size();
            // Initial values of RAM also occupy flash.
            sizes.0 += loaded;
        } else if segment.address() >= FLASH_START {
            sizes.0 += loaded;
        }
    }
    Ok(sizes)
}

#[cfg(test)]
mod tests {
    use super::super::board::Chip;
    use super::*;

    fn name(path: &Path) -> String {
        file_name(path, &Board::emulated(), "plant", DEFAULT_TICK_RATE)
    }

    /// Joints, boards, rates and folders never share an image's file name.
    #[test]
    fn image_names_differ() {
        let preset = preset_file("q1");
        assert_eq!(name(&preset), "q1-olimex-h405-plant.elf");
        assert_ne!(name(&preset), name(&preset_file("s1")));
        assert_ne!(name(Path::new("/a/q1.toml")), name(Path::new("/b/q1.toml")));
        let nucleo = Board::load("nucleo-h743zi").unwrap();
        assert_eq!(file_name(&preset, &nucleo, "plant", 10_000), "q1-nucleo-h743zi-plant-10000hz.elf");
        let own = Board { file: "/mine/nucleo-h743zi.toml".into(), ..nucleo };
        assert_ne!(file_name(&preset, &own, "plant", 10_000), "q1-nucleo-h743zi-plant-10000hz.elf");
    }

    /// The default tick rate divides the core clock of every chip.
    #[test]
    fn default_tick_rate_divides_every_clock() {
        assert!(Chip::ALL.iter().all(|chip| chip.core_rate().is_multiple_of(DEFAULT_TICK_RATE)));
    }

    /// A board that cannot be a drive on CAN is refused with the reason, and no such board is offered.
    #[test]
    fn boards_without_drive_not_offered() {
        let name = "feather-f405";
        let board = Board::load(name).unwrap();
        let failure = no_drive(&board, board.description.can_line().expect_err(name));
        let help = failure.help().unwrap();
        assert!(failure.message().contains("no [can]"), "{failure}");
        assert!(help.contains("nucleo-g474re, nucleo-h743zi, odrive-3.6") && !help.contains(name), "{help}");
        assert!(help.contains("add [can]"), "{help}");
    }

    /// Only the linker's assertion about size becomes the message.
    #[test]
    fn oversized_image_message_is_one_line() {
        let board = Board::load("b-g431b-esc1").unwrap();
        let said = "building the firmware failed\n  = note: ld.lld: error: statics are too large for the board b-g431b-esc1: why\n";
        let failure = size_failure(&Failure::new(said), &board).unwrap();
        assert_eq!(failure.message(), "statics are too large for the board b-g431b-esc1: why");
        assert!(failure.help().unwrap().contains("--role plant"), "{failure}");
        assert!(size_failure(&Failure::new("no such crate"), &board).is_none());
    }

    /// A file that is no ELF file has no sizes.
    #[test]
    fn sizes_reject_non_elf() {
        assert!(sizes(b"no elf").is_err());
    }
}
