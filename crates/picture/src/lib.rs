//! Pictures of surfaces, curves and volumes, and plots: values in, pixels out.
//!
//! There is no window, no graphics card and no file here. A [`Scene`] holds borrowed positions and
//! faces, [`Scene::draw`] rasterises it on the processor into an [`Image`], and
//! [`Image::to_png`] encodes that as bytes. The same scene gives the same bytes on any number of
//! threads. Lighting is computed in linear light; all colours that go in and come out are sRGB.
//!
//! ```
//! use msplines_picture::{Camera, Curves, Drawing, Rgb, Scene, Surface, View};
//! use nalgebra::Point3;
//!
//! let positions = [
//!     Point3::new(0.0, 0.0, 0.0),
//!     Point3::new(1.0, 0.0, 0.0),
//!     Point3::new(0.0, 1.0, 0.0),
//! ];
//! let mut scene = Scene::new(Camera::framing(&positions, &View::default()));
//! scene.add(Surface::new(&positions, &[[0, 1, 2]]));
//! scene.add(Curves::new(&positions, &[[0, 1]]).colour(Rgb::RED).width(2.0));
//! let image = scene.draw(&Drawing { width: 60, height: 60, ..Drawing::default() })?;
//! let png: Vec<u8> = image.to_png();
//! # assert_eq!(&png[1..4], b"PNG");
//! # Ok::<(), msplines_picture::PictureError>(())
//! ```
//!
//! [`Grid`] puts pictures side by side, [`Callout`] draws a magnified part into a corner,
//! [`ColourBar`] explains the colours of a scalar, [`category_colours`] tells neighbours apart,
//! [`cells`] cuts volumes open, and [`plot`] draws curves and bars as SVG.

pub mod cells;
pub mod plot;

mod callout;
mod camera;
mod categories;
mod colour;
mod colour_bar;
mod colour_map;
mod draw;
mod error;
mod grid;
mod image;
mod scene;
mod text;
mod ticks;

pub use callout::{Callout, Corner};
pub use camera::{Axis, Camera, View};
pub use categories::category_colours;
pub use colour::Rgb;
pub use colour_bar::ColourBar;
pub use colour_map::{ColourMap, ColourScale, Spacing};
pub use draw::{Detail, Drawing, Occlusion};
pub use error::PictureError;
pub use grid::{Grid, LabelPlace, Panel};
pub use image::{Image, MAX_PIXELS, Rect};
pub use scene::{Curves, Object, Paint, Radius, Scene, Shading, Spheres, Surface, edges};
pub use text::{Anchor, TextStyle, text_width};
