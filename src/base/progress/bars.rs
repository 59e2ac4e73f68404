//! Bars drawn by indicatif; where stderr is not a terminal, a line now and then (`lines`).

use std::io::{IsTerminal as _, Write as _};

use indicatif::{HumanDuration, MultiProgress, ProgressBar, ProgressDrawTarget, ProgressState, ProgressStyle};

use super::lines::Lines;
use crate::control::{Stage, Watcher};
use crate::escape;
use crate::signal::{self, Signal};

/// Stages are bars on stderr, and signals stop.
pub(crate) struct Terminal {
    bars: MultiProgress,
    /// What a pipe gets in their place.
    lines: Option<Lines>,
}

impl Terminal {
    pub(crate) fn new() -> Self {
        let bars = MultiProgress::with_draw_target(ProgressDrawTarget::stderr_with_hz(8));
        Self { bars, lines: (!std::io::stderr().is_terminal()).then(Lines::default) }
    }
}

impl Watcher for Terminal {
    fn stopped_by(&self) -> Option<&'static str> {
        signal::stopped_by().map(Signal::name)
    }

    fn begin(&self, name: &str, length: u64) -> Box<dyn Stage> {
        if let Some(lines) = &self.lines {
            return lines.begin(name, length);
        }
        let bar = self.bars.add(ProgressBar::new(length).with_style(style(length)).with_message(name.to_owned()));
        Box::new(Bar(bar))
    }

    fn remark(&self, sentence: &str) {
        self.bars.suspend(|| {
            // Where nobody can be told, the report still says it.
            let _ = writeln!(std::io::stderr(), "{}", escape::terminal(sentence));
        });
    }
}

/// Name, percentage and time left; of length 0, where nobody knows how long it takes, the name
/// alone.
fn style(length: u64) -> ProgressStyle {
    let template = if length == 0 { "{msg} …" } else { "{msg:18} {bar:32} {percent:>3} %  {left}" };
    let style = ProgressStyle::with_template(template).unwrap_or_else(|_| ProgressStyle::default_bar());
    style.with_key("left", |state: &ProgressState, out: &mut dyn std::fmt::Write| {
        // Before the first step is done, nothing is known.
        if state.pos() > 0 {
            let _ = write!(out, "{:#} left", HumanDuration(state.eta()));
        }
    })
}

struct Bar(ProgressBar);

impl Stage for Bar {
    fn set(&self, steps: u64) {
        self.0.set_position(steps);
    }

    fn add(&self, steps: u64) {
        self.0.inc(steps);
    }

    fn rename(&self, name: &str) {
        self.0.set_message(name.to_owned());
    }
}

impl Drop for Bar {
    fn drop(&mut self) {
        self.0.finish_and_clear();
    }
}
