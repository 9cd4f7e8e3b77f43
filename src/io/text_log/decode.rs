//! Bytes to text.

/// The text of bytes in UTF-8, UTF-16 or Windows' Latin alphabet, without byte order mark, and whether they
/// are UTF-8. UTF-16 without a mark shows by its zeros: letters and digits have one in every other byte.
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
            Err(_) => (bytes.iter().map(|b| char::from(*b)).collect(), false),
        }
    };
    (text.trim_start_matches('\u{feff}').to_string(), is_utf8)
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
        // a letter of two bytes that was cut
        assert!(decoded(&"t;µ".as_bytes()[..3]).1);
    }
}
