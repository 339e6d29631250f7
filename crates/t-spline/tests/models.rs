//! Domains of surfaces of the library of models.
#![allow(clippy::print_stdout, reason = "the figures of every model are shown")]

mod library;

use std::time::Instant;

use msplines_t_spline::domain::{Domain, DomainOptions};

const CLOSED: [&str; 6] = [
    "kitten_40k",
    "rocker_arm_50k",
    "fertility_30k",
    "double_torus_2k",
    "happy_buddha_25k",
    "heptoroid_22k",
];

#[test]
fn closed_models_are_cut_into_cylinders() {
    for name in CLOSED {
        let Some(mesh) = library::model(name) else {
            continue;
        };
        let start = Instant::now();
        match Domain::of_surface(&mesh, &DomainOptions::default()) {
            Ok(domain) => println!("{name}: {:?} {:?}", start.elapsed(), domain.report()),
            Err(error) => println!("{name}: {:?} {error}", start.elapsed()),
        }
    }
}
