//! Bytes to text.

/// Letters of the bytes from 0x80 on in the alphabets of Windows for Central Europe (1250) and for Cyrillic (1251).
const CENTRAL: &str = "€\u{fffd}\u{201a}\u{fffd}\u{201e}\u{2026}\u{2020}\u{2021}\u{fffd}\u{2030}Š\u{2039}ŚŤŽŹ\u{fffd}\u{2018}\u{2019}\u{201c}\u{201d}\u{2022}\u{2013}\u{2014}\u{fffd}™š\u{203a}śťžź\
     \u{a0}ˇ˘Ł¤Ą¦§¨©Ş«¬\u{ad}®Ż°±˛ł´µ¶·¸ąş»Ľ˝ľż\
     ŔÁÂĂÄĹĆÇČÉĘËĚÍÎĎĐŃŇÓÔŐÖ×ŘŮÚŰÜÝŢß\
     ŕáâăäĺćçčéęëěíîďđńňóôőö÷řůúűüýţ˙";
const CYRILLIC: &str = "ЂЃ\u{201a}ѓ\u{201e}\u{2026}\u{2020}\u{2021}€\u{2030}Љ\u{2039}ЊЌЋЏђ\u{2018}\u{2019}\u{201c}\u{201d}\u{2022}\u{2013}\u{2014}\u{fffd}™љ\u{203a}њќћџ\
     \u{a0}ЎўЈ¤Ґ¦§Ё©Є«¬\u{ad}®Ї°±Ііґµ¶·ё№є»јЅѕї\
     АБВГДЕЖЗИЙКЛМНОПРСТУФХЦЧШЩЪЫЬЭЮЯ\
     абвгдежзийклмнопрстуфхцчшщъыьэюя";
/// Bytes in a row that are letters of the Cyrillic alphabet; accented Latin letters do not follow one another.
const WORD: usize = 4;
/// Bytes that are letters of Central Europe (ł, ą, ż, ź), and signs elsewhere.
const SIGNS: [u8; 4] = [0xb3, 0xb9, 0xbf, 0x9f];
/// The end of Polish words, `ść`.
const ENDING: [u8; 2] = [0x9c, 0xe6];

/// The text of bytes of one letter each: of the Latin alphabet, unless words show another.
fn of_windows(bytes: &[u8]) -> String {
    let is_cyrillic = bytes.windows(WORD).any(|w| w.iter().all(|b| *b >= 0xc0));
    let is_within = |w: &[u8]| {
        w[0].is_ascii_alphabetic() && SIGNS.contains(&w[1]) && w[2].is_ascii_alphabetic()
    };
    let is_central = || bytes.windows(3).any(is_within) || bytes.windows(2).any(|w| w == ENDING);
    let letters = if is_cyrillic {
        CYRILLIC
    } else if is_central() {
        CENTRAL
    } else {
        return bytes.iter().map(|b| char::from(*b)).collect();
    };
    let letters: Vec<char> = letters.chars().collect();
    let letter = |b: &u8| match b.checked_sub(0x80) {
        Some(place) => letters[usize::from(place)],
        None => char::from(*b),
    };
    bytes.iter().map(letter).collect()
}

/// The text of bytes in UTF-8, UTF-16 or an alphabet of Windows, without byte order mark, and whether they
/// are UTF-8 with lines as other systems end them. UTF-16 without a mark shows by its zeros: letters and digits have one in every other byte.
pub(super) fn decoded(bytes: &[u8]) -> (String, bool) {
    let start = &bytes[..bytes.len().min(256)];
    let zeros = |odd: usize| start.iter().skip(odd).step_by(2).filter(|b| **b == 0).count();
    let (even, odd, half) = (zeros(0), zeros(1), start.len() / 2);
    let wide = |read: fn([u8; 2]) -> u16| {
        let units: Vec<u16> = bytes.chunks_exact(2).map(|b| read([b[0], b[1]])).collect();
        String::from_utf16_lossy(&units)
    };
    let (text, is_utf8) = if bytes.starts_with(&[0xff, 0xfe]) || 2 * odd > half && even == 0 {
        (wide(u16::from_le_bytes), false)
    } else if bytes.starts_with(&[0xfe, 0xff]) || 2 * even > half && odd == 0 {
        (wide(u16::from_be_bytes), false)
    } else {
        // where the bytes were cut a letter may be
        match str::from_utf8(bytes) {
            Ok(text) => (text.to_string(), true),
            Err(e) if e.error_len().is_none() => {
                (String::from_utf8_lossy(bytes).into_owned(), true)
            }
            Err(_) => (of_windows(bytes), false),
        }
    };
    let text = text.trim_start_matches('\u{feff}');
    // Excel of macOS
    if text.contains('\r') && !text.contains('\n') {
        return (text.replace('\r', "\n"), false);
    }
    (text.to_string(), is_utf8)
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
        assert_eq!(decoded(b"t;w [\xb0/s]"), ("t;w [°/s]".into(), false));
        assert_eq!(decoded(b"pr\xb9d P;napi\xeacie").0, "prąd P;napięcie");
        assert_eq!(decoded(b"pr\xeadko\x9c\xe6 L").0, "prędkość L");
        assert_eq!(decoded(b"\xf2\xee\xea;\xf1\xea\xee\xf0\xee\xf1\xf2\xfc").0, "ток;скорость");
        // lines of Excel on macOS
        assert_eq!(decoded(b"t;w\r0;1\r"), ("t;w\n0;1\n".into(), false));
        // a letter of two bytes that was cut
        assert!(decoded(&"t;µ".as_bytes()[..3]).1);
    }
}
