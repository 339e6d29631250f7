//! Comparison with established libraries: OpenMesh, OpenSubdiv, CGAL, CHOLMOD, and VTK, meshio and
//! SciPy in Python, and OpenCASCADE's program DRAW.
//!
//! The functions here return what those libraries find on a [`TriangleMesh`], a polygon mesh, a
//! sparse matrix, tetrahedra or a file; the tests of this package set it beside what this project
//! finds, and leave the largest deviation of each quantity in `target/reference` through
//! [`record::Comparison`].

mod bindings;
pub mod cholmod;
pub mod draw;
pub mod meshes;
pub mod peers;
pub mod polygon;
pub mod python;
pub mod record;
pub mod solids;
pub mod splines;
pub mod t_splines;

use msplines_common::mesh::TriangleMesh;
use nalgebra::Point3;

pub use bindings::{Measures, MeshFacts, Pieces, Shape, Soup};

/// Returns the vertices, edges, faces, boundary loops and manifoldness that OpenMesh finds.
///
/// The faces may be anything; those that OpenMesh cannot take are counted.
#[must_use]
pub fn openmesh_facts(positions: &[Point3<f64>], faces: &[[u32; 3]]) -> MeshFacts {
    bindings::openmesh_facts(&flat(positions), faces.as_flattened())
}

/// A mesh that nothing has checked.
type Bare = (Vec<Point3<f64>>, Vec<[u32; 3]>);

/// Returns the mesh after one round of OpenMesh's Loop subdivision: old vertices come first.
#[must_use]
pub fn openmesh_loop(mesh: &TriangleMesh) -> Bare {
    let surface = bindings::openmesh_loop(&flat(mesh.positions()), mesh.faces().as_flattened());
    bare(&surface)
}

/// Returns the mesh after one round of OpenMesh's modified butterfly: old vertices come first.
#[must_use]
pub fn openmesh_butterfly(mesh: &TriangleMesh) -> Bare {
    let faces = mesh.faces().as_flattened();
    bare(&bindings::openmesh_butterfly(
        &flat(mesh.positions()),
        faces,
    ))
}

fn bare(surface: &bindings::Surface) -> Bare {
    let (positions, _) = surface.positions.as_chunks::<3>();
    let (faces, _) = surface.faces.as_chunks::<3>();
    let positions = positions.iter().map(|&p| Point3::from(p));
    (positions.collect(), faces.to_vec())
}

/// Returns CGAL's components of faces and the lengths of its boundary loops.
#[must_use]
pub fn cgal_pieces(mesh: &TriangleMesh) -> Pieces {
    bindings::cgal_pieces(&flat(mesh.positions()), mesh.faces().as_flattened())
}

/// Returns what CGAL says of triangles that may be anything with three corners.
#[must_use]
pub fn cgal_soup(vertex_count: usize, faces: &[[u32; 3]]) -> Soup {
    bindings::cgal_soup(vertex_count, faces.as_flattened())
}

/// Returns CGAL's unit normals of faces, lengths of edges and angles of faces.
#[must_use]
pub fn cgal_shape(mesh: &TriangleMesh) -> Shape {
    bindings::cgal_shape(&flat(mesh.positions()), mesh.faces().as_flattened())
}

/// Returns CGAL's Delaunay triangles of points in the plane, no two of which are equal.
#[must_use]
pub fn cgal_plane_delaunay(points: &[[f64; 2]]) -> Vec<[u32; 3]> {
    let faces = bindings::cgal_plane_delaunay(points.as_flattened());
    faces.as_chunks::<3>().0.to_vec()
}

/// Returns the ends and the length of each edge of CGAL's intrinsic Delaunay triangulation, in CGAL's
/// numbering of vertices.
#[must_use]
pub fn cgal_intrinsic(mesh: &TriangleMesh) -> Vec<([u32; 2], f64)> {
    let found = bindings::cgal_intrinsic(&flat(mesh.positions()), mesh.faces().as_flattened());
    let (ends, _) = found.ends.as_chunks::<2>();
    ends.iter().copied().zip(found.lengths).collect()
}

/// Returns the places of a disk's vertices by CGAL's discrete harmonic map: those on the boundary are
/// kept.
///
/// # Errors
/// What CGAL says.
pub fn cgal_harmonic(
    mesh: &TriangleMesh,
    places: &[[f64; 2]],
) -> Result<Vec<[f64; 2]>, cxx::Exception> {
    let faces = mesh.faces().as_flattened();
    let places = bindings::cgal_harmonic(&flat(mesh.positions()), faces, places.as_flattened())?;
    Ok(places.as_chunks::<2>().0.to_vec())
}

/// Returns CGAL's areas, volume and mixed Voronoi areas.
#[must_use]
pub fn cgal_measures(mesh: &TriangleMesh) -> Measures {
    bindings::cgal_measures(&flat(mesh.positions()), mesh.faces().as_flattened())
}

/// Returns the place in the plane of each vertex of a disk by CGAL's least squares conformal map.
///
/// # Errors
/// What CGAL says.
pub fn cgal_lscm(mesh: &TriangleMesh) -> Result<Vec<[f64; 2]>, cxx::Exception> {
    let places = bindings::cgal_lscm(&flat(mesh.positions()), mesh.faces().as_flattened())?;
    Ok(places.as_chunks::<2>().0.to_vec())
}

/// Returns the place in the unit disk of each vertex of a disk by CGAL's mean value coordinates, the
/// boundary by arc length.
///
/// # Errors
/// What CGAL says.
pub fn cgal_mean_value(mesh: &TriangleMesh) -> Result<Vec<[f64; 2]>, cxx::Exception> {
    let places = bindings::cgal_mean_value(&flat(mesh.positions()), mesh.faces().as_flattened())?;
    Ok(places.as_chunks::<2>().0.to_vec())
}

/// Returns the largest distance of a point of one surface from another one, by CGAL, within `error` of it.
///
/// # Errors
/// What CGAL says.
pub fn cgal_hausdorff(
    from: &TriangleMesh,
    to: &TriangleMesh,
    error: f64,
) -> Result<f64, cxx::Exception> {
    bindings::cgal_hausdorff(
        &flat(from.positions()),
        from.faces().as_flattened(),
        &flat(to.positions()),
        to.faces().as_flattened(),
        error,
    )
}

/// Returns random points of one surface, as dense everywhere, and their distances from another one, drawn
/// and measured by CGAL.
///
/// # Errors
/// What CGAL says.
pub fn cgal_sampled(
    from: &TriangleMesh,
    to: &TriangleMesh,
    count: usize,
) -> Result<Vec<(Point3<f64>, f64)>, cxx::Exception> {
    let sampled = bindings::cgal_sampled(
        &flat(from.positions()),
        from.faces().as_flattened(),
        &flat(to.positions()),
        to.faces().as_flattened(),
        count,
    )?;
    let (points, _) = sampled.points.as_chunks::<3>();
    let points = points.iter().map(|&p| Point3::from(p));
    Ok(points.zip(sampled.distances).collect())
}

/// Returns CGAL's cotangent of each corner's angle, three for each face.
#[must_use]
pub fn cgal_face_cotangents(mesh: &TriangleMesh) -> Vec<f64> {
    bindings::cgal_face_cotangents(&flat(mesh.positions()), mesh.faces().as_flattened())
}

/// Returns CGAL's `cotangent_weight` of each flap `[opposite, end, opposite, end]`.
#[must_use]
pub fn cgal_cotangent_weights(mesh: &TriangleMesh, flaps: &[[u32; 4]]) -> Vec<f64> {
    bindings::cgal_cotangent_weights(&flat(mesh.positions()), flaps.as_flattened())
}

/// A library that is compared with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Library {
    /// Topology, Loop and Catmull-Clark subdivision.
    OpenMesh,
    /// Catmull-Clark subdivision with creases, and its limits.
    OpenSubdiv,
    /// Areas, volumes, angles, predicates, Delaunay tetrahedra and self-intersections.
    Cgal,
    /// Sparse factorisation.
    Cholmod,
    /// Sparse factorisation without blocks.
    Eigen,
    /// Bézier cells and the quality of hexahedra.
    Vtk,
    /// Files of meshes.
    Meshio,
    /// Tensor products of B-splines.
    Scipy,
    /// Files of boundary representations.
    OpenCascade,
}

impl Library {
    /// Returns the name and the version this package was compiled with or asks.
    ///
    /// # Panics
    /// If it is a Python package or a program and cannot be asked.
    #[must_use]
    pub fn version(self) -> String {
        match self {
            Self::OpenMesh => format!("OpenMesh {}", bindings::openmesh_version()),
            Self::OpenSubdiv => format!("OpenSubdiv {}", bindings::opensubdiv_version()),
            Self::Cgal => format!("CGAL {}", bindings::cgal_version()),
            Self::Cholmod => format!("CHOLMOD {}", bindings::cholmod_version()),
            Self::Eigen => format!("Eigen {}", bindings::eigen_version()),
            Self::Vtk => format!("VTK {}", python::version("vtk")),
            Self::Meshio => format!("meshio {}", python::version("meshio")),
            Self::Scipy => format!("SciPy {}", python::version("scipy")),
            Self::OpenCascade => {
                let version = draw::version().unwrap_or_else(|error| panic!("{error}"));
                format!("OpenCASCADE {version}")
            }
        }
    }
}

/// Returns the processor time that this process has used, in seconds.
#[must_use]
pub fn cpu_seconds() -> f64 {
    bindings::cpu_seconds()
}

fn flat(positions: &[Point3<f64>]) -> Vec<f64> {
    positions.iter().flat_map(|p| [p.x, p.y, p.z]).collect()
}
