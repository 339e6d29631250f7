//! Plots are whole, safe and repeatable SVG files.

use std::collections::BTreeMap;

use msplines_picture::PictureError;
use msplines_picture::plot::{Bar, Bars, Highlight, Look, Note, Plot, Quantity, Series};
use quick_xml::Reader;
use quick_xml::events::Event;

/// Returns how often each element occurs, and all text without the references to characters.
fn parse(svg: &str) -> (BTreeMap<String, usize>, String) {
    let mut reader = Reader::from_str(svg);
    reader.config_mut().check_end_names = true;
    let (mut counts, mut text, mut depth) = (BTreeMap::new(), String::new(), 0);
    loop {
        match reader.read_event().expect("well-formed XML") {
            Event::Start(tag) => {
                depth += 1;
                let name = tag.name().as_ref().to_owned();
                *counts.entry(name).or_default() += 1;
                assert!(tag.attributes().all(|attribute| attribute.is_ok()));
            }
            Event::Empty(tag) => {
                let name = tag.name().as_ref().to_owned();
                *counts.entry(name).or_default() += 1;
                assert!(tag.attributes().all(|attribute| attribute.is_ok()));
            }
            Event::End(_) => depth -= 1,
            Event::Text(piece) => text += &piece,
            Event::Eof => break,
            _ => {}
        }
    }
    assert_eq!(depth, 0);
    (counts, text)
}

const POINTS: [[f64; 2]; 4] = [[1.0, 0.1], [2.0, 0.01], [f64::NAN, 1.0], [4.0, 0.001]];

fn plot() -> Plot<'static> {
    let marks = Series {
        look: Look::Marks,
        ..Series::new("a < b & \"c\"", &POINTS)
    };
    Plot {
        title: "T <&> \u{0}\u{1b}'",
        x: Quantity::linear("time (s)"),
        y: Quantity::logarithmic("error"),
        series: vec![marks, Series::new("second", &POINTS)],
        notes: vec![Note {
            at: POINTS[1],
            text: "<script>",
        }],
        highlight: Some(Highlight {
            name: "front",
            points: &POINTS,
        }),
        size: [640, 400],
    }
}

#[test]
fn a_plot_is_well_formed_and_its_text_escaped() {
    let svg = plot().to_svg().expect("a plot");
    assert_eq!(svg, plot().to_svg().expect("a plot"));
    let (counts, text) = parse(&svg);
    assert_eq!(counts["svg"], 1);
    assert!(svg.contains("a &lt; b &amp; &quot;c&quot;") && svg.contains("&lt;script&gt;"));
    assert!(!svg.contains("<script") && !svg.contains('\u{1b}'));
    assert!(text.contains("time (s)") && text.contains("front") && text.contains("0.001"));
    // Nothing outside is referred to, and the font is the reader's own.
    assert!(!svg.contains("href") && svg.contains("font-family=\"sans-serif\""));
}

#[test]
fn every_finite_point_has_a_mark() {
    let svg = plot().to_svg().expect("a plot");
    // Three points and the legend of the first series, whose mark is a circle.
    assert_eq!(parse(&svg).0["circle"], 4);
}

#[test]
fn bars_are_well_formed_and_one_without_a_value_is_left_out() {
    let bar = |name, value| Bar {
        name,
        value,
        kind: 1,
    };
    let bars = [
        bar("x & y", 2.5),
        bar("none", f64::INFINITY),
        bar("small", 0.1),
    ];
    for quantity in [Quantity::linear("s"), Quantity::logarithmic("s")] {
        let svg = Bars::new(quantity, &bars).to_svg().expect("a chart");
        let (counts, text) = parse(&svg);
        // The white ground and two bars.
        assert_eq!(counts["polygon"], 3);
        assert!(text.contains("2.5") && text.contains("small"));
    }
}

#[test]
fn what_cannot_be_plotted_is_named() {
    let none = Plot {
        series: vec![Series::new("", &[])],
        ..Plot::default()
    };
    assert_eq!(none.to_svg(), Err(PictureError::NothingToPlot));
    let wrong = [[1.0, 0.0]];
    let plot = Plot {
        y: Quantity::logarithmic("y"),
        series: vec![Series::new("s", &wrong)],
        ..Plot::default()
    };
    let series = "s".to_owned();
    assert_eq!(
        plot.to_svg(),
        Err(PictureError::NotPositive { series, value: 0.0 })
    );
    let tiny = Plot {
        size: [5, 400],
        ..self::plot()
    };
    assert!(matches!(tiny.to_svg(), Err(PictureError::BadOption { .. })));
    assert_eq!(
        Bars::new(Quantity::default(), &[]).to_svg(),
        Err(PictureError::NothingToPlot)
    );
}

#[test]
fn extreme_numbers_still_give_a_plot() {
    for points in [
        [[0.0, 0.0], [0.0, 0.0]],
        [[-f64::MAX, 1.0], [f64::MAX, 2.0]],
        [[5e-324, 1e308], [1e-300, -1e308]],
    ] {
        let plot = Plot {
            series: vec![Series::new("s", &points)],
            ..Plot::default()
        };
        parse(&plot.to_svg().expect("a plot"));
    }
}
