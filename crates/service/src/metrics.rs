//! What the service counts, for Prometheus.

use std::sync::{Arc, atomic::AtomicU64};

use prometheus_client::{
    encoding::{EncodeLabelSet, text::encode},
    metrics::{counter::Counter, family::Family, gauge::Gauge, histogram::Histogram},
    registry::Registry,
};

/// Counts, shared by all that counts; cheap to clone.
#[derive(Clone, Debug)]
pub(crate) struct Metrics {
    registry: Arc<Registry>,
    /// How long answers took [s].
    pub(crate) request_durations: Family<RequestLabels, Histogram>,
    /// Requests under way.
    pub(crate) requests_in_flight: Gauge,
    /// States that searches expanded.
    pub(crate) expansions: Counter,
    /// Questions whose planner was at hand, and whose was not.
    pub(crate) planners: Family<CacheLabels, Counter>,
    /// Requests refused because there was too much to do.
    pub(crate) shed: Family<ShedLabels, Counter>,
    /// Faults that were caught.
    pub(crate) panics: Counter,
    /// Computations that wait for their turn, and that run.
    pub(crate) computations: Family<StateLabels, Gauge>,
    /// Jobs at hand by state.
    pub(crate) jobs: Family<StateLabels, Gauge>,
    /// Threads of jobs that do not end although they were told to.
    pub(crate) stuck_threads: Gauge,
    /// Physical memory of the process [bytes].
    pub(crate) resident_bytes: Gauge,
    /// What requests under way may take together, as estimated [bytes].
    pub(crate) reserved_bytes: Gauge,
    /// What planners keep between requests [bytes].
    pub(crate) kept_bytes: Gauge,
    /// Bounds of the connections that are open.
    pub(crate) connections: Gauge,
    /// Longest time that anybody has waited for a turn of late [s].
    pub(crate) projected_wait_s: Gauge<f64, AtomicU64>,
}

/// What a request's duration is told by.
#[derive(Clone, Debug, Hash, PartialEq, Eq, EncodeLabelSet)]
pub(crate) struct RequestLabels {
    pub(crate) method: &'static str,
    /// The template, as `/v1/maps/{id}`; `none` where there is no such path.
    pub(crate) path: String,
    pub(crate) status: u16,
}

/// Whether something was at hand.
#[derive(Clone, Debug, Hash, PartialEq, Eq, EncodeLabelSet)]
pub(crate) struct CacheLabels {
    /// `hit` or `miss`.
    pub(crate) outcome: &'static str,
}

/// Why a request was refused.
#[derive(Clone, Debug, Hash, PartialEq, Eq, EncodeLabelSet)]
pub(crate) struct ShedLabels {
    /// `queue`, `memory` or `connections`.
    pub(crate) reason: &'static str,
}

/// Where something stands.
#[derive(Clone, Debug, Hash, PartialEq, Eq, EncodeLabelSet)]
pub(crate) struct StateLabels {
    pub(crate) state: &'static str,
}

/// Bounds of durations [s]: from a walk to a held goal to the longest that a plan may take.
const DURATION_BOUNDS_S: [f64; 14] =
    [0.0005, 0.001, 0.0025, 0.005, 0.01, 0.025, 0.05, 0.1, 0.25, 0.5, 1.0, 5.0, 15.0, 60.0];

impl Metrics {
    pub(crate) fn new() -> Self {
        let mut metrics = Metrics {
            registry: Arc::default(),
            request_durations: Family::new_with_constructor(|| Histogram::new(DURATION_BOUNDS_S)),
            requests_in_flight: Gauge::default(),
            expansions: Counter::default(),
            planners: Family::default(),
            shed: Family::default(),
            panics: Counter::default(),
            computations: Family::default(),
            jobs: Family::default(),
            stuck_threads: Gauge::default(),
            resident_bytes: Gauge::default(),
            reserved_bytes: Gauge::default(),
            kept_bytes: Gauge::default(),
            connections: Gauge::default(),
            projected_wait_s: Gauge::default(),
        };
        metrics.registry = Arc::new(metrics.registered());
        metrics
    }

    fn registered(&self) -> Registry {
        let mut registry = Registry::with_prefix("joulepath");
        registry.register(
            "http_request_duration_seconds",
            "Time from a request's head to its answer's, by path template and status",
            self.request_durations.clone(),
        );
        registry.register("http_requests_in_flight", "Requests under way", self.requests_in_flight.clone());
        registry.register("connections", "Connections that are open", self.connections.clone());
        registry.register("expansions", "States that searches expanded", self.expansions.clone());
        registry.register(
            "planner_cache_requests",
            "Questions about maps, by whether their planner was at hand",
            self.planners.clone(),
        );
        registry.register("shed", "Requests refused because of too much to do", self.shed.clone());
        registry.register("panics", "Faults that were caught", self.panics.clone());
        registry.register("computations", "Computations by state", self.computations.clone());
        registry.register(
            "projected_wait_seconds",
            "Time that a computation would wait for its turn now",
            self.projected_wait_s.clone(),
        );
        registry.register("jobs", "Jobs at hand by state", self.jobs.clone());
        registry.register("stuck_threads", "Threads of jobs that do not end", self.stuck_threads.clone());
        registry.register(
            "resident_memory_bytes",
            "Physical memory of the process",
            self.resident_bytes.clone(),
        );
        registry.register(
            "reserved_memory_bytes",
            "Memory that requests under way may take, as estimated",
            self.reserved_bytes.clone(),
        );
        registry.register("kept_memory_bytes", "Memory that planners keep", self.kept_bytes.clone());
        registry
    }

    /// All counts as OpenMetrics text.
    pub(crate) fn text(&self) -> String {
        let resident = memory_stats::memory_stats().map_or(0, |stats| stats.physical_mem);
        self.resident_bytes.set(i64::try_from(resident).unwrap_or(i64::MAX));
        let mut text = String::new();
        // Writing to a string does not fail.
        let _ = encode(&mut text, &self.registry);
        text
    }
}
