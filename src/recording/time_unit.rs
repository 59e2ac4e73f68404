//! Units of time, by the names that headings give them.

/// A unit of time.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TimeUnit {
    /// s.
    Second,
    /// ms.
    Millisecond,
    /// µs.
    Microsecond,
    /// ns.
    Nanosecond,
}

/// States how the unit is known.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Basis {
    /// The heading names it.
    Heading,
    /// Seconds, which nothing contradicts.
    Default,
    /// The rate given.
    Rate,
    /// In this unit the stamps are dates of our time.
    Epoch,
    /// In this unit the rate is one that sensors have.
    Magnitude,
}

/// Every unit, largest first.
pub(crate) const UNITS: [TimeUnit; 4] =
    [TimeUnit::Second, TimeUnit::Millisecond, TimeUnit::Microsecond, TimeUnit::Nanosecond];

impl TimeUnit {
    /// Returns it as people write it.
    pub fn name(self) -> &'static str {
        ["s", "ms", "µs", "ns"][self as usize]
    }

    /// Its length, s.
    pub fn seconds(self) -> f64 {
        [1.0, 1e-3, 1e-6, 1e-9][self as usize]
    }

    /// The unit that a heading names: `t_ns`, `timestamp [ns]`, `time (ms)`, `TimeUS`.
    pub fn of_heading(heading: &str) -> Option<Self> {
        let word = |text: &str| match text.to_lowercase().as_str() {
            "s" | "sec" | "secs" | "second" | "seconds" => Some(Self::Second),
            "ms" | "msec" | "msecs" | "milli" | "millis" | "millisecond" | "milliseconds" => Some(Self::Millisecond),
            "us" | "µs" | "μs" | "usec" | "usecs" | "micro" | "micros" | "microsecond" | "microseconds" => {
                Some(Self::Microsecond)
            }
            "ns" | "nsec" | "nsecs" | "nano" | "nanos" | "nanosec" | "nanosecond" | "nanoseconds" => {
                Some(Self::Nanosecond)
            }
            _ => None,
        };
        let words = heading.split(|c: char| !c.is_alphanumeric()).filter(|w| !w.is_empty());
        words.clone().filter_map(word).next_back().or_else(|| {
            // TimeUS, timeMs: the unit behind a small letter.
            let mut words = words;
            let last = words.next_back()?;
            let cut = last.char_indices().rev().nth(1)?.0;
            let (front, end) = last.split_at(cut);
            let capital = end.starts_with(|c: char| c.is_uppercase());
            (capital && front.ends_with(|c: char| c.is_lowercase())).then(|| word(end)).flatten()
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn headings_name_units() {
        for (heading, unit) in [
            ("t_s", Some(TimeUnit::Second)),
            ("Time [s]", Some(TimeUnit::Second)),
            ("timestamp [ns]", Some(TimeUnit::Nanosecond)),
            ("t_ms", Some(TimeUnit::Millisecond)),
            ("time (µs)", Some(TimeUnit::Microsecond)),
            ("TimeUS", Some(TimeUnit::Microsecond)),
            ("t", None),
            ("timestamp", None),
            ("%time", None),
            ("status", None),
        ] {
            assert_eq!(TimeUnit::of_heading(heading), unit, "{heading}");
        }
    }
}
