//! The laws of every channel of a recording, searched for; and once more below the frequency from
//! which on a filter takes the noise away, where the laws followed the filter.

use super::channel::{Channel, Curve};
use super::common::{self, Common};
use super::selection::{self, Selection, Surroundings};
use super::shape::Following;
use super::{agreement, corner, describe, rival_column, shared_lag};
use crate::control::{Control, Stopped};
use crate::model::Noise;
use crate::number::short;
use crate::parallel;

/// Channels with what surrounds them.
pub(super) struct Measured<'a> {
    pub(super) channels: Vec<Channel>,
    pub(super) environment: Vec<(String, Curve)>,
    pub(super) noise: Option<&'a Noise>,
}

/// Channels with what was selected for each.
pub(super) struct Searched<'a> {
    pub(super) measured: Measured<'a>,
    pub(super) selected: Vec<Selection>,
    pub(super) common: Option<Common>,
}

impl<'a> Measured<'a> {
    /// The same channels and columns at a sampling rate reduced by this factor.
    fn slowed(&self, slower: usize) -> Self {
        let channel = |of: &Channel| {
            let mut channel = corner::slowed_channel(of, slower);
            channel.promised = describe::promised(&channel, self.noise);
            channel
        };
        let column = |(name, curve): &(String, Curve)| (name.clone(), corner::slowed_curve(curve, slower));
        Self {
            channels: self.channels.iter().map(channel).collect(),
            environment: self.environment.iter().map(column).collect(),
            noise: self.noise,
        }
    }
}

impl<'a> Searched<'a> {
    /// Searches.
    ///
    /// # Errors
    /// Stopped.
    pub(super) fn of(measured: Measured<'a>, control: &Control) -> Result<Self, Stopped> {
        let Measured { channels, environment, .. } = &measured;
        let work = control.stage("searching the laws of each channel", channels.len() as u64);
        let followed = shared_lag::find(channels, environment, control)?;
        let select = |(channel, following): (&Channel, &Vec<Following>)| {
            let surroundings = Surroundings { columns: environment, following };
            let selected = selection::select(channel, &surroundings, channels.len(), control);
            work.step();
            selected
        };
        let asked: Vec<_> = channels.iter().zip(&followed).collect();
        let selected: Result<Vec<_>, Stopped> = parallel::map(&asked, |of| select(*of)).into_iter().collect();
        let mut selected = selected?;
        work.rename("comparing the channels");
        agreement::agree(channels, &mut selected, environment, control)?;
        rival_column::tie(channels, &mut selected, environment, control)?;
        let common = if environment.is_empty() { common::find(channels, &selected) } else { None };
        Ok(Self { measured, selected, common })
    }

    /// Searches once more below the corner of a filter, where one may have bent the laws and what
    /// lies below is described without it; returns what is to be said of that.
    ///
    /// # Errors
    /// Stopped.
    pub(super) fn below_the_corner(self, control: &Control) -> Result<(Self, Option<String>), Stopped> {
        let channels = &self.measured.channels;
        let count = channels.len();
        let bent = |i: &usize| corner::may_be_bent(&channels[*i], &self.selected[*i].chosen, count);
        let asked: Vec<usize> = (0..count).filter(bent).collect();
        let found = parallel::map(&asked, |i| (*i, corner::slower(&channels[*i])));
        let falling: Vec<(usize, usize)> = found.into_iter().filter_map(|(i, slower)| Some((i, slower?))).collect();
        let Some(slower) = falling.iter().map(|(_, slower)| *slower).max() else { return Ok((self, None)) };
        if self.selected.iter().any(|s| corner::has_line_above(&s.chosen, slower)) {
            return Ok((self, None));
        }
        let below = Self::of(self.measured.slowed(slower), control)?;
        let described =
            |i: &usize| corner::is_described(&below.measured.channels[*i], &below.selected[*i].chosen, count);
        if !falling.iter().all(|(i, _)| described(i)) {
            return Ok((self, None));
        }
        let names: Vec<String> = falling.iter().map(|(i, _)| format!("`{}`", channels[*i].name)).collect();
        let half_hz = channels.first().map_or(0.0, |c| c.rate_hz / 2.0);
        let said = format!(
            "{}: the noise falls off towards {} Hz, as behind a low-pass filter, whose shape is not asked for here; what \
             lies below {} Hz is judged, and nothing faster",
            names.join(", "),
            short(half_hz),
            short(half_hz / slower as f64)
        );
        Ok((below, Some(said)))
    }
}
