//! A coloured surface with its lines, points and camera as text that a page can hold.
//!
//! The text is base64 of gzip of little-endian numbers, read again by `viewer/viewer.js`:
//!
//! | type | count | what |
//! |---|---|---|
//! | u32 | 1 | the letters `MSV1` |
//! | u32 | 4 | number of vertices, triangles, segments, points |
//! | f32 | 3 + 3 | lowest and highest corner of the box |
//! | f32 | 3 + 3 + 3 | camera: eye, target, up |
//! | f32 | 1 + 1 + 1 | vertical field of view, line width, point radius |
//! | u32 | 3 per triangle | vertices |
//! | u16 | 3 per vertex, 6 per segment, 3 per point | coordinates as 65,535ths of the box |
//! | u8 | 3 per vertex, then 3 + 3 | colours of the vertices, of the lines, of the points |

use std::io::Write as _;

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use flate2::Compression;
use flate2::write::GzEncoder;

/// The letters `MSV1`.
const MAGIC: u32 = u32::from_le_bytes(*b"MSV1");
/// Steps across the box in each direction.
const STEPS: f64 = u16::MAX as f64;
/// Colour of vertices that have none, in sRGB.
pub const CLAY: [u8; 3] = [214, 208, 198];

/// A surface as it is looked at. Lengths are those of `positions`, colours are sRGB.
#[derive(Clone, Copy, Debug)]
pub struct SurfaceView<'a> {
    /// Positions of the vertices.
    pub positions: &'a [[f64; 3]],
    /// Vertices of each triangle.
    pub triangles: &'a [[u32; 3]],
    /// Colour of each vertex; those that are missing at the end are [`CLAY`].
    pub colours: &'a [[u8; 3]],
    /// Lines on the surface.
    pub lines: Lines<'a>,
    /// Points on the surface.
    pub points: Points<'a>,
    /// Where it is seen from.
    pub camera: Camera,
}

/// Pieces of lines.
#[derive(Clone, Copy, Debug, Default)]
pub struct Lines<'a> {
    /// Both ends of each piece.
    pub segments: &'a [[[f64; 3]; 2]],
    /// Their colour.
    pub colour: [u8; 3],
    /// Their width in pixels of the still picture.
    pub width: f64,
}

/// Points, shown as spheres.
#[derive(Clone, Copy, Debug, Default)]
pub struct Points<'a> {
    /// Their positions.
    pub positions: &'a [[f64; 3]],
    /// Their colour.
    pub colour: [u8; 3],
    /// Radius of the spheres.
    pub radius: f64,
}

/// A perspective camera.
#[derive(Clone, Copy, Debug)]
pub struct Camera {
    /// Where it stands.
    pub eye: [f64; 3],
    /// What it looks at, and what it turns around.
    pub target: [f64; 3],
    /// What is up in the picture; not parallel to the view.
    pub up: [f64; 3],
    /// Angle between the lower and the upper edge of the picture, in radians.
    pub field_of_view: f64,
}

/// Returns the surface as base64 text.
///
/// A coordinate is off by at most half a step, 1/131,070 of the box in its direction, and by what
/// rounding the box to single precision moves. Takes 6 + 3 bytes per vertex and 12 per triangle
/// before compression, so a mesh should be as coarse as its picture allows. Coordinates that are not
/// finite end up at the lowest corner of the box.
#[must_use]
pub fn encode(view: &SurfaceView) -> String {
    let bytes = numbers(view);
    let mut packed = GzEncoder::new(Vec::new(), Compression::best());
    // Writing to memory does not fail.
    let _ = packed.write_all(&bytes);
    STANDARD.encode(packed.finish().unwrap_or_default())
}

fn numbers(view: &SurfaceView) -> Vec<u8> {
    let SurfaceView {
        positions,
        triangles,
        colours,
        lines,
        points,
        camera,
    } = view;
    let ends = lines.segments.as_flattened();
    let groups = [positions, ends, points.positions];
    let (low, high) = bounds(groups.into_iter().flatten());

    let mut out = Vec::with_capacity(92 + 9 * positions.len() + 12 * triangles.len());
    let counts = [
        positions.len(),
        triangles.len(),
        lines.segments.len(),
        points.positions.len(),
    ];
    put_u32(&mut out, MAGIC);
    for count in counts {
        put_u32(&mut out, u32::try_from(count).unwrap_or(u32::MAX));
    }
    let corners = [low, high].map(|corner| corner.map(f64::from));
    for point in corners
        .iter()
        .chain([&camera.eye, &camera.target, &camera.up])
    {
        put_f32(&mut out, point);
    }
    put_f32(
        &mut out,
        &[camera.field_of_view, lines.width, points.radius],
    );
    for &vertex in triangles.as_flattened() {
        put_u32(&mut out, vertex);
    }
    for point in groups.into_iter().flatten() {
        for step in steps(point, low, high) {
            out.extend(step.to_le_bytes());
        }
    }
    let bare = positions.len().saturating_sub(colours.len());
    let coloured = colours.iter().take(positions.len());
    for colour in coloured.chain(std::iter::repeat_n(&CLAY, bare)) {
        out.extend(colour);
    }
    out.extend(lines.colour);
    out.extend(points.colour);
    out
}

/// Returns the corners of the box of all finite coordinates, as single precision holds them.
fn bounds<'a>(points: impl Iterator<Item = &'a [f64; 3]>) -> ([f32; 3], [f32; 3]) {
    let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    for point in points {
        for axis in (0..3).filter(|&axis| point[axis].is_finite()) {
            low[axis] = low[axis].min(point[axis]);
            high[axis] = high[axis].max(point[axis]);
        }
    }
    let told = |corner: [f64; 3]| corner.map(|c| if c.is_finite() { c as f32 } else { 0.0 });
    (told(low), told(high))
}

/// Returns the coordinates as steps from the low corner; a flat box has only step 0.
fn steps(point: &[f64; 3], low: [f32; 3], high: [f32; 3]) -> [u16; 3] {
    std::array::from_fn(|axis| {
        let (low, high) = (f64::from(low[axis]), f64::from(high[axis]));
        // A cast saturates, and takes what is no number to 0.
        ((point[axis] - low) / (high - low) * STEPS).round() as u16
    })
}

fn put_u32(out: &mut Vec<u8>, value: u32) {
    out.extend(value.to_le_bytes());
}

fn put_f32(out: &mut Vec<u8>, values: &[f64; 3]) {
    for &value in values {
        out.extend((value as f32).to_le_bytes());
    }
}

#[cfg(test)]
mod tests {
    use std::io::Read as _;

    use super::*;

    const CAMERA: Camera = Camera {
        eye: [0.0, -5.0, 1.0],
        target: [0.0, 0.0, 0.5],
        up: [0.0, 0.0, 1.0],
        field_of_view: 0.5,
    };

    fn bare<'a>(positions: &'a [[f64; 3]], triangles: &'a [[u32; 3]]) -> SurfaceView<'a> {
        SurfaceView {
            positions,
            triangles,
            colours: &[],
            lines: Lines::default(),
            points: Points::default(),
            camera: CAMERA,
        }
    }

    /// The numbers of a payload, read one after the other.
    struct Reader(std::vec::IntoIter<u8>);

    impl Reader {
        fn open(text: &str) -> Self {
            let packed = STANDARD.decode(text).expect("base64");
            let mut bytes = Vec::new();
            flate2::read::GzDecoder::new(packed.as_slice())
                .read_to_end(&mut bytes)
                .expect("gzip");
            Self(bytes.into_iter())
        }

        fn bytes<const N: usize>(&mut self) -> [u8; N] {
            std::array::from_fn(|_| self.0.next().expect("long enough"))
        }

        fn u32s<const N: usize>(&mut self) -> [u32; N] {
            std::array::from_fn(|_| u32::from_le_bytes(self.bytes()))
        }

        fn f32s(&mut self) -> [f32; 3] {
            std::array::from_fn(|_| f32::from_le_bytes(self.bytes()))
        }

        fn point(&mut self, low: [f32; 3], high: [f32; 3]) -> [f64; 3] {
            std::array::from_fn(|axis| {
                let step = f64::from(u16::from_le_bytes(self.bytes()));
                let (low, high) = (f64::from(low[axis]), f64::from(high[axis]));
                low + step / STEPS * (high - low)
            })
        }
    }

    /// Points of a helix: no two coordinates alike.
    fn helix(count: usize) -> Vec<[f64; 3]> {
        let angle = |i: usize| i as f64 * 0.37;
        let point = |i| [angle(i).cos() * 3.0, angle(i).sin(), 0.01 * i as f64 - 7.0];
        (0..count).map(point).collect()
    }

    #[test]
    fn what_is_written_is_read_again_within_half_a_step() {
        let positions = helix(500);
        let colours: Vec<[u8; 3]> = (0..500).map(|i| [(i % 256) as u8, 7, 250]).collect();
        let segments = [[positions[3], positions[400]], [[3.5, 0.0, 0.0], [0.0; 3]]];
        let view = SurfaceView {
            colours: &colours,
            lines: Lines {
                segments: &segments,
                colour: [1, 2, 3],
                width: 1.5,
            },
            points: Points {
                positions: &positions[10..12],
                colour: [4, 5, 6],
                radius: 0.25,
            },
            ..bare(&positions, &[[0, 1, 2], [2, 1, 499]])
        };
        let mut reader = Reader::open(&encode(&view));
        assert_eq!(reader.bytes(), *b"MSV1");
        assert_eq!(reader.u32s(), [500, 2, 2, 2]);
        let (low, high) = (reader.f32s(), reader.f32s());
        assert_eq!(high[0], 3.5);
        assert_eq!(low[2], -7.0);
        assert_eq!(reader.f32s(), [0.0, -5.0, 1.0]);
        assert_eq!(reader.f32s(), [0.0, 0.0, 0.5]);
        assert_eq!(reader.f32s(), [0.0, 0.0, 1.0]);
        assert_eq!(reader.f32s(), [0.5, 1.5, 0.25]);
        assert_eq!(reader.u32s(), [0, 1, 2, 2, 1, 499]);
        let written = positions
            .iter()
            .chain(segments.as_flattened())
            .chain(&positions[10..12]);
        for point in written {
            let read = reader.point(low, high);
            for axis in 0..3 {
                // Half a step, and the single precision of the box: 2^-24 of its corners.
                let side = f64::from(high[axis]) - f64::from(low[axis]);
                let bound = side / 131_070.0 + 8.0 * f64::from(f32::EPSILON);
                assert!(
                    (read[axis] - point[axis]).abs() <= bound,
                    "{point:?} {read:?}"
                );
            }
        }
        for colour in &colours {
            assert_eq!(reader.bytes(), *colour);
        }
        assert_eq!(reader.bytes(), [1, 2, 3]);
        assert_eq!(reader.bytes(), [4, 5, 6]);
        assert_eq!(reader.0.next(), None);
    }

    #[test]
    fn more_vertices_than_sixteen_bits_count_are_told_apart() {
        let positions = helix(70_000);
        let mut reader = Reader::open(&encode(&bare(&positions, &[[0, 65_536, 69_999]])));
        assert_eq!(reader.u32s::<5>()[1..], [70_000, 1, 0, 0]);
        let _ = reader.bytes::<72>();
        assert_eq!(reader.u32s(), [0, 65_536, 69_999]);
        assert_eq!(reader.0.len(), 70_000 * 9 + 6);
    }

    #[test]
    fn missing_colours_are_clay_and_too_many_are_left_out() {
        let positions = helix(2);
        for colours in [&[][..], &[[9, 9, 9]; 3]] {
            let view = SurfaceView {
                colours,
                ..bare(&positions, &[])
            };
            let reader = Reader::open(&encode(&view));
            let rest: Vec<u8> = reader.0.skip(92 + 12).collect();
            let expected = if colours.is_empty() { CLAY } else { [9, 9, 9] };
            assert_eq!(rest[..6], [expected, expected].concat());
            assert_eq!(rest.len(), 12);
        }
    }

    #[test]
    fn flat_empty_and_infinite_surfaces_are_text_too() {
        let odd = [[0.0, 1.0, f64::NAN], [2.0, 1.0, f64::INFINITY]];
        let mut reader = Reader::open(&encode(&bare(&odd, &[])));
        let _ = reader.bytes::<20>();
        let (low, high) = (reader.f32s(), reader.f32s());
        assert_eq!((low, high), ([0.0, 1.0, 0.0], [2.0, 1.0, 0.0]));
        assert_eq!(Reader::open(&encode(&bare(&[], &[]))).0.len(), 98);
    }
}
