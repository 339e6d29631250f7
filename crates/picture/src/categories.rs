//! Colours of categories, such as the cells of a partition of a surface.

use crate::Rgb;

/// Colours that are told apart from each other at a glance, and from the red of curves and the
/// grey of what has no value.
const PALETTE: [Rgb; 8] = [
    Rgb::new(90, 190, 165),
    Rgb::new(252, 155, 92),
    Rgb::new(92, 137, 192),
    Rgb::new(255, 222, 89),
    Rgb::new(238, 165, 208),
    Rgb::new(150, 205, 84),
    Rgb::new(142, 100, 172),
    Rgb::new(128, 94, 80),
];
/// Turn of the hue from one further colour to the next: the golden ratio leaves the widest gaps.
const TURN: f64 = 0.618_033_988_749_895;

/// Returns a colour for each of `count` categories, different for the two of every pair in
/// `touching`; pairs may come in any order and more than once.
///
/// Categories are coloured from the one with the most neighbours, each in the colour that is used
/// least so far among those that no neighbour has. A category whose neighbours have the whole
/// palette gets a further hue. The same pairs give the same colours.
///
/// # Panics
/// If a pair names a category that is not below `count`.
///
/// ```
/// let colours = msplines_picture::category_colours(3, &[[0, 1], [1, 2]]);
/// assert!(colours[0] != colours[1] && colours[1] != colours[2]);
/// ```
#[must_use]
pub fn category_colours(count: usize, touching: &[[u32; 2]]) -> Vec<Rgb> {
    let neighbours = neighbours(count, touching);
    let mut order: Vec<usize> = (0..count).collect();
    order.sort_by_key(|&category| std::cmp::Reverse(neighbours[category].len()));
    let mut uses = vec![0_usize; PALETTE.len()];
    let mut chosen: Vec<Option<usize>> = vec![None; count];
    for category in order {
        let taken: Vec<usize> = neighbours[category]
            .iter()
            .filter_map(|&other| chosen[other as usize])
            .collect();
        let free = |colour: &usize| !taken.contains(colour);
        let least = (0..PALETTE.len())
            .filter(free)
            .min_by_key(|&colour| uses[colour]);
        let colour = match least {
            Some(colour) => colour,
            None => (PALETTE.len()..).find(free).unwrap_or(usize::MAX),
        };
        if let Some(uses) = uses.get_mut(colour) {
            *uses += 1;
        }
        chosen[category] = Some(colour);
    }
    let colours = chosen
        .into_iter()
        .map(|colour| colour.map_or(Rgb::GREY, colour_of));
    colours.collect()
}

/// Returns the neighbours of each category, each once.
fn neighbours(count: usize, touching: &[[u32; 2]]) -> Vec<Vec<u32>> {
    let mut neighbours = vec![Vec::new(); count];
    for &[a, b] in touching {
        if a != b {
            neighbours[a as usize].push(b);
            neighbours[b as usize].push(a);
        }
    }
    for list in &mut neighbours {
        list.sort_unstable();
        list.dedup();
    }
    neighbours
}

fn colour_of(index: usize) -> Rgb {
    match PALETTE.get(index) {
        Some(&colour) => colour,
        None => hue(((index - PALETTE.len()) as f64 * TURN).fract()),
    }
}

/// Returns a light colour of this hue in 0..1.
fn hue(hue: f64) -> Rgb {
    // Lightness and strength of the palette.
    const LOW: f64 = 85.0;
    const HIGH: f64 = 245.0;
    let channel = |shift: f64| {
        let away = ((hue + shift).fract() * 6.0 - 3.0).abs() - 1.0;
        (LOW + (HIGH - LOW) * away.clamp(0.0, 1.0)).round() as u8
    };
    Rgb::new(channel(0.0), channel(2.0 / 3.0), channel(1.0 / 3.0))
}

#[cfg(test)]
mod tests {
    use super::{PALETTE, category_colours};

    /// Cells of a square grid that touch at sides and corners, which takes four colours.
    fn grid(side: u32) -> Vec<[u32; 2]> {
        let at = |x: u32, y: u32| y * side + x;
        let inside = |x: u32, y: u32| x < side && y < side;
        let cells = (0..side).flat_map(|y| (0..side).map(move |x| (x, y)));
        let right = |(x, y): (u32, u32)| {
            let others = [
                (x + 1, y),
                (x, y + 1),
                (x + 1, y + 1),
                (x.wrapping_sub(1), y + 1),
            ];
            others.map(|(u, v)| inside(u, v).then(|| [at(x, y), at(u, v)]))
        };
        cells.flat_map(right).flatten().collect()
    }

    #[test]
    fn neighbours_differ_and_the_whole_palette_is_used() {
        let pairs = grid(12);
        let colours = category_colours(144, &pairs);
        for &[a, b] in &pairs {
            assert_ne!(colours[a as usize], colours[b as usize], "{a} {b}");
        }
        assert!(PALETTE.iter().all(|colour| colours.contains(colour)));
    }

    #[test]
    fn the_order_of_the_pairs_does_not_matter() {
        let mut pairs = grid(5);
        let colours = category_colours(25, &pairs);
        pairs.reverse();
        pairs.extend(grid(5).into_iter().map(|[a, b]| [b, a]));
        assert_eq!(category_colours(25, &pairs), colours);
    }

    #[test]
    fn more_neighbours_than_colours_get_further_hues() {
        let count = 20;
        let all = (0..count).flat_map(|a| (0..a).map(move |b| [a, b]));
        let colours = category_colours(count as usize, &all.collect::<Vec<_>>());
        for (at, colour) in colours.iter().enumerate() {
            assert!(!colours[..at].contains(colour), "{at}: {colour:?}");
        }
    }

    #[test]
    fn nothing_and_a_category_beside_itself_have_colours() {
        assert!(category_colours(0, &[]).is_empty());
        assert_eq!(category_colours(1, &[[0, 0]]), [PALETTE[0]]);
    }
}
