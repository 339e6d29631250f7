use super::*;

const ROUNDING: f64 = 1e-14;

/// Parts of a shell.
#[derive(Clone)]
struct Parts {
    vertices: Vec<Point3<f64>>,
    edges: Vec<BezierEdge>,
    faces: Vec<BezierFace>,
}

impl Parts {
    fn build(self) -> Result<BezierShell, ShellError> {
        BezierShell::build(self.vertices, self.edges, self.faces, ROUNDING)
    }
}

/// The surface `z = x y` over a rectangle; edges that are used backwards are written as `!edge`.
fn patch([x0, x1]: [f64; 2], [y0, y1]: [f64; 2], around: &[i32]) -> BezierFace {
    let corners = [[x0, y0], [x1, y0], [x0, y1], [x1, y1]];
    let used = |&edge: &i32| EdgeUse {
        edge: edge.max(!edge) as u32,
        reversed: edge < 0,
    };
    BezierFace {
        degree: [1, 1],
        points: corners.map(|[x, y]| Point3::new(x, y, x * y)).to_vec(),
        weights: None,
        boundary: around.iter().map(used).collect(),
    }
}

/// One patch beside two, which end at its side.
fn t_junction() -> Parts {
    const PLACES: [[f64; 2]; 8] = [
        [0.0, 0.0],
        [1.0, 0.0],
        [1.0, 1.0],
        [1.0, 2.0],
        [0.0, 2.0],
        [2.0, 0.0],
        [2.0, 1.0],
        [2.0, 2.0],
    ];
    const ENDS: [[u32; 2]; 10] = [
        [0, 1],
        [1, 2],
        [2, 3],
        [3, 4],
        [4, 0],
        [1, 5],
        [5, 6],
        [6, 2],
        [6, 7],
        [7, 3],
    ];
    let vertices = PLACES.map(|[x, y]| Point3::new(x, y, x * y));
    let faces = vec![
        patch([0.0, 1.0], [0.0, 2.0], &[0, 1, 2, 3, 4]),
        patch([1.0, 2.0], [0.0, 1.0], &[5, 6, 7, !1]),
        patch([1.0, 2.0], [1.0, 2.0], &[!7, 8, 9, !2]),
    ];
    let mut edges: Vec<BezierEdge> = ENDS
        .into_iter()
        .map(|ends| BezierEdge {
            ends,
            curve: BezierCurve {
                points: ends.map(|v| vertices[v as usize]).to_vec(),
                weights: None,
            },
        })
        .collect();
    edges[1].curve = faces[0].side(1).piece([0.0, 0.5]);
    edges[2].curve = faces[0].side(1).piece([0.5, 1.0]);
    Parts {
        vertices: vertices.to_vec(),
        edges,
        faces,
    }
}

/// The two sides of one patch, sewn together all around.
fn pillow() -> Parts {
    let mut parts = t_junction();
    let mut back = patch([0.0, 1.0], [0.0, 2.0], &[!4, !3, !2, !1, !0]);
    back.points.swap(1, 2);
    parts.faces.truncate(1);
    parts.faces.push(back);
    parts.edges.truncate(5);
    parts.vertices.truncate(5);
    parts
}

#[test]
fn patches_that_end_at_the_side_of_one_are_joined_to_it() {
    let parts = t_junction();
    let shell = parts.clone().build().unwrap();
    assert_eq!(shell.edges(), parts.edges);
    let open = ShellComponent {
        faces: vec![0, 1, 2],
        is_closed: false,
    };
    assert_eq!(shell.components(), [open]);
}

#[test]
fn components_are_told_apart_and_closed_ones_known() {
    let (mut parts, second) = (t_junction(), pillow());
    let (vertices, edges) = (parts.vertices.len() as u32, parts.edges.len() as u32);
    parts.vertices.extend(second.vertices);
    parts.edges.extend(second.edges.into_iter().map(|edge| {
        let ends = edge.ends.map(|v| v + vertices);
        BezierEdge { ends, ..edge }
    }));
    let moved = second.faces.into_iter().map(|mut face| {
        for used in &mut face.boundary {
            used.edge += edges;
        }
        face
    });
    parts.faces.splice(1..1, moved);
    let component = |faces: &[u32], is_closed| ShellComponent {
        faces: faces.to_vec(),
        is_closed,
    };
    assert_eq!(
        parts.build().unwrap().components(),
        [component(&[0, 3, 4], false), component(&[1, 2], true)]
    );
}

#[test]
fn a_side_that_is_a_point_has_no_edge() {
    let mut parts = t_junction();
    // A triangle of the two small patches' common side and the far corner, where side 3 is.
    let far = parts.vertices[5];
    let mut face = patch([1.0, 2.0], [0.0, 1.0], &[0, 1, 2]);
    face.points = vec![far, parts.vertices[6], far, parts.vertices[2]];
    parts.vertices = vec![far, parts.vertices[6], parts.vertices[2]];
    let sides = [0, 1, 2].map(|side| face.side(side));
    let ends = [[0, 1], [1, 2], [2, 0]].into_iter();
    let edges = ends.zip(sides);
    parts.edges = edges
        .map(|(ends, curve)| BezierEdge { ends, curve })
        .collect();
    parts.faces = vec![face];
    parts.clone().build().unwrap();
    parts.faces[0].boundary.reverse();
    for used in &mut parts.faces[0].boundary {
        used.reversed = true;
    }
    assert_eq!(parts.build(), Err(ShellError::Corners { face: 0 }));
}

#[test]
fn sides_go_around() {
    let points: Vec<_> = (0..12)
        .map(|i| Point3::new(f64::from(i), 0.0, 0.0))
        .collect();
    let face = BezierFace {
        degree: [2, 3],
        weights: Some(points.iter().map(|p| p.x + 1.0).collect()),
        points,
        boundary: Vec::new(),
    };
    let expected = [
        &[0.0, 1.0, 2.0][..],
        &[2.0, 5.0, 8.0, 11.0],
        &[11.0, 10.0, 9.0],
        &[9.0, 6.0, 3.0, 0.0],
    ];
    for (side, expected) in expected.into_iter().enumerate() {
        let curve = face.side(side);
        let found: Vec<f64> = curve.points.iter().map(|p| p.x).collect();
        assert_eq!(found, expected);
        let weights: Vec<f64> = expected.iter().map(|x| x + 1.0).collect();
        assert_eq!(curve.weights, Some(weights));
    }
}

#[test]
fn a_piece_is_the_curve_over_its_interval() {
    let points = [
        [0.0, 0.0, 1.0],
        [1.0, 2.0, 0.0],
        [3.0, -1.0, 0.5],
        [4.0, 1.0, 2.0],
    ];
    for weights in [None, Some(vec![1.0, 0.5, 2.0, 1.5])] {
        let curve = BezierCurve {
            points: points.map(Point3::from).to_vec(),
            weights,
        };
        assert_eq!(curve.piece([0.0, 1.0]).points.len(), 4);
        for [from, to] in [[0.0, 0.5], [0.5, 1.0], [0.25, 0.75], [0.1, 0.3], [0.0, 1.0]] {
            let piece = curve.piece([from, to]);
            assert_eq!(piece.weights.is_some(), curve.weights.is_some());
            for step in 0..=8 {
                let t = f64::from(step) / 8.0;
                let expected = curve.position(from + (to - from) * t);
                assert!((piece.position(t) - expected).norm() < ROUNDING);
            }
        }
        // Where a curve is cut in two, both pieces have the same end.
        let [low, high] = [[0.0, 0.3], [0.3, 1.0]].map(|range| curve.piece(range));
        assert_eq!(low.points.last(), high.points.first());
    }
    // A quarter of a circle: the law that polynomial pieces cannot fulfil.
    let quarter = BezierCurve {
        points: [[1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]]
            .map(Point3::from)
            .to_vec(),
        weights: Some(vec![1.0, 0.5_f64.sqrt(), 1.0]),
    };
    let radius = quarter.piece([0.2, 0.7]).position(0.4).coords.norm();
    assert!((radius - 1.0).abs() < ROUNDING);
}

/// Returns why a shell with a T-junction is none after `spoil`.
fn refusal(spoil: impl FnOnce(&mut Parts)) -> String {
    let mut parts = t_junction();
    spoil(&mut parts);
    parts.build().unwrap_err().to_string()
}

#[test]
fn parts_that_are_not_fit_are_named() {
    let text = refusal(|p| p.vertices[3].y = f64::NAN);
    assert!(text.contains("coordinate of vertex 3"), "{text}");
    let text = refusal(|p| p.edges[2].curve.points[1].y = f64::INFINITY);
    assert!(text.contains("coordinate of edge 2"), "{text}");
    let text = refusal(|p| p.faces[1].points[2].z = f64::NAN);
    assert!(text.contains("coordinate of face 1"), "{text}");
    let text = refusal(|p| p.edges[4].curve.points.truncate(1));
    assert!(text.contains("edge 4 is of degree 0"), "{text}");
    let text = refusal(|p| p.faces[2].degree = [0, 3]);
    assert!(text.contains("face 2 is of degree 0"), "{text}");
    let text = refusal(|p| p.faces[2].degree = [2, 3]);
    assert!(text.contains("face 2 has 4 control points"), "{text}");
    assert!(text.contains("ask for 12"), "{text}");
    let text = refusal(|p| p.faces[2].degree = [usize::MAX, 3]);
    assert!(text.contains("face 2 has 4 control points"), "{text}");
    let text = refusal(|p| p.faces[0].weights = Some(vec![1.0; 3]));
    assert!(text.contains("face 0 has 3 weights for 4"), "{text}");
    for weight in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let text = refusal(|p| p.edges[6].curve.weights = Some(vec![1.0, weight]));
        assert!(text.contains("control point 1 of edge 6 is"), "{text}");
    }
    let text = refusal(|p| p.edges[9].ends[0] = 8);
    assert!(text.contains("edge 9 ends at vertex 8"), "{text}");
    assert!(text.contains("there are 8 vertices"), "{text}");
    let text = refusal(|p| p.vertices[7].z += 1e-3);
    assert!(text.contains("edge 8 ends 1"), "{text}");
    assert!(text.contains("from vertex 7"), "{text}");
}

#[test]
fn boundaries_that_are_not_fit_are_named() {
    let text = refusal(|p| p.faces[1].boundary.clear());
    assert!(text.contains("face 1 has no edges"), "{text}");
    let text = refusal(|p| p.faces[1].boundary[2].edge = 10);
    assert!(text.contains("face 1 names edge 10"), "{text}");
    let text = refusal(|p| p.faces[1].boundary[2].reversed = true);
    assert!(text.contains("around face 1, edge 6"), "{text}");
    assert!(
        text.contains("edge 7 after it starts at vertex 2"),
        "{text}"
    );
    let text = refusal(|p| p.faces[1].boundary.swap(0, 1));
    assert!(text.contains("around face 1"), "{text}");
    let text = refusal(|p| {
        p.faces[0].boundary.reverse();
        for used in &mut p.faces[0].boundary {
            used.reversed = !used.reversed;
        }
    });
    assert!(text.contains("face 0 does not pass the corners"), "{text}");
    // A patch with its directions exchanged has its other side out.
    let text = refusal(|p| p.faces[0].points.swap(1, 2));
    assert!(text.contains("face 0 does not pass the corners"), "{text}");
}

#[test]
fn edges_of_no_face_of_three_and_of_two_that_face_apart_are_named() {
    let text = refusal(|p| p.edges.push(p.edges[0].clone()));
    assert!(text.contains("edge 10 is used 0 times"), "{text}");
    let text = refusal(|p| {
        let mut third = p.faces[2].clone();
        third.points.swap(1, 2);
        third.boundary.reverse();
        for used in &mut third.boundary {
            used.reversed = !used.reversed;
        }
        p.faces.push(third);
    });
    assert!(text.contains("edge 2 is used 3 times"), "{text}");
    // The pillow's back turned out to the same side as its front.
    let mut parts = pillow();
    parts.faces[1] = parts.faces[0].clone();
    let expected = ShellError::SameDirection {
        edge: 0,
        faces: [0, 1],
    };
    assert_eq!(parts.build(), Err(expected.clone()));
    assert!(expected.to_string().contains("faces [0, 1] use edge 0"));
}

#[test]
fn a_shell_has_faces_and_a_tolerance() {
    let text = refusal(|p| p.faces.clear());
    assert!(text.contains("without faces"), "{text}");
    for tolerance in [-1.0, f64::NAN, f64::INFINITY] {
        let parts = t_junction();
        let error = BezierShell::build(parts.vertices, parts.edges, parts.faces, tolerance);
        let text = error.unwrap_err().to_string();
        assert!(text.contains("the tolerance is"), "{text}");
    }
    let mut parts = t_junction();
    parts.vertices[0].x = 1e-3;
    BezierShell::build(parts.vertices, parts.edges, parts.faces, 1e-2).unwrap();
}
