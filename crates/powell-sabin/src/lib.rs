//! Powell-Sabin splines over planar triangulations and over surfaces of any genus.
