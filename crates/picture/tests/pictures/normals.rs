//! Surfaces whose normals are known.

use msplines_picture::{PictureError, Scene, Shading, Surface};
use nalgebra::Vector3;

use crate::{PLAIN, ball, before};

#[test]
fn exact_normals_light_coarse_facets_as_the_surface_itself() {
    let bytes = |rings: u32, exact: bool, shading| {
        let (positions, faces) = ball(1.0, rings);
        let normals: Vec<Vector3<f64>> = positions.iter().map(|p| p.coords.normalize()).collect();
        let surface = Surface::new(&positions, &faces).shading(shading);
        let mut scene = Scene::new(before(4.0));
        scene.add(if exact {
            surface.normals(&normals)
        } else {
            surface
        });
        scene.draw(&PLAIN).expect("a picture").bytes().to_vec()
    };
    let truth = bytes(200, true, Shading::Smooth);
    // Away from the rim, where a coarse ball is smaller.
    let apart = |other: &[u8]| {
        let rows = (60..140).flat_map(|row| (60..140).map(move |column| 3 * (200 * row + column)));
        let differences = rows.map(|i| u64::from(truth[i].abs_diff(other[i])));
        differences.sum::<u64>()
    };
    let (means, exact) = (
        apart(&bytes(9, false, Shading::Smooth)),
        apart(&bytes(9, true, Shading::Smooth)),
    );
    assert!(2 * exact < means, "{exact} {means}");
    // Flat faces have normals of their own.
    assert_eq!(
        bytes(9, true, Shading::Flat),
        bytes(9, false, Shading::Flat)
    );
}

#[test]
fn normals_are_as_many_as_vertices() {
    let (positions, faces) = ball(1.0, 6);
    let normals = [Vector3::x()];
    let mut scene = Scene::new(before(4.0));
    scene.add(Surface::new(&positions, &faces).normals(&normals));
    let error = scene.draw(&PLAIN).err();
    let found = matches!(
        error,
        Some(PictureError::WrongCount {
            what: "normals",
            found: 1,
            ..
        })
    );
    assert!(found, "{error:?}");
}
