//! Surfaces whose normals are known.

use msplines_picture::{PictureError, Scene, Shading, Surface};
use nalgebra::{Point3, Vector3};

use crate::{PLAIN, ball, before};

#[test]
fn known_normals_are_lit_in_place_of_the_means_of_faces() {
    let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
    let positions = corners.map(|[x, y]| Point3::new(x, y, 0.0));
    let faces = [[0, 1, 2], [0, 2, 3]];
    let lit = |normal: Option<[f64; 3]>, shading| {
        let normals = [Vector3::from(normal.unwrap_or_default()).normalize(); 4];
        let surface = Surface::new(&positions, &faces).shading(shading);
        let mut scene = Scene::new(before(4.0));
        scene.add(match normal {
            Some(_) => surface.normals(&normals),
            None => surface,
        });
        scene.draw(&PLAIN).expect("a picture").bytes().to_vec()
    };
    let sum = |bytes: &[u8]| bytes.iter().map(|&b| u64::from(b)).sum::<u64>();
    let means = lit(None, Shading::Smooth);
    assert_eq!(lit(Some([0.0, 0.0, 1.0]), Shading::Smooth), means);
    // The key light stands at the upper left of the eye.
    let (towards, away) = ([-0.5, 0.5, 1.0], [0.5, -0.5, 1.0]);
    let towards = sum(&lit(Some(towards), Shading::Smooth));
    let opposed = sum(&lit(Some(away), Shading::Smooth));
    assert!(towards > sum(&means) && sum(&means) > opposed);
    // Flat faces have normals of their own.
    assert_eq!(lit(Some(away), Shading::Flat), lit(None, Shading::Flat));
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
