//! The batch after the one that a card works on, drawn meanwhile.

use std::ops::Range;
use std::sync::Arc;

use super::drawn::Drawn;
use crate::kernel::integrator::Integrator;
use crate::kernel::job::{Clock, Job, Member};

/// A batch that is drawn, and what its draws depend on.
pub(super) struct Ahead {
    draw: Arc<dyn Fn(u64) -> Member + Send + Sync>,
    clock: Clock,
    integrator: Integrator,
    of: u64,
    members: Range<u64>,
    drawn: Drawn,
}

impl Ahead {
    /// Draws the batch of the same size after this one, where there is one and this one is not
    /// stopped meanwhile. A member that cannot be stepped is an error when its turn comes.
    pub(super) fn after(job: &Job, members: &Range<u64>, stop: &(dyn Fn() -> bool + Sync)) -> Option<Self> {
        let size = members.end - members.start;
        let next = members.end..job.members.min(members.end.saturating_add(size));
        if next.is_empty() {
            return None;
        }
        let drawn = Drawn::of(job, next.clone(), stop).ok()?;
        let (draw, clock) = (job.draw.clone(), job.clock.clone());
        Some(Self { draw, clock, integrator: job.integrator, of: job.members, members: next, drawn })
    }

    /// The members, if they are these of this job.
    pub(super) fn taken(self, job: &Job, members: &Range<u64>) -> Option<Drawn> {
        let same_job = Arc::ptr_eq(&self.draw, &job.draw)
            && self.clock == job.clock
            && self.integrator == job.integrator
            && self.of == job.members;
        (same_job && self.members == *members).then_some(self.drawn)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sensor::Sensor;
    use crate::validation::jobs::{Sine, job};

    #[test]
    fn the_next_batch_is_drawn_for_its_own_job_alone_and_none_after_the_last() {
        let still = Sine { amplitude_m_s2: 0.0, frequency_hz: 0.0, offset_m_s2: 0.0 };
        let job = job(Sensor::default(), 1000, &[1.0], still, Integrator::Ideal);
        let ahead = || Ahead::after(&job, &(0..512), &|| false);
        assert!(ahead().is_some_and(|next| next.taken(&job, &(512..1000)).is_some()));
        assert!(ahead().is_some_and(|next| next.taken(&job, &(512..768)).is_none()));
        let mut longer = job.clone();
        longer.clock.samples += 1;
        assert!(ahead().is_some_and(|next| next.taken(&longer, &(512..1000)).is_none()));
        let drawn_otherwise =
            Job { draw: Arc::new(|_| Member { sensor: Sensor::default(), sine: None }), ..job.clone() };
        assert!(ahead().is_some_and(|next| next.taken(&drawn_otherwise, &(512..1000)).is_none()));
        assert!(Ahead::after(&job, &(512..1000), &|| false).is_none());
        assert!(Ahead::after(&job, &(0..512), &|| true).is_none());
    }
}
