//! Compiles the bindings and links the libraries.

fn main() {
    let sources = [
        "cpp/openmesh.cc",
        "cpp/opensubdiv.cc",
        "cpp/cgal.cc",
        "cpp/topology.cc",
        "cpp/delaunay.cc",
        "cpp/distance.cc",
        "cpp/flattening.cc",
        "cpp/solids.cc",
        "cpp/cholmod.cc",
        "cpp/eigen.cc",
    ];
    cxx_build::bridge("src/bindings.rs")
        .files(sources)
        .include("cpp")
        .include("/usr/include/eigen3")
        .std("c++17")
        // Both sides of the timing are optimised, whatever the profile of the tests.
        .opt_level(3)
        .define("NDEBUG", None)
        // CGAL's interval arithmetic is wrong where the compiler assumes one way of rounding.
        .flag_if_supported("-frounding-math")
        .flag_if_supported("-Wno-deprecated-declarations")
        .warnings(false)
        .compile("msplines-reference");
    // CGAL and Eigen are headers alone; CGAL's rational numbers are GMP's.
    for library in ["OpenMeshCore", "osdCPU", "cholmod", "gmp"] {
        println!("cargo::rustc-link-lib={library}");
    }
    println!("cargo::rerun-if-changed=cpp");
    println!("cargo::rerun-if-changed=src/bindings.rs");
}
