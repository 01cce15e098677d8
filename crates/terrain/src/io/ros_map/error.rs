//! What can be wrong with a ROS map.

/// An error of a `map_server` map; the message names the field and says how to mend it.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RosMapError {
    /// The YAML cannot be read.
    #[error("the map_server YAML cannot be read: {0}")]
    Yaml(#[from] serde_yaml_ng::Error),
    /// A resolution that no map has.
    #[error(
        "resolution of the map_server YAML is {value}, but must lie in {min} to {max}: give metres per pixel"
    )]
    Resolution {
        /// The value found [m].
        value: f64,
        /// Smallest accepted [m].
        min: f64,
        /// Largest accepted [m].
        max: f64,
    },
    /// An origin of another length.
    #[error("origin of the map_server YAML has {found} numbers, but must have 3: x [m], y [m], yaw [rad]")]
    Origin {
        /// Numbers found.
        found: usize,
    },
    /// A map that is rotated.
    #[error(
        "origin yaw of the map_server YAML is {yaw_rad}, but only maps without rotation are read: rotate the image by `magick {image} -background '#cdcdcd' -rotate {clockwise_deg:.6} -depth 8 rotated.png`, and write `image: rotated.png` and `origin: [{x_m:.3}, {y_m:.3}, 0]`"
    )]
    Yaw {
        /// The yaw [rad].
        yaw_rad: f64,
        /// The same clockwise [deg].
        clockwise_deg: f64,
        /// Name of the image.
        image: String,
        /// South-west corner of the rotated image, x [m].
        x_m: f64,
        /// South-west corner of the rotated image, y [m].
        y_m: f64,
    },
    /// A mode that map servers do not have.
    #[error("mode of the map_server YAML is `{found}`, but must be trinary, scale or raw")]
    Mode {
        /// What stands there.
        found: String,
    },
    /// A threshold that is no share.
    #[error("{field} of the map_server YAML is {value}, but must lie in 0 to 1: write 0.65 for 65 %")]
    Threshold {
        /// `occupied_thresh` or `free_thresh`.
        field: &'static str,
        /// The value found.
        value: f64,
    },
    /// Thresholds that leave pixels both free and occupied.
    #[error(
        "free_thresh of the map_server YAML is {free}, above occupied_thresh, which is {occupied}: swap them"
    )]
    Thresholds {
        /// The free threshold.
        free: f64,
        /// The occupied threshold.
        occupied: f64,
    },
    /// The image cannot be had.
    #[error("the map image {name}, which the map_server YAML names, cannot be read: {source}")]
    Read {
        /// The image's name in the YAML.
        name: String,
        /// Why.
        source: std::io::Error,
    },
    /// The image is none, or is broken.
    #[error(
        "the map image {name} cannot be read: {source}; map images are PGM, PNG or BMP, whatever their name"
    )]
    Image {
        /// The image's name in the YAML.
        name: String,
        /// Why.
        source: image::ImageError,
    },
    /// No pixel is free or occupied.
    #[error(
        "every pixel of the map image {name} is unknown in mode {mode}, with occupied_thresh {occupied} and free_thresh {free}: check mode, thresholds and negate"
    )]
    AllUnknown {
        /// The image's name in the YAML.
        name: String,
        /// The mode.
        mode: &'static str,
        /// The occupied threshold.
        occupied: f64,
        /// The free threshold.
        free: f64,
    },
}
