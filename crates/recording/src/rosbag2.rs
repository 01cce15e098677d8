//! What `ros2 bag record` leaves: a folder of `metadata.yaml` and storage files, MCAP or SQLite, split or compressed.

pub(crate) mod db3;
pub(crate) mod folder;
mod metadata;
mod sqlite;
pub(crate) mod storage;
