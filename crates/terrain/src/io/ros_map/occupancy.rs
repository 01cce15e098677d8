//! From a pixel to what the map server publishes for it.

use serde::Deserialize;

use super::RosMapError;

/// How pixels are read, as `nav2_map_server` defines it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Mode {
    /// Occupied, free or unknown by the two thresholds. An alpha channel counts as a fourth colour.
    Trinary,
    /// Between the thresholds by share; not opaque is unknown.
    Scale,
    /// The brightness of 255 steps is the occupancy in percent; above 100 is unknown.
    Raw,
}

impl Mode {
    pub(super) fn named(name: &str) -> Result<Self, RosMapError> {
        match name {
            "trinary" => Ok(Mode::Trinary),
            "scale" => Ok(Mode::Scale),
            "raw" => Ok(Mode::Raw),
            found => Err(RosMapError::Mode { found: found.chars().take(40).collect() }),
        }
    }

    pub(super) fn name(self) -> &'static str {
        match self {
            Mode::Trinary => "trinary",
            Mode::Scale => "scale",
            Mode::Raw => "raw",
        }
    }
}

/// What a cell is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Occupancy {
    Free,
    /// Neither free nor as occupied as an obstacle.
    Partly,
    Occupied,
    Unknown,
}

/// A rule from pixels to occupancy.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rule {
    pub(super) mode: Mode,
    pub(super) negate: bool,
    pub(super) occupied: f64,
    pub(super) free: f64,
}

/// A pixel: colours and, where the image has it, opacity, 0 to 1.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pixel {
    pub(super) colors: [f64; 3],
    pub(super) opacity: Option<f64>,
}

impl Rule {
    /// What a pixel stands for (`loadMapFromFile` of `nav2_map_server`). What it publishes as 1 to 99 percent is partly
    /// occupied, except above `occupied_thresh` in mode raw, where whoever uses the map applies it.
    pub(super) fn occupancy(&self, pixel: Pixel) -> Occupancy {
        let sum: f64 = pixel.colors.iter().sum();
        let shade = match pixel.opacity {
            Some(opacity) if self.mode == Mode::Trinary => (sum + opacity) / 4.0,
            _ => sum / 3.0,
        };
        let share = if self.negate { shade } else { 1.0 - shade };
        match self.mode {
            Mode::Raw => self.percent((shade * 255.0).round()),
            Mode::Scale if pixel.opacity.is_some_and(|opacity| opacity < 1.0) => Occupancy::Unknown,
            _ if share > self.occupied => Occupancy::Occupied,
            _ if share < self.free => Occupancy::Free,
            Mode::Trinary => Occupancy::Unknown,
            Mode::Scale => {
                let width = self.occupied - self.free;
                // Equal thresholds leave nothing between them but themselves.
                let between = if width > 0.0 { (share - self.free) / width } else { 1.0 };
                self.whole_percent((100.0 * between).round())
            }
        }
    }

    fn percent(&self, percent: f64) -> Occupancy {
        match percent {
            p if p > 100.0 => Occupancy::Unknown,
            p if p > 100.0 * self.occupied => Occupancy::Occupied,
            p => self.whole_percent(p),
        }
    }

    fn whole_percent(&self, percent: f64) -> Occupancy {
        match percent {
            p if p >= 100.0 => Occupancy::Occupied,
            p if p <= 0.0 => Occupancy::Free,
            _ => Occupancy::Partly,
        }
    }
}

/// `negate` as map servers take it: a whole number, of which all but 0 are true, or a truth value of YAML.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Negate(pub(super) bool);

impl<'de> Deserialize<'de> for Negate {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        #[derive(Deserialize)]
        #[serde(untagged)]
        enum Form {
            Truth(bool),
            Number(i64),
            Word(String),
        }
        let wrong = || serde::de::Error::custom("negate must be 0, 1, true or false");
        match Form::deserialize(deserializer).map_err(|_| wrong())? {
            Form::Truth(truth) => Ok(Negate(truth)),
            Form::Number(number) => Ok(Negate(number != 0)),
            Form::Word(word) => match word.to_ascii_lowercase().as_str() {
                "yes" | "on" | "y" | "true" => Ok(Negate(true)),
                "no" | "off" | "n" | "false" => Ok(Negate(false)),
                _ => Err(wrong()),
            },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rule(mode: Mode) -> Rule {
        Rule { mode, negate: false, occupied: 0.65, free: 0.196 }
    }

    fn gray(value: u8) -> Pixel {
        Pixel { colors: [f64::from(value) / 255.0; 3], opacity: None }
    }

    #[test]
    fn trinary_pixels_are_free_occupied_or_unknown() {
        for (value, occupancy) in [
            (254, Occupancy::Free),
            (205, Occupancy::Unknown),
            (0, Occupancy::Occupied),
            (89, Occupancy::Occupied),
        ] {
            assert_eq!(rule(Mode::Trinary).occupancy(gray(value)), occupancy, "{value}");
        }
        let negated = Rule { negate: true, ..rule(Mode::Trinary) };
        assert_eq!(negated.occupancy(gray(254)), Occupancy::Occupied);
        let black_and_opaque = Pixel { opacity: Some(1.0), ..gray(0) };
        assert_eq!(rule(Mode::Trinary).occupancy(black_and_opaque), Occupancy::Occupied);
        let black_and_clear = Pixel { opacity: Some(0.0), ..gray(255) };
        assert_eq!(
            rule(Mode::Trinary).occupancy(black_and_clear),
            Occupancy::Unknown,
            "a fourth colour of 0"
        );
    }

    #[test]
    fn raw_pixels_are_percent() {
        for (value, occupancy) in [
            (0, Occupancy::Free),
            (30, Occupancy::Partly),
            (66, Occupancy::Occupied),
            (100, Occupancy::Occupied),
            (101, Occupancy::Unknown),
            (255, Occupancy::Unknown),
        ] {
            assert_eq!(rule(Mode::Raw).occupancy(gray(value)), occupancy, "{value}");
        }
    }

    #[test]
    fn scaled_pixels_lie_between_the_thresholds_and_only_clear_ones_are_unknown() {
        let speed_mask = Rule { occupied: 1.0, free: 0.0, ..rule(Mode::Scale) };
        for (value, occupancy) in [(255, Occupancy::Free), (128, Occupancy::Partly), (0, Occupancy::Occupied)]
        {
            assert_eq!(speed_mask.occupancy(gray(value)), occupancy, "{value}");
        }
        let clear = Pixel { opacity: Some(0.5), ..gray(255) };
        assert_eq!(speed_mask.occupancy(clear), Occupancy::Unknown);
    }
}
