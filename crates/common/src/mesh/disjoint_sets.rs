//! Disjoint sets with parity: which elements belong together, and which are mirrored.

/// A forest over `0..n`; the smallest element of a set is its root.
pub(crate) struct DisjointSets {
    parent: Vec<u32>,
    odd: Vec<bool>,
}

impl DisjointSets {
    /// Returns `count` sets of one element each.
    pub(crate) fn new(count: usize) -> Self {
        Self {
            parent: (0..count as u32).collect(),
            odd: vec![false; count],
        }
    }

    /// Returns the root of an element, and whether the element is mirrored against it.
    pub(crate) fn find(&mut self, element: u32) -> (u32, bool) {
        let (mut root, mut odd) = (element, false);
        while self.parent[root as usize] != root {
            odd ^= self.odd[root as usize];
            root = self.parent[root as usize];
        }
        let (mut here, mut parity) = (element, odd);
        while self.parent[here as usize] != root && here != root {
            let (next, step) = (self.parent[here as usize], self.odd[here as usize]);
            self.parent[here as usize] = root;
            self.odd[here as usize] = parity;
            parity ^= step;
            here = next;
        }
        (root, odd)
    }

    /// Returns the root of an element.
    pub(crate) fn root(&mut self, element: u32) -> u32 {
        self.find(element).0
    }

    /// Joins two sets so that the elements are `mirrored` or alike; returns false if the two are
    /// in one set already and are not.
    pub(crate) fn join(&mut self, one: u32, two: u32, mirrored: bool) -> bool {
        let ((a, odd_a), (b, odd_b)) = (self.find(one), self.find(two));
        if a == b {
            return (odd_a ^ odd_b) == mirrored;
        }
        let (low, high) = (a.min(b), a.max(b));
        self.parent[high as usize] = low;
        self.odd[high as usize] = odd_a ^ odd_b ^ mirrored;
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parity_adds_along_a_chain_and_an_odd_cycle_is_refused() {
        let mut sets = DisjointSets::new(6);
        assert!(sets.join(4, 5, true) && sets.join(3, 4, true) && sets.join(0, 3, false));
        assert_eq!(sets.find(5), (0, false));
        assert_eq!(sets.find(4), (0, true));
        assert!(sets.join(0, 5, false));
        assert!(!sets.join(5, 3, true));
        assert_eq!(sets.root(2), 2);
    }
}
