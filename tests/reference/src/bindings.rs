//! Declarations of the C++ functions in `cpp/`.

#[cxx::bridge(namespace = "reference")]
mod ffi {
    /// Facts that OpenMesh finds.
    #[derive(Clone, Debug, PartialEq, Eq)]
    struct MeshFacts {
        /// Vertices.
        vertices: usize,
        /// Edges.
        edges: usize,
        /// Faces that were taken.
        faces: usize,
        /// Boundary loops.
        boundary_loops: usize,
        /// Vertices on the boundary.
        boundary_vertices: usize,
        /// Vertices whose faces form more than one fan.
        non_manifold_vertices: usize,
        /// Faces that were not taken.
        refused_faces: usize,
    }

    /// A triangle mesh in flat arrays.
    struct Surface {
        /// Coordinates, vertex after vertex.
        positions: Vec<f64>,
        /// Corners, face after face.
        faces: Vec<u32>,
    }

    /// Areas and volume that CGAL finds.
    struct Measures {
        /// Area of the surface.
        area: f64,
        /// Volume that a closed mesh bounds, or 0.
        volume: f64,
        /// Area of each face.
        face_areas: Vec<f64>,
        /// `mixed_voronoi_area` of each corner, three for each face.
        corner_areas: Vec<f64>,
    }

    unsafe extern "C++" {
        include!("reference.h");

        fn openmesh_facts(positions: &[f64], faces: &[u32]) -> MeshFacts;
        fn openmesh_loop(positions: &[f64], faces: &[u32]) -> Surface;
        fn openmesh_version() -> String;

        fn cgal_measures(positions: &[f64], faces: &[u32]) -> Measures;
        fn cgal_face_cotangents(positions: &[f64], faces: &[u32]) -> Vec<f64>;
        fn cgal_cotangent_weights(positions: &[f64], flaps: &[u32]) -> Vec<f64>;
        fn cgal_version() -> String;

        type Cholmod;
        fn cholmod_lower(starts: &[usize], rows: &[u32], values: &[f64]) -> UniquePtr<Cholmod>;
        fn analyze(self: Pin<&mut Cholmod>) -> Result<()>;
        fn factor(self: Pin<&mut Cholmod>) -> Result<()>;
        fn solve(
            self: Pin<&mut Cholmod>,
            right_hand_sides: &[f64],
            solutions: &mut [f64],
        ) -> Result<()>;
        fn stored_values(self: &Cholmod) -> usize;
        fn cholmod_version() -> String;
        fn cpu_seconds() -> f64;
    }
}

pub use ffi::*;
