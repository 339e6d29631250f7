//! One axis of an array.

/// One axis of an array of several: where its numbers stand.
///
/// The number `index` of the line `(outer, inner)` stands at
/// `(outer * count + index) * inner_count + inner`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Axis {
    /// Numbers that vary slower: the product of the sizes of the axes after this one.
    pub outer: usize,
    /// Numbers along the axis.
    pub count: usize,
    /// Numbers that vary faster: the product of the sizes of the axes before this one, times the
    /// components of a number.
    pub inner: usize,
}

impl Axis {
    /// Returns axis `axis` of an array of `sizes`, the first of which varies fastest, with `components`
    /// numbers side by side at each place.
    #[must_use]
    pub fn of(sizes: &[usize], axis: usize, components: usize) -> Self {
        Self {
            outer: sizes[axis + 1..].iter().product(),
            count: sizes[axis],
            inner: sizes[..axis].iter().product::<usize>() * components,
        }
    }

    /// Numbers of the whole array.
    #[must_use]
    pub fn len(self) -> usize {
        self.outer * self.count * self.inner
    }

    /// Whether the array is empty.
    #[must_use]
    pub fn is_empty(self) -> bool {
        self.len() == 0
    }

    /// Applies a matrix with few entries in a row along the axis: row `r` of the result is the sum of
    /// `weights[r][p]` times the numbers `first[r] + p`.
    ///
    /// # Panics
    /// If the rows differ in number, reach beyond the axis, or `values` is not an array of this shape.
    #[must_use]
    pub fn apply<const W: usize>(
        self,
        first: &[usize],
        weights: &[[f64; W]],
        values: &[f64],
    ) -> Vec<f64> {
        assert_eq!(values.len(), self.len(), "an array of this shape");
        assert_eq!(first.len(), weights.len(), "one first column for each row");
        let mut out = vec![0.0; self.outer * first.len() * self.inner];
        if out.is_empty() {
            return out;
        }
        let (source, target) = (self.count * self.inner, first.len() * self.inner);
        for (block, result) in values
            .chunks_exact(source)
            .zip(out.chunks_exact_mut(target))
        {
            for (row, line) in result.chunks_exact_mut(self.inner).enumerate() {
                for (p, &weight) in weights[row].iter().enumerate() {
                    let start = (first[row] + p) * self.inner;
                    let column = &block[start..start + self.inner];
                    for (sum, &value) in line.iter_mut().zip(column) {
                        *sum += weight * value;
                    }
                }
            }
        }
        out
    }

    /// Applies the transpose of what [`apply`](Self::apply) applies; `values` has as many numbers
    /// along the axis as there are rows, the result has `count`.
    ///
    /// # Panics
    /// As [`apply`](Self::apply).
    #[must_use]
    pub fn apply_transposed<const W: usize>(
        self,
        first: &[usize],
        weights: &[[f64; W]],
        values: &[f64],
    ) -> Vec<f64> {
        let (target, source) = (self.count * self.inner, first.len() * self.inner);
        assert_eq!(values.len(), self.outer * source, "one line for each row");
        let mut out = vec![0.0; self.len()];
        if out.is_empty() || source == 0 {
            return out;
        }
        for (block, result) in values
            .chunks_exact(source)
            .zip(out.chunks_exact_mut(target))
        {
            for (row, line) in block.chunks_exact(self.inner).enumerate() {
                for (p, &weight) in weights[row].iter().enumerate() {
                    let start = (first[row] + p) * self.inner;
                    let column = &mut result[start..start + self.inner];
                    for (sum, &value) in column.iter_mut().zip(line) {
                        *sum += weight * value;
                    }
                }
            }
        }
        out
    }
}

#[cfg(test)]
mod tests {
    use super::Axis;

    /// Numbers of an array of 2 × 3 × 4 places with two components.
    const SIZES: [usize; 3] = [2, 3, 4];
    const COMPONENTS: usize = 2;

    fn place(at: [usize; 3], sizes: [usize; 3], component: usize) -> usize {
        ((at[2] * sizes[1] + at[1]) * sizes[0] + at[0]) * COMPONENTS + component
    }

    fn numbers(count: usize) -> Vec<f64> {
        (0..count).map(|i| ((i * 7 + 3) % 11) as f64).collect()
    }

    #[test]
    fn rows_combine_the_numbers_of_each_line() {
        for axis in 0..3 {
            let along = Axis::of(&SIZES, axis, COMPONENTS);
            assert_eq!(along.len(), 48);
            let last = SIZES[axis] - 2;
            let (first, weights) = ([last, 0, 0], [[1.0, -2.0], [0.5, 4.0], [3.0, 0.0]]);
            let values = numbers(along.len());
            let found = along.apply(&first, &weights, &values);
            let mut sizes = SIZES;
            sizes[axis] = first.len();
            assert_eq!(found.len(), sizes.iter().product::<usize>() * COMPONENTS);
            for index in 0..found.len() / COMPONENTS {
                let at = [
                    index % sizes[0],
                    index / sizes[0] % sizes[1],
                    index / (sizes[0] * sizes[1]),
                ];
                for component in 0..COMPONENTS {
                    let term = |p: usize| {
                        let mut from = at;
                        from[axis] = first[at[axis]] + p;
                        weights[at[axis]][p] * values[place(from, SIZES, component)]
                    };
                    let sum = term(0) + term(1);
                    assert_eq!(
                        found[place(at, sizes, component)],
                        sum,
                        "axis {axis}, {at:?}"
                    );
                }
            }
        }
    }

    #[test]
    fn the_transpose_has_the_same_products() {
        for (axis, size) in SIZES.into_iter().enumerate() {
            let along = Axis::of(&SIZES, axis, COMPONENTS);
            let (first, weights) = ([0, size - 2, 0], [[1.0, -2.0], [0.5, 4.0], [3.0, 1.0]]);
            let values = numbers(along.len());
            let forward = along.apply(&first, &weights, &values);
            let others = numbers(forward.len() + 5)[5..].to_vec();
            let back = along.apply_transposed(&first, &weights, &others);
            let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
            assert_eq!(dot(&forward, &others), dot(&values, &back));
        }
    }

    #[test]
    fn without_rows_or_numbers_nothing_is_summed() {
        let along = Axis::of(&SIZES, 1, COMPONENTS);
        assert!(!along.is_empty());
        let none: [[f64; 2]; 0] = [];
        assert!(along.apply(&[], &none, &numbers(48)).is_empty());
        assert_eq!(along.apply_transposed(&[], &none, &[]), vec![0.0; 48]);
        let empty = Axis::of(&[2, 0, 4], 0, COMPONENTS);
        assert!(empty.is_empty());
        assert!(empty.apply(&[0], &[[1.0, 1.0]], &[]).is_empty());
        assert!(empty.apply_transposed(&[0], &[[1.0, 1.0]], &[]).is_empty());
    }
}
