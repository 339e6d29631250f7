//! Shells in STEP files. That a program for design takes them for what they are, `tests/reference`
//! tells.

use std::collections::BTreeMap;

use msplines_common::bspline::{BezierCurve, BezierEdge, BezierFace, BezierShell, EdgeUse};
use msplines_io::{WriteError, write_step};
use nalgebra::Point3;

use crate::common::scratch;

/// Corners of a box, the first coordinate fastest, and its sides, each counterclockwise from outside.
const SIDES: [[u32; 4]; 6] = [
    [0, 2, 3, 1],
    [4, 5, 7, 6],
    [0, 1, 5, 4],
    [2, 6, 7, 3],
    [0, 4, 6, 2],
    [1, 3, 7, 5],
];

/// Returns boxes of bilinear patches, without some of the sides of the first.
fn boxes(places: &[f64], left_out: usize) -> BezierShell {
    let (mut vertices, mut edges, mut faces) = (Vec::new(), Vec::new(), Vec::new());
    for (copy, &place) in places.iter().enumerate() {
        let base = vertices.len() as u32;
        vertices.extend((0..8).map(|v| {
            let [x, y, z] = [v & 1, v >> 1 & 1, v >> 2].map(f64::from);
            Point3::new(place + 0.1 * x, y, 1e-9 * z)
        }));
        let first_edge = edges.len();
        let skipped = if copy == 0 { left_out } else { 0 };
        for corners in &SIDES[skipped..] {
            let corners = corners.map(|v| v + base);
            let around = (0..4).map(|i| [corners[i], corners[(i + 1) % 4]]);
            let boundary = around.map(|[from, to]| {
                let known: &[BezierEdge] = &edges[first_edge..];
                let known = known.iter().position(|e| e.ends == [to, from]);
                let edge = known.map_or(edges.len(), |at| first_edge + at);
                if known.is_none() {
                    let points = [from, to].map(|v| vertices[v as usize]).to_vec();
                    edges.push(BezierEdge {
                        ends: [from, to],
                        curve: BezierCurve {
                            points,
                            weights: None,
                        },
                    });
                }
                EdgeUse {
                    edge: edge as u32,
                    reversed: known.is_some(),
                }
            });
            let boundary = boundary.collect();
            let [a, b, c, d] = corners.map(|v| vertices[v as usize]);
            faces.push(BezierFace {
                degree: [1, 1],
                points: vec![a, b, d, c],
                weights: None,
                boundary,
            });
        }
    }
    BezierShell::build(vertices, edges, faces, 0.0).unwrap()
}

/// Returns one patch of degrees 2 and 3 with weights.
fn rational_patch() -> BezierShell {
    let places = (0..4).flat_map(|j| (0..3).map(move |i| [f64::from(i), f64::from(j)]));
    let points: Vec<_> = places
        .map(|[i, j]| Point3::new(i, j, i * j / 3.0))
        .collect();
    let weights = points.iter().map(|p| 1.0 + p.x / 8.0 + p.y / 4.0);
    let mut face = BezierFace {
        degree: [2, 3],
        weights: Some(weights.collect()),
        points,
        boundary: Vec::new(),
    };
    let used = |edge| EdgeUse {
        edge,
        reversed: false,
    };
    face.boundary = [0, 1, 2, 3].map(used).to_vec();
    let curves = [0, 1, 2, 3].map(|side| face.side(side));
    let vertices = curves.iter().map(|curve| curve.points[0]).collect();
    let ends = [[0, 1], [1, 2], [2, 3], [3, 0]].into_iter();
    let edges = ends
        .zip(curves)
        .map(|(ends, curve)| BezierEdge { ends, curve })
        .collect();
    BezierShell::build(vertices, edges, vec![face], 1e-3).unwrap()
}

/// Entities of a file by number.
struct File {
    text: String,
    entities: BTreeMap<usize, String>,
}

impl File {
    /// Writes a shell and reads what the file says; every entity names only ones before it.
    fn of(shell: &BezierShell) -> Self {
        let (_directory, path) = scratch("a.STEP");
        write_step(&path, shell).unwrap();
        let text = std::fs::read_to_string(&path).unwrap();
        let (_, data) = text.split_once("DATA;\n").unwrap();
        let data = data.strip_suffix("ENDSEC;\nEND-ISO-10303-21;\n").unwrap();
        let mut entities = BTreeMap::new();
        for line in data.strip_suffix(";\n").unwrap().split(";\n") {
            let (id, entity) = line.strip_prefix('#').unwrap().split_once('=').unwrap();
            let id: usize = id.parse().unwrap();
            assert!(references(entity).iter().all(|&other| other < id), "{line}");
            assert!(entities.insert(id, entity.replace('\n', "")).is_none());
        }
        Self { text, entities }
    }

    /// Returns the entities of a kind.
    fn all(&self, kind: &str) -> Vec<&String> {
        let start = format!("{kind}(");
        let entities = self.entities.values();
        entities.filter(|e| e.starts_with(&start)).collect()
    }

    fn only(&self, kind: &str) -> &str {
        let [only] = self.all(kind)[..] else {
            panic!("one {kind}");
        };
        only
    }

    /// Returns the coordinates of points that an entity names.
    fn points(&self, entity: &str) -> Vec<[f64; 3]> {
        let ids = references(entity);
        let points = ids.iter().map(|id| {
            let place = self.entities[id].strip_prefix("CARTESIAN_POINT('',(");
            let place = place.unwrap().strip_suffix("))").unwrap();
            let numbers: Vec<f64> = place.split(',').map(|x| x.parse().unwrap()).collect();
            numbers.try_into().unwrap()
        });
        points.collect()
    }
}

/// Returns the numbers of entities that an entity names, in order.
fn references(entity: &str) -> Vec<usize> {
    let after = entity.split('#').skip(1);
    let digits = after.map(|text| text.split(|c: char| !c.is_ascii_digit()).next());
    digits.map(|id| id.unwrap().parse().unwrap()).collect()
}

#[test]
fn a_closed_shell_is_a_solid_whose_faces_share_edges() {
    let shell = boxes(&[0.0], 0);
    let file = File::of(&shell);
    let counts = [
        ("VERTEX_POINT", 8),
        ("CARTESIAN_POINT", 8),
        ("EDGE_CURVE", 12),
        ("B_SPLINE_CURVE_WITH_KNOTS", 12),
        ("ORIENTED_EDGE", 24),
        ("EDGE_LOOP", 6),
        ("FACE_OUTER_BOUND", 6),
        ("ADVANCED_FACE", 6),
        ("B_SPLINE_SURFACE_WITH_KNOTS", 6),
        ("CLOSED_SHELL", 1),
        ("MANIFOLD_SOLID_BREP", 1),
        ("ADVANCED_BREP_SHAPE_REPRESENTATION", 1),
        ("SHAPE_DEFINITION_REPRESENTATION", 1),
        ("OPEN_SHELL", 0),
        ("SHELL_BASED_SURFACE_MODEL", 0),
    ];
    for (kind, count) in counts {
        assert_eq!(file.all(kind).len(), count, "{kind}");
    }
    // Each edge is used once in each direction.
    let mut uses: Vec<_> = file.all("ORIENTED_EDGE");
    uses.sort();
    uses.dedup();
    assert_eq!(uses.len(), 24);
    let written = file.all("EDGE_CURVE");
    for (edge, written) in shell.edges().iter().zip(written) {
        let ends = &references(written)[..2];
        let ends: Vec<_> = ends
            .iter()
            .flat_map(|vertex| file.points(&file.entities[vertex]))
            .collect();
        let expected: [[f64; 3]; 2] = edge
            .ends
            .map(|v| shell.vertices()[v as usize].coords.into());
        assert_eq!(ends, expected);
    }
}

#[test]
fn what_is_open_makes_the_whole_a_surface() {
    let file = File::of(&boxes(&[0.0, 3.0], 0));
    assert_eq!(file.all("MANIFOLD_SOLID_BREP").len(), 2);
    assert_eq!(file.all("CLOSED_SHELL").len(), 2);
    let file = File::of(&boxes(&[0.0, 3.0], 1));
    assert_eq!(file.all("MANIFOLD_SOLID_BREP").len(), 0);
    let open = references(file.only("OPEN_SHELL"));
    let closed = references(file.only("CLOSED_SHELL"));
    assert_eq!([open.len(), closed.len()], [5, 6]);
    let model = file.only("SHELL_BASED_SURFACE_MODEL");
    assert_eq!(references(model).len(), 2);
    assert_eq!(file.all("MANIFOLD_SURFACE_SHAPE_REPRESENTATION").len(), 1);
}

#[test]
fn rational_patches_keep_their_points_and_weights() {
    let shell = rational_patch();
    let file = File::of(&shell);
    let face = &shell.faces()[0];
    let complex = file.all("(BOUNDED_SURFACE()B_SPLINE_SURFACE");
    let [surface] = complex[..] else {
        panic!("one surface");
    };
    assert!(surface.contains("B_SPLINE_SURFACE(2,3,(("), "{surface}");
    let knots = "B_SPLINE_SURFACE_WITH_KNOTS((3,3),(4,4),(0.,1.),(0.,1.),.UNSPECIFIED.)";
    assert!(surface.contains(knots), "{surface}");
    let weights = surface.split("RATIONAL_B_SPLINE_SURFACE((").nth(1).unwrap();
    let weights = weights.split("))").next().unwrap();
    let weights = weights.split("),(").map(|row| {
        let numbers = row.trim_matches(['(', ')']).split(',');
        numbers.map(|x| x.parse().unwrap()).collect::<Vec<f64>>()
    });
    let weights: Vec<_> = weights.collect();
    let points = file.points(surface);
    for i in 0..3 {
        for j in 0..4 {
            let at = i + 3 * j;
            assert_eq!(Point3::from(points[4 * i + j]), face.points[at]);
            let given = face.weights.as_ref().unwrap()[at];
            assert_eq!(weights[i][j].to_bits(), given.to_bits());
        }
    }
    let curves = file.all("(BOUNDED_CURVE()B_SPLINE_CURVE");
    assert_eq!(curves.len(), 4);
    for (edge, written) in shell.edges().iter().zip(curves) {
        let points: Vec<_> = file.points(written);
        let expected: Vec<[f64; 3]> = edge.curve.points.iter().map(|p| p.coords.into()).collect();
        assert_eq!(points, expected);
        assert!(written.contains("RATIONAL_B_SPLINE_CURVE(("), "{written}");
    }
    // The tolerance of the shell is the accuracy of the file.
    let accuracy = file.only("UNCERTAINTY_MEASURE_WITH_UNIT");
    assert!(accuracy.contains("LENGTH_MEASURE(0.001)"), "{accuracy}");
}

#[test]
fn the_same_shell_gives_the_same_bytes_and_numbers_come_back() {
    let shell = boxes(&[1.0 / 3.0, 5.0], 0);
    let file = File::of(&shell);
    assert_eq!(file.text, File::of(&shell).text);
    assert!(file.text.starts_with("ISO-10303-21;\nHEADER;\n"));
    assert!(file.text.contains("'1970-01-01T00:00:00'"));
    let surfaces = file.all("B_SPLINE_SURFACE_WITH_KNOTS");
    for (face, written) in shell.faces().iter().zip(surfaces) {
        let points = file.points(written);
        let expected: [[f64; 3]; 4] = [0, 2, 1, 3].map(|at| face.points[at].coords.into());
        assert_eq!(points, expected);
    }
    // A billionth of the diagonal, which is a little longer than 4.766.
    let accuracy = file.only("UNCERTAINTY_MEASURE_WITH_UNIT");
    assert!(accuracy.contains("LENGTH_MEASURE(4.87"), "{accuracy}");
}

#[test]
fn other_extensions_and_absent_folders_are_refused() {
    let shell = rational_patch();
    for name in ["a.vtu", "a", "step"] {
        let error = write_step(name.as_ref(), &shell).unwrap_err();
        assert!(matches!(error, WriteError::StepFormat { .. }));
        let text = error.to_string();
        assert!(text.contains("name it .step or .stp"), "{text}");
    }
    let (directory, _) = scratch("");
    let path = directory.path().join("none").join("a.stp");
    let error = write_step(&path, &shell).unwrap_err();
    assert!(matches!(error, WriteError::Io { .. }));
}
