//! Files written by hand from the rules of the format, each with one record whose description is false.

use super::*;

const LENGTH_MAX: u64 = u64::MAX;

fn record(opcode: u8, content: &[u8]) -> Vec<u8> {
    [&[opcode], &(content.len() as u64).to_le_bytes()[..], content].concat()
}

fn text(text: &str) -> Vec<u8> {
    [&(text.len() as u32).to_le_bytes(), text.as_bytes()].concat()
}

fn schema() -> Vec<u8> {
    record(op::SCHEMA, &[vec![1, 0], text("a/B"), text("ros2msg"), text("float64 a")].concat())
}

fn channel(topic: &str) -> Vec<u8> {
    record(op::CHANNEL, &[vec![1, 0, 1, 0], text(topic), text("cdr"), vec![0; 4]].concat())
}

fn message(data: &[u8]) -> Vec<u8> {
    record(op::MESSAGE, &[&[1, 0], &[0; 20][..], data].concat())
}

fn chunk(compression: &str, unpacked: u64, data: &[u8]) -> Vec<u8> {
    let head = [&[0; 16][..], &unpacked.to_le_bytes(), &[0; 4], &text(compression)].concat();
    record(op::CHUNK, &[&head, &(data.len() as u64).to_le_bytes()[..], data].concat())
}

/// File with these records between the mandatory ones.
fn file(records: &[&[u8]]) -> Vec<u8> {
    let head = record(op::HEADER, &[text(""), text("by hand")].concat());
    let end = [record(op::DATA_END, &[0; 4]), record(op::FOOTER, &[0; 20])].concat();
    [MAGIC, &head, &records.concat(), &end, MAGIC].concat()
}

/// Number of messages in a file, or the damage.
fn messages(file: &[u8]) -> Result<usize, String> {
    let mut count = 0;
    let read = read(file, &mut |_: &Message<'_>| {
        count += 1;
        Ok::<(), ()>(())
    });
    match read {
        Ok(()) => Ok(count),
        Err(ReadEnd::Damaged(why)) => Err(why),
        Err(ReadEnd::Callback(())) => Err("nobody has refused".to_owned()),
    }
}

#[track_caller]
fn damaged(file: &[u8], words: &str) {
    let why = messages(file).expect_err("damaged");
    assert!(why.contains(words), "`{words}` is not in: {why}");
}

/// Valid files are read, with and without chunks.
#[test]
fn valid_mcap_is_read() {
    let records = [schema(), channel("/a"), message(b"1"), message(b"2")];
    let plain: Vec<&[u8]> = records.iter().map(Vec::as_slice).collect();
    assert_eq!(messages(&file(&plain)), Ok(2));
    let content = records.concat();
    assert_eq!(messages(&file(&[&chunk("", content.len() as u64, &content)])), Ok(2));
    // Unused records may have any content of the stated length.
    assert_eq!(messages(&file(&[plain.concat().as_slice(), &record(op::ATTACHMENT, &[1; 7])])), Ok(2));
}

/// A text longer than its record is rejected before memory is reserved.
#[test]
fn text_length_is_checked_first() {
    let endless = [&[1, 0, 1, 0], &u32::MAX.to_le_bytes()[..], b"/a"].concat();
    for opcode in [op::CHANNEL, op::SCHEMA] {
        damaged(&file(&[&schema(), &record(opcode, &endless)]), "a text extends beyond its end");
    }
    let mut pairs = channel("/a");
    let end = pairs.len();
    pairs[end - 4..].copy_from_slice(&u32::MAX.to_le_bytes());
    damaged(&file(&[&schema(), &pairs]), "channel at byte");
    let mut compression = chunk("", 0, &[]);
    compression[RECORD_HEADER_SIZE + 28..RECORD_HEADER_SIZE + 32].copy_from_slice(&u32::MAX.to_le_bytes());
    damaged(&file(&[&compression]), "chunk at byte");
    damaged(&file(&[&schema(), &channel(&"a".repeat(2000))]), "the name of a topic has 2000 letters");
}

/// A record longer than the file is reported with its place.
#[test]
fn long_record_is_named_by_place() {
    for length in [LENGTH_MAX, LENGTH_MAX - 5, 1 << 45, 1000] {
        damaged(&file(&[&[op::MESSAGE], &length.to_le_bytes()]), "record at byte");
    }
}

/// An uncompressed chunk must end with its last record.
#[test]
fn plain_chunk_holds_whole_records() {
    let content = [schema(), channel("/a"), message(b"1")].concat();
    let size = content.len() as u64;
    damaged(&file(&[&chunk("", size + 1, &content)]), "but it has");
    // The last record would end behind the chunk.
    let short = &content[..content.len() - 1];
    damaged(&file(&[&chunk("", size - 1, short), &[0; 40]]), "a record extends beyond its end");
}

/// Chunks may unpack to a limited multiple of the file's size.
#[test]
fn unpacked_chunk_size_is_limited() {
    for compression in ["lz4", "zstd"] {
        damaged(&file(&[&chunk(compression, LENGTH_MAX, b"few bytes")]), "far more than a file of this size holds");
        damaged(&file(&[&chunk(compression, 1 << 19, b"few bytes")]), "chunk at byte");
    }
    // Two chunks share the limit.
    let half = chunk("", 0, &[]);
    let third = chunk("lz4", 2 * UNPACKED_BASE, b"");
    damaged(&file(&[&half, &third]), "far more");
}

/// A file cut at any byte is rejected; a changed byte never aborts the process.
#[test]
fn damaged_mcap_never_panics() {
    let content = [schema(), channel("/a"), message(b"1")].concat();
    let whole = file(&[&schema(), &channel("/a"), &message(b"0"), &chunk("", content.len() as u64, &content)]);
    assert_eq!(messages(&whole), Ok(2));
    for place in 0..whole.len() {
        assert!(messages(&whole[..place]).is_err(), "{place}");
        for bits in [0x01, 0x80, 0xff] {
            let mut changed = whole.clone();
            changed[place] ^= bits;
            // Not every change is harmful; none may abort the process.
            let _ = messages(&changed);
        }
    }
}
