//! `msplines info`: what a mesh file holds, and every defect of it.

mod solid;

use std::fmt::Write as _;
use std::io::Write as _;

use msplines_common::mesh::{Facts, Policy, PolygonSoup, accept, preflight};
use msplines_compare::error::exit;
use msplines_compare::input::{file_name, holds_tetrahedra, unreadable};
use msplines_io::{read_soup, read_tets, sha256_file};
use serde::Serialize;

use crate::arguments::Info;
use crate::session::{Failure, Session};

/// The schema of the JSON.
const SCHEMA: &str = "msplines.info/1";

/// What is said about a file.
#[derive(Debug, Serialize)]
struct Findings {
    schema: &'static str,
    file: String,
    sha256: String,
    vertices: usize,
    faces: usize,
    polygons: usize,
    attributes: Vec<String>,
    components: Vec<u32>,
    coincident_vertices: usize,
    defects: Vec<String>,
    /// Facts of the mesh; with `--repair` of the repaired one.
    mesh: Option<Facts>,
    /// With `--repair`: what was done.
    repairs: Vec<String>,
    /// With `--repair`: why the file cannot be repaired.
    refused: Option<String>,
}

/// Prints what a file holds; any file that can be parsed is a success, whatever its defects.
pub(crate) fn run(info: &Info, session: &Session) -> Result<u8, Failure> {
    let file = file_name(&info.input);
    let refused = |text: String| Failure {
        code: exit::INPUT,
        text: format!("{file}: {text}"),
    };
    let sha256 = sha256_file(&info.input).map_err(|e| refused(unreadable(&e)))?;
    let policy = if session.repair {
        Policy::Repair
    } else {
        Policy::Refuse
    };
    if holds_tetrahedra(&info.input) {
        let soup = read_tets(&info.input).map_err(|e| refused(e.to_string()))?;
        let findings = solid::Findings::of(&soup, policy, &file, sha256);
        return say(info, session, &findings, || findings.describe());
    }
    let soup = read_soup(&info.input).map_err(|e| refused(e.to_string()))?;
    let findings = examine(&soup, policy, &file, sha256);
    say(info, session, &findings, || describe(&findings))
}

/// Prints findings as JSON or as text, and writes them to the file of `--report`.
fn say(
    info: &Info,
    session: &Session,
    findings: &impl Serialize,
    describe: impl FnOnce() -> String,
) -> Result<u8, Failure> {
    let text = if info.json {
        let json = serde_json::to_string_pretty(findings).map_err(|e| Failure {
            code: exit::INPUT,
            text: format!("{}: {e}", file_name(&info.input)),
        });
        json? + "\n"
    } else {
        describe()
    };
    // A reader that has had enough, such as `head`, closes the pipe.
    let _ = std::io::stdout().write_all(text.as_bytes());
    session.write_report(findings)?;
    Ok(exit::SUCCESS)
}

fn examine(soup: &PolygonSoup, policy: Policy, file: &str, sha256: String) -> Findings {
    let found = preflight(soup);
    let clean = found.defects.is_empty();
    let mut findings = Findings {
        schema: SCHEMA,
        file: file.to_owned(),
        sha256,
        vertices: soup.positions.len(),
        faces: soup.face_count(),
        polygons: found.polygons,
        attributes: soup.attributes.iter().map(|a| a.name.clone()).collect(),
        components: found.components,
        coincident_vertices: found.coincident.len(),
        defects: found
            .defects
            .iter()
            .map(|defect| format!("{defect}; {}", defect.remedy_text()))
            .collect(),
        mesh: None,
        repairs: Vec::new(),
        refused: None,
    };
    if clean || policy == Policy::Repair {
        match accept(soup, policy) {
            Ok(accepted) => {
                findings.mesh = Some(Facts::measure(&accepted.mesh));
                findings.repairs = accepted.repairs.iter().map(ToString::to_string).collect();
            }
            Err(error) => findings.refused = Some(error.to_string()),
        }
    }
    findings
}

fn describe(findings: &Findings) -> String {
    let mut text = format!(
        "{}: {} vertices, {} faces ({} with more than three corners), {} edge-connected components\n",
        findings.file,
        findings.vertices,
        findings.faces,
        findings.polygons,
        findings.components.len()
    );
    if !findings.attributes.is_empty() {
        let _ = writeln!(
            text,
            "vertex attributes: {}",
            findings.attributes.join(", ")
        );
    }
    if findings.coincident_vertices > 0 {
        let _ = writeln!(
            text,
            "{} vertices lie exactly on an earlier one",
            findings.coincident_vertices
        );
    }
    for repair in &findings.repairs {
        let _ = writeln!(text, "repaired: {repair}");
    }
    if let Some(facts) = &findings.mesh {
        describe_facts(&mut text, facts);
    }
    let _ = match findings.defects.len() {
        0 => writeln!(text, "no defects"),
        count => writeln!(text, "{count} defects:"),
    };
    for defect in &findings.defects {
        let _ = writeln!(text, "  {defect}");
    }
    if let Some(reason) = &findings.refused {
        let _ = writeln!(text, "cannot be used: {reason}");
    }
    text
}

fn describe_facts(text: &mut String, facts: &Facts) {
    let genus = facts
        .genus
        .map_or("undefined".to_owned(), |genus| genus.to_string());
    let _ = writeln!(
        text,
        "mesh: {} vertices, {} edges, {} faces, genus {genus}, {} boundary loops",
        facts.vertices, facts.edges, facts.faces, facts.boundary_loops
    );
    let [low, high] = facts.bounding_box;
    let _ = writeln!(
        text,
        "box {low:?} to {high:?}, diagonal {:.6}, area {:.6}",
        facts.diagonal, facts.area
    );
    let (edge, angle) = (&facts.edge_length, &facts.angle);
    let _ = writeln!(
        text,
        "edges {:.6} to {:.6}, mean {:.6}; angles {:.3} to {:.3} degrees; valence {:.0} to {:.0}",
        edge.min,
        edge.max,
        edge.mean,
        angle.min.to_degrees(),
        angle.max.to_degrees(),
        facts.valence.min,
        facts.valence.max
    );
}
