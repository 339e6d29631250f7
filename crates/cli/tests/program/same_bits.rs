//! Same input, same bytes: on any number of threads, and every time.

use crate::kills::content;
use crate::shape::Shape;
use crate::workbench::Workbench;

/// A command and the files that it writes.
pub(crate) struct Fit {
    pub(crate) arguments: &'static str,
    pub(crate) outputs: &'static [&'static str],
    pub(crate) shape: fn() -> Shape,
}

/// Every method, with the file of its spline first.
pub(crate) const FITS: [Fit; 10] = [
    Fit {
        arguments: "fit biharmonic in.obj --knots 40",
        outputs: &["a.json", "a.ply", "a.glb"],
        shape: Shape::ball,
    },
    Fit {
        arguments: "fit biharmonic in.obj --knots 30 --selection l1+exchange",
        outputs: &["a.json", "a.ply"],
        shape: Shape::ball,
    },
    Fit {
        arguments: "fit ls-mesh in.obj --controls 40",
        outputs: &["a.json", "a.ply"],
        shape: Shape::ball,
    },
    Fit {
        arguments: "fit powell-sabin in.obj",
        outputs: &["a.json", "a.ply", "a.vtu", "a.obj"],
        shape: Shape::ball,
    },
    Fit {
        arguments: "fit powell-sabin in.obj",
        outputs: &["a.json", "a.ply", "a.vtu", "a.obj"],
        shape: Shape::ring,
    },
    Fit {
        arguments: "fit sparse-manifold in.obj",
        outputs: &["a.json", "a.ply"],
        shape: Shape::quads,
    },
    Fit {
        arguments: "fit curve-network in.obj",
        outputs: &["a.json", "a.ply"],
        shape: Shape::curves,
    },
    Fit {
        arguments: "fit trivariate in.obj --spans 4 --spacing 12 --samples 3000,2000 --validate-at 4 --tessellate 2",
        outputs: &["a.json", "a.ply", "a.vtu", "a.msh", "a.xml"],
        shape: Shape::ball,
    },
    Fit {
        arguments: "fit t-spline in.obj --control-points 120",
        outputs: &["a.json", "a.ply", "a.vtu", "a.step"],
        shape: Shape::ring,
    },
    Fit {
        arguments: "conformal in.obj",
        outputs: &["a.json", "a.obj", "a.npy"],
        shape: Shape::ring,
    },
];

#[test]
fn every_method_gives_the_same_bytes_on_any_number_of_threads_and_again() {
    for fit in &FITS {
        let workbench = Workbench::new();
        workbench.write("in.obj", &(fit.shape)().obj());
        let outputs = fit.outputs.join(" -o ");
        let files = |threads: u32| -> Vec<Vec<u8>> {
            let line = format!(
                "{} -o {outputs} --threads {threads} --report r.json",
                fit.arguments
            );
            workbench.expect(0, &line);
            let names = fit.outputs.iter().chain([&"r.json"]);
            names.map(|name| content(&workbench, name)).collect()
        };
        let one = files(1);
        for threads in [2, 4] {
            let other = files(threads);
            for (index, name) in fit.outputs.iter().chain([&"r.json"]).enumerate() {
                let is_same = one[index] == other[index];
                assert!(is_same, "{}, {threads} threads: {name}", fit.arguments);
            }
        }
    }
}
