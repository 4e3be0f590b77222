//! Generates scenes of any size as files: hills of triangles, and instances of a plate.

use std::fs::File;
use std::io::{BufWriter, Result, Write};
use std::path::{Path, PathBuf};

/// The head of both scenes.
const HEAD: &str = r#"<scene version="3.0.0"><integrator type="path"><integer name="max_depth" value="4"/></integrator>
<sensor type="perspective"><float name="fov" value="50"/><transform name="to_world">
<lookat origin="0.5, 0.6, -0.6" target="0.5, 0, 0.5" up="0, 1, 0"/></transform></sensor>
<emitter type="constant"/>
"#;
const TERRAIN: &str = r#"<shape type="ply"><string name="filename" value="terrain.ply"/><bsdf type="diffuse"/></shape>"#;
const GROUP: &str = r#"<shape type="shapegroup" id="plate"><shape type="ply"><string name="filename" value="plate.ply"/><bsdf type="diffuse"/></shape></shape>"#;

/// Quads along a side of the instanced plate: ten thousand triangles.
const PLATE: usize = 71;

/// What is repeated in a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// Triangles of one mesh.
    Triangles,
    /// Instances of one group of ten thousand triangles.
    Instances,
}

impl Kind {
    /// In words.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Triangles => "triangles",
            Self::Instances => "instances",
        }
    }
}

/// Writes a scene with this many triangles or instances, rounded down to a full grid, and its mesh
/// into a folder; returns the scene file.
pub(super) fn write(folder: &Path, kind: Kind, count: usize) -> Result<PathBuf> {
    let path = folder.join(format!("{}.xml", kind.name()));
    let mut scene = BufWriter::new(File::create(&path)?);
    scene.write_all(HEAD.as_bytes())?;
    match kind {
        Kind::Triangles => {
            write_terrain(&folder.join("terrain.ply"), (count / 2).isqrt().max(1))?;
            writeln!(scene, "{TERRAIN}")?;
        }
        Kind::Instances => {
            write_terrain(&folder.join("plate.ply"), PLATE)?;
            writeln!(scene, "{GROUP}")?;
            write_instances(&mut scene, count)?;
        }
    }
    writeln!(scene, "</scene>")?;
    scene.flush()?;
    Ok(path)
}

/// Instances of the group `plate` in different orientations, on a grid over the unit square.
fn write_instances(file: &mut impl Write, count: usize) -> Result<()> {
    let side = count.isqrt().max(1);
    let scale = 0.8 / side as f64;
    for index in 0..count {
        let [x, z] = [index % side, index / side].map(|place| place as f64 / side as f64);
        let angle = index * 137 % 360;
        writeln!(
            file,
            r#"<shape type="instance"><ref id="plate"/><transform name="to_world"><scale value="{scale}"/><rotate y="1" angle="{angle}"/><translate x="{x}" z="{z}"/></transform></shape>"#
        )?;
    }
    Ok(())
}

/// Hills of `side`² quads, as a binary PLY file.
fn write_terrain(path: &Path, side: usize) -> Result<()> {
    let mut file = BufWriter::new(File::create(path)?);
    let (vertices, faces) = ((side + 1) * (side + 1), 2 * side * side);
    write!(
        file,
        "ply\nformat binary_little_endian 1.0\nelement vertex {vertices}\nproperty float x\n\
         property float y\nproperty float z\nelement face {faces}\n\
         property list uchar int vertex_indices\nend_header\n"
    )?;
    for place in 0..vertices {
        let [x, z] = [place % (side + 1), place / (side + 1)].map(|k| k as f32 / side as f32);
        let y = 0.05 * (x * 9.0).sin() * (z * 7.0).cos() + 0.01 * (x * 61.0 + z * 53.0).sin();
        for number in [x, y, z] {
            file.write_all(&number.to_le_bytes())?;
        }
    }
    for quad in 0..side * side {
        let a = (quad / side * (side + 1) + quad % side) as u32;
        let below = a + side as u32 + 1;
        for triangle in [[a, below, a + 1], [a + 1, below, below + 1]] {
            file.write_all(&[3])?;
            for index in triangle {
                file.write_all(&index.to_le_bytes())?;
            }
        }
    }
    file.flush()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scenes_have_what_was_asked_for() {
        let folder = std::env::temp_dir().join(format!("etendue-scale-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let scene = write(&folder, Kind::Triangles, 200).unwrap();
        let hills = std::fs::read(folder.join("terrain.ply")).unwrap();
        let ends = hills.windows(11).position(|bytes| bytes == b"end_header\n").unwrap() + 11;
        assert_eq!(hills.len() - ends, 121 * 12 + 200 * 13);
        assert!(std::fs::read_to_string(scene).unwrap().contains("terrain.ply"));
        let scene = write(&folder, Kind::Instances, 100).unwrap();
        let text = std::fs::read_to_string(scene).unwrap();
        assert_eq!(text.matches("type=\"instance\"").count(), 100);
        assert!(text.ends_with("</scene>\n"));
        std::fs::remove_dir_all(folder).unwrap();
    }
}
