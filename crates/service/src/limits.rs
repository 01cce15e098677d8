//! What one request may ask for.

use std::time::Duration;

use crate::{maps::MapLimits, store::Quota};

/// Limits of the service; the defaults suit a laptop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Largest request body [bytes]. Default 64 MiB, a 3000 × 3000 map as text.
    pub body_bytes: usize,
    /// Longest time for one plan [s]. Default 60 s.
    pub plan_time: Duration,
    /// Most states (cells × 16 headings) of one plan. Default 32 million: 1400 × 1400 cells.
    pub plan_states: usize,
    /// Most entries of a matrix: sources times targets. Default 2500: 50 × 50.
    pub matrix_entries: usize,
    /// Most cells over all stored maps, of which a tenant among others may take half. Default 200 million.
    pub stored_cells: usize,
    /// Most bytes of stored maps that are kept in memory. Default 1 GiB.
    pub kept_map_bytes: usize,
    /// Most bytes that planners keep between requests: costs of motions and fields of goals. Default 2 GiB.
    pub kept_bytes: usize,
    /// Most bytes that requests under way may take together, as estimated. Default 4 GiB.
    pub request_memory_bytes: u64,
    /// Computations that run at the same time; more wait. Default: one for each core, but two, so that a job leaves room.
    pub parallel_plans: usize,
    /// Requests that may wait to compute, however long it takes. Default: sixteen for each that computes.
    pub patient_plans: usize,
    /// More may wait while none would wait longer than this [s]; others are refused at once. Default 0.1 s.
    pub queue_time: Duration,
    /// Requests that may wait to compute at most. Default 256.
    pub queued_plans: usize,
    /// Largest recording [bytes]. Default 12 GiB.
    pub recording_bytes: u64,
    /// Most bytes over all stored recordings. Default 64 GiB.
    pub stored_recording_bytes: u64,
    /// Most bytes of maps, robots and recordings that a tenant may keep. Default: as many as recordings may take.
    pub tenant_bytes: u64,
    /// Most maps, robots and recordings that a tenant may keep. Default 10 000.
    pub tenant_objects: usize,
    /// Most jobs of a tenant that may wait or run, at all services together. Default: those of a service.
    pub tenant_jobs: usize,
    /// Longest time for one job [s]. Default 3600 s.
    pub job_time: Duration,
    /// Jobs that may wait or run; more are refused. Default 32.
    pub open_jobs: usize,
    /// Jobs that run at the same time, of the computations that may. Default: one less than cores, but one.
    pub parallel_jobs: usize,
    /// Reports of each tenant's jobs that ended and are kept for who asks later. Default 1000.
    pub kept_jobs: usize,
    /// How long a service that works on a job may be silent before another takes the job up [s]. Default 15 s.
    pub lease_time: Duration,
    /// Connections that may be open; more are refused. Default 1024.
    pub connections: usize,
    /// Longest wait for the head of a request, and for the next one on a connection [s]. Default 30 s.
    pub head_time: Duration,
    /// Longest pause while a body is sent or an answer is taken [s]. Default 30 s.
    pub body_pause: Duration,
    /// Least mean speed of a body that takes longer than a pause [bytes/s]. Default 4096.
    pub body_bytes_per_s: u64,
    /// How long the service goes on when it is asked to end, so that who asks `/readyz` learns of it [s]. Default 0 s.
    pub unready_time: Duration,
    /// Longest wait for requests under way after that [s]. Default 10 s.
    pub drain_time: Duration,
    /// Holes of unknown ground up to this wide are filled in maps whose request says nothing of it [m]. Default: none.
    pub fill_voids_m: Option<f64>,
    /// Elevation of unknown cells of maps whose request says nothing of it, beside those that the map marks [m]. Default: none.
    pub nodata_m: Option<f64>,
}

impl Limits {
    /// How a map in a request is read.
    pub(crate) fn map_options(&self) -> terrain::io::Options {
        terrain::io::Options {
            most_cells: self.map_cells(),
            nodata_m: self.nodata_m,
            fill_voids_m: self.fill_voids_m,
            ..terrain::io::Options::default()
        }
    }
}

impl Default for Limits {
    fn default() -> Self {
        let cores = std::thread::available_parallelism().map_or(1, usize::from);
        Limits {
            body_bytes: 64 << 20,
            plan_time: Duration::from_secs(60),
            plan_states: 32_000_000,
            matrix_entries: 2500,
            stored_cells: 200_000_000,
            kept_map_bytes: 1 << 30,
            kept_bytes: 2 << 30,
            request_memory_bytes: 4 << 30,
            parallel_plans: cores.max(2),
            patient_plans: 16 * cores.max(2),
            queue_time: Duration::from_millis(100),
            queued_plans: 256,
            recording_bytes: 12 << 30,
            stored_recording_bytes: 64 << 30,
            tenant_bytes: 64 << 30,
            tenant_objects: 10_000,
            tenant_jobs: 32,
            job_time: Duration::from_secs(3600),
            open_jobs: 32,
            parallel_jobs: (cores - 1).max(1),
            kept_jobs: 1000,
            lease_time: Duration::from_secs(15),
            connections: 1024,
            head_time: Duration::from_secs(30),
            body_pause: Duration::from_secs(30),
            body_bytes_per_s: 4096,
            unready_time: Duration::ZERO,
            drain_time: Duration::from_secs(10),
            fill_voids_m: None,
            nodata_m: None,
        }
    }
}

impl Limits {
    /// Most that a tenant may keep.
    pub(crate) fn quota(&self) -> Quota {
        Quota { bytes: self.tenant_bytes, objects: self.tenant_objects }
    }

    /// Most that maps may take.
    pub(crate) fn maps(&self) -> MapLimits {
        MapLimits { stored_cells: self.stored_cells, quota: self.quota() }
    }

    /// Most cells of a map that can be planned over.
    pub fn map_cells(&self) -> u64 {
        (self.plan_states / planner::HEADINGS) as u64
    }
}
