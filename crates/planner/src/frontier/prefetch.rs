//! Asking for memory before it is needed.
//!
//! A search jumps along its wavefront, so nearly every state it takes up lies in memory that the processor does not hold.
//! Asking for the states next in line while one is worked on takes an expansion on a 1000 × 1000 map to about a third of its
//! time (`joulepath bench --size 1000`, with `CODES_AHEAD` as it is and out of reach).

/// Hints that an element of a slice will be read soon; does nothing where it does not exist.
#[inline(always)]
#[allow(unsafe_code)]
pub(crate) fn prefetch<T>(slice: &[T], index: usize) {
    #[cfg(target_arch = "x86_64")]
    if let Some(element) = slice.get(index) {
        use core::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
        // SAFETY: a prefetch reads nothing and faults on nothing, and the address is that of a live element.
        unsafe { _mm_prefetch::<_MM_HINT_T0>(std::ptr::from_ref(element).cast()) };
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = (slice, index);
}
