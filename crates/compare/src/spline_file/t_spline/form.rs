//! A closed form in few bytes, to the bit.
//!
//! Half-edges of one edge have opposite values, and those around a face add up to rounding: of a face with
//! two known edges the third is stored as how many floating-point numbers it is off the sum. Edges of which
//! that is not known are stored as they are, about one per vertex.

use std::collections::VecDeque;

use msplines_common::mesh::{NONE, Topology};
use serde::{Deserialize, Serialize};

use super::packed::Bytes;
use crate::error::SplineFileError;

/// A form on the half-edges of a mesh.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum StoredForm {
    /// In the order in which its edges follow from each other.
    Closed(Bytes),
    /// By half-edge, where those of one edge are not opposite to the bit.
    HalfEdges(Vec<[f64; 2]>),
}

impl StoredForm {
    /// Returns the stored form.
    #[must_use]
    pub fn of(topology: &Topology, form: &[[f64; 2]]) -> Self {
        let mut bytes = Vec::new();
        let told = along(topology, |half_edge, due| {
            let given = *form.get(half_edge as usize)?;
            for k in 0..2 {
                if let Some(due) = due {
                    push_small(&mut bytes, place(given[k]).wrapping_sub(place(due[k])));
                } else {
                    bytes.extend(given[k].to_le_bytes());
                }
            }
            Some(given)
        });
        let same = |a: &[f64; 2], b: &[f64; 2]| a.map(f64::to_bits) == b.map(f64::to_bits);
        match told {
            Some(told) if told.iter().zip(form).all(|(a, b)| same(a, b)) => {
                Self::Closed(Bytes(bytes))
            }
            _ => Self::HalfEdges(form.to_vec()),
        }
    }

    /// Returns the form, by half-edge.
    ///
    /// # Errors
    /// More or fewer bytes than the mesh asks for.
    pub fn restore(&self, topology: &Topology) -> Result<Vec<[f64; 2]>, SplineFileError> {
        let Bytes(bytes) = match self {
            Self::HalfEdges(form) => return Ok(form.clone()),
            Self::Closed(bytes) => bytes,
        };
        let mut rest = bytes.as_slice();
        let form = along(topology, |_, due| {
            let mut vector = [0.0; 2];
            for (k, number) in vector.iter_mut().enumerate() {
                *number = match due {
                    Some(due) => number_at(place(due[k]).wrapping_add(take_small(&mut rest)?)),
                    None => {
                        let (word, after) = rest.split_first_chunk::<8>()?;
                        rest = after;
                        f64::from_le_bytes(*word)
                    }
                };
            }
            Some(vector)
        });
        form.filter(|_| rest.is_empty())
            .ok_or(SplineFileError::Form {
                bytes: bytes.len(),
                edges: topology.edge_count(),
            })
    }
}

/// Asks for the value of every edge, at one of its half-edges and with what the face beside it tells, and
/// returns those of all half-edges; nothing if one is not answered.
fn along(
    topology: &Topology,
    mut value: impl FnMut(u32, Option<[f64; 2]>) -> Option<[f64; 2]>,
) -> Option<Vec<[f64; 2]>> {
    let sides = 3 * topology.face_count();
    let mut form: Vec<Option<[f64; 2]>> = vec![None; sides];
    let mut faces = VecDeque::new();
    for first in 0..sides as u32 {
        if form[first as usize].is_some() {
            continue;
        }
        let settle = |half_edge: u32, value: [f64; 2], form: &mut Vec<Option<[f64; 2]>>| {
            form[half_edge as usize] = Some(value);
            let twin = topology.twin(half_edge);
            if twin != NONE {
                form[twin as usize] = Some(value.map(|x| -x));
            }
            [half_edge, twin]
                .into_iter()
                .filter(|&h| h != NONE)
                .map(|h| h / 3)
        };
        faces.extend(settle(first, value(first, None)?, &mut form));
        while let Some(face) = faces.pop_front() {
            let of_face = [0, 1, 2].map(|k| form[(3 * face + k) as usize]);
            let (missing, due) = match of_face {
                [None, Some(a), Some(b)] => (0, [a, b]),
                [Some(a), None, Some(b)] => (1, [a, b]),
                [Some(a), Some(b), None] => (2, [a, b]),
                _ => continue,
            };
            let [a, b] = due;
            let due = [0, 1].map(|k| -(a[k] + b[k]));
            let half_edge = 3 * face + missing;
            let told = value(half_edge, Some(due))?;
            faces.extend(settle(half_edge, told, &mut form));
        }
    }
    form.into_iter().collect()
}

/// Returns the place of a number among all in order, those below zero mirrored: neighbours differ by 1.
fn place(x: f64) -> i64 {
    let bits = x.to_bits() as i64;
    if bits < 0 {
        i64::MIN.wrapping_sub(bits).wrapping_sub(1)
    } else {
        bits
    }
}

/// Returns the number of a place.
fn number_at(place: i64) -> f64 {
    let bits = if place < 0 {
        i64::MIN.wrapping_sub(place).wrapping_sub(1)
    } else {
        place
    };
    f64::from_bits(bits as u64)
}

/// Adds a number in as many groups of seven bits as it needs.
fn push_small(bytes: &mut Vec<u8>, number: i64) {
    let mut rest = ((number << 1) ^ (number >> 63)) as u64;
    while rest >= 0x80 {
        bytes.push(rest as u8 | 0x80);
        rest >>= 7;
    }
    bytes.push(rest as u8);
}

fn take_small(rest: &mut &[u8]) -> Option<i64> {
    let mut found = 0_u64;
    for shift in (0..64).step_by(7) {
        let (&byte, after) = rest.split_first()?;
        *rest = after;
        found |= u64::from(byte & 0x7f) << shift;
        if byte < 0x80 {
            return Some((found >> 1) as i64 ^ -((found & 1) as i64));
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use msplines_common::mesh::shapes;
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn numbers_and_places_are_one_to_one(bits in any::<u64>(), step in any::<i64>()) {
            let x = f64::from_bits(bits);
            prop_assert_eq!(number_at(place(x)).to_bits(), bits);
            let mut bytes = Vec::new();
            push_small(&mut bytes, step);
            let mut rest = bytes.as_slice();
            prop_assert_eq!(take_small(&mut rest), Some(step));
            prop_assert!(rest.is_empty());
        }
    }

    #[test]
    fn closed_forms_come_back_to_the_bit_in_few_bytes() {
        for mesh in [shapes::torus(1.0, 0.4, 900), shapes::height_field(400)] {
            let topology = mesh.topology();
            let at = |v: u32| mesh.positions()[v as usize];
            let along = |h: u32| {
                let along = at(topology.target(h)) - at(topology.origin(h));
                [along.x + 0.3 * along.z, along.y]
            };
            // One of two half-edges tells both: zeros have signs too.
            let side = |h: u32| match topology.twin(h) {
                twin if twin < h => along(twin).map(|x| -x),
                _ => along(h),
            };
            let form: Vec<[f64; 2]> = (0..3 * mesh.face_count() as u32).map(side).collect();
            let stored = StoredForm::of(topology, &form);
            let StoredForm::Closed(Bytes(bytes)) = &stored else {
                panic!("a closed form");
            };
            assert!(
                bytes.len() < 10 * form.len(),
                "{} of {}",
                bytes.len(),
                form.len()
            );
            let bits = |form: &[[f64; 2]]| -> Vec<[u64; 2]> {
                form.iter().map(|v| v.map(f64::to_bits)).collect()
            };
            let read = stored.restore(topology).expect("a form");
            assert_eq!(bits(&read), bits(&form));
            let short = StoredForm::Closed(Bytes(bytes[1..].to_vec()));
            assert!(short.restore(topology).is_err());
            let mut long = bytes.clone();
            long.push(0);
            assert!(StoredForm::Closed(Bytes(long)).restore(topology).is_err());
        }
    }

    #[test]
    fn other_forms_are_kept_as_they_are() {
        let mesh = shapes::torus(1.0, 0.4, 100);
        let form: Vec<[f64; 2]> = (0..3 * mesh.face_count())
            .map(|h| [h as f64, 1.0])
            .collect();
        let stored = StoredForm::of(mesh.topology(), &form);
        assert!(matches!(stored, StoredForm::HalfEdges(_)));
        assert_eq!(stored.restore(mesh.topology()).expect("a form"), form);
    }
}
