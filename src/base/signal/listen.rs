//! Who hears the signals: a thread of this process (Unix), or a handler that the system calls.

use std::io::Write as _;
use std::time::{Duration, Instant};

use super::{Signal, is_kept, raise};

/// A second Ctrl-C this long after the first one was typed by someone who no longer wants to wait.
/// Terminals that close, `timeout` and batch systems send several signals within milliseconds, and
/// mean one.
const BY_HAND: Duration = Duration::from_secs(1);

/// A process that was asked to stop has this long to do so by itself, as its loops look at their
/// control. What takes longer (a file being opened, a library, one step of a search) is ended:
/// results are put into their places whole, so none is left in half.
const BY_ITSELF: Duration = Duration::from_millis(1500);
/// Between looks at whether a state is still being kept.
const LOOK: Duration = Duration::from_millis(50);

/// Ends the process by `exit`, unless it has ended by itself before, as soon as no state is kept.
fn end_soon(signal: Signal, exit: impl Fn(i32) + Send + 'static) {
    let wait = move || {
        std::thread::sleep(BY_ITSELF);
        while is_kept() {
            std::thread::sleep(LOOK);
        }
        // Where nobody can be told, the exit code still tells.
        let _ = writeln!(std::io::stderr(), "error: stopped by {}", signal.name());
        exit(i32::from(signal.exit_code()));
    };
    let _ = std::thread::Builder::new().name("end".into()).spawn(wait);
}

/// Counts the signals of one process.
#[derive(Debug, Default)]
struct Listener {
    first_interrupt: Option<Instant>,
    ends: bool,
}

impl Listener {
    /// Returns true for the first signal of all, after which the process is to end soon.
    fn is_first(&mut self) -> bool {
        !std::mem::replace(&mut self.ends, true)
    }

    /// Returns whether this signal must end the process at once, keeping nothing.
    fn kills(&mut self, signal: Signal, now: Instant) -> bool {
        if signal != Signal::Interrupt {
            return false;
        }
        now.duration_since(*self.first_interrupt.get_or_insert(now)) >= BY_HAND
    }
}

/// Makes SIGINT, SIGTERM and SIGHUP raise a flag that long loops look at, and end the process soon
/// after where they do not and no state is kept. Only a second Ctrl-C, a second or more after the
/// first, kills it at once.
#[cfg(unix)]
pub fn listen_for_interrupt() {
    use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
    // Refused only where the system has no room for a handler; signals then kill, as they do
    // without one.
    let Ok(mut signals) = signal_hook::iterator::Signals::new([SIGINT, SIGTERM, SIGHUP]) else { return };
    let listen = move || {
        let mut listener = Listener::default();
        for number in signals.forever() {
            let signal = match number {
                SIGINT => Signal::Interrupt,
                SIGTERM => Signal::Terminate,
                _ => Signal::HangUp,
            };
            raise(signal);
            if listener.is_first() {
                end_soon(signal, |code| signal_hook::low_level::exit(code));
            }
            if listener.kills(signal, Instant::now()) {
                signal_hook::low_level::exit(i32::from(signal.exit_code()));
            }
        }
    };
    let _ = std::thread::Builder::new().name("signals".into()).spawn(listen);
}

/// Makes Ctrl-C raise a flag instead of killing the process; a second one, a second or more later,
/// kills it.
#[cfg(not(unix))]
pub(crate) fn listen_for_interrupt() {
    let mut listener = Listener::default();
    // Refused only when a handler exists already, which then does the stopping.
    let _ = ctrlc::set_handler(move || {
        raise(Signal::Interrupt);
        if listener.is_first() {
            end_soon(Signal::Interrupt, |code| std::process::exit(code));
        }
        if listener.kills(Signal::Interrupt, Instant::now()) {
            std::process::exit(i32::from(Signal::Interrupt.exit_code()));
        }
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_a_second_ctrl_c_a_second_later_kills() {
        let (start, mut listener) = (Instant::now(), Listener::default());
        let mut kills = |signal, after_ms| listener.kills(signal, start + Duration::from_millis(after_ms));
        // A burst of any signals, and later ones that nobody types.
        assert!(!kills(Signal::Terminate, 0) && !kills(Signal::HangUp, 2) && !kills(Signal::Interrupt, 5));
        assert!(!kills(Signal::Interrupt, 900) && !kills(Signal::Terminate, 5000));
        assert!(kills(Signal::Interrupt, 1010));
    }

    #[test]
    fn the_end_waits_for_a_state_that_is_kept() {
        let (send, ended) = std::sync::mpsc::channel();
        let kept = super::super::Keeping::begin();
        end_soon(Signal::Terminate, move |code| send.send(code).expect("somebody waits"));
        assert!(ended.recv_timeout(BY_ITSELF + 10 * LOOK).is_err(), "it ended while a state was kept");
        drop(kept);
        assert_eq!(ended.recv_timeout(Duration::from_secs(10)), Ok(143));
    }
}
