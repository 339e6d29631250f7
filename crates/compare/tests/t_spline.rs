//! The figures of He2006 that need no model: their rows run, their bounds hold, and every panel is drawn.

mod drawn;

use drawn::{page, text};

#[test]
fn every_panel_of_the_generated_figures_is_drawn() {
    // Figures 3, 4 and 8 are of the same kinds, on larger surfaces.
    for item in ["figure1", "figure2", "figure6"] {
        let page = page(&text("he2006", item));
        assert!(!page.contains("class=\"missing\""), "{item}: {page}");
    }
}

#[test]
fn panels_that_a_row_cannot_fill_say_what_to_write() {
    let head =
        "schema = \"msplines.experiment/1\"\npaper = \"he2006\"\nitem = \"i\"\ntitle = \"t\"\n";
    let row =
        "[[row]]\nid = \"a\"\nlabel = \"A\"\nsurface = \"torus-500\"\nmethod = \"t-spline\"\n";
    let fit = "fit = { stop = { control_points = 200 } }";
    let figure = "[[figure]]\nid = \"f\"\ncaption = \"\"\n[[figure.panel]]\nrow = \"a\"\n";
    for (pictures, show, why) in [
        ("", "show = \"cylinders\"", "pictures = true"),
        ("", "show = \"control-points\"", "pictures = true"),
        ("", "show = \"checkers\"", "pictures = true"),
        (
            "pictures = true, ",
            "show = \"level\"\nlevel = 6",
            "there are 6",
        ),
        ("pictures = true, ", "show = \"isophotes\"", "exact normals"),
    ] {
        let method = format!("t_spline = {{ {pictures}{fit} }}\n");
        let page = page(&format!("{head}{row}{method}{figure}{show}\n"));
        assert!(page.contains(why), "{show}: {page}");
    }
    for show in ["show = \"level\"", "show = \"spline\"\nlevel = 0"] {
        let text = format!("{head}{row}{figure}{show}\n");
        let error = msplines_compare::experiment::Experiment::parse(&text, "he2006/i.toml")
            .expect_err(show)
            .to_string();
        assert!(error.contains("`level` goes with"), "{error}");
    }
}
