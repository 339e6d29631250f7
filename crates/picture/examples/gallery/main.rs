//! Draws one picture of everything the crate can do into a folder given on the command line.

#![expect(clippy::print_stdout, reason = "an example tells what it has written")]

mod plots;
mod shapes;

use std::error::Error;
use std::fs;
use std::path::PathBuf;

use msplines_picture::cells::{HalfSpace, cut_hexahedra};
use msplines_picture::{
    Axis, Callout, Camera, ColourBar, ColourMap, ColourScale, Corner, Curves, Drawing, Grid, Image,
    Paint, Panel, Radius, Rect, Rgb, Scene, Shading, Spheres, Surface, View, edges,
};
use nalgebra::{Point3, Vector3};

type Outcome = Result<Image, Box<dyn Error>>;
/// A name and what draws the picture of this name.
type Entry = (&'static str, fn() -> Outcome);

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args()
        .nth(1)
        .ok_or("give a folder to draw into")?;
    let folder = PathBuf::from(folder);
    fs::create_dir_all(&folder)?;
    let pictures: [Entry; 8] = [
        ("clay", clay),
        ("knot", knot),
        ("errors", errors),
        ("holes", holes),
        ("checkers", checkers),
        ("control", control),
        ("volume", volume),
        ("panels", panels),
    ];
    for (name, draw) in pictures {
        let png = draw()?.to_png();
        println!("{name}.png: {} bytes", png.len());
        fs::write(folder.join(format!("{name}.png")), png)?;
    }
    for (name, svg) in [
        ("convergence", plots::convergence()?),
        ("front", plots::front()?),
        ("times", plots::times()?),
    ] {
        println!("{name}.svg: {} bytes", svg.len());
        fs::write(folder.join(format!("{name}.svg")), svg)?;
    }
    Ok(())
}

fn drawing(side: usize) -> Drawing {
    Drawing {
        width: side,
        height: side,
        ..Drawing::default()
    }
}

fn clay() -> Outcome {
    let shape = shapes::bumpy_sphere(370);
    let mut scene = Scene::new(Camera::framing(&shape.positions, &View::default()));
    scene.add(Surface::new(&shape.positions, &shape.faces));
    Ok(scene.draw(&drawing(1000))?)
}

fn knot() -> Outcome {
    let shape = shapes::torus_knot(400, 36);
    let view = View {
        elevation: 0.9,
        ..View::default()
    };
    let mut scene = Scene::new(Camera::framing(&shape.positions, &view));
    let blue = Paint::Uniform(Rgb::SKY);
    scene.add(Surface::new(&shape.positions, &shape.faces).paint(blue));
    Ok(scene.draw(&drawing(800))?)
}

fn errors() -> Outcome {
    let shape = shapes::bumpy_sphere(200);
    let values: Vec<f64> = shape
        .positions
        .iter()
        .map(|p| 1e-4 * (p.coords.norm() - 1.0).abs().powi(2) * 40.0)
        .collect();
    let scale = ColourScale::linear(ColourMap::ColdWarm, [0.0, 1.2e-4]);
    let mut scene = Scene::new(Camera::framing(&shape.positions, &View::default()));
    let paint = Paint::Scalars {
        values: &values,
        scale,
    };
    scene.add(Surface::new(&shape.positions, &shape.faces).paint(paint));
    let drawing = drawing(900);
    let image = scene.draw(&drawing)?;
    let callout = Callout {
        corner: Corner::TopLeft,
        magnification: 3,
        ..Callout::new(Rect {
            x: 500,
            y: 380,
            width: 90,
            height: 90,
        })
    };
    let wires = edges(&shape.faces);
    scene.add(Curves::new(&shape.positions, &wires).width(0.3));
    let inset = scene.draw(&Drawing {
        detail: Some(callout.detail()),
        ..drawing
    })?;
    let image = callout.place(&image, &inset)?;
    Ok(ColourBar::new(scale, "error / diagonal").beside(&image)?)
}

fn holes() -> Outcome {
    let shape = shapes::bumpy_sphere(60);
    let faces: Vec<_> = shape
        .faces
        .iter()
        .filter(|face| {
            let centre = face.iter().map(|v| shape.positions[*v as usize].coords);
            let centre = centre.sum::<Vector3<f64>>() / 3.0;
            centre.dot(&Vector3::new(0.5, 0.5, 0.8)) < 0.62
        })
        .copied()
        .collect();
    let wires = edges(&faces);
    let mut scene = Scene::new(Camera::framing(&shape.positions, &View::default()));
    scene.add(Surface::new(&shape.positions, &faces).shading(Shading::Flat));
    scene.add(
        Curves::new(&shape.positions, &wires)
            .width(1.0)
            .colour(Rgb::GREY),
    );
    Ok(scene.draw(&drawing(800))?)
}

fn checkers() -> Outcome {
    let shape = shapes::sphere(120);
    let corners = shape.texture(120);
    let paint = Paint::Checkers {
        corners: &corners,
        squares: 16.0,
        colours: [Rgb::WHITE, Rgb::BLUE],
    };
    let mut scene = Scene::new(Camera::framing(&shape.positions, &View::default()));
    scene.add(Surface::new(&shape.positions, &shape.faces).paint(paint));
    Ok(scene.draw(&drawing(800))?)
}

fn control() -> Outcome {
    let shape = shapes::bumpy_sphere(160);
    let curve: Vec<Point3<f64>> = shapes::loop_on_bumpy_sphere(300);
    let segments: Vec<[u32; 2]> = (0..300).map(|i| [i, (i + 1) % 300]).collect();
    let coarse = shapes::bumpy_sphere(8);
    let hull: Vec<_> = coarse
        .positions
        .iter()
        .map(|p| Point3::from(p.coords * 1.25))
        .collect();
    let near: Vec<_> = coarse
        .faces
        .iter()
        .filter(|face| face.iter().all(|v| hull[*v as usize].x > 0.2))
        .copied()
        .collect();
    let sides = edges(&near);
    let mut used: Vec<u32> = near.iter().flatten().copied().collect();
    used.sort_unstable();
    used.dedup();
    let points: Vec<_> = used.iter().map(|v| hull[*v as usize]).collect();
    let mut scene = Scene::new(Camera::framing(&hull, &View::default()));
    scene.add(Surface::new(&shape.positions, &shape.faces));
    scene.add(Curves::new(&curve, &segments).width(4.0).colour(Rgb::RED));
    let glass = Surface::new(&hull, &near).paint(Paint::Uniform(Rgb::SKY));
    scene.add(glass.shading(Shading::Flat).opacity(0.35));
    scene.add(Curves::new(&hull, &sides).width(2.0).colour(Rgb::BLUE));
    scene.add(Spheres::new(&points).radius(Radius::Pixels(8.0)));
    let knots: Vec<_> = curve.iter().step_by(20).copied().collect();
    let dots = Spheres::new(&knots).radius(Radius::World(0.03));
    scene.add(dots.colour(Rgb::SAND));
    Ok(scene.draw(&drawing(1000))?)
}

fn volume() -> Outcome {
    let (points, cells) = shapes::twisted_block(14);
    let plane = HalfSpace {
        point: Point3::origin(),
        normal: Vector3::new(1.0, 0.0, 0.6),
    };
    let upper = HalfSpace {
        point: Point3::new(0.0, 0.05, 0.0),
        normal: Vector3::y(),
    };
    let skin = cut_hexahedra(&cells, |cell| {
        let cell = &cells[cell];
        !(plane.holds_centre(&points, cell) && upper.holds_centre(&points, cell))
    });
    let mut scene = Scene::new(Camera::framing(&points, &View::default()));
    for (faces, colour) in [(&skin.outer, Rgb::SKY), (&skin.fresh, Rgb::SAND)] {
        let surface = Surface::new(&points, &faces.triangles).shading(Shading::Flat);
        scene.add(surface.paint(Paint::Uniform(colour)));
        scene.add(Curves::new(&points, &faces.edges).width(1.2));
    }
    Ok(scene.draw(&drawing(900))?)
}

fn panels() -> Outcome {
    let mut images = Vec::new();
    for map in [
        ColourMap::Viridis,
        ColourMap::Magma,
        ColourMap::Inferno,
        ColourMap::ColdWarm,
        ColourMap::Diverging,
    ] {
        let shape = shapes::bumpy_sphere(100);
        let values: Vec<f64> = shape
            .positions
            .iter()
            .map(|p| 10f64.powf(2.0 * p.y))
            .collect();
        let scale = ColourScale::logarithmic(map, [1e-2, 1e2]);
        let view = View {
            up: Axis::Z,
            azimuth: 0.8,
            ..View::default()
        };
        let mut scene = Scene::new(Camera::framing(&shape.positions, &view));
        let paint = Paint::Scalars {
            values: &values,
            scale,
        };
        scene.add(Surface::new(&shape.positions, &shape.faces).paint(paint));
        let image = scene.draw(&drawing(360))?;
        let bar = ColourBar {
            text_size: 18.0,
            ..ColourBar::new(scale, "ratio")
        };
        images.push((bar.beside(&image)?, format!("({map:?})")));
    }
    let panels: Vec<_> = images
        .iter()
        .map(|(image, label)| Panel { image, label })
        .collect();
    Ok(Grid::default().compose(&panels)?)
}
