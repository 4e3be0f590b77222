//! `mesh_attribute`: an attribute of a mesh's vertices or faces.

use super::{TextureModel, Textures};
use crate::builder::Builder;
use crate::ids::ShapeId;
use crate::interaction::SurfaceInteraction;
use crate::manual::{Manual, parameter};
use etendue_document::{Fault, Parameters};
use etendue_mesh::{Attribute, AttributeDomain};
use etendue_spectrum::Spectrum;
use std::sync::Arc;

/// The manual page.
pub const MANUAL: Manual = Manual {
    summary: "An attribute of the mesh that it lies on: the numbers that a PLY file holds for each \
              vertex, which are interpolated, or for each face. One number is grey, three are a \
              colour, of four the last is left out. Lights cannot be coloured by it.",
    parameters: &[
        parameter(
            "name",
            "string",
            "",
            "The attribute, with `vertex_` or `face_` before its name: the properties `r`, `g` and \
             `b` of the vertices are `vertex_color`, the property `weight` of the faces is \
             `face_weight`. Required.",
        ),
        parameter("scale", "float", "1", "A factor on the numbers."),
    ],
    sample: r#"<scene>
    <shape type="ply">
        <string name="filename" value="sample.ply"/>
        <bsdf type="diffuse">
            <texture type="mesh_attribute" name="reflectance">
                <string name="name" value="vertex_color"/>
            </texture>
        </bsdf>
    </shape>
</scene>"#,
};

/// An attribute of the mesh to which the texture is applied.
#[derive(Clone, Debug)]
pub struct MeshAttribute {
    name: String,
    scale: f32,
    /// By shape in ascending order, for binary search, as few shapes have any.
    places: Vec<(ShapeId, Arc<TriangleValues>)>,
}

/// The values of an attribute on one mesh, grouped by triangle.
///
/// Vertex values are repeated for each triangle: a hit reads one place in memory, and the texture
/// does not need the mesh's indices.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct TriangleValues {
    is_grey: bool,
    /// Whether each triangle has three values, one per corner, rather than one.
    has_corners: bool,
    values: Vec<f32>,
}

/// Reads the texture. Its values are added once all shapes have been built.
#[must_use]
pub fn build(_: &mut Builder<'_>, parameters: &Parameters<'_>) -> Option<MeshAttribute> {
    let scale = parameters.float_in("scale", 1.0, -1e30..=1e30) as f32;
    let name = parameters.required_string("name")?;
    let domains = [AttributeDomain::Vertex, AttributeDomain::Face];
    if !domains.iter().any(|domain| name.starts_with(domain.prefix())) {
        let message = format!("`{name}` must start with `vertex_` or `face_`");
        parameters.error(Fault::BadValue, "name", message);
        return None;
    }
    Some(MeshAttribute { name: name.to_owned(), scale, places: Vec::new() })
}

impl TextureModel for MeshAttribute {
    fn eval(&self, _textures: Textures<'_>, surface: &SurfaceInteraction) -> Spectrum {
        self.eval(surface)
    }

    fn mean(&self, _textures: Textures<'_>) -> Spectrum {
        self.mean()
    }

    fn memory_bytes(&self) -> usize {
        self.memory_bytes()
    }
}

impl MeshAttribute {
    /// The attribute's name, including its domain.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Adds the values on a shape. Shapes must be added in ascending order.
    pub(crate) fn connect(&mut self, shape: ShapeId, values: Arc<TriangleValues>) {
        debug_assert!(self.places.last().is_none_or(|(last, _)| *last < shape));
        self.places.push((shape, values));
    }

    /// The colour at a surface point; black if the shape lacks the attribute, which the scene
    /// builder reports.
    #[must_use]
    pub fn eval(&self, surface: &SurfaceInteraction) -> Spectrum {
        let found = self.places.binary_search_by_key(&surface.shape, |(shape, _)| *shape);
        found.map_or(Spectrum::ZERO, |place| self.places[place].1.eval(surface) * self.scale)
    }

    /// The mean colour of all faces or corners.
    #[must_use]
    pub fn mean(&self) -> Spectrum {
        let (mut sum, mut count) = ([0.0; 3], 0.0);
        for value in self.places.iter().flat_map(|(_, values)| values.colors()) {
            count += 1.0;
            for (sum, value) in sum.iter_mut().zip(value.rgb()) {
                *sum += f64::from(value);
            }
        }
        let mean = sum.map(|sum| (sum / f64::max(count, 1.0)) as f32);
        Spectrum::from_rgb(mean) * self.scale
    }

    /// Memory use in bytes.
    #[must_use]
    pub fn memory_bytes(&self) -> usize {
        self.places.iter().map(|(_, values)| size_of_val(values.values.as_slice())).sum()
    }
}

impl TriangleValues {
    /// Collects the values on the triangles of a mesh; `None` unless there are one, three or four
    /// channels.
    pub(crate) fn new(attribute: &Attribute, triangles: &[[u32; 3]]) -> Option<Self> {
        let channels = attribute.channels as usize;
        let kept = match channels {
            1 => 1,
            3 | 4 => 3,
            _ => return None,
        };
        let of = |index: usize| &attribute.values[index * channels..index * channels + kept];
        let values = match attribute.domain {
            AttributeDomain::Vertex => triangles
                .iter()
                .flatten()
                .flat_map(|&vertex| of(vertex as usize))
                .copied()
                .collect(),
            AttributeDomain::Face => (0..triangles.len()).flat_map(of).copied().collect(),
        };
        let has_corners = attribute.domain == AttributeDomain::Vertex;
        Some(Self { is_grey: kept == 1, has_corners, values })
    }

    /// All values, as colours.
    fn colors(&self) -> impl Iterator<Item = Spectrum> + '_ {
        self.values.chunks_exact(self.channels()).map(|value| match *value {
            [red, green, blue] => Spectrum::from_rgb([red, green, blue]),
            _ => Spectrum::splat(value[0]),
        })
    }

    fn channels(&self) -> usize {
        if self.is_grey { 1 } else { 3 }
    }

    fn color(&self, index: usize) -> Spectrum {
        if self.is_grey {
            return Spectrum::splat(self.values[index]);
        }
        let value = &self.values[3 * index..3 * index + 3];
        Spectrum::from_rgb([value[0], value[1], value[2]])
    }

    fn eval(&self, surface: &SurfaceInteraction) -> Spectrum {
        let triangle = surface.primitive as usize;
        if !self.has_corners {
            return self.color(triangle);
        }
        let second_and_third = surface.barycentric;
        let first = 1.0 - second_and_third.x - second_and_third.y;
        self.color(3 * triangle) * first
            + self.color(3 * triangle + 1) * second_and_third.x
            + self.color(3 * triangle + 2) * second_and_third.y
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use etendue_math::Frame;
    use glam::{Vec2, Vec3};

    const TRIANGLES: [[u32; 3]; 2] = [[0, 1, 2], [0, 2, 3]];

    fn texture(attribute: &Attribute) -> MeshAttribute {
        let values = TriangleValues::new(attribute, &TRIANGLES).expect("channels of a texture");
        let mut texture =
            MeshAttribute { name: attribute.name.clone(), scale: 2.0, places: Vec::new() };
        texture.connect(ShapeId(3), Arc::new(values));
        texture
    }

    fn at(shape: u32, primitive: u32, barycentric: Vec2) -> SurfaceInteraction {
        let shape = ShapeId(shape);
        let frame = Frame::from_normal(Vec3::Z);
        SurfaceInteraction {
            shape,
            primitive,
            barycentric,
            ..SurfaceInteraction::at_uv(Vec2::ZERO, frame)
        }
    }

    #[test]
    fn values_of_vertices_are_interpolated() {
        let values: Vec<f32> = (0..4).flat_map(|i| [i as f32, 10.0 * i as f32, 1.0, 7.0]).collect();
        let domain = AttributeDomain::Vertex;
        let attribute = Attribute { name: "vertex_color".into(), domain, channels: 4, values };
        let texture = texture(&attribute);
        let corner = texture.eval(&at(3, 1, Vec2::Y));
        assert_eq!(corner.rgb(), [6.0, 60.0, 2.0]);
        let middle = texture.eval(&at(3, 1, Vec2::splat(0.25))).rgb();
        assert_eq!(middle, [2.5, 25.0, 2.0]);
        assert_eq!(texture.eval(&at(2, 1, Vec2::ZERO)), Spectrum::ZERO);
        // The corners are 0, 1, 2 and 0, 2, 3.
        assert!((texture.mean()[0] - 2.0 * 8.0 / 6.0).abs() < 1e-6);
    }

    #[test]
    fn values_of_faces_are_constant() {
        let domain = AttributeDomain::Face;
        let values = vec![0.5, 0.25];
        let attribute = Attribute { name: "face_weight".into(), domain, channels: 1, values };
        let texture = texture(&attribute);
        assert_eq!(texture.eval(&at(3, 0, Vec2::splat(0.2))).rgb(), [1.0; 3]);
        assert_eq!(texture.eval(&at(3, 1, Vec2::splat(0.4))).rgb(), [0.5; 3]);
    }

    #[test]
    fn two_channels_are_no_color() {
        let domain = AttributeDomain::Face;
        let attribute =
            Attribute { name: "face_uv".into(), domain, channels: 2, values: vec![0.0; 4] };
        assert_eq!(TriangleValues::new(&attribute, &TRIANGLES), None);
    }
}
