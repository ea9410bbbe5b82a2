//! EDS file of the dictionary (CiA 306).

use super::dictionary::{Access, ENTRIES, Entry, GROUPS, Initial, Kind};
use std::fmt::Write;
use std::format;
use std::string::String;

const PATH: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/src/cia402/joint-drive.eds");

const HEAD: &str = "; Written by the test eds_file_is_the_dictionary of the crate drives; UPDATE_EDS=1 rewrites it.
[FileInfo]
FileName=joint-drive.eds
FileVersion=1
FileRevision=0
EDSVersion=4.0
Description=CiA 402 drive of a geared joint with two encoders

[DeviceInfo]
VendorName=
VendorNumber=0
ProductName=Geared joint drive
ProductNumber=1
RevisionNumber=0x00010000
BaudRate_10=0
BaudRate_20=0
BaudRate_50=0
BaudRate_125=1
BaudRate_250=1
BaudRate_500=1
BaudRate_800=0
BaudRate_1000=1
SimpleBootUpMaster=0
SimpleBootUpSlave=1
Granularity=8
DynamicChannelsSupported=0
GroupMessaging=0
NrOfRXPDO=4
NrOfTXPDO=4
LSS_Supported=0

[DummyUsage]
Dummy0001=0
Dummy0002=0
Dummy0003=0
Dummy0004=0
Dummy0005=0
Dummy0006=0
Dummy0007=0

[Comments]
Lines=0
";

/// Indices of the dictionary that a filter lets through.
fn indices(is_in: impl Fn(u16) -> bool) -> std::vec::Vec<u16> {
    let mut indices: std::vec::Vec<u16> =
        ENTRIES.iter().map(|entry| entry.address.index).filter(|index| is_in(*index)).collect();
    indices.dedup();
    indices
}

fn section(eds: &mut String, title: &str, indices: &[u16]) -> std::fmt::Result {
    writeln!(eds, "\n[{title}]\nSupportedObjects={}", indices.len())?;
    for (number, index) in indices.iter().enumerate() {
        writeln!(eds, "{}=0x{index:04X}", number + 1)?;
    }
    Ok(())
}

fn group(index: u16) -> Option<(String, bool)> {
    let pdo = |name: &str| Some((format!("{name} {}", (index & 3) + 1), false));
    match index {
        0x1400..=0x1403 => pdo("RPDO communication parameter"),
        0x1600..=0x1603 => pdo("RPDO mapping parameter"),
        0x1800..=0x1803 => pdo("TPDO communication parameter"),
        0x1A00..=0x1A03 => pdo("TPDO mapping parameter"),
        _ => GROUPS
            .iter()
            .find(|(group, ..)| *group == index)
            .map(|(_, name, is_array)| (String::from(*name), *is_array)),
    }
}

fn variable(eds: &mut String, entry: &Entry, is_sub: bool) -> std::fmt::Result {
    let (index, sub) = (entry.address.index, entry.address.sub);
    if is_sub {
        writeln!(eds, "\n[{index:04X}sub{sub:X}]")?;
    } else {
        writeln!(eds, "\n[{index:04X}]")?;
    }
    let name = if entry.name == "Mapped object" { format!("Mapped object {sub}") } else { String::from(entry.name) };
    let access = match entry.rules.access {
        Access::Constant => "const",
        Access::ReadOnly => "ro",
        Access::ReadWrite if entry.rules.is_mappable => "rww",
        Access::ReadWrite => "rw",
    };
    writeln!(eds, "ParameterName={name}\nObjectType=0x7\nDataType=0x{:04X}\nAccessType={access}", entry.kind.code())?;
    match entry.rules.initial {
        Initial::Number(number) if entry.kind == Kind::Unsigned32 => writeln!(eds, "DefaultValue=0x{number:X}")?,
        Initial::Number(number) => writeln!(eds, "DefaultValue={number}")?,
        Initial::PlusNode(base) => writeln!(eds, "DefaultValue=$NODEID+0x{base:X}")?,
        Initial::Text(text) => writeln!(eds, "DefaultValue={text}")?,
        Initial::Live => {}
    }
    if let Some((low, high)) = entry.rules.range {
        writeln!(eds, "LowLimit={low}\nHighLimit={high}")?;
    }
    writeln!(eds, "PDOMapping={}", u8::from(entry.rules.is_mappable))
}

fn generated() -> Result<String, std::fmt::Error> {
    let mut eds = String::from(HEAD);
    let is_mandatory = |index| matches!(index, 0x1000 | 0x1001 | 0x1018);
    let is_manufacturers = |index| (0x2000..0x6000).contains(&index);
    section(&mut eds, "MandatoryObjects", &indices(is_mandatory))?;
    section(&mut eds, "OptionalObjects", &indices(|index| !is_mandatory(index) && !is_manufacturers(index)))?;
    section(&mut eds, "ManufacturerObjects", &indices(is_manufacturers))?;
    for index in indices(|_| true) {
        let entries = || ENTRIES.iter().filter(|entry| entry.address.index == index);
        let name = group(index);
        if let Some((name, is_array)) = &name {
            let kind = if *is_array { 8 } else { 9 };
            writeln!(
                eds,
                "\n[{index:04X}]\nParameterName={name}\nObjectType=0x{kind}\nSubNumber={}",
                entries().count()
            )?;
        }
        entries().try_for_each(|entry| variable(&mut eds, entry, name.is_some()))?;
    }
    Ok(eds)
}

#[test]
fn eds_file_is_the_dictionary() {
    let generated = generated().unwrap();
    if std::env::var_os("UPDATE_EDS").is_some() {
        std::fs::write(PATH, &generated).unwrap();
    }
    let file = std::fs::read_to_string(PATH).unwrap();
    assert!(file == generated, "joint-drive.eds is not that of the dictionary: run this test with UPDATE_EDS=1");
}

#[test]
fn every_group_has_a_name() {
    for entry in ENTRIES.iter().filter(|entry| entry.address.sub > 0) {
        assert!(group(entry.address.index).is_some(), "{:?}", entry.address);
    }
    for (index, name, _) in GROUPS {
        assert!(ENTRIES.iter().any(|entry| entry.address.index == index), "{name}");
    }
}
