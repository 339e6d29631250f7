//! Limbs along which forms decay below every digit of their potentials.

use msplines_common::progress::unobserved;

use super::shapes::with_finger;
use crate::{Atlas, FormChoice, HolomorphicBasis};

#[test]
fn a_finger_lies_flat_although_the_form_decays_beyond_the_digits_of_a_number() {
    let mesh = with_finger(60);
    let basis = HolomorphicBasis::build(&mesh, &mut unobserved()).unwrap();
    assert!(
        basis.co_closedness < 1e-9,
        "flux relative to its neighbours {}",
        basis.co_closedness
    );
    let found = Atlas::closed(&mesh, &FormChoice::default(), &mut unobserved()).unwrap();
    assert_eq!(
        (found.atlas.folded_faces(), found.atlas.zeros().len()),
        (0, 0)
    );
    let lengths = found.atlas.form().iter().map(|v| v[0].hypot(v[1]));
    let (least, largest) = lengths.fold((f64::INFINITY, 0.0f64), |(a, b), l| (a.min(l), b.max(l)));
    assert!(least < 1e-20 * largest, "from {least} to {largest}");
    assert!(found.atlas.closedness() < 1e-12);
}
