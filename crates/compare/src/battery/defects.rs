//! The twelve defects, put into sound meshes, control meshes, networks and solids.

use msplines_common::mesh::shapes;

use super::draft::{Draft, Kind};
use super::inputs::Bench;
use super::subjects::{SUBJECTS, Subject};
use super::{BatteryError, Group, REPAIRED, Trial};

/// Names of the defects, in the order of the peers' table.
pub(super) const DEFECTS: [&str; 12] = [
    "zero-area face, a vertex on its neighbour",
    "collinear sliver of 1e-12",
    "NaN vertex",
    "unreferenced vertex",
    "second component without a knot",
    "two fifths of the faces removed, orphans left",
    "duplicated knot",
    "face index out of range",
    "flipped face",
    "flap",
    "bow tie",
    "open boundary",
];
/// Height of a sliver over its base.
const SLIVER: f64 = 1e-12;
/// The defect that is one of the options, not of the mesh.
const DUPLICATED_KNOT: usize = 6;
/// The defect that takes a choice of knots as well.
const SECOND_COMPONENT: usize = 4;

/// Returns every method on every defect, without and with repair.
pub(super) fn trials(bench: &Bench) -> Result<Vec<Trial>, BatteryError> {
    let mut trials = Vec::new();
    for subject in SUBJECTS.iter().filter(|s| s.takes_defects) {
        let sound = bench.draft(subject.input);
        for (number, name) in DEFECTS.into_iter().enumerate() {
            let Some((file, command)) = prepared(bench, subject, number)? else {
                continue;
            };
            for repair in ["", REPAIRED] {
                trials.push(Trial {
                    group: Group::Meshes,
                    case: name.to_owned(),
                    method: format!("{}{repair}", subject.name),
                    arguments: subject.arguments(&command, &file, repair),
                    bounds: Some(sound.bounds()),
                });
            }
        }
    }
    Ok(trials)
}

/// Writes a defective input and returns its name and the command; `None` where there is no such thing.
fn prepared(
    bench: &Bench,
    subject: &Subject,
    number: usize,
) -> Result<Option<(String, String)>, BatteryError> {
    let mut draft = bench.draft(subject.input);
    let mut command = subject.command.to_owned();
    let is_network = draft.kind == Kind::Curves;
    if number == DUPLICATED_KNOT && !is_network {
        let Some((option, instead)) = subject.twice else {
            return Ok(None);
        };
        command = replaced(&command, option, instead);
    }
    if number == SECOND_COMPONENT && subject.name == "fit biharmonic" {
        command = replaced(&command, "--knots", "--knots-from=knots.obj");
    }
    spoil(&mut draft, number);
    let stem = subject.input.split('.').next().unwrap_or_default();
    let file = format!("{stem}-{number}.{}", draft.ending());
    bench.write(&file, draft.text().as_bytes())?;
    Ok(Some((file, command)))
}

/// Returns a command whose option is taken out, and others are added.
pub(super) fn replaced(command: &str, option: &str, instead: &str) -> String {
    let others = command.split(' ').filter(|word| {
        let name = word.split('=').next().unwrap_or_default();
        name != option
    });
    let mut words: Vec<&str> = others.collect();
    if !instead.is_empty() {
        words.push(instead);
    }
    words.join(" ")
}

fn spoil(draft: &mut Draft, number: usize) {
    let count = draft.positions.len() as u32;
    let first = draft.cells[0].clone();
    let at = |draft: &Draft, v: u32| draft.positions[v as usize];
    match number {
        0 => {
            let onto = at(draft, first[1]);
            draft.positions[first[0] as usize] = onto;
        }
        1 => {
            let (a, b) = (at(draft, first[1]), at(draft, first[2]));
            let middle = [0, 1, 2].map(|d| 0.5 * (a[d] + b[d]));
            draft.positions[first[0] as usize] = [middle[0], middle[1], middle[2] + SLIVER];
        }
        2 => draft.positions[first[0] as usize][1] = f64::NAN,
        3 => draft.positions.push([0.1, 0.2, 0.3]),
        4 => draft.add_beside(&island(draft), None),
        5 => {
            let removed = draft.cells.len() * 2 / 5;
            draft.cells.drain(..removed);
        }
        6 if draft.kind == Kind::Curves => draft.cells.push(first),
        7 => draft.cells[0][0] = count + 10,
        8 => draft.cells[0].swap(0, 1),
        9 => add_flap(draft, &first),
        10 => draft.add_beside(&island(draft), Some((0, first[0]))),
        11 => {
            let removed = draft.cells.len() / 20 + 1;
            draft.cells.drain(..removed);
            draft.compact();
        }
        _ => {}
    }
}

/// Returns a small thing of the same kind.
fn island(draft: &Draft) -> Draft {
    match draft.kind {
        Kind::Faces if draft.cells[0].len() == 4 => {
            Draft::of_polygons(&shapes::box_surface([1; 3]))
        }
        Kind::Faces => Draft {
            kind: Kind::Faces,
            positions: CORNERS.to_vec(),
            cells: [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]]
                .map(Vec::from)
                .to_vec(),
        },
        Kind::Curves => Draft {
            kind: Kind::Curves,
            positions: CORNERS.to_vec(),
            cells: vec![vec![0, 1, 2, 3, 0]],
        },
        Kind::Tets => Draft {
            kind: Kind::Tets,
            positions: CORNERS.to_vec(),
            cells: vec![vec![0, 1, 2, 3]],
        },
    }
}

/// Corners of a tetrahedron.
const CORNERS: [[f64; 3]; 4] = [
    [0.0, 0.0, 0.0],
    [1.0, 0.0, 0.0],
    [0.0, 1.0, 0.0],
    [0.0, 0.0, 1.0],
];

/// Adds a cell at a side that has all its neighbours already.
fn add_flap(draft: &mut Draft, first: &[u32]) {
    let count = draft.positions.len() as u32;
    let far = draft.bounds().inner[1];
    let new = |shift: f64| [far[0] + 0.1 + shift, far[1] + 0.1, far[2] + 0.1];
    let flap = match (draft.kind, first) {
        (Kind::Tets, [a, b, c, _]) => vec![*a, *b, *c, count],
        (Kind::Faces, [a, b, _, _]) => vec![*a, *b, count, count + 1],
        (Kind::Curves, [a, ..]) => vec![*a, count],
        (_, [a, b, ..]) => vec![*a, *b, count],
        _ => return,
    };
    draft.positions.push(new(0.0));
    if flap.contains(&(count + 1)) {
        draft.positions.push(new(0.1));
    }
    draft.cells.push(flap);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sound() -> Draft {
        Draft::of_triangles(&shapes::sphere(42))
    }

    /// Each defect must be there, or the battery proves nothing.
    #[test]
    fn every_defect_changes_the_mesh_as_it_says() {
        for number in (0..DEFECTS.len()).filter(|&n| n != DUPLICATED_KNOT) {
            let (before, mut after) = (sound(), sound());
            spoil(&mut after, number);
            assert_ne!(before.text(), after.text(), "{}", DEFECTS[number]);
        }
        let spoiled = |number: usize| {
            let mut draft = sound();
            spoil(&mut draft, number);
            draft
        };
        assert!(spoiled(2).text().contains("nan"));
        assert_eq!(spoiled(3).positions.len(), 43);
        assert_eq!(spoiled(4).positions.len(), 46);
        assert_eq!(spoiled(10).positions.len(), 45);
        assert_eq!(spoiled(5).positions.len(), 42);
        assert!(spoiled(11).cells.len() < sound().cells.len());
    }

    #[test]
    fn an_option_is_replaced_by_name() {
        let command = "fit x {} --knots=40 --knots-from=a";
        assert_eq!(
            replaced(command, "--knots", "--b"),
            "fit x {} --knots-from=a --b"
        );
        assert_eq!(replaced(command, "--none", ""), command);
    }
}
