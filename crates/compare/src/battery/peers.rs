//! What other tools made of the twelve defects.

/// The tools, as they were measured.
pub(super) const PEERS: [&str; 3] = [
    "igl.harmonic, k = 2",
    "robust_laplacian and SuperLU",
    "potpourri3d heat",
];

/// What each tool did, in the order of [`super::defects::DEFECTS`].
pub(super) const MEASURED: [[&str; 3]; 12] = [
    ["**2,870 of 2,930 rows NaN, exit 0**", "ok", "ok"],
    ["**NaN, exit 0**", "ok", "ok"],
    ["**NaN, exit 0**", "\"exactly singular\"", "clear error"],
    ["RuntimeError, no place", "ok", "ok"],
    ["RuntimeError, no place", "finite, exit 0, no warning", "ok"],
    [
        "**up to 6.9e4, exit 0**",
        "ok",
        "assertion that names the vertex",
    ],
    [
        "**up to 1.1e3, exit 0**",
        "**wrong by 0.68, exit 0**",
        "not applicable",
    ],
    ["**SIGSEGV**", "assertion", "assertion"],
    ["ok", "ok", "ok"],
    ["ok", "ok", "ok"],
    ["ok", "ok", "ok"],
    ["ok", "ok", "ok"],
];

/// What was measured, and how.
pub(super) const MEASUREMENT: &str = "The three columns on the right are what other tools made of the same defects in one mesh of 2,930 \
vertices with 60 knots, each case in a process of its own: libigl 2.6.3, robust_laplacian 1.1.0 with the SuperLU of SciPy 1.17.1, and \
potpourri3d 1.4.0, as Python wheels. In bold is what ends without an error and is wrong, or crashes.";
