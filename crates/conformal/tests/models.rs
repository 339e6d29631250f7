//! Conformal maps of surfaces of the library of models.
mod library;

use msplines_common::operators::intrinsic::FlipRule;
use msplines_conformal::sphere::spherical_map;

#[test]
fn probe() {
    let names = std::env::var("NAMES").unwrap();
    for name in names.split(',') {
        let Some(mesh) = library::model(name) else {
            continue;
        };
        for rule in [FlipRule::Simplicial, FlipRule::Any] {
            let t = std::time::Instant::now();
            match spherical_map(&mesh, rule) {
                Ok(m) => println!(
                    "{name} {rule:?} nv {} neg {} moved {} meshflips {} {:?} {:.2}s",
                    mesh.vertex_count(),
                    m.triangulation.negative_edges,
                    m.moved,
                    m.flips_of_mesh,
                    m.distortion,
                    t.elapsed().as_secs_f64()
                ),
                Err(e) => println!("{name} {rule:?} {e} {:.2}s", t.elapsed().as_secs_f64()),
            }
        }
    }
}
