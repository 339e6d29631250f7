//! The next finer space: which leaves are split, and how wide the caps are.

use msplines_common::progress::Outcome;

use super::{State, marking};
use crate::caps::{CapKind, Caps};
use crate::options::Stop;
use crate::space::TSplineSpace;

/// Rounds after which no fit goes on.
const MOST_ROUNDS: u32 = 200;

/// How many times more than elsewhere errors in a cap may be, as roots of mean squares. With 2.5 or without
/// a bound happy_buddha_25k is met to 0.055 % and 0.62 % at 4,000 control points (rms, max), with 1.5 to
/// 0.048 % and 0.31 %, with 1.1 to 0.048 % and 0.28 %.
const WORSE_CAP: f64 = 1.5;
/// Shares of the control points between which caps become narrower.
const NARROWING: std::ops::Range<f64> = 0.5..0.85;
/// Samples that a cap keeps at least, and the share of its largest radius: half or double changes errors
/// by a tenth.
const FEWEST: usize = 40;
const NARROWEST: f64 = 0.3;

impl State<'_> {
    /// Returns the next finer space, or how the fit ends without one.
    pub(super) fn next(&self) -> Result<TSplineSpace, Outcome> {
        let most = match self.options.stop {
            Stop::ControlPoints(most) => most,
            Stop::Tolerance(_) if self.is_within(1.0) => return Err(Outcome::Converged),
            Stop::Tolerance(_) => usize::MAX,
        };
        if self.rounds >= MOST_ROUNDS {
            return Err(Outcome::MaxIterations);
        }
        let refinement = &self.options.refinement;
        let own = self.spline.space();
        let distances = self.distances();
        let ranked = marking::ranked(&self.spline, &self.sorted, &distances, refinement.exponent);
        let wanted = (refinement.share * own.mesh().leaves().len() as f64).ceil() as usize;
        let marked = marking::directed(
            &self.spline,
            &ranked[..wanted.min(ranked.len())],
            refinement,
        );
        let caps = match self.options.stop {
            // Of a coarse surface the caps are the worst part; and at the end no control points are
            // left for what a narrower one lays bare.
            Stop::ControlPoints(most)
                if !NARROWING.contains(&(own.unknowns() as f64 / most as f64)) =>
            {
                own.caps().clone()
            }
            _ => self.narrowed(&distances),
        };
        let refined = |count: usize| {
            let mut mesh = own.mesh().clone();
            let more = mesh.refine(&marked[..count], &refinement.grading);
            (more > 0).then(|| TSplineSpace::with_caps(mesh, caps.clone()))
        };
        let fits = |space: &TSplineSpace| space.unknowns() <= most;
        match refined(marked.len()) {
            None => return Err(Outcome::Stalled),
            Some(space) if fits(&space) => return Ok(space),
            Some(_) => {}
        }
        // As many of them as may be: the number of unknowns grows with every split.
        let (mut low, mut high) = (0, marked.len());
        let mut best = None;
        while high - low > 1 {
            let middle = low.midpoint(high);
            match refined(middle).filter(fits) {
                Some(space) => (low, best) = (middle, Some(space)),
                None => high = middle,
            }
        }
        best.ok_or(Outcome::Converged)
    }

    /// Returns the caps, those of zeros narrower where a polynomial is further from the samples than the
    /// surface elsewhere.
    fn narrowed(&self, distances: &[f64]) -> Caps {
        let mut caps = self.spline.space().caps().clone();
        let (mut sums, mut counts) = (
            vec![0.0; caps.caps().len() + 1],
            vec![0_usize; caps.caps().len() + 1],
        );
        for (sample, distance) in self.sorted.samples.iter().zip(distances) {
            let place = caps.at(sample.at).map_or(0, |cap| 1 + cap.cap as usize);
            sums[place] += distance * distance;
            counts[place] += 1;
        }
        let mean = |place: usize| sums[place] / counts[place].max(1) as f64;
        let most = (WORSE_CAP * WORSE_CAP) * mean(0);
        for index in 0..caps.caps().len() {
            let cap = caps.caps()[index];
            let narrow = matches!(cap.kind, CapKind::Zero { .. }) && mean(index + 1) > most;
            if narrow && counts[index + 1] > FEWEST && cap.radius > NARROWEST * cap.limit {
                caps.set_radius(index as u32, 0.75 * cap.radius);
            }
        }
        caps
    }
}
