//! The texts of refusals, and files that are replaced whole.

use std::io;
use std::path::Path;

use msplines_io::{
    OutputFormat, ReadError, Surface, WriteError, parse_soup, read_soup, write_atomically,
    write_surface,
};

use crate::common::{attribute, refusal, scratch, soup, tetrahedron};

#[test]
fn a_refusal_names_the_file_and_the_remedy() {
    let missing = read_soup(Path::new("no/such/file.ply")).unwrap_err();
    assert!(matches!(missing, ReadError::Open { .. }));
    let texts = [
        (
            missing.to_string(),
            "cannot read no/such/file.ply: ",
            "check that the file exists",
        ),
        (
            refusal("a.ply", "").to_string(),
            "a.ply is empty",
            "export it again",
        ),
        (
            refusal("a.step", "ISO-10303").to_string(),
            "a.step is in no known format",
            "give an OBJ",
        ),
        (
            refusal("a.ply", "plx").to_string(),
            "a.ply (PLY), line 1: the first line is not `ply`",
            "export",
        ),
        (
            refusal("a.ply", "ply\n").to_string(),
            "the header has no `end_header`",
            "copy or export",
        ),
        (
            refusal("a.off", "v 0 0 0").to_string(),
            "a.off (OFF), line 1: the first word",
            "export",
        ),
    ];
    for (text, wrong, remedy) in texts {
        assert!(text.starts_with(wrong) || text.contains(wrong), "{text}");
        assert!(text.contains(remedy), "{text}");
    }
}

#[test]
fn content_tells_the_format_before_the_extension_does() {
    let ply = tetrahedron().written("a.ply");
    for name in ["a.obj", "a.stl", "a", "a.txt"] {
        assert_eq!(soup(name, &ply).face_count(), 4);
    }
    assert_eq!(soup("a.txt", "OFF 1 1 0\n0 0 0\n3 0 0 0\n").face_count(), 1);
    assert_eq!(soup("A.OBJ", "v 0 0 0\nf 1 1 1\n").face_count(), 1);
    assert!(parse_soup(Path::new("a.txt"), b"v 0 0 0\nf 1 1 1\n").is_err());
}

#[test]
fn a_surface_unfit_to_write_is_refused_and_leaves_nothing() {
    let mut bad = [
        tetrahedron(),
        tetrahedron(),
        tetrahedron(),
        tetrahedron(),
        tetrahedron(),
    ];
    bad[0].faces[2][1] = 4;
    bad[1].positions[3].y = f64::NAN;
    bad[2].attributes[1].values.pop();
    bad[3].attributes.push(attribute("two words", &[0.0; 4]));
    bad[4].attributes.push(attribute("red", &[0.0; 4]));
    let texts = [
        "face 2 names vertex 4, but there are 4 vertices",
        "`position` of vertex 3 is not finite in this format",
        "attribute `green` has 3 values for 4 vertices",
        "attribute `two words` cannot be written",
        "attribute `red` cannot be written",
    ];
    for (surface, expected) in bad.iter().zip(texts) {
        for name in ["a.ply", "a.obj", "a.vtu", "a.glb"] {
            let (directory, path) = scratch(name);
            let text = write_surface(&path, &surface.surface())
                .unwrap_err()
                .to_string();
            assert!(text.contains(expected), "{text}");
            assert_eq!(directory.path().read_dir().unwrap().count(), 0);
        }
    }
    let (_directory, path) = scratch("a.stl");
    let refused = write_surface(&path, &tetrahedron().surface()).unwrap_err();
    assert!(matches!(refused, WriteError::UnknownFormat { .. }));
    assert_eq!(OutputFormat::of(&path), None);
    assert_eq!(
        OutputFormat::of(Path::new("A.GLB")),
        Some(OutputFormat::Glb)
    );
}

#[test]
fn single_precision_overflow_is_refused_for_glb_only() {
    let mut surface = tetrahedron();
    surface.positions[1].x = 1e39;
    let (_directory, path) = scratch("a.glb");
    let refused = write_surface(&path, &surface.surface()).unwrap_err();
    assert!(
        matches!(refused, WriteError::NotFinite { vertex: 1, .. }),
        "{refused}"
    );
    assert!(write_surface(&path.with_extension("vtu"), &surface.surface()).is_ok());
}

#[test]
fn a_failed_write_keeps_the_old_file_and_leaves_nothing_else() {
    let (directory, path) = scratch("a.ply");
    std::fs::write(&path, "old").unwrap();
    let failed = write_atomically(&path, |to| {
        to.write_all(b"half")?;
        Err(io::Error::other("disk on fire"))
    });
    assert!(failed.unwrap_err().to_string().contains("disk on fire"));
    assert_eq!(std::fs::read(&path).unwrap(), b"old");
    assert_eq!(directory.path().read_dir().unwrap().count(), 1);
    write_atomically(&path, |to| to.write_all(b"new")).unwrap();
    assert_eq!(std::fs::read(&path).unwrap(), b"new");
    assert_eq!(directory.path().read_dir().unwrap().count(), 1);
    let nowhere = Path::new("no/such/folder/a.ply");
    assert!(write_atomically(nowhere, |_| Ok(())).is_err());
}

#[test]
fn what_a_killed_writer_left_is_removed_and_what_a_living_one_writes_is_not() {
    let (directory, path) = scratch("a.ply");
    let left = directory.path().join(".msplines-Killed.tmp");
    std::fs::write(&left, "half").unwrap();
    let others = [".msplines.tmp", "msplines-Killed.tmp", ".msplines-Killed"];
    let others = others.map(|name| directory.path().join(name));
    for other in &others {
        std::fs::write(other, "of somebody else").unwrap();
    }
    write_atomically(&path, |outer| {
        assert!(!left.exists());
        outer.write_all(b"long")?;
        let inner = directory.path().join("b.ply");
        write_atomically(&inner, |to| to.write_all(b"short")).map_err(io::Error::other)
    })
    .unwrap();
    assert_eq!(std::fs::read(&path).unwrap(), b"long");
    assert!(others.iter().all(|other| other.exists()));
    assert_eq!(directory.path().read_dir().unwrap().count(), 5);
}

#[cfg(unix)]
#[test]
fn a_new_file_is_as_readable_as_any_other() {
    use std::os::unix::fs::PermissionsExt;
    let (directory, path) = scratch("a.ply");
    let other = directory.path().join("other");
    std::fs::write(&other, "x").unwrap();
    write_atomically(&path, |to| to.write_all(b"x")).unwrap();
    let mode = |path: &Path| std::fs::metadata(path).unwrap().permissions().mode();
    assert_eq!(mode(&path), mode(&other));
}

#[test]
fn a_surface_without_parts_can_be_written() {
    for name in ["a.ply", "a.obj", "a.vtu", "a.glb"] {
        let (_directory, path) = scratch(name);
        write_surface(&path, &Surface::default()).unwrap();
    }
}
