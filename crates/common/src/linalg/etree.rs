//! Elimination trees: parents, postorder and column counts.
//!
//! # Reference
//! [Liu1990]; [Gilbert1994].

/// The parent of a root.
pub(super) const ROOT: u32 = u32::MAX;

/// A symmetric pattern: for each column the other rows, both triangles, no diagonal needed.
pub(super) struct Pattern {
    pub(super) starts: Vec<usize>,
    pub(super) rows: Vec<u32>,
}

impl Pattern {
    pub(super) fn size(&self) -> usize {
        self.starts.len() - 1
    }

    pub(super) fn column(&self, column: usize) -> &[u32] {
        &self.rows[self.starts[column]..self.starts[column + 1]]
    }
}

/// Returns the parent of each column in the elimination tree.
pub(super) fn parents(pattern: &Pattern) -> Vec<u32> {
    let size = pattern.size();
    let (mut parent, mut ancestor) = (vec![ROOT; size], vec![ROOT; size]);
    for column in 0..size as u32 {
        for &row in pattern.column(column as usize) {
            let mut node = row;
            while node < column {
                let next = std::mem::replace(&mut ancestor[node as usize], column);
                if next == ROOT {
                    parent[node as usize] = column;
                    break;
                }
                node = next;
            }
        }
    }
    parent
}

/// Returns the columns in postorder: every column after its descendants, which come in one run.
pub(super) fn postorder(parent: &[u32]) -> Vec<u32> {
    let size = parent.len();
    let (mut first_child, mut sibling) = (vec![ROOT; size], vec![ROOT; size]);
    for node in (0..size).rev() {
        if parent[node] != ROOT {
            sibling[node] = first_child[parent[node] as usize];
            first_child[parent[node] as usize] = node as u32;
        }
    }
    let mut order = Vec::with_capacity(size);
    let mut stack = Vec::new();
    for root in (0..size as u32).filter(|&n| parent[n as usize] == ROOT) {
        stack.push(root);
        while let Some(&node) = stack.last() {
            let child = std::mem::replace(&mut first_child[node as usize], ROOT);
            if child == ROOT {
                order.push(node);
                stack.pop();
                continue;
            }
            first_child[node as usize] = sibling[child as usize];
            stack.push(child);
        }
    }
    order
}

/// Returns the number of entries of each column of the factor, diagonal included, of a pattern that
/// is already in postorder.
pub(super) fn column_counts(pattern: &Pattern, parent: &[u32]) -> Vec<u32> {
    let size = pattern.size();
    let mut first = vec![ROOT; size];
    let mut delta = vec![0i64; size];
    for column in 0..size {
        delta[column] = i64::from(first[column] == ROOT);
        let mut node = column as u32;
        while node != ROOT && first[node as usize] == ROOT {
            first[node as usize] = column as u32;
            node = parent[node as usize];
        }
    }
    let mut ancestor: Vec<u32> = (0..size as u32).collect();
    let (mut max_first, mut previous_leaf) = (vec![-1i64; size], vec![ROOT; size]);
    for column in 0..size {
        if parent[column] != ROOT {
            delta[parent[column] as usize] -= 1;
        }
        for &row in pattern
            .column(column)
            .iter()
            .filter(|&&r| r as usize > column)
        {
            let row = row as usize;
            if i64::from(first[column]) <= max_first[row] {
                continue;
            }
            max_first[row] = i64::from(first[column]);
            let previous = std::mem::replace(&mut previous_leaf[row], column as u32);
            delta[column] += 1;
            if previous != ROOT {
                delta[lowest_set(&mut ancestor, previous) as usize] -= 1;
            }
        }
        if parent[column] != ROOT {
            ancestor[column] = parent[column];
        }
    }
    for column in 0..size {
        if parent[column] != ROOT {
            delta[parent[column] as usize] += delta[column];
        }
    }
    delta.into_iter().map(|count| count as u32).collect()
}

/// Returns the representative of `node` in the forest of finished columns, and compresses its path.
fn lowest_set(ancestor: &mut [u32], node: u32) -> u32 {
    let mut top = node;
    while ancestor[top as usize] != top {
        top = ancestor[top as usize];
    }
    let mut walk = node;
    while walk != top {
        walk = std::mem::replace(&mut ancestor[walk as usize], top);
    }
    top
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Pattern of the factor by elimination on sets.
    fn eliminated(pattern: &Pattern) -> Vec<Vec<u32>> {
        let size = pattern.size();
        let mut below: Vec<std::collections::BTreeSet<u32>> = (0..size)
            .map(|c| {
                pattern
                    .column(c)
                    .iter()
                    .copied()
                    .filter(|&r| r as usize > c)
                    .collect()
            })
            .collect();
        for column in 0..size {
            if let Some(&parent) = below[column].first() {
                let rest: Vec<u32> = below[column].iter().copied().skip(1).collect();
                below[parent as usize].extend(rest);
            }
        }
        below
            .into_iter()
            .map(|set| set.into_iter().collect())
            .collect()
    }

    #[test]
    fn tree_and_counts_equal_those_of_explicit_elimination() {
        let size = 40u32;
        let mut columns = vec![std::collections::BTreeSet::new(); size as usize];
        for k in 0..90u32 {
            let (a, b) = ((k * 17 + 3) % size, (k * k * 5 + 11) % size);
            if a != b {
                columns[a as usize].insert(b);
                columns[b as usize].insert(a);
            }
        }
        let build = |order: &[u32]| {
            let mut number = vec![0; size as usize];
            order
                .iter()
                .enumerate()
                .for_each(|(k, &row)| number[row as usize] = k as u32);
            let mut pattern = Pattern {
                starts: vec![0],
                rows: Vec::new(),
            };
            for &row in order {
                pattern
                    .rows
                    .extend(columns[row as usize].iter().map(|&r| number[r as usize]));
                pattern.starts.push(pattern.rows.len());
            }
            pattern
        };
        let natural: Vec<u32> = (0..size).collect();
        let order = postorder(&parents(&build(&natural)));
        let pattern = build(&order);
        let factor = eliminated(&pattern);
        let parent = parents(&pattern);
        let counts = column_counts(&pattern, &parent);
        for column in 0..size as usize {
            assert_eq!(
                parent[column],
                factor[column].first().copied().unwrap_or(ROOT)
            );
            assert_eq!(
                counts[column] as usize,
                factor[column].len() + 1,
                "column {column}"
            );
        }
    }
}
