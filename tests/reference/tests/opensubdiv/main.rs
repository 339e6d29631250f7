//! Catmull-Clark subdivision with creases and its limits against OpenSubdiv.
//!
//! What differs, and how far, is measured here too:
//!
//! - OpenSubdiv holds sharpness, and what it blends masks by, in single precision. Where tags make it
//!   divide by three, refined points agree to that precision; elsewhere in double precision.
//! - Under Chaikin's rule a sharpness above one may become zero in one step, if the other edges are
//!   much less sharp. The point of the edge is then the midpoint here; OpenSubdiv extrapolates beyond
//!   it, although its comments say that the weight is clamped to one.
//! - At darts OpenSubdiv has the limit mask of smooth vertices, which is not the limit.
//! - In creased sectors of more than two faces, OpenSubdiv's tangents belong to rules of
//!   refinement that it does not have.

mod cases;
mod limits;
mod refined;
mod rings;
