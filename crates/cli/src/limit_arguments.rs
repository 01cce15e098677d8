//! The service's limits as flags of `serve`.

use std::{str::FromStr, time::Duration};

use clap::Args;
use service::{Limits, Tokens};

/// Each is also a variable of the environment and a setting of the file.
#[derive(Args)]
#[command(next_help_heading = "Limits")]
pub(crate) struct LimitArguments {
    /// Largest request body, unpacked [bytes]
    #[arg(long, env = "JOULEPATH_BODY_BYTES", default_value_t = Limits::default().body_bytes, value_parser = some::<usize>)]
    body_bytes: usize,
    /// Longest time for one plan [s]
    #[arg(long, env = "JOULEPATH_PLAN_TIME_S", default_value = "60", value_parser = some_seconds)]
    plan_time_s: Duration,
    /// Most states (cells × 16 headings) of one plan
    #[arg(long, env = "JOULEPATH_PLAN_STATES", default_value_t = Limits::default().plan_states, value_parser = some::<usize>)]
    plan_states: usize,
    /// Most entries of a matrix: sources times targets
    #[arg(long, env = "JOULEPATH_MATRIX_ENTRIES", default_value_t = Limits::default().matrix_entries, value_parser = some::<usize>)]
    matrix_entries: usize,
    /// Most cells over all stored maps
    #[arg(long, env = "JOULEPATH_STORED_CELLS", default_value_t = Limits::default().stored_cells)]
    stored_cells: usize,
    /// Most bytes of stored maps that are kept in memory
    #[arg(long, env = "JOULEPATH_KEPT_MAP_BYTES", default_value_t = Limits::default().kept_map_bytes)]
    kept_map_bytes: usize,
    /// Most bytes that planners keep between requests
    #[arg(long, env = "JOULEPATH_KEPT_BYTES", default_value_t = Limits::default().kept_bytes)]
    kept_bytes: usize,
    /// Most bytes that requests under way may take together, as estimated
    #[arg(long, env = "JOULEPATH_REQUEST_MEMORY_BYTES", default_value_t = Limits::default().request_memory_bytes, value_parser = some::<u64>)]
    request_memory_bytes: u64,
    /// Computations that run at the same time; the default is one for each core, but two
    #[arg(long, env = "JOULEPATH_PARALLEL_PLANS", default_value_t = Limits::default().parallel_plans, value_parser = some::<usize>)]
    parallel_plans: usize,
    /// Requests that may wait to compute, however long it takes
    #[arg(long, env = "JOULEPATH_PATIENT_PLANS", default_value_t = Limits::default().patient_plans)]
    patient_plans: usize,
    /// More may wait while none would wait longer than this; others are refused at once [s]
    #[arg(long, env = "JOULEPATH_QUEUE_TIME_S", default_value = "0.1", value_parser = seconds)]
    queue_time_s: Duration,
    /// Requests that may wait to compute at most
    #[arg(long, env = "JOULEPATH_QUEUED_PLANS", default_value_t = Limits::default().queued_plans)]
    queued_plans: usize,
    /// Largest recording [bytes]
    #[arg(long, env = "JOULEPATH_RECORDING_BYTES", default_value_t = Limits::default().recording_bytes)]
    recording_bytes: u64,
    /// Most bytes over all stored recordings
    #[arg(long, env = "JOULEPATH_STORED_RECORDING_BYTES", default_value_t = Limits::default().stored_recording_bytes)]
    stored_recording_bytes: u64,
    /// Most bytes of maps, robots and recordings that a tenant may keep [default: as many as recordings may take, half of them
    /// where tokens tell tenants apart]
    #[arg(long, env = "JOULEPATH_TENANT_BYTES")]
    tenant_bytes: Option<u64>,
    /// Most maps, robots and recordings that a tenant may keep
    #[arg(long, env = "JOULEPATH_TENANT_OBJECTS", default_value_t = Limits::default().tenant_objects)]
    tenant_objects: usize,
    /// Most jobs of a tenant that may wait or run, at all services over the store together [default: those of a service, half of
    /// them where tokens tell tenants apart]
    #[arg(long, env = "JOULEPATH_TENANT_JOBS")]
    tenant_jobs: Option<usize>,
    /// Longest time for one job [s]
    #[arg(long, env = "JOULEPATH_JOB_TIME_S", default_value = "3600", value_parser = some_seconds)]
    job_time_s: Duration,
    /// Jobs that may wait or run
    #[arg(long, env = "JOULEPATH_OPEN_JOBS", default_value_t = Limits::default().open_jobs)]
    open_jobs: usize,
    /// Jobs that run at the same time; the default is one less than cores, but one
    #[arg(long, env = "JOULEPATH_PARALLEL_JOBS", default_value_t = Limits::default().parallel_jobs, value_parser = some::<usize>)]
    parallel_jobs: usize,
    /// Jobs of each tenant that ended and are kept for who asks later
    #[arg(long, env = "JOULEPATH_KEPT_JOBS", default_value_t = Limits::default().kept_jobs)]
    kept_jobs: usize,
    /// How long a service that works on a job may be silent before another takes the job up [s]
    #[arg(long, env = "JOULEPATH_LEASE_S", default_value = "15", value_parser = lease)]
    lease_s: Duration,
    /// Connections that may be open
    #[arg(long, env = "JOULEPATH_CONNECTIONS", default_value_t = Limits::default().connections, value_parser = some::<usize>)]
    connections: usize,
    /// Longest wait for the head of a request, and for the next one on a connection [s]
    #[arg(long, env = "JOULEPATH_HEAD_TIME_S", default_value = "30", value_parser = some_seconds)]
    head_time_s: Duration,
    /// Longest pause while a body is sent or an answer is taken [s]
    #[arg(long, env = "JOULEPATH_BODY_PAUSE_S", default_value = "30", value_parser = some_seconds)]
    body_pause_s: Duration,
    /// Least mean speed of a body that takes longer than a pause [bytes/s]
    #[arg(long, env = "JOULEPATH_BODY_BYTES_PER_S", default_value_t = Limits::default().body_bytes_per_s, value_parser = some::<u64>)]
    body_bytes_per_s: u64,
    /// How long the service goes on when asked to end, while `/readyz` says so [s]
    #[arg(long, env = "JOULEPATH_UNREADY_TIME_S", default_value = "0", value_parser = seconds)]
    unready_time_s: Duration,
    /// Longest wait for requests under way after that [s]
    #[arg(long, env = "JOULEPATH_DRAIN_TIME_S", default_value = "10", value_parser = seconds)]
    drain_time_s: Duration,
    /// Fill holes of unknown ground up to this wide, of maps whose request does not say, from the ground around them [m]
    /// [default: none]
    #[arg(long, visible_alias = "fill-voids", env = "JOULEPATH_FILL_VOIDS_M", value_name = "M")]
    fill_voids_m: Option<f64>,
    /// Elevation of unknown cells of maps whose request does not say, beside those that the map marks [m] [default: none]
    #[arg(long, env = "JOULEPATH_NODATA", value_name = "V", allow_hyphen_values = true)]
    nodata: Option<f64>,
}

/// Longest time that may be set [s]: a day.
const MOST_S: f64 = 86_400.0;

fn seconds(text: &str) -> Result<Duration, String> {
    let value: f64 = text.parse().map_err(|_| "give seconds".to_owned())?;
    if !(0.0..=MOST_S).contains(&value) {
        return Err(format!("give 0 to {MOST_S} seconds"));
    }
    Ok(Duration::from_secs_f64(value))
}

/// A time of which none would let nothing happen.
fn some_seconds(text: &str) -> Result<Duration, String> {
    let time = seconds(text)?;
    if time.is_zero() { Err("must be above 0 s".to_owned()) } else { Ok(time) }
}

/// A count of which none would let nothing happen.
fn some<T: FromStr + PartialOrd + From<u8>>(text: &str) -> Result<T, String> {
    let count: T = text.parse().map_err(|_| "give a whole number".to_owned())?;
    if count < T::from(1) { Err("must be at least 1".to_owned()) } else { Ok(count) }
}

fn lease(text: &str) -> Result<Duration, String> {
    /// Below it a busy disk could look like a service that is no more.
    const SHORTEST: Duration = Duration::from_millis(100);
    let time = seconds(text)?;
    if time < SHORTEST { Err(format!("must be at least {} s", SHORTEST.as_secs_f64())) } else { Ok(time) }
}

impl LimitArguments {
    /// The limits of a service whose tenants its tokens tell apart; without tokens there is one tenant, who may have everything.
    pub(crate) fn limits(&self, tokens: &Tokens) -> Limits {
        // Half: no tenant alone keeps all others out.
        let share = if tokens.is_empty() { 1 } else { 2 };
        Limits {
            body_bytes: self.body_bytes,
            plan_time: self.plan_time_s,
            plan_states: self.plan_states,
            matrix_entries: self.matrix_entries,
            stored_cells: self.stored_cells,
            kept_map_bytes: self.kept_map_bytes,
            kept_bytes: self.kept_bytes,
            request_memory_bytes: self.request_memory_bytes,
            parallel_plans: self.parallel_plans,
            patient_plans: self.patient_plans,
            queue_time: self.queue_time_s,
            queued_plans: self.queued_plans,
            recording_bytes: self.recording_bytes,
            stored_recording_bytes: self.stored_recording_bytes,
            tenant_bytes: self.tenant_bytes.unwrap_or(self.stored_recording_bytes / share as u64),
            tenant_objects: self.tenant_objects,
            tenant_jobs: self.tenant_jobs.unwrap_or(self.open_jobs.div_ceil(share)),
            job_time: self.job_time_s,
            open_jobs: self.open_jobs,
            parallel_jobs: self.parallel_jobs,
            kept_jobs: self.kept_jobs,
            lease_time: self.lease_s,
            connections: self.connections,
            head_time: self.head_time_s,
            body_pause: self.body_pause_s,
            body_bytes_per_s: self.body_bytes_per_s,
            unready_time: self.unready_time_s,
            drain_time: self.drain_time_s,
            fill_voids_m: self.fill_voids_m,
            nodata_m: self.nodata,
        }
    }
}

#[cfg(test)]
mod tests {
    use clap::{Args, Command, FromArgMatches};

    use super::*;

    #[test]
    fn defaults_of_flags_are_those_of_the_service() {
        let command = LimitArguments::augment_args(Command::new("serve"));
        let matches = command.try_get_matches_from(["serve"]).unwrap();
        let limits = |tokens: &str| {
            let tokens = Tokens::parse(tokens).unwrap();
            LimitArguments::from_arg_matches(&matches).unwrap().limits(&tokens)
        };
        let all = Limits::default();
        assert_eq!(limits(""), all);
        let halved = Limits { tenant_bytes: all.tenant_bytes / 2, tenant_jobs: all.tenant_jobs / 2, ..all };
        assert_eq!(limits("alice:0123456789abcdef"), halved);
    }

    #[test]
    fn limits_that_let_nothing_happen_are_refused() {
        for flag in [
            "body-bytes",
            "plan-time-s",
            "plan-states",
            "matrix-entries",
            "request-memory-bytes",
            "parallel-plans",
            "parallel-jobs",
            "connections",
            "head-time-s",
            "body-pause-s",
            "body-bytes-per-s",
        ] {
            let command = LimitArguments::augment_args(Command::new("serve"));
            let error =
                command.try_get_matches_from(["serve".to_owned(), format!("--{flag}=0")]).unwrap_err();
            let said = error.to_string();
            assert!(said.contains(flag) && said.contains("must be"), "{said}");
        }
    }

    #[test]
    fn times_that_cannot_be_are_refused() {
        for wrong in ["", "a", "-1", "nan", "inf", "1e9"] {
            assert!(seconds(wrong).is_err(), "{wrong}");
        }
        assert_eq!(seconds("0.15"), Ok(Duration::from_millis(150)));
    }
}
