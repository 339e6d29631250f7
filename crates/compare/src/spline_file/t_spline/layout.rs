//! The mesh on the cylinders, as what differs from the mesh of the file.

use msplines_common::Point3;
use msplines_common::mesh::TriangleMesh;
use serde::{Deserialize, Serialize};

use crate::error::SplineFileError;
use crate::spline_file::StoredMesh;

/// A mesh that was made of another one: edges flipped, faces split, stars of poles removed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StoredLayout {
    /// Runs of vertices: the first one of the input and how many follow on it, or how many are added.
    pub vertices: Vec<(Option<u32>, u32)>,
    /// Positions of those that are added; of all if an old one has another position.
    pub positions: Vec<[f64; 3]>,
    /// Runs of faces.
    pub faces: Vec<FaceRun>,
}

/// Faces that follow each other.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum FaceRun {
    /// Those of the input: the first one, and how many; runs ascend.
    Input(u32, u32),
    /// Others, by vertices of this mesh.
    Own(Vec<[u32; 3]>),
}

impl StoredLayout {
    /// Returns what a mesh differs from another one by; `origins` says which vertex of that each is.
    #[must_use]
    pub fn of(own: &TriangleMesh, origins: &[Option<u32>], input: &TriangleMesh) -> Self {
        let bits = |p: &Point3<f64>| [p.x, p.y, p.z].map(f64::to_bits);
        let stays = |(origin, position): (&Option<u32>, &Point3<f64>)| {
            let old = origin.and_then(|v| input.positions().get(v as usize));
            old.is_none_or(|old| bits(old) == bits(position))
        };
        let all = !origins.iter().zip(own.positions()).all(stays);
        let listed = origins.iter().zip(own.positions());
        let listed = listed.filter(|(origin, _)| all || origin.is_none());
        Self {
            vertices: vertex_runs(origins),
            positions: listed.map(|(_, p)| [p.x, p.y, p.z]).collect(),
            faces: face_runs(own, origins, input),
        }
    }

    /// Returns what a whole mesh in an older file is.
    #[must_use]
    pub fn whole(mesh: StoredMesh, origins: &[Option<u32>]) -> Self {
        Self {
            vertices: vertex_runs(origins),
            positions: mesh.positions,
            faces: vec![FaceRun::Own(mesh.faces)],
        }
    }

    /// Returns the mesh, and which vertex of the input each of its vertices is.
    ///
    /// # Errors
    /// Runs that name what the input does not have, or no manifold.
    pub fn restore(
        &self,
        input: &TriangleMesh,
    ) -> Result<(TriangleMesh, Vec<Option<u32>>), SplineFileError> {
        let (origins, added) = self.origins(input.vertex_count())?;
        let positions = self.placed(input, &origins, added)?;
        let faces = self.all_faces(input, &origins)?;
        if faces == input.faces() && positions == input.positions() {
            return Ok((input.clone(), origins));
        }
        Ok((TriangleMesh::build(positions, faces)?, origins))
    }

    /// Returns the origins and how many vertices have none.
    fn origins(&self, vertices: usize) -> Result<(Vec<Option<u32>>, usize), SplineFileError> {
        let (mut origins, mut old, mut added) = (Vec::new(), 0_usize, 0_usize);
        for &(first, count) in &self.vertices {
            let Some(first) = first else {
                added += count as usize;
                if added > self.positions.len() {
                    return Err(SplineFileError::Layout {
                        what: "added vertices",
                    });
                }
                origins.extend((0..count).map(|_| None));
                continue;
            };
            old += count as usize;
            let end = u64::from(first) + u64::from(count);
            if end > vertices as u64 {
                let vertex = u32::try_from(end - 1).unwrap_or(u32::MAX);
                return Err(SplineFileError::NoSuchVertex { vertex, vertices });
            }
            if old > vertices {
                return Err(SplineFileError::Layout { what: "vertices" });
            }
            origins.extend((first..first + count).map(Some));
        }
        Ok((origins, added))
    }

    fn placed(
        &self,
        input: &TriangleMesh,
        origins: &[Option<u32>],
        added: usize,
    ) -> Result<Vec<Point3<f64>>, SplineFileError> {
        let finite = |p: &[f64; 3]| p.iter().all(|x| x.is_finite());
        if let Some(index) = self.positions.iter().position(|p| !finite(p)) {
            let what = "position";
            return Err(SplineFileError::NotFinite { what, index });
        }
        let mut given = self.positions.iter().map(|&p| Point3::from(p));
        if self.positions.len() == origins.len() {
            return Ok(given.collect());
        }
        if self.positions.len() != added {
            return Err(SplineFileError::Layout { what: "positions" });
        }
        let place = |origin: &Option<u32>| match origin {
            Some(v) => Some(input.positions()[*v as usize]),
            None => given.next(),
        };
        let placed: Option<Vec<Point3<f64>>> = origins.iter().map(place).collect();
        placed.ok_or(SplineFileError::Layout { what: "positions" })
    }

    fn all_faces(
        &self,
        input: &TriangleMesh,
        origins: &[Option<u32>],
    ) -> Result<Vec<[u32; 3]>, SplineFileError> {
        let names = named(origins, input.vertex_count());
        let (mut faces, mut from) = (Vec::new(), 0);
        for run in &self.faces {
            let (first, count) = match run {
                FaceRun::Own(own) => {
                    faces.extend_from_slice(own);
                    continue;
                }
                FaceRun::Input(first, count) => (*first as usize, *count as usize),
            };
            let run = input.faces().get(first..first.saturating_add(count));
            let run = run.filter(|_| first >= from);
            let run = run.ok_or(SplineFileError::Layout { what: "faces" })?;
            faces.extend(run.iter().map(|face| face.map(|v| names[v as usize])));
            from = first + count;
        }
        Ok(faces)
    }
}

fn vertex_runs(origins: &[Option<u32>]) -> Vec<(Option<u32>, u32)> {
    let mut runs: Vec<(Option<u32>, u32)> = Vec::new();
    for &origin in origins {
        let follows = |first: Option<u32>, count: u32| match first {
            // A damaged file may name the last number there is.
            Some(first) => origin.is_some() && first.checked_add(count) == origin,
            None => origin.is_none(),
        };
        match runs.last_mut() {
            Some((first, count)) if follows(*first, *count) => *count += 1,
            _ => runs.push((origin, 1)),
        }
    }
    runs
}

/// Returns the vertex of this mesh that each vertex of the input is; none, as a number that is no vertex.
fn named(origins: &[Option<u32>], vertices: usize) -> Vec<u32> {
    let mut names = vec![u32::MAX; vertices];
    for (own, origin) in (0..).zip(origins) {
        if let Some(name) = origin.and_then(|v| names.get_mut(v as usize)) {
            *name = own;
        }
    }
    names
}

fn face_runs(own: &TriangleMesh, origins: &[Option<u32>], input: &TriangleMesh) -> Vec<FaceRun> {
    let names = named(origins, input.vertex_count());
    let renamed = |face: usize| input.faces()[face].map(|v| names[v as usize]);
    let (mut runs, mut next): (Vec<FaceRun>, usize) = (Vec::new(), 0);
    for face in own.faces() {
        // Faces that were removed are passed over, faces that were changed are not looked for.
        let removed = |f: &usize| renamed(*f).contains(&u32::MAX);
        while next < input.face_count() && removed(&next) {
            next += 1;
        }
        let same = next < input.face_count() && renamed(next) == *face;
        match (runs.last_mut(), same) {
            (Some(FaceRun::Input(first, count)), true) if (*first + *count) as usize == next => {
                *count += 1;
            }
            (_, true) => runs.push(FaceRun::Input(next as u32, 1)),
            (Some(FaceRun::Own(faces)), false) => faces.push(*face),
            (_, false) => runs.push(FaceRun::Own(vec![*face])),
        }
        // A changed face stands where the old one did.
        next += 1;
    }
    runs
}
