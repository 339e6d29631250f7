//! T-splines that are fitted to whole surfaces.

use msplines_common::mesh::{TriangleMesh, shapes};
use msplines_common::progress::unobserved;
use msplines_t_spline::domain::{Domain, DomainOptions};
use msplines_t_spline::{FitOptions, Sampling, Stop, TSplineSurface};

use crate::meshes;

/// Models, their poles and numbers of control points.
const MODELS: [(&str, &[u32], usize); 3] = [
    ("kitten_40k.ply", &[], 765),
    ("fertility_30k.ply", &[], 2000),
    ("bunny_30k.ply", &[29830, 29379, 16387], 1303),
];

/// A surface and the T-spline that was fitted to it.
#[derive(Clone, Debug)]
pub struct Whole {
    /// What it is called.
    pub name: String,
    /// The surface.
    pub mesh: TriangleMesh,
    /// The T-spline.
    pub surface: TSplineSurface,
}

/// Returns the fit of a surface with these vertices as poles and so many control points.
///
/// # Panics
/// If there is none.
#[must_use]
pub fn whole(name: &str, mesh: TriangleMesh, poles: &[u32], most: usize) -> Whole {
    let options = DomainOptions {
        poles: poles.to_vec(),
        ..DomainOptions::default()
    };
    let domain = Domain::of_surface(&mesh, &options, &mut unobserved());
    let domain = domain.unwrap_or_else(|error| panic!("{name}: {error}"));
    let options = FitOptions {
        stop: Stop::ControlPoints(most),
        ..FitOptions::default()
    };
    let sampling = Sampling::default();
    let fitted = TSplineSurface::fit(domain, &mesh, &sampling, &options, &mut unobserved());
    let fitted = fitted.unwrap_or_else(|error| panic!("{name}: {error}"));
    Whole {
        name: name.to_owned(),
        surface: fitted.surface,
        mesh,
    }
}

/// Returns fits of generated surfaces: without zeros, with zeros, and with poles.
///
/// The torus is jittered. That of an even mesh is turned by 2e-8 of a period from its bottom to its top, so
/// that there are faces narrower than what OpenCASCADE tells apart, which finds their wires invalid.
#[must_use]
pub fn generated() -> Vec<Whole> {
    let bumpy = shapes::bumpy_sphere(2_000);
    let poles = ends(&bumpy);
    let torus = meshes::jittered(&shapes::torus(1.0, 0.4, 1_500), 0.2, 5);
    vec![
        whole("jittered torus", torus, &[], 150),
        whole("torus knot", shapes::torus_knot(2, 3, 3_000), &[], 300),
        whole("genus 2", shapes::genus(2, 2_500), &[], 500),
        whole("genus 3", shapes::genus(3, 4_000), &[], 900),
        whole("bumpy sphere", bumpy, &poles, 300),
    ]
}

/// Returns fits of the models that are there and whose names are wanted, and says which are not there.
#[must_use]
pub fn models(wanted: &[&str]) -> Vec<Whole> {
    let asked = MODELS.into_iter().filter(|model| wanted.contains(&model.0));
    let found = asked.filter_map(|(name, poles, most)| {
        let mesh = meshes::model(name)?;
        Some(whole(name, mesh, poles, most))
    });
    found.collect()
}

/// Names of all models.
#[must_use]
pub fn model_names() -> Vec<&'static str> {
    MODELS.map(|model| model.0).to_vec()
}

/// The vertices farthest up and down.
fn ends(mesh: &TriangleMesh) -> Vec<u32> {
    let height = |v: &u32| mesh.positions()[*v as usize].z;
    let mut vertices: Vec<u32> = (0..mesh.vertex_count() as u32).collect();
    vertices.sort_by(|a, b| height(a).total_cmp(&height(b)));
    vec![vertices[vertices.len() - 1], vertices[0]]
}

/// Returns a surface as triangles, `segments` along each edge of a face.
///
/// # Panics
/// If poles do not close it.
#[must_use]
pub fn tessellated(surface: &TSplineSurface, segments: u32) -> TriangleMesh {
    let found = surface.tessellate(segments).expect("a closed surface");
    TriangleMesh::build(found.positions, found.faces).expect("a surface")
}
