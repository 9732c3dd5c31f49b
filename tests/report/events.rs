//! `events`: what TensorBoard reads.

use footwork::report::events::{self, EventWriter};
use std::fs;

/// The data of every record, after checking its length and both checksums.
fn records(mut file: &[u8]) -> Vec<Vec<u8>> {
    let mut records = Vec::new();
    while !file.is_empty() {
        let length = u64::from_le_bytes(file[..8].try_into().unwrap()) as usize;
        let (data, rest) = file[12..].split_at(length);
        assert_eq!(file[8..12], masked_crc(&file[..8]));
        assert_eq!(rest[..4], masked_crc(data));
        records.push(data.to_vec());
        file = &rest[4..];
    }
    records
}

/// CRC-32C bit by bit, from its definition.
fn masked_crc(data: &[u8]) -> [u8; 4] {
    let mut crc = u32::MAX;
    for &byte in data {
        crc ^= u32::from(byte);
        for _ in 0..8 {
            crc = (crc >> 1) ^ if crc & 1 == 1 { 0x82f6_3b78 } else { 0 };
        }
    }
    (!crc)
        .rotate_right(15)
        .wrapping_add(0xa282_ead8)
        .to_le_bytes()
}

#[test]
fn events_decode() {
    let folder = tempfile::tempdir().unwrap();
    let mut writer = EventWriter::create(folder.path(), 1.5).unwrap();
    writer.scalar("a/b", 300, 2.5, 0.25).unwrap();
    writer.flush().unwrap();
    let file = fs::read(folder.path().join(events::FILE_NAME)).unwrap();

    let mut version = vec![0x09];
    version.extend(1.5_f64.to_le_bytes());
    version.extend([0x1a, 13]);
    version.extend(b"brain.Event:2");
    let mut scalar = vec![0x09];
    scalar.extend(2.5_f64.to_le_bytes());
    scalar.extend([0x10, 0xac, 0x02, 0x2a, 12, 0x0a, 10, 0x0a, 3]);
    scalar.extend(b"a/b");
    scalar.push(0x15);
    scalar.extend(0.25_f32.to_le_bytes());
    assert_eq!(records(&file), [version, scalar]);
}

#[test]
fn events_refuse_what_is_no_folder() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("file");
    fs::write(&file, "").unwrap();
    assert!(EventWriter::create(&file, 0.0).is_err());
}
