//! From samples to a solid.

pub mod certified;
pub mod least_squares;
pub mod multilevel;

/// Numbers of spans from the coarsest to the finest, each twice the one before; absent if the finest is
/// not reached so.
fn doubling(coarsest: usize, finest: usize) -> Option<Vec<usize>> {
    if coarsest == 0 || finest > crate::spline::MOST_SPANS {
        return None;
    }
    let levels: Vec<usize> = std::iter::successors(Some(coarsest), |n| Some(2 * n))
        .take_while(|&n| n <= finest)
        .collect();
    (levels.last() == Some(&finest)).then_some(levels)
}
