//! The fit over an atlas.

use msplines_common::mesh::{TopologyError, TriangleMesh};
use msplines_common::progress::{Observer, Progress};
use msplines_conformal::{Atlas, Zero};
use serde::{Deserialize, Serialize};

use super::PowellSabinSurface;
use super::chart::Reach;
use super::error::{SurfaceError, SurfaceWarning};
use super::hole::{Cap, Hole};
use super::minimal::{MinimalCap, Relaxed, Rim};
use super::options::{Fill, SurfaceOptions};
use super::part::Part;
use super::smooth::{Around, SmoothCap};
use crate::domain::FlatDomain;
use crate::error::FitError;
use crate::fit::{Report, VertexCondition, fit};

/// A surface and how it was found.
#[derive(Clone, Debug)]
pub struct SurfaceFit {
    /// The surface.
    pub spline: PowellSabinSurface,
    /// How the fit went.
    pub report: SurfaceReport,
}

/// How a fit over an atlas went.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SurfaceReport {
    /// The fit away from the zeros. Its warnings are among [`Self::warnings`].
    pub regular: Report,
    /// How each hole was filled.
    pub holes: Vec<HoleReport>,
    /// What the result should be read with; vertices are those of the whole mesh.
    pub warnings: Vec<SurfaceWarning>,
}

/// How a hole was filled.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct HoleReport {
    /// Order of the zero.
    pub order: i32,
    /// Its first vertex.
    pub vertex: u32,
    /// Faces that were cut out.
    pub faces: usize,
    /// What fills them.
    pub filled: Filled,
}

/// What fills a hole.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Filled {
    /// Nothing.
    Open,
    /// A spline in a chart of its own.
    Smooth {
        /// How far its chart goes.
        reach: Reach,
        /// Vertices that the spline inside passes inside out.
        violations: usize,
    },
    /// A surface of small area.
    Minimal {
        /// Rounds in which the area was decreased.
        rounds: u32,
        /// Its area.
        area: f64,
    },
}

/// Returns the fairest surface over an atlas that does at every vertex of `atlas.mesh()` what
/// `conditions` say, with its holes filled.
///
/// `observer` sees the phases `fit` and `caps`; a break leaves holes open. The cost is that of the fit
/// of the regular part, and a small fit per hole.
///
/// # Reference
/// [He2005] §3.3. Deviation: holes are filled smoothly unless [`Fill::Minimal`] is asked for.
///
/// # Errors
/// Conditions or options that are no task, an atlas whose regular part is no domain, and what
/// [`fit()`](crate::fit()) refuses.
pub fn fit_surface(
    atlas: &Atlas,
    conditions: &[VertexCondition],
    options: &SurfaceOptions,
    observer: &mut Observer<'_>,
) -> Result<SurfaceFit, SurfaceError> {
    check(atlas, conditions)?;
    let mesh = atlas.mesh();
    let part = regular_part(mesh, atlas.zeros())?;
    let domain = part.mesh(mesh).map_err(|error| pinched(error, &part))?;
    let domain = FlatDomain::build(domain, part.pick_sides(atlas.form()))
        .map_err(|e| SurfaceError::Domain(e.renamed(&part.vertices, &part.faces)))?;
    let regular = fit(&domain, &part.pick(conditions), &options.spline, observer)
        .map_err(|e| e.renamed(&part.vertices))?;
    let around = Around {
        mesh,
        holes: atlas.zeros().len(),
        form: atlas.form(),
        regular: &regular.spline,
        part: &part,
        conditions,
        options,
    };
    let (holes, holes_report, mut warnings) = fill(&around, atlas.zeros(), observer);
    let own = regular.report.warnings.iter().cloned();
    warnings.extend(own.map(|w| SurfaceWarning::Regular(w.renamed(&part.vertices))));
    let form = atlas.form().to_vec();
    let spline = PowellSabinSurface::assemble(mesh.clone(), form, regular.spline, part, holes);
    warnings.extend(folds(&spline));
    Ok(SurfaceFit {
        spline,
        report: SurfaceReport {
            regular: regular.report,
            holes: holes_report,
            warnings,
        },
    })
}

/// Says where a surface turns over.
fn folds(spline: &PowellSabinSurface) -> Option<SurfaceWarning> {
    let faces = spline.folded_faces();
    let corners = faces
        .iter()
        .flat_map(|&f| spline.mesh().faces()[f as usize]);
    let mut vertices: Vec<u32> = corners.collect();
    vertices.sort_unstable();
    vertices.dedup();
    (!faces.is_empty()).then_some(SurfaceWarning::Folded { faces, vertices })
}

fn check(atlas: &Atlas, conditions: &[VertexCondition]) -> Result<(), SurfaceError> {
    let vertices = atlas.mesh().vertex_count();
    if conditions.len() != vertices {
        return Err(SurfaceError::Fit(FitError::DataCount {
            found: conditions.len(),
            vertices,
        }));
    }
    for (vertex, condition) in conditions.iter().enumerate() {
        condition.check(vertex as u32)?;
    }
    let inside = atlas.zeros().iter().flat_map(|zero| &zero.vertices);
    let fixed = |v: &&u32| matches!(conditions[**v as usize], VertexCondition::Fixed { .. });
    inside
        .copied()
        .find(|v| fixed(&v))
        .map_or(Ok(()), |vertex| {
            Err(SurfaceError::GradientInHole { vertex })
        })
}

/// Says where the regular part is no surface.
pub(super) fn pinched(error: TopologyError, part: &Part) -> SurfaceError {
    match error {
        TopologyError::VertexNotManifold { vertex } => SurfaceError::Pinched {
            vertex: part.vertices[vertex as usize],
        },
        other => SurfaceError::Domain(other.into()),
    }
}

/// Returns the faces outside of the holes.
pub(super) fn regular_part(mesh: &TriangleMesh, zeros: &[Zero]) -> Result<Part, SurfaceError> {
    let mut outside = vec![true; mesh.face_count()];
    for &face in zeros.iter().flat_map(|zero| &zero.faces) {
        outside[face as usize] = false;
    }
    let faces = (0..mesh.face_count() as u32).filter(|&f| outside[f as usize]);
    let part = Part::new(mesh, faces.collect());
    if part.faces.is_empty() {
        let faces = mesh.face_count();
        return Err(SurfaceError::NothingLeft { faces });
    }
    Ok(part)
}

type Filling = (Vec<Hole>, Vec<HoleReport>, Vec<SurfaceWarning>);

fn fill(around: &Around<'_>, zeros: &[Zero], observer: &mut Observer<'_>) -> Filling {
    let (mut holes, mut reports, mut warnings) = (Vec::new(), Vec::new(), Vec::new());
    // Caps touch neither holes nor each other.
    let mut taken = vec![false; around.mesh.vertex_count()];
    let mark = |taken: &mut Vec<bool>, zero: &Zero, value: bool| {
        for &face in &zero.faces {
            let corners = around.mesh.faces()[face as usize];
            corners.iter().for_each(|&v| taken[v as usize] = value);
        }
    };
    zeros.iter().for_each(|zero| mark(&mut taken, zero, true));
    let mut open = around.options.fill == Fill::Open;
    for (done, zero) in zeros.iter().enumerate() {
        let step = Progress::new("caps", done as u64, zeros.len() as u64);
        open |= observer(&step).is_break();
        let (cap, filled) = if open {
            (Cap::Open, Filled::Open)
        } else {
            mark(&mut taken, zero, false);
            let found = cap(around, zero, &taken, &mut warnings);
            mark(&mut taken, zero, true);
            if let Cap::Smooth(cap) = &found.0 {
                cap.covered_vertices()
                    .for_each(|v| taken[v as usize] = true);
            }
            found
        };
        reports.push(HoleReport {
            order: zero.order,
            vertex: zero.vertices[0],
            faces: zero.faces.len(),
            filled,
        });
        holes.push(Hole {
            order: zero.order,
            vertices: zero.vertices.clone(),
            faces: zero.faces.clone(),
            cap,
        });
    }
    (holes, reports, warnings)
}

fn cap(
    around: &Around<'_>,
    zero: &Zero,
    taken: &[bool],
    warnings: &mut Vec<SurfaceWarning>,
) -> (Cap, Filled) {
    let vertex = zero.vertices[0];
    if around.options.fill == Fill::Smooth {
        match SmoothCap::fit(around, zero, taken) {
            Ok((cap, own)) => {
                let warned = own.warnings.iter().cloned();
                warnings.extend(warned.map(|warning| SurfaceWarning::Cap {
                    vertex,
                    warning: warning.renamed(cap.vertices()),
                }));
                let filled = Filled::Smooth {
                    reach: cap.reach(),
                    violations: own.violations_after,
                };
                return (Cap::Smooth(Box::new(cap)), filled);
            }
            Err(reason) => warnings.push(SurfaceWarning::MinimalInstead { vertex, reason }),
        }
    }
    let rim = Rim {
        mesh: around.mesh,
        regular: around.regular,
        part: around.part,
    };
    let Some((
        cap,
        Relaxed {
            area,
            rounds,
            settled,
            ..
        },
    )) = MinimalCap::span(&rim, zero)
    else {
        warnings.push(SurfaceWarning::LeftOpen { vertex });
        return (Cap::Open, Filled::Open);
    };
    if !settled {
        warnings.push(SurfaceWarning::MinimalUnsettled { vertex, area });
    }
    (
        Cap::Minimal(Box::new(cap)),
        Filled::Minimal { rounds, area },
    )
}
