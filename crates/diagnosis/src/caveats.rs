//! What a diagnosis has to say of itself.

use calibration::slopes_note;
use recording::Recording;

/// What a diagnosis without healthy drives has to say of itself.
const ALONE: &str = "without drives known to be healthy (`--reference`) only what sets in during a drive or grows with time can be \
     told; what acts all the time looks like what the model itself misses";

/// What a diagnosis of motor currents has to say of itself.
pub(crate) const BY_CURRENT: &str = "motor currents were taken for forces by `force_n_per_a` of the robot's file and for power by its k1 and k2";

/// What a finding outside the list has to say of itself.
const OUTSIDE: &str = "what is outside the list is described, not understood: no robot's file can hold it, and the corrected \
     robot is without it";

/// What has to be said of a diagnosis of some drives, without healthy ones, by motor currents, or with something outside the list.
pub(crate) fn caveats(
    suspect: &Recording,
    is_alone: bool,
    is_by_current: bool,
    is_outside: bool,
) -> impl Iterator<Item = &'static str> {
    let said = [(is_alone, ALONE), (is_by_current, BY_CURRENT), (is_outside, OUTSIDE)];
    said.into_iter().filter(|(is_so, _)| *is_so).map(|(_, note)| note).chain(slopes_note(suspect))
}
