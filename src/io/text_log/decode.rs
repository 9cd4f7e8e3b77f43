//! Bytes to text.

use chardetng::{EncodingDetector, Iso2022JpDetection, Utf8Detection};
use encoding_rs::{
    Encoding, ISO_8859_2, UTF_8, UTF_16BE, UTF_16LE, WINDOWS_1250, WINDOWS_1252, WINDOWS_1254,
};

use crate::io::{side, words};

/// Number of bytes from which the encoding is determined: the same for the beginning of a file and for all of it.
const SEEN: usize = 1 << 16;
/// Number of bytes whose zeros show UTF-16 without a byte order mark.
const ZEROS: usize = 256;

/// The encoding of bytes. A byte order mark states it; UTF-16 without one shows by its zeros, since letters and digits
/// have one in every other byte. Bytes that are not UTF-8 are in an encoding of Windows or of East Asia: the one in
/// which they are words (chardetng, the detector of Firefox).
fn encoding(bytes: &[u8]) -> &'static Encoding {
    if let Some((encoding, _)) = Encoding::for_bom(bytes) {
        return encoding;
    }
    let start = &bytes[..bytes.len().min(ZEROS)];
    let zeros = |odd: usize| start.iter().skip(odd).step_by(2).filter(|b| **b == 0).count();
    let (even, odd, half) = (zeros(0), zeros(1), start.len() / 2);
    if 2 * odd > half && even == 0 {
        return UTF_16LE;
    } else if 2 * even > half && odd == 0 {
        return UTF_16BE;
    }
    // where the bytes were cut a letter may be
    if str::from_utf8(bytes).map_or_else(|e| e.error_len().is_none(), |_| true) {
        return UTF_8;
    }
    let seen = &bytes[..bytes.len().min(SEEN)];
    let mut detector = EncodingDetector::new(Iso2022JpDetection::Deny);
    detector.feed(seen, true);
    match detector.guess(None, Utf8Detection::Deny) {
        // the two differ in a few letters, and logs with µ and ą are of Windows
        found if found == ISO_8859_2 && letters(WINDOWS_1250, seen) >= letters(found, seen) => {
            WINDOWS_1250
        }
        // the two differ in six letters, Turkish in one and Icelandic in the other
        found if found == WINDOWS_1252 && sides(WINDOWS_1254, seen) > sides(found, seen) => {
            WINDOWS_1254
        }
        found => found,
    }
}

/// Number of letters that bytes are in an encoding.
fn letters(encoding: &'static Encoding, bytes: &[u8]) -> usize {
    encoding.decode_without_bom_handling(bytes).0.chars().filter(|c| c.is_alphabetic()).count()
}

/// Number of words for the sides of a robot in the first line of bytes in an encoding.
fn sides(encoding: &'static Encoding, bytes: &[u8]) -> usize {
    let first = bytes.split(|b| *b == b'\n').next().unwrap_or_default();
    let text = encoding.decode_without_bom_handling(first).0;
    words(&text).iter().filter(|word| side(word).is_some()).count()
}

/// The text of bytes in any encoding, without byte order mark, and whether they are UTF-8 with lines as other systems
/// end them.
pub(super) fn decoded(bytes: &[u8]) -> (String, bool) {
    let encoding = encoding(bytes);
    let (text, _) = encoding.decode_with_bom_removal(bytes);
    // Excel of macOS
    if text.contains('\r') && !text.contains('\n') {
        return (text.replace('\r', "\n"), false);
    }
    (text.into_owned(), encoding == UTF_8)
}

/// The name of the encoding of bytes that are not UTF-8.
pub(super) fn foreign(bytes: &[u8]) -> Option<&'static str> {
    let found = encoding(bytes);
    (found != UTF_8).then(|| found.name())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_of_every_encoding_are_the_same() {
        let text = "t;ω [°/s]\n0;µ";
        let wide = |order: fn(u16) -> [u8; 2]| -> Vec<u8> {
            text.encode_utf16().flat_map(order).collect()
        };
        let marked = |mark: [u8; 2], bytes: Vec<u8>| [&mark[..], &bytes].concat();
        for bytes in [
            marked([0xff, 0xfe], wide(u16::to_le_bytes)),
            marked([0xfe, 0xff], wide(u16::to_be_bytes)),
            wide(u16::to_le_bytes),
            wide(u16::to_be_bytes),
        ] {
            assert_eq!(decoded(&bytes), (text.to_string(), false));
        }
        assert_eq!(decoded("\u{feff}t;µ".as_bytes()), ("t;µ".into(), true));
        // Windows: one byte a letter
        assert_eq!(decoded(b"t [\xb5s];w [\xb0/s]").0, "t [µs];w [°/s]");
        assert_eq!(decoded(b"t;w [\xb0/s]"), ("t;w [°/s]".into(), false));
        assert_eq!(decoded(b"pr\xb9d P;napi\xeacie").0, "prąd P;napięcie");
        assert_eq!(decoded(b"pr\xeadko\x9c\xe6 L").0, "prędkość L");
        assert_eq!(decoded(b"\xf2\xee\xea;\xf1\xea\xee\xf0\xee\xf1\xf2\xfc").0, "ток;скорость");
        assert_eq!(decoded(b"Sa\xf0 h\xfdz;Sol h\xfdz").0, "Sağ hız;Sol hız");
        // East Asia: two bytes a letter
        let east = |encoding: &'static Encoding, text: &str| {
            let (bytes, ..) = encoding.encode(text);
            assert_eq!(decoded(&bytes), (text.to_string(), false), "{}", encoding.name());
            assert_eq!(foreign(&bytes), Some(encoding.name()));
        };
        east(encoding_rs::GBK, "时间(ms),左轮转速(rpm),右轮转速(rpm),左电机电流(mA)\n0,1,2,3");
        east(encoding_rs::EUC_KR, "시간(ms),왼쪽속도(rpm),오른쪽속도(rpm)\n0,1,2");
        east(encoding_rs::SHIFT_JIS, "時間(ms),左車輪速度(rpm),右車輪速度(rpm)\n0,1,2");
        assert_eq!(foreign("t;µ".as_bytes()), None);
        // lines of Excel on macOS
        assert_eq!(decoded(b"t;w\r0;1\r"), ("t;w\n0;1\n".into(), false));
        // a letter of two bytes that was cut
        assert!(decoded(&"t;µ".as_bytes()[..3]).1);
    }
}
