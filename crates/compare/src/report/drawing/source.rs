//! What the pictures of a row are drawn from.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::{Arc, Mutex, OnceLock};

use msplines_common::mesh::{Decimated, TriangleMesh, VertexAttribute, decimate, edge_pieces};
use msplines_common::{Point3, Vector3};
use msplines_io::{read_npy, read_points};
use msplines_picture::edges;

use super::companions::{Companions, FieldMesh, Lines, SolidSurfaces};
use super::fitted::Fitted;
use super::frames;
use super::t_spline::TSplineSurfaces;
use crate::campaign::{RowReport, Sources};
use crate::case::Input;
use crate::clock::PhaseClock;
use crate::experiment::{FieldSurface, MethodName, ViewHint};
use crate::input::{LoadedInput, load, read_surface};
use crate::output::{NORMALS, ROW_KNOTS, ROW_SURFACE, ROW_TEXTURE};

/// Larger meshes get lighter ones to turn.
const LIGHT_ENOUGH: usize = 24_000;
/// Vertices of those.
const LIGHT_VERTICES: usize = 12_000;

/// Why errors cannot be shown at the vertices of a control mesh.
const NO_DATA: &str = "control vertices have no data; show the field `distance_to_limit` instead";

/// Why errors of a solid are shown on its input only.
const NO_VERTICES: &str =
    "a solid has no vertices of its input; show the field `error` on the input instead";

/// Why an atlas has no errors.
const NO_SPLINE: &str = "an atlas is no fit and has no errors; show `checkers` instead";

/// Why an interpolating surface has no errors.
const NO_ERRORS: &str = "the surface passes through all vertices; show the spline instead";

/// A domain that is loaded by whoever asks first.
type Loading = Arc<OnceLock<Result<Arc<Domain>, String>>>;

/// Inputs that were loaded, each once.
#[derive(Default)]
pub(super) struct Domains {
    loading: Mutex<BTreeMap<String, Loading>>,
}

/// An input, and a lighter mesh of it.
pub(super) struct Domain {
    loaded: LoadedInput,
    light: OnceLock<Option<Decimated>>,
}

impl Domains {
    fn load(&self, input: &Input) -> Result<Arc<Domain>, String> {
        let key = format!("{input:?}");
        let mut loading = self.loading.lock().unwrap_or_else(|e| e.into_inner());
        let cell = Arc::clone(loading.entry(key).or_default());
        drop(loading);
        let load_now = || {
            let mut clock = PhaseClock::start(std::time::Instant::now());
            let loaded = load(input, &mut clock).map_err(|e| e.to_string())?;
            let light = OnceLock::new();
            Ok(Arc::new(Domain { loaded, light }))
        };
        cell.get_or_init(load_now).clone()
    }
}

impl Domain {
    /// Returns a mesh that the run of a row left as its domain.
    fn of_row(mesh: &TriangleMesh, report: &RowReport) -> Result<Self, String> {
        let facts = report.result.record().ok_or_else(missing)?.input.clone();
        Ok(Self {
            loaded: LoadedInput {
                mesh: mesh.clone(),
                facts,
                attributes: Vec::new(),
                warnings: Vec::new(),
            },
            light: OnceLock::new(),
        })
    }

    /// Returns a lighter mesh of a large input.
    pub(super) fn light(&self) -> Option<&Decimated> {
        let mesh = &self.loaded.mesh;
        let decimated =
            || (mesh.vertex_count() > LIGHT_ENOUGH).then(|| decimate(mesh, LIGHT_VERTICES).ok())?;
        self.light.get_or_init(decimated).as_ref()
    }
}

/// The input, the stored surface, and what lies between them.
pub(super) struct Source {
    /// The domain.
    pub(super) domain: Arc<Domain>,
    /// The surface that was fitted, where that is a frame of an animation of the domain.
    frame: Option<TriangleMesh>,
    /// The stored surface: the spline where it was evaluated, or the domain where the data are no
    /// positions.
    pub(super) spline: TriangleMesh,
    /// What the stored surface carries at its vertices.
    attributes: Vec<VertexAttribute>,
    /// How it compares with the data, or why it cannot be compared.
    pub(super) fitted: Result<Fitted, String>,
    /// Places of the knots on the domain.
    pub(super) knots: Vec<Point3<f64>>,
    /// A control mesh and what is approximated, where the method has them.
    companions: Option<Companions>,
    /// Surfaces beside the spline of a solid, or of an interpolant.
    solid: Option<SolidSurfaces>,
    /// What there is of a T-spline.
    pub(super) t_spline: Option<TSplineSurfaces>,
    /// Texture coordinates of the corners of every face of the stored surface of an atlas, or of the mesh
    /// that the form of a T-spline lies on.
    texture: Option<Vec<[[f64; 2]; 3]>>,
    /// Exact unit normals of the stored surface, where they are known.
    normals: Option<Vec<Vector3<f64>>>,
    /// Rounds of subdivision from the input to the spline.
    rounds: u32,
    /// Where it is seen from.
    pub(super) view: ViewHint,
}

/// A surface with the numbers at its vertices and the lines on it.
pub(super) type Shown<'a> = (&'a TriangleMesh, &'a [VertexAttribute], Option<&'a Lines>);

impl Source {
    /// Loads the files of a row that ran, or says why they cannot be used.
    pub(super) fn load(
        report: &RowReport,
        frame: Option<usize>,
        domains: &Domains,
    ) -> Result<Self, String> {
        let sources = report.sources.as_ref().ok_or_else(missing)?;
        let Sources { input, files, view } = sources;
        let has_charts = report.row.method.has_charts();
        let has_own_input = has_charts
            && report
                .row
                .manifold
                .as_ref()
                .is_none_or(|m| m.scan.is_none());
        let companions = has_charts.then(|| Companions::load(files)).transpose()?;
        let is_solid = report.row.method == MethodName::Trivariate;
        let is_atlas = report.row.method == MethodName::Conformal;
        let is_interpolant = report.row.method == MethodName::PowellSabin;
        let has_beside = is_solid || is_interpolant;
        let solid = has_beside.then(|| SolidSurfaces::load(files)).transpose()?;
        let domain = match (&companions, &solid) {
            (Some(companions), _) if has_own_input => {
                Arc::new(Domain::of_row(&companions.control.0, report)?)
            }
            (_, Some(solid)) => Arc::new(Domain::of_row(&solid.input.mesh, report)?),
            _ => domains.load(input)?,
        };
        let (frame, spline, attributes) =
            match frames::load(report, frame, files, &domain.loaded.mesh)? {
                Some([original, spline]) => (Some(original), spline, Vec::new()),
                None => {
                    let surface = read_surface(&files.join(ROW_SURFACE));
                    let (spline, attributes) = surface.map_err(|e| e.to_string())?;
                    (None, spline, attributes)
                }
            };
        let knots = knots_of(report.row.method, files)?;
        let t_spline = report.row.t_spline.as_ref().filter(|own| own.pictures);
        let has_texture = is_atlas || t_spline.is_some();
        Ok(Self {
            fitted: match &frame {
                None if has_charts => Err(NO_DATA.to_owned()),
                None if is_solid => Err(NO_VERTICES.to_owned()),
                None if is_atlas => Err(NO_SPLINE.to_owned()),
                None if is_interpolant => Err(NO_ERRORS.to_owned()),
                Some(original) => Ok(Fitted::of_frame(original, &spline, &domain.loaded)),
                None => Fitted::of(report.row.data, &domain.loaded, &spline, &attributes),
            },
            companions,
            solid,
            normals: normals(&attributes),
            texture: has_texture.then(|| texture(files)).transpose()?,
            t_spline: t_spline.map(|_| TSplineSurfaces::of(files)),
            frame,
            spline,
            attributes,
            knots,
            rounds: report.row.subdivide,
            view: view.unwrap_or_default(),
            domain,
        })
    }

    /// Returns a surface that carries numbers, with them and the lines on it.
    pub(super) fn shown(&self, on: FieldSurface) -> Result<Shown<'_>, String> {
        let beside = match (on, &self.solid) {
            (FieldSurface::Spline, _) => {
                let lines = self.lines().map(|[_, spline]| spline);
                return Ok((&self.spline, &self.attributes, lines));
            }
            (FieldSurface::Input, Some(solid)) => Some(&solid.input),
            (FieldSurface::Cut, Some(solid)) => solid.cut.as_ref(),
            (_, None) => None,
        };
        let found = beside.map(|s| (&s.mesh, s.attributes.as_slice(), Some(&s.lines)));
        found.ok_or_else(|| format!("its run left no surface `{}` with fields", on.name()))
    }

    /// Returns the lines on a surface that carries numbers, where there are any.
    pub(super) fn field_lines(&self, on: FieldSurface) -> Option<&Lines> {
        self.shown(on).ok()?.2
    }

    /// Returns an attribute of a surface, `[vertex]`, or says which there are.
    pub(super) fn attribute(&self, on: FieldSurface, name: &str) -> Result<&[f64], String> {
        let attributes = self.shown(on)?.1;
        let found = attributes.iter().find(|a| a.name == name);
        found.map(|a| a.values.as_slice()).ok_or_else(|| {
            let names: Vec<&str> = attributes.iter().map(|a| a.name.as_str()).collect();
            let names = if names.is_empty() {
                "none".to_owned()
            } else {
                names.join(", ")
            };
            format!("its surface has no attribute `{name}`; there are: {names}")
        })
    }

    /// Returns the texture coordinates of the corners of every face of the stored surface.
    pub(super) fn texture(&self) -> Result<&[[[f64; 2]; 3]], String> {
        let texture = self.texture.as_deref();
        texture.ok_or_else(|| "its run left no texture; only conformal atlases have one, and T-splines with `pictures = true`"
                .to_owned())
    }

    /// Returns the exact normals of the stored surface, where they are known.
    pub(super) fn normals(&self) -> Option<&[Vector3<f64>]> {
        self.normals.as_deref()
    }

    /// Returns the control triangles.
    pub(super) fn control(&self) -> Result<&FieldMesh, String> {
        self.beside(
            |beside| beside.control.as_ref(),
            "no control triangles; only Powell-Sabin splines have them",
        )
    }

    /// Returns the domain with its faces split.
    pub(super) fn refinement(&self) -> Result<&FieldMesh, String> {
        self.beside(
            |beside| beside.refinement.as_ref(),
            "no refinement; give `layout = \"plane\"`",
        )
    }

    /// Returns two charts in the plane.
    pub(super) fn charts(&self) -> Result<&FieldMesh, String> {
        self.beside(
            |beside| beside.charts.as_ref(),
            "no charts; give their places as `charts`",
        )
    }

    fn beside(
        &self,
        which: impl Fn(&SolidSurfaces) -> Option<&FieldMesh>,
        missing: &str,
    ) -> Result<&FieldMesh, String> {
        let found = self.solid.as_ref().and_then(which);
        found.ok_or_else(|| format!("its run left {missing}"))
    }

    /// Returns the surface that is approximated and the lines on it.
    pub(super) fn target(&self) -> Result<&(TriangleMesh, Lines), String> {
        let companions = self.companions.as_ref();
        let target = companions.and_then(|companions| companions.target.as_ref());
        target.ok_or_else(|| "its run left no surface that is approximated".to_owned())
    }

    /// Returns the lines on the control mesh, and those on the spline, where there are any.
    pub(super) fn lines(&self) -> Option<[&Lines; 2]> {
        if let Some(solid) = &self.solid {
            return Some([&solid.input.lines, &solid.spline]);
        }
        let companions = self.companions.as_ref()?;
        Some([&companions.control.1, &companions.spline])
    }

    /// Returns the domain mesh.
    pub(super) fn input(&self) -> &TriangleMesh {
        &self.domain.loaded.mesh
    }

    /// Returns the surface that was fitted: the domain, or a frame of its animation.
    pub(super) fn original(&self) -> &TriangleMesh {
        self.frame.as_ref().unwrap_or(self.input())
    }

    /// Returns how many pieces of an edge of the domain lie on the spline.
    pub(super) fn pieces_per_edge(&self) -> f64 {
        if let (Some(_), Some(beside)) = (&self.normals, &self.solid) {
            let edges = self.input().topology().edge_count().max(1);
            return beside.spline.edges.len() as f64 / edges as f64;
        }
        f64::from(self.rounds).exp2()
    }

    /// Returns the pieces of the edges of the domain on the spline, as pairs of its vertices; the
    /// edges of the stored surface where that is no subdivision of the domain.
    pub(super) fn domain_edges(&self) -> Vec<[u32; 2]> {
        let (faces, topology) = (self.spline.faces(), self.input().topology());
        if faces.len() == topology.face_count() << (2 * self.rounds) {
            edge_pieces(topology, faces, self.rounds)
        } else {
            edges(faces)
        }
    }
}

/// Returns the normals among attributes.
pub(super) fn normals(attributes: &[VertexAttribute]) -> Option<Vec<Vector3<f64>>> {
    let component = |name: &str| attributes.iter().find(|a| a.name == name);
    let [x, y, z] = NORMALS.map(component);
    let (x, y, z) = (&x?.values, &y?.values, &z?.values);
    let vertices = 0..x.len();
    Some(vertices.map(|v| Vector3::new(x[v], y[v], z[v])).collect())
}

/// Returns the texture coordinates in the folder of a row.
fn texture(files: &Path) -> Result<Vec<[[f64; 2]; 3]>, String> {
    let array = read_npy(&files.join(ROW_TEXTURE)).map_err(|e| e.to_string())?;
    let faces = array.values.as_chunks::<6>().0.iter();
    Ok(faces
        .map(|&[a, b, c, d, e, f]| [[a, b], [c, d], [e, f]])
        .collect())
}

/// What is said where files of a row are gone.
pub(super) fn missing() -> String {
    "its files are missing; run the row again with --fresh".to_owned()
}

/// Returns the places of knots of a row, or of the zeros of its form.
fn knots_of(method: MethodName, files: &Path) -> Result<Vec<Point3<f64>>, String> {
    let knots = read_points(&files.join(ROW_KNOTS));
    match method {
        MethodName::SparseManifold | MethodName::CurveNetwork | MethodName::Trivariate => {
            Ok(Vec::new())
        }
        // A form without zeros leaves no file.
        MethodName::Conformal | MethodName::PowellSabin | MethodName::TSpline => {
            Ok(knots.unwrap_or_default())
        }
        _ => knots.map_err(|e| e.to_string()),
    }
}
