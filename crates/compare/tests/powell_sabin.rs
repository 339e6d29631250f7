//! The figures of He2005 that need no model: their rows run, their bounds hold, and every panel is drawn.

mod drawn;

use drawn::{page, text};
use msplines_compare::experiment::Experiment;

#[test]
fn every_panel_of_the_generated_figures_is_drawn() {
    // Figures 1 and 8 are of the same kinds, on larger surfaces.
    for item in [
        "figure2", "figure3", "figure4", "figure5", "figure6", "figure7", "holes",
    ] {
        let page = page(&text("he2005", item));
        assert!(!page.contains("class=\"missing\""), "{item}: {page}");
    }
}

#[test]
fn panels_that_a_row_cannot_fill_say_what_to_write() {
    let head =
        "schema = \"msplines.experiment/1\"\npaper = \"he2005\"\nitem = \"i\"\ntitle = \"t\"\n";
    let row =
        "[[row]]\nid = \"a\"\nlabel = \"A\"\nsurface = \"torus-500\"\nmethod = \"powell-sabin\"\n";
    let atlas = row.replace("powell-sabin", "conformal");
    let figure = "[[figure]]\nid = \"f\"\ncaption = \"\"\n[[figure.panel]]\nrow = \"a\"\n";
    for (row, show, why) in [
        (row, "show = \"refinement\"", "layout = &quot;plane&quot;"),
        (row, "show = \"charts\"", "give their places"),
        (
            row,
            "show = \"spline\"\nclose = { mark = 0, radius = 0.1 }",
            "no mark 0",
        ),
        (
            &atlas,
            "show = \"control-triangles\"",
            "only Powell-Sabin splines",
        ),
        (&atlas, "show = \"isophotes\"", "exact normals"),
    ] {
        let page = page(&format!("{head}{row}{figure}{show}\n"));
        assert!(page.contains(why), "{show}: {page}");
    }
    for close in [
        "{ radius = 0.1 }",
        "{ mark = 0, at = [0, 0, 0], radius = 0.1 }",
        "{ mark = 0, radius = 0.0 }",
    ] {
        let text = format!("{head}{row}{figure}show = \"spline\"\nclose = {close}\n");
        let error = Experiment::parse(&text, "he2005/i.toml")
            .expect_err(close)
            .to_string();
        assert!(error.contains("`close` needs"), "{error}");
    }
}
