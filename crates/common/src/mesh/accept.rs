//! From a polygon soup to a mesh: refuse what is broken, or repair it.

use super::defect::{Defect, Remedy};
use super::preflight::preflight;
use super::repair::Sheet;
use super::repairs::{Log, Repair};
use super::soup::{PolygonSoup, VertexAttribute};
use super::topology::TopologyError;
use super::triangle::TriangleMesh;

/// What to do about defects.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Policy {
    /// Refuse a soup with any defect.
    #[default]
    Refuse,
    /// Mend what can be mended, and say what was done.
    Repair,
}

/// A mesh, and how it came from its soup.
#[derive(Clone, Debug)]
pub struct Accepted {
    /// The mesh.
    pub mesh: TriangleMesh,
    /// What was done to the soup.
    pub repairs: Vec<Repair>,
    /// Input vertex of each vertex of the mesh.
    pub vertex_origin: Vec<u32>,
    /// Attributes of the soup, by vertices of the mesh.
    pub attributes: Vec<VertexAttribute>,
}

/// Why a soup did not become a mesh.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PreflightError {
    /// The soup has defects and the policy is to refuse them.
    #[error("{}", refusal(.first, *.count))]
    Defects {
        /// The first defects.
        first: Vec<Defect>,
        /// How many there are.
        count: usize,
    },
    /// Nothing is left of the soup after repair.
    #[error("no usable face is left of {faces} after repair; check how the file was written")]
    NothingLeft {
        /// Number of faces in the soup.
        faces: usize,
    },
    /// The surface has only one side, or would once coincident edges are joined.
    #[error("{defect}; repair cannot mend this: {}", .defect.remedy_text())]
    NotOrientable {
        /// The defect, by input ids.
        defect: Defect,
    },
    /// An attribute does not have one value per vertex.
    #[error("attribute {name} has {values} values for {vertices} vertices")]
    AttributeLength {
        /// Name of the attribute.
        name: String,
        /// Number of its values.
        values: usize,
        /// Number of vertices.
        vertices: usize,
    },
    /// The triangles that polygons were cut into do not fit together.
    #[error("the faces do not form a surface once cut into triangles: {0}; give triangles instead")]
    Triangles(#[from] TopologyError),
}

/// How many defects an error lists.
const LISTED: usize = 5;

/// Rounds after which repair gives up; each one but the last changes something, and dropping
/// a component may let edges join that could not before.
const MOST_ROUNDS: usize = 64;

/// Returns the mesh of a soup.
///
/// Polygons are cut into triangles under either policy. [`Policy::Refuse`] keeps every vertex and
/// its id. [`Policy::Repair`] drops faces that cannot be used, removes faces of no area, drops
/// duplicate faces, joins boundary edges that coincide exactly, cuts along edges of more than two
/// faces, splits bow-tie vertices, keeps the component of most faces, orients faces alike (outwards
/// if closed) and drops unused vertices, until nothing is left to do: repairing the result again
/// changes nothing. Cost: O(n log n) for each of, usually, two rounds.
///
/// # Errors
/// The defects, if the policy refuses them or repair cannot mend them.
///
/// # Panics
/// If the face offsets of the soup do not ascend within its corners.
pub fn accept(soup: &PolygonSoup, policy: Policy) -> Result<Accepted, PreflightError> {
    let vertices = soup.positions.len();
    if let Some(odd) = soup.attributes.iter().find(|a| a.values.len() != vertices) {
        let (name, values) = (odd.name.clone(), odd.values.len());
        return Err(PreflightError::AttributeLength {
            name,
            values,
            vertices,
        });
    }
    let mut log = Log::default();
    let sheet = match policy {
        Policy::Refuse => checked(soup, &mut log)?,
        Policy::Repair => repaired(soup, &mut log)?,
    };
    let pick = |attribute: &VertexAttribute| VertexAttribute {
        name: attribute.name.clone(),
        values: sheet
            .vertex_origin
            .iter()
            .map(|&v| attribute.values[v as usize])
            .collect(),
    };
    let attributes = soup.attributes.iter().map(pick).collect();
    let mesh = TriangleMesh::build(sheet.positions(), sheet.faces)?;
    Ok(Accepted {
        mesh,
        repairs: log.repairs(),
        vertex_origin: sheet.vertex_origin,
        attributes,
    })
}

fn checked<'a>(soup: &'a PolygonSoup, log: &mut Log) -> Result<Sheet<'a>, PreflightError> {
    let mut defects = preflight(soup).defects;
    if defects.is_empty() {
        return Ok(Sheet::new(soup, log));
    }
    let count = defects.len();
    // What repair cannot mend comes first: it decides what the user has to do.
    defects.sort_by_key(|defect| defect.remedy() == Remedy::Repair);
    defects.truncate(LISTED);
    Err(PreflightError::Defects {
        first: defects,
        count,
    })
}

fn repaired<'a>(soup: &'a PolygonSoup, log: &mut Log) -> Result<Sheet<'a>, PreflightError> {
    if soup.face_count() == 0 {
        let first = vec![Defect::NoFace {
            vertices: soup.positions.len(),
        }];
        return Err(PreflightError::Defects { first, count: 1 });
    }
    let mut sheet = Sheet::new(soup, log);
    let mut rounds = 0;
    while sheet.repair_round(log) && rounds < MOST_ROUNDS {
        rounds += 1;
    }
    if sheet.faces.is_empty() {
        return Err(PreflightError::NothingLeft {
            faces: soup.face_count(),
        });
    }
    if let Err((edge, faces)) = sheet.orient(log) {
        let defect = Defect::NotOrientable { edge, faces };
        return Err(PreflightError::NotOrientable { defect });
    }
    sheet.log_dropped_vertices(log);
    Ok(sheet)
}

fn refusal(first: &[Defect], count: usize) -> String {
    let places: Vec<String> = first.iter().map(Defect::to_string).collect();
    let more = count - first.len();
    let more = if more > 0 {
        format!("; and {more} more defects")
    } else {
        String::new()
    };
    let remedy = match first
        .iter()
        .find(|defect| defect.remedy() == Remedy::Author)
    {
        Some(defect) => defect.remedy_text().to_owned(),
        None if count == 1 => first[0].remedy_text().to_owned(),
        None => "mend them with --repair".to_owned(),
    };
    format!("the mesh is broken: {}{more}; {remedy}", places.join("; "))
}
