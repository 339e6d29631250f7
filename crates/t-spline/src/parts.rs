//! A surface as plain numbers, as spline files hold them.

use std::sync::Arc;

use msplines_common::Vector3;
use msplines_common::mesh::TriangleMesh;
use serde::{Deserialize, Serialize};

use crate::caps::{CapOptions, Caps, CapsError};
use crate::domain::{Domain, DomainError, End, PeriodicForm, SnapOptions};
use crate::fit::Level;
use crate::space::TSplineSpace;
use crate::spline::TSpline;
use crate::surface::TSplineSurface;
use crate::tmesh::{Axis, Grid, TMesh, TMeshError};

/// The numbers of a surface besides those of its mesh.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SurfaceParts {
    /// The form, by half-edge of the mesh.
    pub form: Vec<[f64; 2]>,
    /// What lies beyond each boundary loop of the mesh.
    pub ends: Vec<End>,
    /// What counted as thin and near.
    pub snap: SnapOptions,
    /// The vertex of the input that each vertex of the mesh is; nothing for added ones.
    pub origins: Vec<Option<u32>>,
    /// The faces of the mesh that close holes, in order: they are no part of the surface.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub outside: Vec<u32>,
    /// How far each vertex has moved, in units.
    pub shifts: Vec<[f64; 2]>,
    /// The base grid of each cylinder.
    pub grids: Vec<Grid>,
    /// The splits of leaves, in order.
    pub splits: Vec<(u32, Axis)>,
    /// Degrees of the caps.
    pub caps: CapOptions,
    /// Radius of each cap.
    pub radii: Vec<f64>,
    /// Control points, then coefficients of caps.
    pub control: Vec<[f64; 3]>,
    /// Coarser surfaces on the way to this one, the coarsest first.
    #[serde(default)]
    pub levels: Vec<LevelParts>,
}

/// The numbers of a coarser surface on the way to another one: its T-mesh begins with the same splits.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LevelParts {
    /// How many of the splits it has.
    pub splits: usize,
    /// Radius of each of its caps.
    pub radii: Vec<f64>,
    /// Its control points, then coefficients of caps.
    pub control: Vec<[f64; 3]>,
}

/// Every leaf of a T-mesh has about one function, and caps take some of them away; with this many cells of
/// base grids for each control vector memory stays in proportion to the file.
const CELLS_PER_CONTROL: u128 = 16;

/// Numbers that are no surface over a mesh.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PartsError {
    /// The form does not cut the mesh into cylinders.
    #[error("the form of the mesh: {0}")]
    Domain(#[from] DomainError),
    /// Base grids that fit no cylinders.
    #[error("the T-mesh: {0}")]
    TMesh(#[from] TMeshError),
    /// Caps that do not fit.
    #[error("the caps: {0}")]
    Caps(#[from] CapsError),
    /// Base grids of more cells than the control vectors can be of.
    #[error(
        "base grids of {cells} cells for {control} control vectors; they are damaged, fit again"
    )]
    Grids {
        /// Number of cells.
        cells: u128,
        /// Number of control vectors.
        control: usize,
    },
    /// A split of a leaf that is not there, or cannot be split.
    #[error("split {index} is of leaf {leaf}, which is not there or too narrow")]
    Split {
        /// The split.
        index: usize,
        /// The leaf.
        leaf: u32,
    },
    /// Numbers in another count than the surface needs.
    #[error("there are {given} {what} where {needed} are needed")]
    Count {
        /// What is counted.
        what: &'static str,
        /// How many there are.
        given: usize,
        /// How many there should be.
        needed: usize,
    },
    /// A level that is not there.
    #[error(
        "there is no level {level}: the levels are 0, the coarsest, to {last}, the surface itself"
    )]
    Level {
        /// What was asked for.
        level: usize,
        /// The finest one.
        last: usize,
    },
    /// A number that is not finite, a radius that is not positive, or a face out of order.
    #[error("number {index} of the {what} is not finite, or out of range")]
    Number {
        /// Which numbers.
        what: &'static str,
        /// The first.
        index: usize,
    },
}

fn listed(control: &[Vector3<f64>]) -> Vec<[f64; 3]> {
    control.iter().map(|c| [c.x, c.y, c.z]).collect()
}

impl SurfaceParts {
    /// Returns the numbers with those of the surfaces of a fit on the way to this one, without the last,
    /// which this one is.
    ///
    /// # Panics
    /// If a level is no prefix of another one's splits: those of one fit are.
    #[must_use]
    pub fn with_levels(self, levels: &[Level]) -> Self {
        let coarser = &levels[..levels.len().saturating_sub(1)];
        let part = |level: &Level| {
            let space = level.spline.space();
            let splits = space.mesh().splits();
            assert!(self.splits.starts_with(splits), "levels of one fit");
            LevelParts {
                splits: splits.len(),
                radii: space.caps().caps().iter().map(|cap| cap.radius).collect(),
                control: listed(level.spline.control()),
            }
        };
        let levels = coarser.iter().map(part).collect();
        Self { levels, ..self }
    }

    /// Returns the numbers of a level, with those of all coarser ones: 0 is the coarsest, and the last the
    /// surface itself. Vertices are where they lie on that.
    ///
    /// # Errors
    /// A level that is not there, or has more splits than the surface.
    pub fn at_level(&self, level: usize) -> Result<Self, PartsError> {
        let last = self.levels.len();
        if level == last {
            return Ok(self.clone());
        }
        let found = self.levels.get(level);
        let found = found.ok_or(PartsError::Level { level, last })?;
        let splits = self.splits.get(..found.splits);
        let splits = splits.ok_or(PartsError::Count {
            what: "splits",
            given: self.splits.len(),
            needed: found.splits,
        })?;
        Ok(Self {
            splits: splits.to_vec(),
            radii: found.radii.clone(),
            control: found.control.clone(),
            levels: self.levels[..level].to_vec(),
            ..self.clone()
        })
    }
}

impl TSplineSurface {
    /// Returns the numbers of the surface, besides those of [`Domain::mesh`].
    ///
    /// `caps` are the options that its space was built with.
    #[must_use]
    pub fn parts(&self, caps: &CapOptions) -> SurfaceParts {
        let (domain, space) = (self.domain(), self.spline().space());
        SurfaceParts {
            form: domain.form().form,
            ends: domain.ends().to_vec(),
            snap: *domain.snap(),
            origins: domain.origins().to_vec(),
            outside: domain.outside().to_vec(),
            shifts: self.shifts().to_vec(),
            grids: space.mesh().grids().to_vec(),
            splits: space.mesh().splits().to_vec(),
            caps: *caps,
            radii: space.caps().caps().iter().map(|cap| cap.radius).collect(),
            control: listed(self.spline().control()),
            levels: Vec::new(),
        }
    }

    /// Returns the surface of numbers over its mesh: the same bits as before.
    ///
    /// # Errors
    /// Numbers that are no surface over this mesh.
    pub fn from_parts(mesh: TriangleMesh, parts: &SurfaceParts) -> Result<Self, PartsError> {
        check_finite(parts)?;
        let vertices = mesh.vertex_count();
        check_count("origins", parts.origins.len(), vertices)?;
        check_count("shifts", parts.shifts.len(), vertices)?;
        check_outside(&parts.outside, mesh.face_count())?;
        let given = PeriodicForm {
            mesh,
            form: parts.form.clone(),
            ends: parts.ends.clone(),
        };
        check_grids(&parts.grids, parts.control.len())?;
        let domain = Domain::of_form(&given, &parts.snap)?
            .with_origins(parts.origins.clone())
            .with_outside(parts.outside.clone());
        let mut tmesh = TMesh::build(&Arc::new(domain.complex().clone()), &parts.grids)?;
        for (index, &(leaf, axis)) in parts.splits.iter().enumerate() {
            if leaf as usize >= tmesh.leaves().len() || !tmesh.split(leaf, axis) {
                return Err(PartsError::Split { index, leaf });
            }
        }
        let mut caps = Caps::build(domain.complex(), &parts.caps)?;
        check_count("radii", parts.radii.len(), caps.caps().len())?;
        for (cap, &radius) in (0..).zip(&parts.radii) {
            caps.set_radius(cap, radius);
        }
        let space = Arc::new(TSplineSpace::with_caps(tmesh, caps));
        check_count("control vectors", parts.control.len(), space.unknowns())?;
        let control = parts.control.iter().map(|&c| Vector3::from(c)).collect();
        Ok(Self::new(
            domain,
            parts.shifts.clone(),
            TSpline::new(space, control),
        ))
    }
}

/// Refuses grids that would take memory out of proportion to the numbers there are.
fn check_grids(grids: &[Grid], control: usize) -> Result<(), PartsError> {
    let of = |grid: &Grid| grid.columns as u128 * grid.rows as u128;
    let cells = grids.iter().map(of).fold(0, u128::saturating_add);
    if cells <= CELLS_PER_CONTROL * (control as u128 + 1) {
        return Ok(());
    }
    Err(PartsError::Grids { cells, control })
}

fn check_count(what: &'static str, given: usize, needed: usize) -> Result<(), PartsError> {
    if given == needed {
        return Ok(());
    }
    Err(PartsError::Count {
        what,
        given,
        needed,
    })
}

fn check_outside(outside: &[u32], faces: usize) -> Result<(), PartsError> {
    let is_wrong =
        |&i: &usize| outside[i] as usize >= faces || i > 0 && outside[i] <= outside[i - 1];
    (0..outside.len()).find(is_wrong).map_or(Ok(()), |index| {
        let what = "faces outside";
        Err(PartsError::Number { what, index })
    })
}

fn check_finite(parts: &SurfaceParts) -> Result<(), PartsError> {
    let finite = |x: &f64| x.is_finite();
    let bad = [
        (
            "form",
            parts.form.iter().position(|v| !v.iter().all(finite)),
        ),
        (
            "shifts",
            parts.shifts.iter().position(|v| !v.iter().all(finite)),
        ),
        (
            "radii",
            parts
                .radii
                .iter()
                .position(|r| !(*r > 0.0 && r.is_finite())),
        ),
        (
            "control vectors",
            parts.control.iter().position(|v| !v.iter().all(finite)),
        ),
    ];
    let found = bad
        .into_iter()
        .find_map(|(what, index)| Some((what, index?)));
    found.map_or(Ok(()), |(what, index)| {
        Err(PartsError::Number { what, index })
    })
}

#[cfg(test)]
mod tests {
    use msplines_common::evaluate::Order;
    use msplines_common::mesh::shapes;
    use msplines_common::progress::unobserved;

    use super::*;
    use crate::domain::DomainOptions;
    use crate::fit::{FitOptions, FittedSurface, Sampling, Stop};

    fn surface(mesh: &TriangleMesh, poles: Vec<u32>) -> TSplineSurface {
        fitted(mesh, poles).surface
    }

    fn fitted(mesh: &TriangleMesh, poles: Vec<u32>) -> FittedSurface {
        let options = DomainOptions {
            poles,
            ..DomainOptions::default()
        };
        let domain = Domain::of_surface(mesh, &options, &mut unobserved()).expect("a domain");
        let options = FitOptions {
            stop: Stop::ControlPoints(400),
            ..FitOptions::default()
        };
        let sampling = Sampling::default();
        let fitted = TSplineSurface::fit(domain, mesh, &sampling, &options, &mut unobserved());
        fitted.expect("a surface")
    }

    #[test]
    fn every_level_is_that_of_the_fit_to_the_bit() {
        let sphere = shapes::sphere(900);
        for (mesh, poles) in [(shapes::genus(2, 2000), Vec::new()), (sphere, vec![0, 400])] {
            let fitted = fitted(&mesh, poles);
            let (given, levels) = (fitted.surface, fitted.levels);
            let parts = given.parts(&CapOptions::default()).with_levels(&levels);
            assert!(levels.len() > 2 && parts.levels.len() + 1 == levels.len());
            for (index, level) in levels.iter().enumerate() {
                let coarse = parts.at_level(index).expect("a level");
                assert_eq!(coarse.levels, parts.levels[..index]);
                let own = given.domain().mesh().clone();
                let read = TSplineSurface::from_parts(own, &coarse).expect("a surface");
                assert_eq!(*read.spline(), level.spline);
                assert_eq!(read.shifts(), given.shifts());
            }
            let beyond = parts.at_level(levels.len()).expect_err("no such level");
            let last = levels.len() - 1;
            assert!(
                beyond
                    .to_string()
                    .ends_with(&format!("to {last}, the surface itself"))
            );
        }
    }

    #[test]
    fn numbers_give_the_same_surface_to_the_bit() {
        let sphere = shapes::sphere(900);
        for (mesh, poles) in [
            (shapes::genus(2, 2000), Vec::new()),
            (sphere.clone(), vec![0, 400]),
        ] {
            let given = surface(&mesh, poles);
            let parts = given.parts(&CapOptions::default());
            let own = given.domain().mesh().clone();
            let read = TSplineSurface::from_parts(own, &parts).expect("a surface");
            assert_eq!(read.vertices(), given.vertices());
            assert_eq!(read.spline(), given.spline());
            assert_eq!(read.parts(&CapOptions::default()), parts);
        }
    }

    #[test]
    fn surfaces_close_at_their_poles() {
        let mesh = shapes::sphere(900);
        let surface = surface(&mesh, vec![0, 400]);
        let shown = surface.tessellate(3).expect("triangles");
        let closed = TriangleMesh::build(shown.positions.clone(), shown.faces).expect("a mesh");
        assert_eq!(closed.topology().boundary_loops().len(), 0);
        let poles = surface.domain().poles();
        let centres = surface.domain().mesh().vertex_count()..;
        for (pole, centre) in poles.iter().zip(centres) {
            let there = surface
                .spline()
                .evaluate(&[pole.at], Order::Value)
                .positions[0];
            assert_eq!(there, shown.positions[centre]);
            // The radius is 1: the polynomial of the cap goes on over the star that was removed.
            assert!((there.coords.norm() - 1.0).abs() < 0.01, "{there}");
        }
    }

    #[test]
    fn damaged_numbers_are_refused_by_name() {
        let mesh = shapes::torus(1.0, 0.4, 900);
        let given = surface(&mesh, Vec::new());
        let parts = given.parts(&CapOptions::default());
        let refusal = |change: &dyn Fn(&mut SurfaceParts)| {
            let mut damaged = parts.clone();
            change(&mut damaged);
            let error = TSplineSurface::from_parts(mesh.clone(), &damaged);
            error.expect_err("damaged numbers").to_string()
        };
        let control = refusal(&|p| {
            p.control.pop();
        });
        assert!(control.contains("control vectors where"), "{control}");
        let leaf = refusal(&|p| p.splits.push((90_000, Axis::X)));
        assert!(leaf.contains("leaf 90000"), "{leaf}");
        let number = refusal(&|p| p.shifts[7][1] = f64::NAN);
        assert!(number.contains("number 7 of the shifts"), "{number}");
        // As large as a number can be, so that products overflow, and as memory could still be tried for.
        for [columns, rows] in [
            [usize::MAX; 2],
            [1 << 61, 1],
            [1, 1 << 40],
            [1 << 20, 1 << 10],
        ] {
            let grids = refusal(&|p| p.grids[0] = Grid { columns, rows });
            assert!(grids.contains("base grids of"), "{grids}");
        }
        let form = refusal(&|p| p.form[3][1] += 0.25);
        assert!(form.contains("whole periods"), "{form}");
    }
}
