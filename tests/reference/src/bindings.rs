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

    /// Volume and angles that CGAL finds by rational numbers.
    #[derive(Clone, Copy, Debug, PartialEq)]
    struct Tetrahedron {
        /// Volume, negative if it is inverted.
        volume: f64,
        /// Dihedral angles at the edges `01 02 03 12 13 23` in degrees, with a sign.
        dihedral_degrees: [f64; 6],
    }

    /// Delaunay tetrahedra of points, and their convex hull.
    #[derive(Clone, Debug)]
    struct DelaunayMesh {
        /// Corners, cell after cell, positively oriented.
        cells: Vec<u32>,
        /// Volume of the convex hull.
        hull_volume: f64,
        /// Corners of the convex hull.
        hull_vertices: usize,
    }

    /// Random points of a surface and their distances from another one.
    struct Sampled {
        /// Coordinates, point after point.
        points: Vec<f64>,
        /// Distance of each.
        distances: Vec<f64>,
    }

    /// Components of faces and loops of the boundary.
    #[derive(Clone, Debug)]
    struct Pieces {
        /// Component of each face.
        components: Vec<u32>,
        /// Length of each boundary loop.
        border_lengths: Vec<f64>,
    }

    /// What CGAL says of triangles that may be anything.
    #[derive(Clone, Debug, PartialEq, Eq)]
    struct Soup {
        /// Whether they are an oriented manifold.
        is_manifold: bool,
        /// Whether CGAL's mesh takes them all, which may have several open fans at a vertex.
        takes_all: bool,
        /// Vertices whose faces form more than one fan, if it takes them all.
        non_manifold_vertices: Vec<u32>,
    }

    /// Normals, lengths and angles that CGAL finds.
    #[derive(Clone, Debug)]
    struct Shape {
        /// Unit normals, face after face.
        normals: Vec<f64>,
        /// Length of each edge.
        edge_lengths: Vec<f64>,
        /// Angles of faces in degrees.
        angles_degrees: Vec<f64>,
    }

    /// Edges of an intrinsic triangulation.
    struct IntrinsicEdges {
        /// Two vertices for each edge.
        ends: Vec<u32>,
        /// Length of each edge.
        lengths: Vec<f64>,
    }

    /// A polygon mesh with tags, and what to do with it.
    #[derive(Clone, Debug, Default)]
    struct Control {
        /// Coordinates, vertex after vertex.
        positions: Vec<f64>,
        /// Number of corners of each face.
        sizes: Vec<i32>,
        /// Corners, face after face.
        corners: Vec<i32>,
        /// End vertices of each tagged edge.
        crease_ends: Vec<i32>,
        /// Sharpness of each tagged edge.
        crease_sharpness: Vec<f32>,
        /// Tagged vertices.
        corner_vertices: Vec<i32>,
        /// Sharpness of each tagged vertex.
        corner_sharpness: Vec<f32>,
        /// Whether sharpness falls by Chaikin's rule.
        chaikin: bool,
        /// Whether corners of the boundary are sharp.
        sharp_corners: bool,
        /// Number of refinements.
        levels: u32,
    }

    /// The vertices of one refinement.
    struct PolygonLevel {
        /// Coordinates, vertex after vertex.
        positions: Vec<f64>,
        /// Vertices before the refinement of which each one is the point: a vertex, the ends of an
        /// edge, or the corners of a face.
        origins: Vec<u32>,
        /// Where the origins of each vertex end.
        origin_ends: Vec<usize>,
    }

    /// Limits of the vertices of the last refinement.
    struct PolygonLimits {
        /// Coordinates, vertex after vertex.
        positions: Vec<f64>,
        /// First tangents.
        first_tangents: Vec<f64>,
        /// Second tangents.
        second_tangents: Vec<f64>,
        /// The neighbour along the first edge of each vertex.
        first_neighbours: Vec<u32>,
        /// The neighbour along its first sharp edge, or the vertex itself.
        sharp_neighbours: Vec<u32>,
    }

    /// All refinements and the limits of the last one.
    struct PolygonRefinement {
        /// From the first refinement on.
        levels: Vec<PolygonLevel>,
        /// What the last one tends to.
        limits: PolygonLimits,
    }

    unsafe extern "C++" {
        include!("reference.h");

        fn openmesh_facts(positions: &[f64], faces: &[u32]) -> MeshFacts;
        fn openmesh_loop(positions: &[f64], faces: &[u32]) -> Surface;
        fn openmesh_butterfly(positions: &[f64], faces: &[u32]) -> Surface;
        fn openmesh_catmull_clark(control: &Control) -> Vec<PolygonLevel>;
        fn openmesh_version() -> String;

        fn opensubdiv_refine(control: &Control) -> Result<PolygonRefinement>;
        fn opensubdiv_positions(control: &Control) -> Result<Vec<f64>>;
        fn opensubdiv_version() -> String;

        fn cgal_measures(positions: &[f64], faces: &[u32]) -> Measures;
        fn cgal_face_cotangents(positions: &[f64], faces: &[u32]) -> Vec<f64>;
        fn cgal_cotangent_weights(positions: &[f64], flaps: &[u32]) -> Vec<f64>;
        fn cgal_version() -> String;

        fn cgal_pieces(positions: &[f64], faces: &[u32]) -> Pieces;
        fn cgal_soup(vertices: usize, faces: &[u32]) -> Soup;
        fn cgal_shape(positions: &[f64], faces: &[u32]) -> Shape;

        fn cgal_plane_delaunay(points: &[f64]) -> Vec<u32>;
        fn cgal_intrinsic(positions: &[f64], faces: &[u32]) -> IntrinsicEdges;

        /// Places in the plane, two for each vertex, harmonic inside of a given border.
        fn cgal_harmonic(positions: &[f64], faces: &[u32], places: &[f64]) -> Result<Vec<f64>>;

        /// Places in the plane, two for each vertex, by least squares conformal maps.
        fn cgal_lscm(positions: &[f64], faces: &[u32]) -> Result<Vec<f64>>;

        /// Places in the disk, two for each vertex, by mean value coordinates.
        fn cgal_mean_value(positions: &[f64], faces: &[u32]) -> Result<Vec<f64>>;

        fn cgal_orientations(corners: &[f64]) -> Vec<i8>;
        fn cgal_tetrahedra(corners: &[f64]) -> Vec<Tetrahedron>;
        fn cgal_delaunay(positions: &[f64]) -> DelaunayMesh;
        fn cgal_self_intersections(positions: &[f64], faces: &[u32]) -> Result<Vec<u32>>;

        fn cgal_hausdorff(
            from_positions: &[f64],
            from_faces: &[u32],
            to_positions: &[f64],
            to_faces: &[u32],
            error: f64,
        ) -> Result<f64>;
        fn cgal_sampled(
            from_positions: &[f64],
            from_faces: &[u32],
            to_positions: &[f64],
            to_faces: &[u32],
            count: usize,
        ) -> Result<Sampled>;

        type Cholmod;
        fn cholmod_lower(
            starts: &[usize],
            rows: &[u32],
            values: &[f64],
            metis: bool,
        ) -> UniquePtr<Cholmod>;
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

        type Ldlt;
        fn eigen_lower(starts: &[usize], rows: &[u32], values: &[f64]) -> UniquePtr<Ldlt>;
        fn analyze(self: Pin<&mut Ldlt>);
        fn factor(self: Pin<&mut Ldlt>) -> Result<()>;
        fn solve(self: &Ldlt, right_hand_sides: &[f64], solutions: &mut [f64]);
        fn eigen_version() -> String;
    }
}

pub use ffi::*;
