//! Cycles given by hand.

use std::collections::BTreeMap;

use super::super::error::NetworkError;
use super::super::graph::CurveGraph;

/// Returns given cycles as half-edges, oriented alike.
pub(super) fn cycles(
    graph: &CurveGraph,
    given: &[Vec<u32>],
) -> Result<Vec<Vec<u32>>, NetworkError> {
    let mut junction_at = BTreeMap::new();
    for (v, junction) in graph.junctions().iter().enumerate() {
        junction_at.insert(junction.point, v as u32);
    }
    let follow = |(index, points): (usize, &Vec<u32>)| {
        follow(graph, &junction_at, points).map_err(|problem| NetworkError::Given {
            cycle: index,
            problem,
        })
    };
    let mut cycles = given
        .iter()
        .enumerate()
        .map(follow)
        .collect::<Result<Vec<_>, _>>()?;
    let mut uses: Vec<Vec<u32>> = vec![Vec::new(); graph.arcs().len()];
    for (index, cycle) in cycles.iter().enumerate() {
        for h in cycle {
            uses[*h as usize / 2].push(index as u32);
        }
    }
    let wrong = |uses: &Vec<u32>| uses.is_empty() || uses.len() > 2;
    if let Some(arc) = uses.iter().position(wrong) {
        return Err(NetworkError::GivenUses {
            curve: graph.arcs()[arc].curve,
            ends: graph.arcs()[arc]
                .ends
                .map(|v| graph.junctions()[v as usize].position),
            uses: uses[arc].len(),
        });
    }
    orient(&mut cycles, &uses)?;
    Ok(cycles)
}

/// Returns the half-edges along a list of points.
fn follow(
    graph: &CurveGraph,
    junction_at: &BTreeMap<u32, u32>,
    points: &[u32],
) -> Result<Vec<u32>, String> {
    let mut points = points.to_vec();
    if points.len() > 1 && points.first() == points.last() {
        points.pop();
    }
    let Some(first) = points.iter().position(|p| junction_at.contains_key(p)) else {
        return Err("has no junction; give the junctions around it, in order".to_owned());
    };
    points.rotate_left(first);
    points.push(points[0]);
    let mut half_edges = Vec::new();
    let mut from = 0;
    for to in 1..points.len() {
        let Some(&end) = junction_at.get(&points[to]) else {
            continue;
        };
        let between = &points[from + 1..to];
        let start = junction_at[&points[from]];
        let fits = |&&h: &&u32| {
            let arc = &graph.arc(h).points;
            graph.origin(h ^ 1) == end && between.iter().all(|p| arc[1..arc.len() - 1].contains(p))
        };
        let around = &graph.junctions()[start as usize].half_edges;
        let mut found: Vec<u32> = around.iter().filter(fits).copied().collect();
        // An arc back to its start fits both ways, and either is right.
        found.dedup_by_key(|h| *h / 2);
        let (a, b) = (points[from], points[to]);
        match found[..] {
            [h] => half_edges.push(h),
            [] => {
                return Err(format!(
                    "goes from point {a} to point {b}, which no arc joins that way; give junctions in order"
                ));
            }
            _ => {
                return Err(format!(
                    "goes from point {a} to point {b}, which several arcs join; give a point between them too"
                ));
            }
        }
        from = to;
    }
    Ok(half_edges)
}

/// Reverses cycles until every arc with two of them is passed in both directions.
fn orient(cycles: &mut [Vec<u32>], uses: &[Vec<u32>]) -> Result<(), NetworkError> {
    let mut done = vec![false; cycles.len()];
    for start in 0..cycles.len() {
        if done[start] {
            continue;
        }
        done[start] = true;
        let mut waiting = vec![start];
        while let Some(index) = waiting.pop() {
            for h in cycles[index].clone() {
                let both = &uses[h as usize / 2];
                let Some(&other) = both.iter().find(|&&other| other as usize != index) else {
                    let twice = both.len() == 2 && !cycles[index].contains(&(h ^ 1));
                    if twice {
                        return Err(NetworkError::OneSided { cycle: index });
                    }
                    continue;
                };
                let other = other as usize;
                let against = cycles[other].contains(&(h ^ 1));
                if !against && done[other] {
                    return Err(NetworkError::OneSided { cycle: other });
                }
                if !against {
                    cycles[other].reverse();
                    cycles[other].iter_mut().for_each(|h| *h ^= 1);
                }
                if !done[other] {
                    done[other] = true;
                    waiting.push(other);
                }
            }
        }
    }
    Ok(())
}
