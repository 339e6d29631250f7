//! Spline files whose numbers lie: JSON stays whole, so that damage reaches what makes splines of it.

use std::sync::LazyLock;

use serde_json::{Value, json};

use crate::own_files::spline;

/// Sound files of every method.
const SOUND: [&str; 9] = [
    include_str!("../corpus/spline_file/biharmonic"),
    include_str!("../corpus/spline_file/ls-mesh"),
    include_str!("../corpus/spline_file/sparse-manifold"),
    include_str!("../corpus/spline_file/chart"),
    include_str!("../corpus/spline_file/trivariate"),
    include_str!("../corpus/spline_file/powell-sabin"),
    include_str!("../corpus/spline_file/t-spline"),
    include_str!("../corpus/spline_file/t-spline-1"),
    include_str!("../corpus/spline_file/t-spline-poles"),
];

static FILES: LazyLock<Vec<Value>> = LazyLock::new(|| {
    let read = |text: &&str| match serde_json::from_str(text) {
        Ok(value) => value,
        Err(error) => panic!("a seed is no JSON: {error}"),
    };
    SOUND.iter().map(read).collect()
});

/// Bytes that tell one blow: where, and what happens there.
const BLOW: usize = 4;

/// Holds spline files to their laws after a few blows to a sound one, which the first byte chooses.
pub fn damaged_spline(bytes: &[u8]) {
    let Some((&which, blows)) = bytes.split_first() else {
        return;
    };
    let mut file = FILES[usize::from(which) % FILES.len()].clone();
    for blow in blows.as_chunks::<BLOW>().0 {
        strike(&mut file, blow);
    }
    spline(file.to_string().as_bytes());
}

/// Damages one place: the first byte leads through objects, the next two through arrays.
fn strike(file: &mut Value, &[field, high, low, kind]: &[u8; BLOW]) {
    let mut place = usize::from(u16::from_be_bytes([high, low]));
    let mut field = usize::from(field);
    let mut at = file;
    while leads_on(at, kind) {
        at = match at {
            Value::Object(fields) => {
                let count = fields.len();
                let Some(value) = fields.values_mut().nth(field % count) else {
                    return;
                };
                field /= count;
                value
            }
            Value::Array(list) => {
                let count = list.len();
                let value = &mut list[place % count];
                place /= count;
                value
            }
            _ => return,
        };
    }
    damage(at, kind / 4, place);
}

/// Whether a blow of this kind goes further than here; some hit a whole list of numbers.
fn leads_on(value: &Value, kind: u8) -> bool {
    match value {
        Value::Object(fields) => !fields.is_empty(),
        Value::Array(list) => {
            let stops = kind % 4 == 3 && !list.iter().any(Value::is_array);
            !list.is_empty() && !stops
        }
        _ => false,
    }
}

fn damage(leaf: &mut Value, kind: u8, place: usize) {
    match leaf {
        Value::Array(list) if !list.is_empty() => {
            let at = place % list.len();
            match kind % 3 {
                0 => drop(list.remove(at)),
                1 => list.insert(at, list[at].clone()),
                _ => list.clear(),
            }
        }
        Value::Bool(flag) => *flag = !*flag,
        other => {
            *other = match kind % 16 {
                0 => json!(0),
                1 => json!(1),
                2 => json!(-1),
                3 => json!(2),
                4 => json!(u32::MAX),
                5 => json!(u64::MAX),
                6 => json!(1e308),
                7 => json!(-1e308),
                8 => json!(1e-320),
                9 => json!(0.5),
                10 => Value::Null,
                11 => json!(""),
                12 => json!([]),
                13 => json!(65_535),
                14 => json!(1u64 << 40),
                _ => json!(place),
            }
        }
    }
}
