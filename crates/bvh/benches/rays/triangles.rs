//! What rays meet: the file of triangles that `cargo xtask bench rays` writes for a scene (see
//! `triangles` in `xtask-generate`), or generated hills.

use crate::terrain::terrain;
use glam::Vec3;
use std::error::Error;

/// The triangles of one shape.
pub(crate) struct Mesh {
    pub(crate) positions: Vec<Vec3>,
    pub(crate) indices: Vec<[u32; 3]>,
}

/// A pinhole camera: origins and directions at three corners of the film.
pub(crate) struct Camera([[Vec3; 2]; 3]);

impl Camera {
    /// Origin and direction at a position on the film, from (0, 0) in the top left corner to (1, 1).
    pub(crate) fn ray(&self, x: f32, y: f32) -> [Vec3; 2] {
        let [base, right, down] = &self.0;
        let at = |k: usize| base[k] + (right[k] - base[k]) * x + (down[k] - base[k]) * y;
        [at(0), at(1).normalize()]
    }
}

/// Half a million triangles of hills, seen from above one edge.
pub(crate) fn generated() -> (Camera, Vec<Mesh>) {
    let (positions, indices) = terrain(500);
    let origin = Vec3::new(0.5, 0.4, -0.4);
    let corner = |x: f32, y: f32| [origin, Vec3::new(x, y - 0.5, 1.0)];
    let camera = Camera([corner(-0.6, 0.35), corner(0.6, 0.35), corner(-0.6, -0.35)]);
    (camera, vec![Mesh { positions, indices }])
}

/// Reads the file.
pub(crate) fn read(path: &str) -> Result<(Camera, Vec<Mesh>), Box<dyn Error>> {
    let bytes = std::fs::read(path)?;
    let mut words = Words(&bytes);
    let mut corners = [[Vec3::ZERO; 2]; 3];
    for vector in corners.as_flattened_mut() {
        *vector = Vec3::from_array(words.next()?.map(f32::from_bits));
    }
    let mut meshes = Vec::new();
    for _ in 0..words.count()? {
        let (vertices, triangles) = (words.count()?, words.count()?);
        let position = |words: &mut Words| Ok(Vec3::from_array(words.next()?.map(f32::from_bits)));
        let positions =
            (0..vertices).map(|_| position(&mut words)).collect::<Result<_, Box<dyn Error>>>()?;
        let indices =
            (0..triangles).map(|_| words.next()).collect::<Result<_, Box<dyn Error>>>()?;
        meshes.push(Mesh { positions, indices });
    }
    Ok((Camera(corners), meshes))
}

/// The rest of the file.
struct Words<'a>(&'a [u8]);

impl Words<'_> {
    fn next<const N: usize>(&mut self) -> Result<[u32; N], Box<dyn Error>> {
        let mut numbers = [0; N];
        for number in &mut numbers {
            let (word, rest) = self.0.split_first_chunk().ok_or("the file ends early")?;
            (*number, self.0) = (u32::from_le_bytes(*word), rest);
        }
        Ok(numbers)
    }

    fn count(&mut self) -> Result<usize, Box<dyn Error>> {
        let [low, high] = self.next()?;
        Ok(usize::try_from(u64::from(high) << 32 | u64::from(low))?)
    }
}
