//! Conformal structure of triangle meshes: holomorphic 1-forms, affine atlases, spherical maps.
