//! Power that has nothing to do with the wheels beside it.

use super::{
    Doubt,
    driving::ALIKE_S,
    follow::{Followed, Varies},
};

/// Correlation below which wheels and power have less than a quarter of their variance in common.
const LEAST_R: f64 = 0.5;
/// Standard errors by which it lies below.
const SIGMAS: f64 = 3.0;
/// Variation of the prediction over its mean from which it outweighs what friction, a factor on all of it, is uncertain by.
const LEAST_VARIATION: f64 = 0.5;

/// Tells of power that does not follow the wheels, though what they do should be seen.
pub(super) fn unfollowed(followed: &Followed) -> Option<Doubt> {
    let Varies { r, of_mean, .. } = followed.varies?;
    let manoeuvres = followed.driven_s / ALIKE_S;
    // Fisher's transform is normal with variance 1 / (n - 3).
    let highest = r.atanh() + SIGMAS / (manoeuvres - 3.0).max(0.0).sqrt();
    (highest < LEAST_R.atanh() && of_mean > LEAST_VARIATION).then(|| Doubt {
        name: "power_unrelated",
        statement: format!(
            "power does not follow the wheels: it has {:.0} % of its variation in common with what they and the slopes ask for, as if they do not belong together",
            100.0 * r.max(0.0).powi(2)
        ),
        cure: "are both of the same drive and robot, by clocks of one rate? Look at the sources of power, wheel speeds and pitch, at their units, \
               and whether a counter wraps"
            .to_owned(),
    })
}
