//! The processor time of a thread: what a verdict costs, whatever else the machine does meanwhile.

/// Processor time that this thread has used, s; where the system keeps no account of threads, the
/// time of a clock on the wall.
#[cfg(unix)]
pub(crate) fn thread_s() -> f64 {
    let mut time = libc::timespec { tv_sec: 0, tv_nsec: 0 };
    // SAFETY: `time` is a valid place for the answer, and the call keeps no reference to it.
    let failed = unsafe { libc::clock_gettime(libc::CLOCK_THREAD_CPUTIME_ID, &raw mut time) } != 0;
    if failed { wall_s() } else { time.tv_sec as f64 + 1e-9 * time.tv_nsec as f64 }
}

/// Time of a clock on the wall, s: this system keeps no account of threads.
#[cfg(not(unix))]
pub(crate) fn thread_s() -> f64 {
    wall_s()
}

fn wall_s() -> f64 {
    static BEGUN: std::sync::OnceLock<std::time::Instant> = std::sync::OnceLock::new();
    BEGUN.get_or_init(std::time::Instant::now).elapsed().as_secs_f64()
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;

    #[test]
    fn sleep_costs_nothing_and_work_does() {
        let begun = thread_s();
        std::thread::sleep(std::time::Duration::from_millis(200));
        assert!(thread_s() - begun < 0.1);
        let mut state = 1_u64;
        while thread_s() - begun < 0.12 {
            state = std::hint::black_box(state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1));
        }
        assert_ne!(state, 0);
    }
}
