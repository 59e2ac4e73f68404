//! A number of study.toml: its key, the datasheet unit that the key ends with, the values that make
//! sense, and its slot in the random numbers of tolerances.
//!
//! A key is declared once, next to the physics it belongs to (`sensor`, `excitation`); `study`
//! reads, checks, draws and prints every key from that declaration. Not for keys that hold no
//! drawable number, such as `members` or `kind`.

/// Sign that a value may have.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sign {
    /// Any finite number.
    Any,
    /// Zero or a positive number.
    NotNegative,
    /// A positive number.
    Positive,
}

/// Declaration of one key.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Key {
    /// Counter word in the tolerance stream. It never changes and is never reused, so that the same
    /// seed keeps drawing the same sensors; a new key takes the next free slot.
    pub slot: usize,
    /// Section and key, "gyro.bias_deg_h".
    pub path: &'static str,
    /// Name in a sensor table.
    pub name: &'static str,
    /// Datasheet unit, "1" for none.
    pub unit: &'static str,
    /// SI value = datasheet value × factor.
    pub factor: f64,
    /// Sign that a value may have.
    pub sign: Sign,
    /// Value of a study that leaves the key out, in its unit: 0 where it then does nothing.
    pub absent: f64,
    /// Says whether it is a one-sided noise density n, whose factor holds N = n/√2; else it is the
    /// coefficient itself.
    pub one_sided: bool,
}

/// Slots that there may be.
pub const SLOTS: usize = 112;

impl Key {
    /// Declares a key; a slot beyond `SLOTS` does not compile in a constant.
    pub const fn new(
        slot: usize,
        path: &'static str,
        name: &'static str,
        unit: &'static str,
        factor: f64,
        sign: Sign,
    ) -> Self {
        assert!(slot < SLOTS);
        Self { slot, path, name, unit, factor, sign, absent: 0.0, one_sided: false }
    }

    /// The same key, which is worth this where a study leaves it out.
    pub const fn or(mut self, absent: f64) -> Self {
        self.absent = absent;
        self
    }

    /// The same key, declared as a one-sided noise density.
    pub const fn one_sided(mut self) -> Self {
        self.one_sided = true;
        self
    }

    /// Its section: "gyro" of "gyro.bias_deg_h".
    pub fn section(&self) -> &'static str {
        self.path.split_once('.').map_or("", |(section, _)| section)
    }

    /// Its name within the section: "bias_deg_h" of "gyro.bias_deg_h".
    pub fn key(&self) -> &'static str {
        self.path.split_once('.').map_or(self.path, |(_, key)| key)
    }

    /// Returns whether the value is cut at zero when it is drawn.
    pub fn is_cut_at_zero(&self) -> bool {
        self.sign != Sign::Any
    }
}
