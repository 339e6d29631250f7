//! Memory bounded by the size of the input.

use peak_alloc::PeakAlloc;

#[global_allocator]
static ALLOCATOR: PeakAlloc = PeakAlloc;

/// One byte of text or binary can become one number or one index, and a growing array is twice as large
/// as its content while it moves; that of the tests of `io`.
const BYTES_PER_BYTE: usize = 64;

/// A shorthand of four bytes in a drawing can become a polyline of 32 points.
const DRAWN_BYTES_PER_BYTE: usize = 1024;

/// Messages, tables of fixed size, and the buffers of the fuzzer itself.
const SLACK: usize = 1 << 18;

/// Returns what `read` makes of `length` bytes.
///
/// # Panics
/// If it takes more memory on its way than so many bytes warrant.
pub(crate) fn bounded<T>(length: usize, read: impl FnOnce() -> T) -> T {
    within(BYTES_PER_BYTE * length + SLACK, read)
}

/// The same of a drawing, whose curves become polylines.
pub(crate) fn bounded_drawing<T>(length: usize, read: impl FnOnce() -> T) -> T {
    within(DRAWN_BYTES_PER_BYTE * length + SLACK, read)
}

/// Returns what `work` makes.
///
/// # Panics
/// If it takes more than so many bytes of memory on its way.
pub(crate) fn within<T>(limit: usize, work: impl FnOnce() -> T) -> T {
    let before = ALLOCATOR.current_usage();
    ALLOCATOR.reset_peak_usage();
    let made = work();
    let peak = ALLOCATOR.peak_usage().saturating_sub(before);
    assert!(peak <= limit, "{peak} bytes of memory instead of {limit}");
    made
}
