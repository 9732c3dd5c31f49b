//! Reads TensorBoard's event files, by what is published of their form.

/// The data of every record, after checking its length and both checksums.
pub fn records(mut file: &[u8]) -> Vec<Vec<u8>> {
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

/// A picture of an event file.
#[derive(Debug)]
pub struct EventImage {
    pub tag: String,
    pub step: u64,
    /// Width and height, pixels, as the event says.
    pub size: [u64; 2],
    pub file: Vec<u8>,
}

/// All pictures of an event file.
pub fn images(file: &[u8]) -> Vec<EventImage> {
    let image = |event: Vec<u8>| {
        let value = message(message(&event, 5)?, 1)?;
        let image = message(value, 4)?;
        assert_eq!(number(image, 3), Some(3), "RGB");
        Some(EventImage {
            tag: String::from_utf8(message(value, 1)?.to_vec()).unwrap(),
            step: number(&event, 2)?,
            size: [number(image, 2)?, number(image, 1)?],
            file: message(image, 4)?.to_vec(),
        })
    };
    records(file).into_iter().filter_map(image).collect()
}

/// What a field of a protobuf message holds.
enum Field<'a> {
    Number(u64),
    Bytes(&'a [u8]),
}

fn field(mut message: &[u8], wanted: u64) -> Option<Field<'_>> {
    while !message.is_empty() {
        let key = varint(&mut message);
        let value = match key & 7 {
            0 => Field::Number(varint(&mut message)),
            1 => Field::Bytes(take(&mut message, 8)),
            2 => {
                let length = varint(&mut message) as usize;
                Field::Bytes(take(&mut message, length))
            }
            5 => Field::Bytes(take(&mut message, 4)),
            kind => panic!("wire type {kind}"),
        };
        if key >> 3 == wanted {
            return Some(value);
        }
    }
    None
}

fn message(of: &[u8], wanted: u64) -> Option<&[u8]> {
    match field(of, wanted)? {
        Field::Bytes(bytes) => Some(bytes),
        Field::Number(_) => None,
    }
}

fn number(of: &[u8], wanted: u64) -> Option<u64> {
    match field(of, wanted)? {
        Field::Number(number) => Some(number),
        Field::Bytes(_) => None,
    }
}

fn varint(message: &mut &[u8]) -> u64 {
    let (mut value, mut shift) = (0, 0);
    loop {
        let byte = take(message, 1)[0];
        value |= u64::from(byte & 0x7f) << shift;
        shift += 7;
        if byte < 0x80 {
            return value;
        }
    }
}

fn take<'a>(message: &mut &'a [u8], length: usize) -> &'a [u8] {
    let (taken, rest) = message.split_at(length);
    *message = rest;
    taken
}
