//! Laws of splines, fits, certificates and measures.

mod export;
mod fits;
mod maps;
mod measure;
mod splines;
mod validity;
