//! Doubts about a map, and what was done to it, in words.

use serde::{Deserialize, Serialize};

/// A doubt about a map or a path over it, or a change that was made to the map.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(deny_unknown_fields)]
pub struct Warning {
    /// Stable name for programs.
    pub kind: WarningKind,
    /// One sentence for people: what was found, where, and what can be done.
    pub detail: String,
}

/// Kinds of warnings.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(rename_all = "kebab-case")]
pub enum WarningKind {
    /// Cells of a conventional fill value that no ground has, which nothing marks, were read as unknown.
    UnmarkedNodata,
    /// Cells of a value that the reader was told of were read as unknown.
    GivenNodata,
    /// Holes of unknown ground were filled from the ground around them.
    FilledVoids,
    /// Pixels of an occupancy map that are neither free nor occupied were read as free.
    PartlyOccupied,
    /// One exact value stands off from all ground beside it, as a fill value does.
    FillValue,
    /// The values fill the range of a byte, as those of a picture do.
    Image,
    /// The values are compass directions.
    Aspect,
    /// Most of the ground is steeper than ground can be.
    ImpossibleSlopes,
    /// Elevations beyond those of dry land on Earth.
    UnusualElevation,
    /// Coordinates could be degrees, and nothing says that they are metres.
    UnknownUnit,
    /// The file holds several images or bands, of which one was read.
    FirstOfSeveral,
    /// The unit of coordinates was assumed, or is disputed by the file itself.
    AssumedUnit,
    /// The unit of elevations was assumed, or is disputed by the file itself.
    AssumedHeightUnit,
    /// Coordinates were multiplied by the scale of their projection.
    ProjectionScale,
    /// Elevations were interpolated onto square cells.
    Interpolated,
    /// Elevations on a grid of degrees were interpolated onto one of metres.
    Warped,
    /// Parts of the file that were never written hold zero.
    UnwrittenBlocks,
    /// A file beside the map contradicts it, or could not be used.
    BesideFile,
    /// Heights are rounded so coarsely that most slopes between cells are rounding.
    CoarseHeights,
    /// Cells far larger than the robot.
    CoarseCells,
    /// Moving the ends to the centres of cells matters to the energy.
    MovedEnds,
    /// The path leads over ground that was filled in.
    FilledGround,
    /// Stops on the way matter to the energy, which leaves them out.
    Stops,
    /// Between its poses the path leads over ground beyond the robot's limits.
    BeyondLimits,
    /// Unknown ground is open to the robot.
    UnknownGround,
    /// How the areas' coordinates were read, or what of them means nothing here.
    Areas,
    /// Constants of the robot are borrowed from other robots.
    BorrowedConstants,
}

impl WarningKind {
    /// Whether the map's cells alone give rise to it, so that it is found anew whenever they are looked at.
    pub(crate) fn is_from_cells(self) -> bool {
        use WarningKind as K;
        matches!(
            self,
            K::FillValue
                | K::Image
                | K::Aspect
                | K::ImpossibleSlopes
                | K::CoarseHeights
                | K::UnusualElevation
        )
    }
}

impl Warning {
    /// Longest sentence that a map may carry [bytes].
    pub const LONGEST_DETAIL: usize = 2000;
    /// Most warnings that a map may carry.
    pub const MOST: usize = 32;

    /// A warning of a kind.
    pub fn new(kind: WarningKind, detail: impl Into<String>) -> Self {
        Warning { kind, detail: detail.into() }
    }
}
