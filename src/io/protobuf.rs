//! Messages of numbers in Protocol Buffers, with the schema that describes them.
//!
//! Source: Protocol Buffers documentation, "Encoding" and `descriptor.proto`.

/// A message of doubles, one field a name, numbered from 1 on.
pub(super) struct Doubles {
    fields: Vec<String>,
}

/// Package and name of the message, and the file that would declare it.
const PACKAGE: &str = "amigo_ident";
const MESSAGE: &str = "Motion";
const FILE: &str = "motion.proto";

/// Wire types.
const VARINT: u64 = 0;
const FIXED_64: u64 = 1;
const BYTES: u64 = 2;

/// `TYPE_DOUBLE` and `LABEL_OPTIONAL` of `descriptor.proto`.
const DOUBLE: u64 = 1;
const OPTIONAL: u64 = 1;

impl Doubles {
    /// Fields of these names; what a name of Protocol Buffers may not hold becomes `_`.
    pub(super) fn new<'a>(names: impl Iterator<Item = &'a str>) -> Self {
        let allowed = |c: char| if c.is_ascii_alphanumeric() { c } else { '_' };
        Self { fields: names.map(|name| name.chars().map(allowed).collect()).collect() }
    }

    /// Full name of the message.
    pub(super) fn name() -> String {
        format!("{PACKAGE}.{MESSAGE}")
    }

    /// The schema: a `FileDescriptorSet` of one file with one message.
    pub(super) fn schema(&self) -> Vec<u8> {
        let mut message = Vec::new();
        bytes(&mut message, 1, MESSAGE.as_bytes());
        for (n, name) in self.fields.iter().enumerate() {
            let mut field = Vec::new();
            bytes(&mut field, 1, name.as_bytes());
            number(&mut field, 3, n as u64 + 1);
            number(&mut field, 4, OPTIONAL);
            number(&mut field, 5, DOUBLE);
            bytes(&mut message, 2, &field);
        }
        let mut file = Vec::new();
        bytes(&mut file, 1, FILE.as_bytes());
        bytes(&mut file, 2, PACKAGE.as_bytes());
        bytes(&mut file, 4, &message);
        bytes(&mut file, 12, b"proto3");
        let mut set = Vec::new();
        bytes(&mut set, 1, &file);
        set
    }

    /// A message of these values, all of them written: a field that is left out reads as zero.
    pub(super) fn message(values: impl Iterator<Item = f64>) -> Vec<u8> {
        let mut out = Vec::new();
        for (n, value) in values.enumerate() {
            tag(&mut out, n as u64 + 1, FIXED_64);
            out.extend(value.to_le_bytes());
        }
        out
    }
}

fn varint(out: &mut Vec<u8>, mut value: u64) {
    while value >= 0x80 {
        out.push(value as u8 | 0x80);
        value >>= 7;
    }
    out.push(value as u8);
}

fn tag(out: &mut Vec<u8>, field: u64, wire_type: u64) {
    varint(out, field << 3 | wire_type);
}

fn number(out: &mut Vec<u8>, field: u64, value: u64) {
    tag(out, field, VARINT);
    varint(out, value);
}

fn bytes(out: &mut Vec<u8>, field: u64, content: &[u8]) {
    tag(out, field, BYTES);
    varint(out, content.len() as u64);
    out.extend_from_slice(content);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_schema_is_that_of_the_reference_implementation() {
        // google.protobuf 7.36 for Python: FileDescriptorSet(file=[fd]).SerializeToString()
        let reference = b"\nE\n\x0cmotion.proto\x12\x0bamigo_ident\" \n\x06Motion\x12\t\n\x01a\x18\x01 \x01(\x01\
            \x12\x0b\n\x03__b\x18\x02 \x01(\x01b\x06proto3";
        assert_eq!(Doubles::new(["a", "é b"].into_iter()).schema(), reference);
    }

    #[test]
    fn numbers_from_16_on_have_tags_of_two_bytes() {
        let message = Doubles::message((1..=16).map(f64::from));
        assert_eq!(message.len(), 15 * 9 + 10);
        // (16 << 3 | 1) = 129 = 0x81 0x01
        assert_eq!(&message[135..137], &[0x81, 0x01]);
        assert_eq!(&message[137..], 16.0_f64.to_le_bytes());
    }
}
