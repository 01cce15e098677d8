//! What a diagnosis is given beside the suspect drive.

use serde::{Deserialize, Serialize};

/// What a diagnosis is given beside the suspect drive.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Way {
    /// The robot's file, whose numbers are off by their stated uncertainty.
    FileAlone,
    /// A file that was calibrated on the healthy drives, without these.
    CalibratedFileAlone,
    /// The robot's file and the healthy drives.
    HealthyDrives,
}

impl Way {
    /// All, the one with least to go by first.
    pub const ALL: [Way; 3] = [Way::FileAlone, Way::CalibratedFileAlone, Way::HealthyDrives];

    /// Folder of its results beside a case's files.
    pub(crate) fn folder(self) -> &'static str {
        match self {
            Way::FileAlone => "diagnosis-file-alone",
            Way::CalibratedFileAlone => "diagnosis-calibrated-file-alone",
            Way::HealthyDrives => "diagnosis",
        }
    }

    /// For people.
    pub fn words(self) -> &'static str {
        match self {
            Way::FileAlone => "file alone",
            Way::CalibratedFileAlone => "calibrated file alone",
            Way::HealthyDrives => "healthy drives beside",
        }
    }
}
