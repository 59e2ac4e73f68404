//! Progress bars on stderr and the Ctrl-C flag: how a long run speaks and how it is stopped.

use std::fmt::Write;
use std::sync::atomic::{AtomicBool, Ordering};

use indicatif::{HumanDuration, ProgressBar, ProgressDrawTarget, ProgressState, ProgressStyle};

static STOP: AtomicBool = AtomicBool::new(false);

/// Makes Ctrl-C raise a flag instead of killing the process; a second Ctrl-C kills it.
pub fn listen_for_interrupt() {
    // Refused only when a handler exists already, which then does the stopping.
    let _ = ctrlc::set_handler(|| {
        if STOP.swap(true, Ordering::SeqCst) {
            std::process::exit(130);
        }
    });
}

/// Whether the user asked to stop. Long loops look at it at least every 100 ms.
pub fn interrupted() -> bool {
    STOP.load(Ordering::Relaxed)
}

/// A bar with a name, percentage and time left; of length 0, where nobody knows how long it takes, the name alone. Hidden
/// when stderr is not a terminal.
pub fn bar(name: &str, length: u64) -> ProgressBar {
    let bar = ProgressBar::with_draw_target(Some(length), ProgressDrawTarget::stderr_with_hz(8));
    let template = if length == 0 { "{msg} …" } else { "{msg:18} {bar:32} {percent:>3} %  {left}" };
    let style = ProgressStyle::with_template(template).unwrap_or_else(|_| ProgressStyle::default_bar());
    bar.set_style(style.with_key("left", |state: &ProgressState, out: &mut dyn Write| {
        // Before the first step is done, nothing is known.
        if state.pos() > 0 {
            let _ = write!(out, "{:#} left", HumanDuration(state.eta()));
        }
    }));
    bar.set_message(name.to_owned());
    bar
}
