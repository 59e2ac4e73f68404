//! Lists the channels that hold more than the noise laws of an Allan curve: a sine, a jump or coarse steps bend that
//! curve, and the coefficients fitted to it are then not those of the noise.

use crate::repeatability::besides::{Besides, What};

use super::detail::{ChannelDetail, Detail};

/// Ids of the noise laws whose coefficients are compared.
const COMPARED: [&str; 4] = ["white-noise", "flicker-noise", "random-walk", "rate-ramp"];

/// Lists what a diagnosis found, channel by channel.
pub(super) fn of(detail: &Detail) -> Vec<Besides> {
    let of_channel = |channel: &ChannelDetail| {
        let named: Vec<String> = channel.named.iter().filter(|id| !COMPARED.contains(&id.as_str())).cloned().collect();
        let jumps = detail.location.jumps.iter().filter(|jump| jump.channels.contains(&channel.name));
        let jumps: Vec<f64> = jumps.map(|jump| jump.time_s).collect();
        let what = match (named.is_empty(), jumps.is_empty(), channel.fits) {
            (false, ..) => What::Named(named),
            (true, false, _) => What::Jumps(jumps),
            (true, true, false) => What::Unnamed,
            (true, true, true) => return None,
        };
        Some(Besides { channel: channel.name.clone(), what })
    };
    detail.channels.iter().filter_map(of_channel).collect()
}
