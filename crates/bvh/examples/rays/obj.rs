//! Just enough of a reader of OBJ files for measurements.

use glam::Vec3;
use std::error::Error;

/// The triangles of one file.
pub(crate) struct Mesh {
    pub(crate) positions: Vec<Vec3>,
    pub(crate) indices: Vec<[u32; 3]>,
}

/// Reads every `.obj` file of a folder, by name.
pub(crate) fn read_folder(folder: &str) -> Result<Vec<Mesh>, Box<dyn Error>> {
    let mut paths: Vec<_> = std::fs::read_dir(folder)?
        .map(|entry| entry.map(|entry| entry.path()))
        .collect::<Result<_, _>>()?;
    paths.retain(|path| path.extension().is_some_and(|extension| extension == "obj"));
    paths.sort();
    paths.iter().map(|path| parse(&std::fs::read_to_string(path)?)).collect()
}

fn parse(text: &str) -> Result<Mesh, Box<dyn Error>> {
    let mut mesh = Mesh { positions: Vec::new(), indices: Vec::new() };
    for line in text.lines() {
        let mut words = line.split_ascii_whitespace();
        match words.next() {
            Some("v") => {
                let numbers: Vec<f32> = words.map(str::parse).collect::<Result<_, _>>()?;
                mesh.positions.push(Vec3::from_slice(numbers.get(..3).ok_or("a short vertex")?));
            }
            Some("f") => {
                let count = mesh.positions.len() as i64;
                let corners =
                    words.map(|word| corner(word, count)).collect::<Result<Vec<_>, _>>()?;
                for pair in corners[1..].windows(2) {
                    mesh.indices.push([corners[0], pair[0], pair[1]]);
                }
            }
            _ => {}
        }
    }
    Ok(mesh)
}

fn corner(word: &str, count: i64) -> Result<u32, Box<dyn Error>> {
    let number: i64 = word.split('/').next().unwrap_or_default().parse()?;
    Ok(u32::try_from(if number < 0 { count + number } else { number - 1 })?)
}
