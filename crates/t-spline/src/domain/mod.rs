//! The domain of a T-spline: from a form on a mesh to cylinders, and where the mesh lies on them.
//!
//! The imaginary part `v` of the form has integer periods, so that its level sets are closed. Those
//! through zeros of the form cut the surface into maximal cylinders. They are traced on the mesh by
//! comparing whole numbers only; lengths are rounded once, as a flow, so that the tables of a
//! [`CylinderComplex`] hold exactly; then cylinders too thin to carry a row are collapsed.
//!
//! # Notation
//! `g` handles, `b` boundary loops, of which some are what removed stars of *poles* left. There are
//! `2g - 2 + b` zeros, and `3g - 3 + 2b` cylinders if all of them are simple and on different levels. A
//! torus without zeros is one cylinder, cut open at a vertex.
//!
//! # Reference
//! [He2006] §3.2. Deviation: levels are compared in whole numbers and near ones made equal afterwards;
//! lengths along trajectories are rounded as a flow.

mod apart;
mod class;
mod collapse;
mod cylinders;
mod error;
mod extent;
mod form;
mod holes;
mod levels;
mod place;
mod poled;
mod rounding;
mod sheet;
mod tables;
#[cfg(test)]
mod tests;
mod trace;

use msplines_common::mesh::{Facts, TriangleMesh};
use msplines_conformal::FormChoice;
use msplines_conformal::poles::PoleChoice;
use serde::{Deserialize, Serialize};

pub use collapse::SnapOptions;
pub use error::DomainError;
pub use form::{End, PeriodicForm};
pub use place::Patch;

use crate::complex::{Beyond, CylinderComplex, Point, UNITS};
use cylinders::{Chart, Cylinders};
use form::Values;
use levels::{Critical, Levels};
use place::Layout;
use sheet::Sheets;
use trace::CriticalGraph;

/// How a surface is cut into cylinders.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct DomainOptions {
    /// The form of a closed surface of genus >= 1, of integer periods.
    pub form: FormChoice,
    /// Vertices around which cylinders close; their stars are removed.
    pub poles: Vec<u32>,
    /// The form of a surface with boundary loops and poles.
    pub pole_form: PoleChoice,
    /// What counts as thin and near.
    pub snap: SnapOptions,
}

impl Default for DomainOptions {
    fn default() -> Self {
        Self {
            form: FormChoice::integer(0),
            poles: Vec::new(),
            pole_form: PoleChoice::default(),
            snap: SnapOptions::default(),
        }
    }
}

/// A zero of the form.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct DomainZero {
    /// The vertex of the mesh that it lies at.
    pub vertex: u32,
    /// Its order.
    pub order: u32,
}

/// The centre of a pole.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pole {
    /// The vertex of the surface.
    pub vertex: u32,
    /// Its index among the ends.
    pub index: u32,
    /// Where it lies.
    pub at: Point,
    /// The direction of `y` towards it, 1 or -1.
    pub away: f64,
}

/// How far beyond the end of a cylinder the centre of a pole is put, in circumferences: the coordinate of
/// a cap is `exp(-16 pi)` there, below the last digit of 1.
const FAR: f64 = 8.0;

/// Figures about a domain.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct DomainReport {
    /// Number of handles.
    pub genus: u32,
    /// Number of boundary loops and poles.
    pub ends: usize,
    /// Number of boundary loops whose holes were closed: these are no ends.
    pub closed_holes: usize,
    /// Number of zeros, counted by order.
    pub zeros: u32,
    /// Number of cylinders before any was collapsed.
    pub cylinders: usize,
    /// Number of cylinders collapsed.
    pub collapsed: usize,
    /// Number of cylinders that are thin but were not collapsed, because that would leave two zeros in
    /// one place or because they end at a boundary.
    pub thin: usize,
    /// Number of cylinders whose twist was changed.
    pub straightened: usize,
    /// Largest miss of whole periods along an edge.
    pub period_defect: f64,
    /// Largest miss of the trajectories along a border, as a share of its circumference.
    pub closure: f64,
    /// Sum of `C H` over the integral of the area form, less 1, before rounding.
    pub area_defect: f64,
    /// The area of the complex, 1 being the square of a period: `∫ |ω|²`.
    pub energy: f64,
    /// Least height of a cylinder of the complex over the root of its area.
    pub least_height: f64,
}

/// Cylinders, and the mesh that lies on them.
#[derive(Clone, Debug)]
pub struct Domain {
    complex: CylinderComplex,
    sheets: Sheets,
    charts: Vec<Chart>,
    layouts: Vec<Layout>,
    zeros: Vec<DomainZero>,
    ends: Vec<End>,
    origins: Vec<Option<u32>>,
    outside: Vec<u32>,
    form: Vec<[f64; 2]>,
    snap: SnapOptions,
    report: DomainReport,
}

impl Domain {
    /// Cuts a mesh along the critical levels of a form. O(n) for each zero.
    ///
    /// # Errors
    /// A form whose imaginary part has no integer periods, is not constant along a boundary loop, or has
    /// extrema; zeros or cylinders in another number than the topology has; borders that do not close.
    pub fn of_form(given: &PeriodicForm, snap: &SnapOptions) -> Result<Self, DomainError> {
        let values = Values::integrate(given)?;
        let levels = Levels::find(&given.mesh, &values)?;
        let sheets = Sheets::build(given, values, levels);
        let graph = CriticalGraph::trace(&sheets)?;
        let real = Cylinders::unite(&sheets, &graph)?;
        let snapped = collapse::snap(rounding::round(&sheets, &real)?, snap);
        let mut next = 0..;
        let names: Vec<Option<u32>> = (snapped.collapsed.iter())
            .map(|rows| rows.is_none().then(|| next.next()).flatten())
            .collect();
        let complex = snapped.tables.complex(&names, &given.ends)?;
        let zeros = zeros(&sheets.levels);
        let area = complex.area() as f64;
        let heights = complex
            .cylinders()
            .iter()
            .map(|c| c.height as f64 / area.sqrt());
        let heights: Vec<f64> = heights.collect();
        let facts = Facts::measure(&given.mesh);
        let report = DomainReport {
            genus: facts.genus.unwrap_or(0),
            ends: given.ends.len(),
            closed_holes: 0,
            zeros: zeros.iter().map(|zero| zero.order).sum(),
            cylinders: real.cylinders.len(),
            collapsed: snapped.collapsed.iter().flatten().count(),
            thin: heights.iter().filter(|&&height| height < snap.thin).count(),
            straightened: snapped.shears.iter().filter(|&&shear| shear != 0).count(),
            period_defect: sheets.values.defect,
            closure: real.closure,
            area_defect: real.area_defect,
            energy: area / (UNITS * UNITS),
            least_height: heights.iter().copied().fold(f64::INFINITY, f64::min),
        };
        Ok(Self {
            layouts: place::layouts(&sheets, &real, &snapped, &names),
            complex,
            charts: real.charts,
            origins: (0..given.mesh.vertex_count() as u32).map(Some).collect(),
            outside: Vec::new(),
            sheets,
            zeros,
            ends: given.ends.clone(),
            form: given.form.clone(),
            snap: *snap,
            report,
        })
    }

    /// Returns the cylinders.
    #[must_use]
    pub fn complex(&self) -> &CylinderComplex {
        &self.complex
    }

    /// Returns the mesh that lies on the cylinders: that of the surface, with edges flipped and faces
    /// split where that was needed, without the stars of poles.
    #[must_use]
    pub fn mesh(&self) -> &TriangleMesh {
        &self.sheets.mesh
    }

    /// Returns, for each vertex of [`Self::mesh`], the vertex of the surface that it is; nothing for
    /// added ones.
    #[must_use]
    pub fn origins(&self) -> &[Option<u32>] {
        &self.origins
    }

    /// Returns the zeros, by the numbers that the complex names them by.
    #[must_use]
    pub fn zeros(&self) -> &[DomainZero] {
        &self.zeros
    }

    /// Returns what lies beyond each boundary loop of [`Self::mesh`], by the numbers that the complex
    /// names boundaries and poles by.
    #[must_use]
    pub fn ends(&self) -> &[End] {
        &self.ends
    }

    /// Returns the form that the mesh was cut by: [`Self::of_form`] makes the same domain of it, with
    /// [`Self::snap`], but for the names of the vertices. O(n).
    #[must_use]
    pub fn form(&self) -> PeriodicForm {
        PeriodicForm {
            mesh: self.mesh().clone(),
            form: self.form.clone(),
            ends: self.ends.clone(),
        }
    }

    /// Returns what counted as thin and near.
    #[must_use]
    pub fn snap(&self) -> &SnapOptions {
        &self.snap
    }

    /// Returns the domain with other names of its vertices, as [`Self::origins`] has them.
    ///
    /// # Panics
    /// If there is not one per vertex of the mesh.
    #[must_use]
    pub fn with_origins(self, origins: Vec<Option<u32>>) -> Self {
        let vertices = self.mesh().vertex_count();
        assert_eq!(origins.len(), vertices, "one origin per vertex");
        Self { origins, ..self }
    }

    /// Returns the centre of every pole and the vertex of the surface that it is. It lies beyond the end of
    /// its cylinder, as far as makes no difference.
    #[must_use]
    pub fn poles(&self) -> Vec<Pole> {
        let mut poles = Vec::new();
        for (cylinder, own) in (0..).zip(self.complex.cylinders()) {
            let [size, height] = [own.circumference, own.height].map(|n| n as f64);
            let borders = [
                (&own.bottom, -FAR * size, -1.0),
                (&own.top, height + FAR * size, 1.0),
            ];
            for (border, y, away) in borders {
                let Some(Beyond::Pole { index }) = border.first().map(|s| s.beyond) else {
                    continue;
                };
                let End::Pole(vertex) = self.ends[index as usize] else {
                    continue;
                };
                let at = Point {
                    cylinder,
                    x: 0.0,
                    y,
                };
                poles.push(Pole {
                    vertex,
                    index,
                    at,
                    away,
                });
            }
        }
        poles.sort_by_key(|pole| pole.index);
        poles
    }

    /// Returns figures about the domain.
    #[must_use]
    pub fn report(&self) -> &DomainReport {
        &self.report
    }
}

/// Zeros in the order of their levels, which is that of their numbers.
fn zeros(levels: &Levels) -> Vec<DomainZero> {
    let zero = |critical: &Critical| match *critical {
        Critical::Zero { vertex, order } if order > 0 => Some(DomainZero { vertex, order }),
        _ => None,
    };
    levels.critical.iter().filter_map(zero).collect()
}
