//! The measures that every spline is judged by. All lengths in results are fractions of a scale.

mod distance;
mod tree;
mod vertex_error;

pub use distance::{Distance, DistanceError, distance};
pub use tree::{Closest, SurfaceTree};
pub use vertex_error::{
    UnitCubeError, VertexError, VertexErrorError, unit_cube_error, vertex_error,
};
