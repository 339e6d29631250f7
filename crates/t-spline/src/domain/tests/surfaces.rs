use msplines_common::mesh::shapes;

use crate::domain::{Domain, DomainOptions};

#[test]
fn first() {
    for mesh in [shapes::torus(1.0, 0.4, 900), shapes::genus(2, 2400), shapes::genus(3, 4800)] {
        let found = Domain::of_surface(&mesh, &DomainOptions::default());
        match found {
            Ok(d) => println!("{:?}\n{:#?}", d.report(), d.complex().cylinders().len()),
            Err(e) => println!("{e}"),
        }
    }
}
