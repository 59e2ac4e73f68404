//! Numbers as files hold them: their width, their kind and the order of their bytes.

use super::clock::stamp::Stamp;

/// Kind of a number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Whole, with a sign.
    Signed,
    /// Unsigned integer.
    Unsigned,
    /// Binary floating point.
    Float,
}

/// States how one number is stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Element {
    /// Integer or floating point.
    pub kind: Kind,
    /// 1, 2, 4 or 8.
    pub bytes: usize,
    /// The highest byte comes first.
    pub big_endian: bool,
}

/// Whole numbers from here on have neighbours that double precision cannot tell apart.
const EXACT: u64 = 1 << 53;

impl Element {
    /// Lowest byte first.
    pub const fn little(kind: Kind, bytes: usize) -> Self {
        Self { kind, bytes, big_endian: false }
    }

    /// In words: "64-bit float".
    pub fn name(self) -> String {
        let kind = match self.kind {
            Kind::Signed => "integer",
            Kind::Unsigned => "unsigned integer",
            Kind::Float => "float",
        };
        format!("{}-bit {kind}", 8 * self.bytes)
    }

    /// The bits, in the low bytes; missing bytes are zero.
    fn bits(self, from: &[u8]) -> u64 {
        let mut all = [0; 8];
        let count = self.bytes.min(from.len()).min(8);
        all[..count].copy_from_slice(&from[..count]);
        if self.big_endian {
            all[..count].reverse();
        }
        u64::from_le_bytes(all)
    }

    /// The whole number with a sign; `None` for floats and what is beyond.
    fn whole(self, bits: u64) -> Option<i64> {
        let unused = 64 - 8 * self.bytes as u32;
        match self.kind {
            Kind::Signed => Some(((bits << unused) as i64) >> unused),
            Kind::Unsigned => i64::try_from(bits).ok(),
            Kind::Float => None,
        }
    }

    fn float(self, bits: u64) -> f64 {
        match self.bytes {
            8 => f64::from_bits(bits),
            4 => f64::from(f32::from_bits(bits as u32)),
            _ => half(bits as u16),
        }
    }

    /// The number as a double.
    pub fn value(self, from: &[u8]) -> f64 {
        let bits = self.bits(from);
        match self.kind {
            Kind::Float => self.float(bits),
            Kind::Unsigned => bits as f64,
            Kind::Signed => self.whole(bits).unwrap_or_default() as f64,
        }
    }

    /// The number as a time stamp, exact where it is whole.
    pub fn stamp(self, from: &[u8]) -> Stamp {
        let bits = self.bits(from);
        match self.kind {
            Kind::Float => Stamp::of_float(self.float(bits)),
            _ => self.whole(bits).map_or(Stamp::MISSING, Stamp::of_integer),
        }
    }

    /// Returns whether the number is a whole one that a double had to round.
    pub fn is_rounded(self, from: &[u8]) -> bool {
        if self.bytes < 8 || self.kind == Kind::Float {
            return false;
        }
        let bits = self.bits(from);
        let size = if self.kind == Kind::Signed { (bits as i64).unsigned_abs() } else { bits };
        size > EXACT && (size as f64) as u128 != u128::from(size)
    }

    /// Appends all numbers of `from`.
    pub fn decode(self, from: &[u8], into: &mut Vec<f64>) {
        match self {
            Self { kind: Kind::Float, bytes: 8, big_endian: false } => {
                into.extend(from.chunks_exact(8).map(|c| f64::from_le_bytes(c.try_into().unwrap_or_default())));
            }
            Self { kind: Kind::Float, bytes: 4, big_endian: false } => into
                .extend(from.chunks_exact(4).map(|c| f64::from(f32::from_le_bytes(c.try_into().unwrap_or_default())))),
            _ => into.extend(from.chunks_exact(self.bytes).map(|c| self.value(c))),
        }
    }
}

fn half(bits: u16) -> f64 {
    let (sign, exponent, fraction) = (bits >> 15, (bits >> 10) & 31, f64::from(bits & 1023));
    let size = match exponent {
        0 => fraction * 2f64.powi(-24),
        31 if fraction == 0.0 => f64::INFINITY,
        31 => f64::NAN,
        e => (1.0 + fraction / 1024.0) * 2f64.powi(i32::from(e) - 15),
    };
    if sign == 1 { -size } else { size }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_read_in_both_orders_of_bytes() {
        let signed = Element::little(Kind::Signed, 4);
        assert_eq!(signed.value(&(-7i32).to_le_bytes()), -7.0);
        assert_eq!(Element { big_endian: true, ..signed }.value(&(-7i32).to_be_bytes()), -7.0);
        assert_eq!(Element::little(Kind::Unsigned, 1).value(&[200]), 200.0);
        // IEEE 754-2019, binary16: 0x3c00 is 1, 0xc000 is -2, 0x0001 is 2^-24, 0x7bff is 65504.
        let halves = [0x3c00u16, 0xc000, 1, 0x7bff].map(|b| Element::little(Kind::Float, 2).value(&b.to_le_bytes()));
        assert_eq!(halves, [1.0, -2.0, 2f64.powi(-24), 65504.0]);
    }

    #[test]
    fn whole_numbers_beyond_double_precision_are_known_and_stamps_of_them_exact() {
        let unsigned = Element::little(Kind::Unsigned, 8);
        let odd = (1u64 << 53) + 1;
        assert!(unsigned.is_rounded(&odd.to_le_bytes()) && !unsigned.is_rounded(&(odd - 1).to_le_bytes()));
        let stamps = [odd, odd + 1].map(|n| unsigned.stamp(&n.to_le_bytes()));
        assert_eq!(stamps[1].since(&stamps[0]), 1.0);
        assert!(unsigned.stamp(&u64::MAX.to_le_bytes()).is_missing());
    }
}
