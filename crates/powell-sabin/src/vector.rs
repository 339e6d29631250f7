//! Vectors of the flat plane.

/// Returns `a + b`.
pub(crate) fn add(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0] + b[0], a[1] + b[1]]
}

/// Returns `a - b`.
pub(crate) fn sub(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0] - b[0], a[1] - b[1]]
}

/// Returns `s a`.
pub(crate) fn scale(s: f64, a: [f64; 2]) -> [f64; 2] {
    [s * a[0], s * a[1]]
}

/// Returns the inner product.
pub(crate) fn dot(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

/// Returns the area of the parallelogram of `a` and `b`, positive if `b` is to the left of `a`.
pub(crate) fn cross(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

/// Returns `a` turned to the left by a right angle.
pub(crate) fn turn(a: [f64; 2]) -> [f64; 2] {
    [-a[1], a[0]]
}

/// Returns the length.
pub(crate) fn norm(a: [f64; 2]) -> f64 {
    a[0].hypot(a[1])
}
