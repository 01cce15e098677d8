//! Scales of charts: round numbers and where they lie.

/// Most ticks of an axis, so that their number is bounded whatever its ends are.
const MOST_TICKS: u32 = 24;

/// A linear map of values onto pixels.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Scale {
    /// Least and greatest value.
    pub(crate) values: [f64; 2],
    /// The pixels of these.
    pub(crate) pixels: [f64; 2],
}

impl Scale {
    /// The pixel of a value.
    pub(crate) fn pixel(&self, value: f64) -> f64 {
        let [low, high] = self.values;
        let [from, to] = self.pixels;
        from + (value - low) / (high - low) * (to - from)
    }

    /// Round values within the scale, about so many.
    pub(crate) fn ticks(&self, about: f64) -> impl Iterator<Item = f64> + use<> {
        let [low, high] = self.values;
        let step = round_step((high - low) / about);
        let first = (low / step).ceil();
        (0..MOST_TICKS)
            .map(move |number| (first + f64::from(number)) * step + 0.0)
            .take_while(move |value| *value <= high)
    }
}

/// Least and greatest of values, apart from each other also where there is one value or none.
pub(crate) fn extent(values: impl IntoIterator<Item = f64>) -> [f64; 2] {
    let start = [f64::INFINITY, f64::NEG_INFINITY];
    let [low, high] = values
        .into_iter()
        .filter(|value| value.is_finite())
        .fold(start, |[low, high], value| [low.min(value), high.max(value)]);
    match high - low {
        wide if wide > 0.0 => [low, high],
        0.0 => [low - 1.0, low + 1.0],
        _ => [-1.0, 1.0],
    }
}

/// 1, 2 or 5 times a power of ten, near a step.
fn round_step(about: f64) -> f64 {
    let power = 10f64.powf(about.max(1e-9).log10().floor());
    let times = match about / power {
        times if times < 1.5 => 1.0,
        times if times < 3.5 => 2.0,
        times if times < 7.5 => 5.0,
        _ => 10.0,
    };
    power * times
}

/// A tick as text, with no more digits than it has.
pub(crate) fn tick_text(value: f64) -> String {
    format!("{}", (value * 1e6).round() / 1e6).replace('-', "−")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ticks(values: [f64; 2], about: f64) -> Vec<f64> {
        Scale { values, pixels: [0.0, 1.0] }.ticks(about).collect()
    }

    #[test]
    fn ticks_are_round_and_inside() {
        assert_eq!(ticks([-185.0, 248.0], 4.0), [-100.0, 0.0, 100.0, 200.0]);
        assert_eq!(ticks([0.0, 10.0], 5.0), [0.0, 2.0, 4.0, 6.0, 8.0, 10.0]);
        assert!(ticks([0.0, f64::MAX], 4.0).len() <= 24);
    }

    #[test]
    fn an_extent_has_a_width_whatever_it_is_of() {
        assert_eq!(extent([]), [-1.0, 1.0]);
        assert_eq!(extent([3.0, f64::NAN]), [2.0, 4.0]);
        assert_eq!(extent([3.0, -1.0]), [-1.0, 3.0]);
    }
}
