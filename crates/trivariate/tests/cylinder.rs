//! Cylindrical parameters of real surfaces, where their files are at hand.

#[path = "../../../tests/library.rs"]
mod library;

use library::model;
use msplines_common::progress::unobserved;
use msplines_trivariate::cylinder::{self, Options, degenerate_places};
use msplines_trivariate::measure::measure;

#[test]
fn the_axis_and_the_poles_of_models_are_degenerate() {
    for (name, rms) in [
        ("bone_6k", 1e-2),
        ("moai_10k", 1e-2),
        ("lion_vase_10k", 1.2e-2),
    ] {
        let Some(surface) = model(name) else {
            continue;
        };
        let options = Options::default();
        let map = cylinder::map(&surface, &options, &mut unobserved()).expect("a map");
        let fit = cylinder::fit(&map, &options, &mut unobserved()).expect("a fit");
        assert!(fit.surface.rms < rms, "{name}: {:?}", fit.surface);
        // No finer sampling helps: they grow like areas.
        let [coarse, fine] = [20, 30].map(|cells| degenerate_places(&fit.spline, cells, 1));
        assert_eq!(
            coarse.total(),
            measure(&fit.spline, 20).degenerate,
            "{name}"
        );
        assert!(
            coarse.axis > 18 * 20 && fine.axis > 2 * coarse.axis,
            "{name}"
        );
        assert!(coarse.poles > 400 && fine.poles > coarse.poles, "{name}");
        assert!(fine.total() > 5000, "{name}: {fine:?}");
    }
}
