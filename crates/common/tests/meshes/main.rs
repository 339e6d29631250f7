//! Laws of the mesh layer on meshes that nobody drew: soups of a few vertices, and what becomes of them.

mod edits;
mod oracle;
mod soups;
