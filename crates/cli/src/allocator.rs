//! The allocator of a service: what requests free goes back to the system.
//!
//! By default glibc learns from the first large block that is freed to keep blocks of up to 32 MiB, in as many arenas as there
//! are threads, eight for each core: eighteen bodies of 60 MB that were refused left 200 MB behind.

/// Blocks from this size on are mapped one by one, and unmapped when they are freed [bytes].
#[cfg(all(target_os = "linux", target_env = "gnu"))]
const MAPPED_FROM_BYTES: i32 = 256 << 10;
/// Free memory at the end of an arena that is kept [bytes].
#[cfg(all(target_os = "linux", target_env = "gnu"))]
const KEPT_BYTES: i32 = 1 << 20;
/// Arenas for small blocks; threads that wait for one another hardly need more.
#[cfg(all(target_os = "linux", target_env = "gnu"))]
const ARENAS: i32 = 4;

/// Sets the allocator up; does nothing where it is another one. Belongs before the first thread.
#[allow(unsafe_code)]
pub(crate) fn give_back_freed_memory() {
    #[cfg(all(target_os = "linux", target_env = "gnu"))]
    for (parameter, value) in [
        (libc::M_MMAP_THRESHOLD, MAPPED_FROM_BYTES),
        (libc::M_TRIM_THRESHOLD, KEPT_BYTES),
        (libc::M_ARENA_MAX, ARENAS),
    ] {
        // SAFETY: `mallopt` takes two numbers and refuses what it does not know.
        unsafe { libc::mallopt(parameter, value) };
    }
}
