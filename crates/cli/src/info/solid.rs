//! What a file of tetrahedra holds, and every defect of it.

use std::fmt::Write as _;

use msplines_common::mesh::Policy;
use msplines_common::mesh::tet::{TetFacts, TetSoup, accept, preflight};
use serde::Serialize;

use super::SCHEMA;

/// What is said about a file.
#[derive(Debug, Serialize)]
pub(super) struct Findings {
    schema: &'static str,
    kind: &'static str,
    file: String,
    sha256: String,
    vertices: usize,
    cells: usize,
    /// Number of cells in each component of cells that share faces.
    components: Vec<u32>,
    /// Whether all cells have their corners in the other order, which is turned around.
    all_inverted: bool,
    defects: Vec<String>,
    /// Facts of the solid; with `--repair` of the repaired one.
    solid: Option<TetFacts>,
    /// What was done.
    repairs: Vec<String>,
    /// With `--repair`: why the file cannot be repaired.
    refused: Option<String>,
}

impl Findings {
    pub(super) fn of(soup: &TetSoup, policy: Policy, file: &str, sha256: String) -> Self {
        let found = preflight(soup);
        let defects = found.defects.iter();
        let mut findings = Self {
            schema: SCHEMA,
            kind: "tets",
            file: file.to_owned(),
            sha256,
            vertices: soup.positions.len(),
            cells: soup.cells.len(),
            components: found.components.clone(),
            all_inverted: found.all_inverted,
            defects: defects
                .map(|defect| format!("{defect}; {}", defect.remedy_text()))
                .collect(),
            solid: None,
            repairs: Vec::new(),
            refused: None,
        };
        if found.defects.is_empty() || policy == Policy::Repair {
            match accept(soup, policy) {
                Ok(accepted) => {
                    findings.solid = Some(TetFacts::measure(&accepted.mesh));
                    findings.repairs = accepted.repairs.iter().map(ToString::to_string).collect();
                }
                Err(error) => findings.refused = Some(error.to_string()),
            }
        }
        findings
    }

    pub(super) fn describe(&self) -> String {
        let mut text = format!(
            "{}: {} vertices, {} tetrahedra, {} face-connected components\n",
            self.file,
            self.vertices,
            self.cells,
            self.components.len()
        );
        for repair in &self.repairs {
            let _ = writeln!(text, "repaired: {repair}");
        }
        if let Some(facts) = &self.solid {
            describe_facts(&mut text, facts);
        }
        let _ = match self.defects.len() {
            0 => writeln!(text, "no defects"),
            count => writeln!(text, "{count} defects:"),
        };
        for defect in &self.defects {
            let _ = writeln!(text, "  {defect}");
        }
        if let Some(reason) = &self.refused {
            let _ = writeln!(text, "cannot be used: {reason}");
        }
        text
    }
}

fn describe_facts(text: &mut String, facts: &TetFacts) {
    let genus = facts
        .boundary_genus
        .map_or("undefined".to_owned(), |genus| genus.to_string());
    let _ = writeln!(
        text,
        "solid: {} vertices, {} edges, {} faces, {} tetrahedra, {} not positive",
        facts.vertices, facts.edges, facts.faces, facts.cells, facts.not_positive
    );
    let _ = writeln!(
        text,
        "boundary: {} vertices, {} faces, {} surfaces, genus {genus}",
        facts.boundary_vertices, facts.boundary_faces, facts.boundary_components
    );
    let [low, high] = facts.bounding_box;
    let _ = writeln!(
        text,
        "box {low:?} to {high:?}, diagonal {:.6}, volume {:.6}, area {:.6}",
        facts.diagonal, facts.volume, facts.boundary_area
    );
    let (edge, angle) = (&facts.edge_length, &facts.dihedral_angle);
    let _ = writeln!(
        text,
        "edges {:.6} to {:.6}, mean {:.6}; dihedral angles {:.3} to {:.3} degrees",
        edge.min,
        edge.max,
        edge.mean,
        angle.min.to_degrees(),
        angle.max.to_degrees()
    );
}
