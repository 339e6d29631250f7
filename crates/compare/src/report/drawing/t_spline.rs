//! What there is to draw of a T-spline, as its run left it.

use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use msplines_common::Vector3;
use msplines_common::mesh::TriangleMesh;
use msplines_picture::Rgb;

use super::Unit;
use super::companions::FieldMesh;
use super::fitted::colours;
use super::source::{Source, normals};
use crate::campaign::RowReport;
use crate::experiment::{Edges, Panel, Show};
use crate::run::t_spline_pictures::{CONTROL, CYLINDERS, LEVELS, NET, RECTANGLES, SURFACE};

/// Channels of the colours of vertices.
const CHANNELS: [&str; 3] = ["red", "green", "blue"];
/// Why there is nothing.
const NO_PICTURES: &str = "only T-splines with `t_spline = { pictures = true }` have it";

/// Control points, and pairs of them that are joined.
pub(super) type ControlNet<'a> = (&'a TriangleMesh, &'a [[u32; 2]]);

/// A surface with exact normals.
pub(super) struct Tiled {
    pub(super) field: FieldMesh,
    pub(super) normals: Option<Vec<Vector3<f64>>>,
}

impl Tiled {
    /// Returns the colours at its vertices.
    pub(super) fn colours(&self) -> Vec<Rgb> {
        let channel = |name| self.field.attributes.iter().find(|a| a.name == name);
        let channels = CHANNELS.map(|name| channel(name).map_or(&[][..], |a| &a.values));
        let of_vertex = |v: usize| channels.map(|channel| channel.get(v).copied().unwrap_or(0.0));
        let vertices = 0..self.field.mesh.vertex_count();
        colours(&vertices.flat_map(of_vertex).collect::<Vec<f64>>())
    }
}

/// The names of all surfaces.
const NAMES: [&str; 5 + LEVELS.len()] = {
    let mut names = [
        SURFACE, CYLINDERS, RECTANGLES, NET, CONTROL, "", "", "", "", "", "",
    ];
    let mut level = 0;
    while level < LEVELS.len() {
        names[5 + level] = LEVELS[level];
        level += 1;
    }
    names
};

/// Surfaces in the folder of a row, each read when it is asked for first.
pub(super) struct TSplineSurfaces {
    files: PathBuf,
    loaded: [OnceLock<Result<Tiled, String>>; NAMES.len()],
}

impl TSplineSurfaces {
    /// Returns those in the folder of a row.
    pub(super) fn of(files: &Path) -> Self {
        Self {
            files: files.to_owned(),
            loaded: Default::default(),
        }
    }

    fn surface(&self, name: &str) -> Result<&Tiled, String> {
        let place = NAMES.iter().position(|own| *own == name);
        let place = place.ok_or_else(|| format!("a T-spline has no surface `{name}`"))?;
        let load = || {
            let field = FieldMesh::load(&self.files, name)?;
            let normals = normals(&field.attributes);
            Ok(Tiled { field, normals })
        };
        let loaded = self.loaded[place].get_or_init(load);
        loaded.as_ref().map_err(Clone::clone)
    }
}

impl Source {
    /// Returns the surface that a panel about a T-spline shows.
    pub(super) fn of_t_spline(&self, panel: &Panel) -> Result<&Tiled, String> {
        let found = self.beside_t_spline(panel)?;
        found.ok_or_else(|| NO_PICTURES.to_owned())
    }

    /// The same; nothing for what other methods have too.
    pub(super) fn beside_t_spline(&self, panel: &Panel) -> Result<Option<&Tiled>, String> {
        let name = match panel.show {
            Show::Spline | Show::ControlPoints => SURFACE,
            Show::Checkers => NET,
            Show::Cylinders => CYLINDERS,
            Show::Rectangles => RECTANGLES,
            Show::Level => {
                let level = panel.level.unwrap_or(0);
                let name = LEVELS.get(level);
                name.ok_or_else(|| format!("no level {level}; there are {}", LEVELS.len()))?
            }
            _ => return Ok(None),
        };
        match (&self.t_spline, panel.show) {
            (Some(surfaces), _) => surfaces.surface(name).map(Some),
            (None, Show::Spline | Show::Checkers) => Ok(None),
            (None, _) => Err(NO_PICTURES.to_owned()),
        }
    }

    /// Returns the control points of a panel, and what joins them where its edges are asked for.
    pub(super) fn control_points(&self, panel: &Panel) -> Result<ControlNet<'_>, String> {
        let surfaces = self
            .t_spline
            .as_ref()
            .ok_or_else(|| NO_PICTURES.to_owned())?;
        let control = &surfaces.surface(CONTROL)?.field;
        let sides = match panel.edges {
            Edges::None => &[][..],
            Edges::Domain => &control.lines.edges,
        };
        Ok((&control.mesh, sides))
    }
}

/// Returns what a surface on the way is called: its control points and its largest error.
pub(super) fn label(report: &RowReport, level: usize) -> Option<String> {
    let record = report.result.record()?;
    let number = |what: &str| {
        record
            .checks
            .get(&format!("level_{level}_{what}"))?
            .as_f64()
    };
    let (count, error) = (number("control_points")?, number("max")?);
    Some(format!(
        "{count} control points, max {}",
        Unit::Fraction.show(error)
    ))
}
