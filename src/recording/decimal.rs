//! Plain decimal numbers as loggers print them, sixteen characters at a time and exact to the last
//! bit.
//!
//! Whatever is beyond (more digits, large powers, words) is left to the standard library: see
//! `format`.

/// Powers of ten that double precision holds exactly.
const TENS: [f64; 23] = [
    1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20,
    1e21, 1e22,
];
/// Most digits that are read here: their whole number fits into 64 bits.
const MOST_DIGITS: usize = 17;

/// Digits without their point.
#[derive(Debug, Clone, Copy)]
struct Mantissa {
    /// The digits as a whole number.
    whole: u64,
    /// States how many stand behind the point.
    decimals: usize,
    /// Bytes read.
    length: usize,
}

/// The number that bytes begin with, and its length: digits with at most one point, a sign and a
/// power of ten, where the digits are a whole number below 2⁵³ and the power is exact. Then one
/// multiplication or division rounds as it must (Clinger, *How to read floating point numbers
/// accurately*, 1990). `None` for anything else, which is for the library.
#[inline]
pub(super) fn leading_number(bytes: &[u8]) -> Option<(f64, usize)> {
    let sign = usize::from(bytes.first() == Some(&b'-'));
    let rest = &bytes[sign..];
    let Mantissa { whole, decimals, length } = match short(rest) {
        Some(found) => found,
        None => long(rest)?,
    };
    let (size, length) = match rest.get(length) {
        Some(b'e' | b'E') => powered(whole, decimals, rest, length)?,
        _ => (whole as f64 / TENS[decimals], length),
    };
    Some((if sign == 1 { -size } else { size }, sign + length))
}

/// At most fifteen digits and a point among sixteen bytes, which they do not fill.
#[inline]
fn short(bytes: &[u8]) -> Option<Mantissa> {
    let sixteen = u128::from_le_bytes(*bytes.first_chunk()?);
    let (mut low, mut high) = (sixteen as u64 ^ ZEROS, (sixteen >> 64) as u64 ^ ZEROS);
    let strange = u128::from(strangers(high)) << 64 | u128::from(strangers(low));
    let first = strange.trailing_zeros() as usize / 8;
    let point = first < 8 && bytes[first] == b'.';
    let length = if point { (strange & (strange - 1)).trailing_zeros() as usize / 8 } else { first };
    let count = length - usize::from(point);
    if count == 0 || length == 16 || bytes[length] == b'.' {
        return None;
    }
    if point {
        // What is behind the point takes its place.
        let before = (1u64 << (8 * first)) - 1;
        low = low & before | (low >> 8 | high << 56) & !before;
        high >>= 8;
    }
    // Digits move to the end, behind zeros.
    let digits = (u128::from(high) << 64 | u128::from(low)) << (8 * (16 - count));
    let whole = eight(digits as u64) * 100_000_000 + eight((digits >> 64) as u64);
    Some(Mantissa { whole, decimals: if point { length - first - 1 } else { 0 }, length })
}

/// The same of any length.
fn long(bytes: &[u8]) -> Option<Mantissa> {
    let (mut whole, mut count) = digits(bytes, 0);
    let (mut length, mut decimals) = (count, 0);
    if bytes.get(count) == Some(&b'.') {
        (whole, decimals) = digits(&bytes[count + 1..], whole);
        count += decimals;
        length += 1 + decimals;
    }
    (0 < count && count <= MOST_DIGITS && whole < 1 << 53).then_some(Mantissa { whole, decimals, length })
}

/// With the power of ten that begins at a place of `bytes`: the number, and where its power ends.
fn powered(whole: u64, decimals: usize, bytes: &[u8], at: usize) -> Option<(f64, usize)> {
    let negative = bytes.get(at + 1) == Some(&b'-');
    let from = at + 1 + usize::from(matches!(bytes.get(at + 1), Some(b'-' | b'+')));
    let (power, count) = digits(&bytes[from..], 0);
    if count == 0 || count > 3 {
        return None;
    }
    let power = if negative { -(power as i64) } else { power as i64 } - decimals as i64;
    let ten = TENS.get(power.unsigned_abs() as usize)?;
    Some((if power < 0 { whole as f64 / ten } else { whole as f64 * ten }, from + count))
}

/// `0` in every byte.
const ZEROS: u64 = 0x3030_3030_3030_3030;

/// The highest bit of every byte that is no digit less `0`; right up to the first byte beyond
/// ASCII.
#[inline]
fn strangers(digits: u64) -> u64 {
    (digits.wrapping_add(0x7676_7676_7676_7676) | digits) & 0x8080_8080_8080_8080
}

/// Eight digits, the highest in the lowest byte, as a number: pairs are joined, then fours, then
/// all.
#[inline]
fn eight(digits: u64) -> u64 {
    let pairs = (digits.wrapping_mul(10) + (digits >> 8)) & 0x00ff_00ff_00ff_00ff;
    let fours = (pairs.wrapping_mul(100) + (pairs >> 16)) & 0x0000_ffff_0000_ffff;
    (fours.wrapping_mul(10_000) + (fours >> 32)) & 0xffff_ffff
}

/// Digits that bytes begin with, behind those of `whole`: the number of all, and how many there are
/// here. Eight at a time; of more than [`MOST_DIGITS`] the number has lost its highest ones.
#[inline]
pub(super) fn digits(bytes: &[u8], mut whole: u64) -> (u64, usize) {
    const WHOLE_TENS: [u64; 9] = [1, 10, 100, 1000, 10_000, 100_000, 1_000_000, 10_000_000, 100_000_000];
    let mut taken = 0;
    while let Some(bytes) = bytes.get(taken..).and_then(|b| b.first_chunk()) {
        let values = u64::from_le_bytes(*bytes) ^ ZEROS;
        let count = strangers(values).trailing_zeros() as usize / 8;
        if count == 0 {
            return (whole, taken);
        }
        let found = eight(values << (8 * (8 - count)));
        whole = whole.wrapping_mul(WHOLE_TENS[count]).wrapping_add(found);
        taken += count;
        if count < 8 || taken > MOST_DIGITS {
            return (whole, taken);
        }
    }
    while let Some(digit) = bytes.get(taken).map(|b| b.wrapping_sub(b'0')).filter(|d| *d < 10) {
        whole = whole.wrapping_mul(10).wrapping_add(u64::from(digit));
        taken += 1;
    }
    (whole, taken)
}

/// Digits with at most one point: the whole units, what is behind the point as a whole number of so
/// many decimals, and the length. `None` where there is none, or more than 17 on either side.
#[inline]
pub(super) fn leading_parts(bytes: &[u8]) -> Option<(u64, u64, usize, usize)> {
    let (whole, front) = digits(bytes, 0);
    let (rest, decimals) = match bytes.get(front) {
        Some(b'.') => digits(&bytes[front + 1..], 0),
        _ => (0, 0),
    };
    let length = front + decimals + usize::from(bytes.get(front) == Some(&b'.'));
    (front + decimals > 0 && front.max(decimals) <= MOST_DIGITS).then_some((whole, rest, decimals, length))
}

/// Ten to a whole power up to 22.
#[inline]
pub(super) fn ten(power: usize) -> f64 {
    TENS[power]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Numbers as loggers write them, and as they do not; what the next cell begins with behind
    /// each.
    fn texts() -> impl Iterator<Item = String> {
        let mut state = 1u64;
        (0..200_000).map(move |i| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            let digits = format!("{}", state >> ((state >> 8) % 60));
            let at = (state >> 20) as usize % (digits.len() + 1);
            let sign = if i % 3 == 0 { "-" } else { "" };
            let power = match i % 5 {
                0 => format!("e{}", (state >> 40) as i64 % 30 - 15),
                1 => format!("E+{:02}", (state >> 40) % 25),
                _ => String::new(),
            };
            let point = if i % 7 == 0 { "" } else { "." };
            format!("{sign}{}{point}{}{power}", &digits[..at], &digits[at..])
        })
    }

    /// The standard library rounds correctly.
    fn agrees(text: &str, read: impl Fn(&[u8]) -> Option<(f64, usize)>) -> Option<bool> {
        let library = text.parse::<f64>().ok()?;
        let all = [",17.25,0.5,12345678\n", "\n", ""].map(|behind| {
            let bytes = format!("{text}{behind}");
            read(bytes.as_bytes()).map(|(value, length)| value.to_bits() == library.to_bits() && length == text.len())
        });
        assert!(all[0] == all[1] && all[0] == all[2], "{text}: what stands behind it matters: {all:?}");
        all[0]
    }

    #[test]
    fn numbers_are_rounded_as_the_library_rounds_them() {
        let (mut right, mut left) = (0, 0);
        for text in texts() {
            match agrees(&text, leading_number) {
                Some(is_right) => {
                    assert!(is_right, "{text}");
                    right += 1;
                }
                None => left += 1,
            }
        }
        assert!(right > 120_000 && left > 1000, "{right} read here, {left} left to the library");
        // Control: a number made by multiplying by a tenth, which no double is, is told from the
        // library's.
        let careless = |bytes: &[u8]| long(bytes).map(|m| (m.whole as f64 * 0.1f64.powi(m.decimals as i32), m.length));
        assert!(texts().any(|text| agrees(&text, careless) == Some(false)), "the comparison can fail");
    }

    #[test]
    fn what_is_no_plain_number_is_left_to_others() {
        let number = |text: &str| leading_number(text.as_bytes());
        assert_eq!([number("1.5"), number("5."), number(".5,")], [Some((1.5, 3)), Some((5.0, 2)), Some((0.5, 2))]);
        assert_eq!(number("-0.00801931,0.00067292,"), Some((-0.008_019_31, 11)));
        assert_eq!([number("1.25e-3"), number("25E2,")], [Some((1.25e-3, 7)), Some((2500.0, 4))]);
        for other in ["", ".", "-", "-.", "--1", "e5", "1e", "1e+", "1e99", "9007199254740993", "123456789012345678.5"]
        {
            assert_eq!(number(other), None, "{other}");
            assert_eq!(number(&format!("{other},1234567890123456")), None, "{other}");
        }
        // Only so far as it is one: the caller looks at what follows.
        assert_eq!([number("1.2.3"), number("12:30")], [Some((1.2, 3)), Some((12.0, 2))]);
    }

    #[test]
    fn a_stamp_of_nineteen_digits_is_left_to_others() {
        assert_eq!(leading_parts(b"1403715523.912143104,7"), Some((1_403_715_523, 912_143_104, 9, 20)));
        assert_eq!([leading_parts(b"12"), leading_parts(b".5")], [Some((12, 0, 0, 2)), Some((0, 5, 1, 2))]);
        assert_eq!(
            [leading_parts(b"."), leading_parts(b"-1"), leading_parts(b"1403715523912143104")],
            [None, None, None]
        );
    }
}
