//! Words of column names, and the words for the two sides.

/// A side of the robot.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WheelSide {
    /// The right side, in the direction of travel.
    Right,
    /// The left side, in the direction of travel.
    Left,
}

/// Words of the right side.
const RIGHT: &[&str] = &[
    "right",
    "r",
    "rt",
    "rhs",
    "rechts",
    "rechte",
    "rechter",
    "rechtes",
    "rechten",
    "droite",
    "droit",
    "derecha",
    "derecho",
    "destra",
    "destro",
    "direita",
    "direito",
    "prawy",
    "prawe",
    "prawa",
    "prawego",
    "prawej",
    "pravy",
    "prave",
    "prava",
    "praveho",
    "hoger",
    "hogra",
    "hojre",
    "hoyre",
    "oikea",
    "oikean",
    "dreapta",
    "derechas",
    "rw",
    "правый",
    "правое",
    "правая",
    "правого",
    "правой",
    "прав",
    "右",
    "오른쪽",
    "우측",
    "re",
    "der",
    "dx",
    "sag",
    "phai",
    "kanan",
    "jobb",
    "права",
    "праве",
    "правий",
    "правого",
    "дясно",
    "десно",
    "desno",
    "desni",
    "δεξια",
    "δεξιος",
    "يمين",
    "اليمين",
    "راست",
    "ימין",
];
/// Words of the left side.
const LEFT: &[&str] = &[
    "left",
    "l",
    "lt",
    "lhs",
    "links",
    "linke",
    "linker",
    "linkes",
    "linken",
    "gauche",
    "izquierda",
    "izquierdo",
    "sinistra",
    "sinistro",
    "esquerda",
    "esquerdo",
    "lewy",
    "lewe",
    "lewa",
    "lewego",
    "lewej",
    "levy",
    "leve",
    "leva",
    "leveho",
    "lavy",
    "lave",
    "lava",
    "laveho",
    "vanster",
    "vanstra",
    "venstre",
    "vasen",
    "vasemman",
    "stanga",
    "izquierdas",
    "lw",
    "левый",
    "левое",
    "левая",
    "левого",
    "левой",
    "лев",
    "左",
    "왼쪽",
    "좌측",
    "li",
    "izq",
    "sx",
    "sol",
    "trai",
    "kiri",
    "bal",
    "ліва",
    "ліве",
    "лівий",
    "лівого",
    "ляво",
    "лево",
    "lijevo",
    "levo",
    "levi",
    "αριστερα",
    "αριστερος",
    "يسار",
    "اليسار",
    "چپ",
    "שמאל",
];

/// Words of languages that are written without spaces.
const UNSPACED: &[&str] = &[
    "目标",
    "目標",
    "左",
    "右",
    "速度",
    "转速",
    "回転数",
    "电压",
    "電圧",
    "电流",
    "電流",
    "扭矩",
    "转矩",
    "トルク",
    "角度",
    "位置",
    "时间",
    "時間",
    "实际",
    "測定",
    "実",
    "指令",
    "轉速",
    "電壓",
    "轉矩",
    "왼쪽",
    "오른쪽",
    "좌측",
    "우측",
    "바퀴",
    "모터",
    "속도",
    "회전수",
    "전압",
    "전류",
    "토크",
    "각도",
    "위치",
    "시간",
    "목표",
];

/// The side named by a word.
#[must_use]
pub fn side(word: &str) -> Option<WheelSide> {
    if RIGHT.contains(&word) {
        Some(WheelSide::Right)
    } else if LEFT.contains(&word) {
        Some(WheelSide::Left)
    } else {
        None
    }
}

/// Whether a text is the word of a side, in any case: `(R)`, `(rechts)`.
#[must_use]
pub fn is_side(text: &str) -> bool {
    matches!(&words(text)[..], [word] if side(word).is_some())
}

/// The words of a name, in lower case and without accents: `/input/LeftVelocity[0]` has input, left, velocity
/// and 0.
#[must_use]
pub fn words(name: &str) -> Vec<String> {
    let mut out = vec![String::new()];
    let mut before = ' ';
    let letters: Vec<char> = name.chars().filter(|c| !is_accent(*c)).collect();
    let mut k = 0;
    while k < letters.len() {
        let c = letters[k];
        if let Some(word) = unspaced(&letters[k..]) {
            out.extend([word.to_string(), String::new()]);
            (k, before) = (k + word.chars().count(), ' ');
            continue;
        }
        let next = letters.get(k + 1).copied().unwrap_or(' ');
        let edge = !c.is_alphanumeric()
            || (before.is_lowercase() && c.is_uppercase())
            || (before.is_uppercase() && c.is_uppercase() && next.is_lowercase())
            || before.is_ascii_digit() != c.is_ascii_digit()
            || is_ideograph(before) != is_ideograph(c);
        if edge {
            out.push(String::new());
        }
        if let (true, Some(last)) = (c.is_alphanumeric(), out.last_mut()) {
            last.extend(c.to_lowercase().map(without_accent));
        }
        (k, before) = (k + 1, c);
    }
    out.retain(|word| !word.is_empty());
    out
}

/// The word of a language without spaces with which `letters` begins.
fn unspaced(letters: &[char]) -> Option<&'static str> {
    let begins = |word: &&str| {
        word.chars().count() <= letters.len() && word.chars().zip(letters).all(|(a, b)| a == *b)
    };
    UNSPACED.iter().copied().find(begins)
}

/// Whether a letter is one of Chinese or Japanese.
fn is_ideograph(c: char) -> bool {
    ('\u{2e80}'..='\u{9fff}').contains(&c)
}

/// A Latin letter without its accent.
fn without_accent(c: char) -> char {
    match c {
        'à' | 'á' | 'â' | 'ã' | 'ä' | 'å' | 'ą' | 'ă' | 'æ' => 'a',
        'ç' | 'ć' | 'č' => 'c',
        'ď' | 'đ' => 'd',
        'è' | 'é' | 'ê' | 'ë' | 'ę' | 'ě' => 'e',
        'ğ' => 'g',
        'ì' | 'í' | 'î' | 'ï' | 'ı' => 'i',
        'ł' | 'ľ' | 'ĺ' => 'l',
        'ñ' | 'ń' | 'ň' => 'n',
        'ò' | 'ó' | 'ô' | 'õ' | 'ö' | 'ø' | 'ő' => 'o',
        'ř' | 'ŕ' => 'r',
        'ś' | 'ş' | 'š' | 'ș' => 's',
        'ť' | 'ț' => 't',
        'ù' | 'ú' | 'û' | 'ü' | 'ů' | 'ű' => 'u',
        'ý' | 'ỳ' | 'ỷ' | 'ỹ' | 'ỵ' => 'y',
        // Vietnamese: letters with two accents
        'ạ' | 'ả' | 'ấ' | 'ầ' | 'ẩ' | 'ẫ' | 'ậ' | 'ắ' | 'ằ' | 'ẳ' | 'ẵ' | 'ặ' => {
            'a'
        }
        'ẹ' | 'ẻ' | 'ẽ' | 'ế' | 'ề' | 'ể' | 'ễ' | 'ệ' => 'e',
        'ỉ' | 'ị' => 'i',
        'ọ' | 'ỏ' | 'ố' | 'ồ' | 'ổ' | 'ỗ' | 'ộ' | 'ơ' | 'ớ' | 'ờ' | 'ở' | 'ỡ' | 'ợ' => {
            'o'
        }
        'ụ' | 'ủ' | 'ư' | 'ứ' | 'ừ' | 'ử' | 'ữ' | 'ự' => 'u',
        // Greek
        'ά' => 'α',
        'έ' => 'ε',
        'ή' => 'η',
        'ί' | 'ϊ' => 'ι',
        'ό' => 'ο',
        'ύ' | 'ϋ' => 'υ',
        'ώ' => 'ω',
        'ź' | 'ż' | 'ž' => 'z',
        _ => c,
    }
}

/// Whether a character is an accent of the letter before it, as file systems of macOS write them.
fn is_accent(c: char) -> bool {
    ('\u{300}'..='\u{36f}').contains(&c)
}

/// Whether two of the names differ only in their side: `rpm_l` and `rpm_r`, `encl` and `encr`.
pub(super) fn have_both_sides(names: &[&str]) -> bool {
    let names: Vec<Vec<String>> = names.iter().map(|name| words(name)).collect();
    names.iter().any(|left| names.iter().any(|right| are_sides(left, right)))
}

/// Whether words are those of the left and of the right side of one quantity.
fn are_sides(left: &[String], right: &[String]) -> bool {
    let mut differ = left.iter().zip(right).filter(|(a, b)| a != b);
    let one = differ.next().is_some_and(|(a, b)| {
        let glued = a.strip_suffix('l').is_some_and(|stem| b.strip_suffix('r') == Some(stem));
        glued || side(a) == Some(WheelSide::Left) && side(b) == Some(WheelSide::Right)
    });
    left.len() == right.len() && one && differ.next().is_none()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_parted_into_words_in_many_languages() {
        for (name, expected) in [
            ("/input/LeftVelocity[0]", &["input", "left", "velocity", "0"][..]),
            ("Vitesse roue gauche", &["vitesse", "roue", "gauche"]),
            ("左目標速度", &["左", "目標", "速度"]),
            ("左轮PWM", &["左", "轮", "pwm"]),
            ("prędkość_lewy", &["predkosc", "lewy"]),
            ("pre\u{328}dkos\u{301}c\u{301} lewego koła", &["predkosc", "lewego", "kola"]),
            ("Otáčky pravého kola", &["otacky", "praveho", "kola"]),
            ("ström vänster", &["strom", "vanster"]),
            ("ω right", &["ω", "right"]),
            ("Tốc độ phải", &["toc", "do", "phai"]),
            ("ταχύτητα δεξιά", &["ταχυτητα", "δεξια"]),
        ] {
            assert_eq!(words(name), expected, "{name}");
        }
    }

    #[test]
    fn names_that_differ_in_the_side_alone_are_those_of_both_wheels() {
        for names in [["rpm_l", "rpm_r"], ["encL", "encR"], ["wl", "wr"], ["vel_sx", "vel_dx"]] {
            assert!(have_both_sides(&names), "{names:?}");
        }
        for names in [["rpm_l", "pwm_r"], ["rpm", "pwm"], ["rpm_1", "rpm_2"]] {
            assert!(!have_both_sides(&names), "{names:?}");
        }
    }
}
