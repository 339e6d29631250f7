//! Collapse of thin cylinders, in whole units.

use crate::domain::collapse::{SnapOptions, snap};
use crate::domain::tables::{Joint, Tables};

/// Two handles: cylinder 0 with a figure eight on either border, 1 and 2 on its two loops; the lower
/// loops start at `turn`.
fn double_torus(heights: [i64; 3], turn: i64) -> Tables {
    let joint = |below, above, length, zero| Joint {
        below: Some(below),
        above: Some(above),
        length,
        zero: Some(zero),
        end: None,
    };
    Tables {
        circumferences: vec![1000, 400, 600],
        heights: heights.to_vec(),
        joints: vec![
            joint((0, turn), (1, 0), 400, 0),
            joint((0, 400 + turn), (2, 0), 600, 0),
            joint((1, 0), (0, 0), 400, 1),
            joint((2, 0), (0, 400), 600, 1),
        ],
    }
}

fn area(tables: &Tables) -> i64 {
    tables
        .heights
        .iter()
        .zip(&tables.circumferences)
        .map(|(h, c)| h * c)
        .sum()
}

fn complex(tables: &Tables, collapsed: &[bool]) -> crate::CylinderComplex {
    let mut next = 0..;
    let names: Vec<Option<u32>> = (collapsed.iter())
        .map(|&gone| (!gone).then(|| next.next()).flatten())
        .collect();
    tables.complex(&names, &[]).expect("a complex")
}

#[test]
fn a_thin_cylinder_becomes_a_line_and_the_area_stays() {
    let tables = double_torus([5, 300, 500], 250);
    let before = area(&tables);
    complex(&tables, &[false; 3]);
    let snapped = snap(tables, &SnapOptions::default());
    assert_eq!(area(&snapped.tables), before);
    assert_eq!(snapped.tables.joints.len(), 4);
    let rows = snapped.collapsed[0].as_ref().expect("collapsed");
    assert_eq!(rows.iter().map(|row| row.length).sum::<i64>(), 1000);
    let glued = complex(&snapped.tables, &[true, false, false]);
    assert_eq!((glued.cylinders().len(), glued.zeros()), (2, 2));
}

#[test]
fn zeros_on_top_of_each_other_are_not_merged() {
    // 5 apart on one level where 6 lay between: less than 6.9, a hundredth of the root of the area, but not much
    // nearer.
    let snapped = snap(double_torus([6, 300, 500], 5), &SnapOptions::default());
    assert!(snapped.collapsed[0].is_some());
    let snapped = snap(double_torus([6, 300, 500], 2), &SnapOptions::default());
    assert!(snapped.collapsed.iter().all(Option::is_none));
    assert_eq!(snapped.tables.heights, [6, 300, 500]);
    // Nor is a cylinder sheared by a third of its height.
    assert_eq!(snapped.shears[0], 0);
    complex(&snapped.tables, &[false; 3]);
}

#[test]
fn cylinders_beside_each_other_collapse_together() {
    let mut tables = double_torus([500, 4, 4], 250);
    // The zeros of the upper two cylinders apart from each other.
    tables.joints[0].above = Some((1, 200));
    tables.joints[1].above = Some((2, 300));
    let before = area(&tables);
    let snapped = snap(tables, &SnapOptions::default());
    assert!(snapped.collapsed[0].is_none());
    assert!(snapped.collapsed[1].is_some() && snapped.collapsed[2].is_some());
    assert_eq!(area(&snapped.tables), before);
    let glued = complex(&snapped.tables, &[false, true, true]);
    assert_eq!(glued.cylinders().len(), 1);
}

#[test]
fn the_graph_moves_that_leaves_the_others_most_alike() {
    let tables = double_torus([300, 5, 12], 250);
    // Cylinder 1 is the thinnest; its partner between the same zeros is made wider first, so that only
    // one goes: both hang on the same graphs, and a whole move would shrink it to 7 either way.
    let mut tables = tables;
    tables.joints[0].above = Some((1, 200));
    let snapped = snap(tables, &SnapOptions::default());
    assert!(snapped.collapsed[1].is_some());
    assert_eq!(snapped.tables.heights[2], 7);
    assert_eq!(snapped.tables.heights[0], 305);
}
