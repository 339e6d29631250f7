//! Numbers in files beside the mesh: data, weights, creases.

use std::path::Path;

use msplines_common::mesh::TriangleMesh;
use msplines_common::{Point3, Vector3};
use msplines_io::read_npy;

use crate::case::Weights;
use crate::error::RunError;
use crate::input::file_name;

/// Returns the rows of numbers in a NumPy array (`.npy`) or in a text file, where empty lines and
/// what follows a `#` are passed over.
///
/// # Errors
/// A file that cannot be read, or something in it that is no number.
pub(crate) fn read_rows(path: &Path, option: &'static str) -> Result<Vec<Vec<f64>>, RunError> {
    let refused = |reason: String| RunError::Array {
        option,
        file: file_name(path),
        reason,
    };
    if path
        .extension()
        .is_some_and(|e| e.eq_ignore_ascii_case("npy"))
    {
        let array = read_npy(path).map_err(|e| refused(e.to_string()))?;
        return match array.shape.as_slice() {
            [_] => Ok(array.values.iter().map(|&x| vec![x]).collect()),
            [_, columns] if *columns > 0 => {
                Ok(array.values.chunks(*columns).map(<[f64]>::to_vec).collect())
            }
            shape => Err(refused(format!(
                "its shape is {shape:?}; give an array of one or two dimensions"
            ))),
        };
    }
    let text = std::fs::read_to_string(path).map_err(|e| {
        refused(format!(
            "cannot be read: {e}; give a NumPy array or text file"
        ))
    })?;
    let mut rows = Vec::new();
    for (index, line) in text.lines().enumerate() {
        let content = line.split('#').next().unwrap_or_default();
        let row: Result<Vec<f64>, _> = content.split_whitespace().map(str::parse).collect();
        match row {
            Ok(row) if row.is_empty() => {}
            Ok(row) => rows.push(row),
            Err(_) => {
                let line = index + 1;
                return Err(refused(format!(
                    "line {line} holds something that is no number; correct it there"
                )));
            }
        }
    }
    Ok(rows)
}

/// Returns the weight of every vertex.
///
/// # Errors
/// A file that cannot be read, or rows of other than one number.
pub(crate) fn weights(weights: &Weights, mesh: &TriangleMesh) -> Result<Vec<f64>, RunError> {
    match weights {
        Weights::File(path) => weights_in(path),
        Weights::Ball { at, radius, weight } => {
            let [low, high] = mesh.bounding_box();
            let middle = low + (high - low).component_mul(&Vector3::from(*at));
            let reach = radius * mesh.diagonal();
            let inside = |p: &Point3<f64>| (p - middle).norm() < reach;
            let positions = mesh.positions().iter();
            Ok(positions
                .map(|p| if inside(p) { *weight } else { 1.0 })
                .collect())
        }
    }
}

fn weights_in(path: &Path) -> Result<Vec<f64>, RunError> {
    let rows = read_rows(path, "--weights")?;
    match rows.iter().position(|row| row.len() != 1) {
        None => Ok(rows.concat()),
        Some(row) => Err(RunError::Array {
            option: "--weights",
            file: file_name(path),
            reason: format!(
                "row {row} has {} numbers instead of one; give one a row",
                rows[row].len()
            ),
        }),
    }
}

/// Returns the edges in a file: two vertices a line, counted from zero.
///
/// # Errors
/// A file that cannot be read, or a line that is no pair of vertices.
pub(crate) fn edges(path: &Path) -> Result<Vec<[u32; 2]>, RunError> {
    let rows = read_rows(path, "--features")?;
    let vertex =
        |x: f64| (x.fract() == 0.0 && (0.0..=f64::from(u32::MAX)).contains(&x)).then_some(x as u32);
    let edge = |row: &Vec<f64>| match row.as_slice() {
        &[from, to] => Some([vertex(from)?, vertex(to)?]),
        _ => None,
    };
    rows.iter()
        .enumerate()
        .map(|(index, row)| {
            edge(row).ok_or_else(|| RunError::Array {
                option: "--features",
                file: file_name(path),
                reason: format!("row {index} is no pair of vertices; give two, counted from zero"),
            })
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file(text: &str) -> tempfile::NamedTempFile {
        let file = tempfile::NamedTempFile::new().expect("a temporary file");
        std::fs::write(file.path(), text).expect("written");
        file
    }

    #[test]
    fn rows_are_read_without_comments() {
        let rows = read_rows(file("# two\n1 2.5\n\n -3e1 4 # end\n").path(), "--data");
        assert_eq!(rows.expect("numbers"), [vec![1.0, 2.5], vec![-30.0, 4.0]]);
    }

    #[test]
    fn what_is_no_number_is_named_with_its_line() {
        let error = read_rows(file("1\ntwo\n").path(), "--weights").expect_err("refused");
        let text = error.to_string();
        assert!(
            text.starts_with("--weights ") && text.contains("line 2 holds"),
            "{text}"
        );
    }

    #[test]
    fn edges_are_pairs_of_vertices() {
        assert_eq!(
            edges(file("0 7\n3 2\n").path()).expect("edges"),
            [[0, 7], [3, 2]]
        );
        for bad in ["0 7 3\n", "0.5 1\n", "-1 2\n"] {
            assert!(edges(file(bad).path()).is_err(), "{bad}");
        }
    }
}
