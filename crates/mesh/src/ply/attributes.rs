//! Assigns the properties of a PLY file to attributes and their channels.

use super::header::{Element, Property};
use super::scalar::ScalarType;
use crate::triangle_mesh::{Attribute, AttributeDomain};

/// The channels of a colour, in both spellings.
const COLOR_CHANNELS: [[&str; 2]; 4] =
    [["r", "red"], ["g", "green"], ["b", "blue"], ["a", "alpha"]];

/// An attribute that is filled from the properties of an element.
#[derive(Debug)]
pub(super) struct Column {
    attribute: Attribute,
    /// The properties that are its channels, in order.
    properties: Vec<usize>,
    /// The divisor of each channel.
    divisors: Vec<f32>,
}

impl Column {
    /// The columns of all numbers of `element`, except the properties in `taken`.
    pub(super) fn all(element: &Element, domain: AttributeDomain, taken: &[usize]) -> Vec<Self> {
        let mut columns: Vec<Self> = Vec::new();
        // The stem of the last column, as long as its next channel may follow.
        let mut open_stem = None;
        for (index, property) in element.properties.iter().enumerate() {
            if taken.contains(&index) || property.list_count.is_some() {
                open_stem = None;
                continue;
            }
            let channel = channel_of(&property.name);
            if let (Some((stem, place)), Some(column)) = (&channel, columns.last_mut())
                && open_stem.as_ref() == Some(stem)
                && *place == column.properties.len()
            {
                column.push(index, property);
                continue;
            }
            open_stem = channel
                .filter(|&(ref stem, place)| {
                    let name = format!("{}{stem}", domain.prefix());
                    place == 0 && !columns.iter().any(|column| column.attribute.name == name)
                })
                .map(|(stem, _)| stem);
            let name = open_stem.as_deref().unwrap_or(&property.name);
            columns.push(Self::new(domain, name));
            if let Some(column) = columns.last_mut() {
                column.push(index, property);
            }
        }
        columns
    }

    fn new(domain: AttributeDomain, stem: &str) -> Self {
        let name = format!("{}{stem}", domain.prefix());
        let attribute = Attribute { name, domain, channels: 0, values: Vec::new() };
        Self { attribute, properties: Vec::new(), divisors: Vec::new() }
    }

    fn push(&mut self, index: usize, property: &Property) {
        let is_color = self.attribute.name.ends_with("_color");
        self.attribute.channels += 1;
        self.properties.push(index);
        self.divisors.push(match property.value {
            ScalarType::Uint8 if is_color => f32::from(u8::MAX),
            ScalarType::Uint16 if is_color => f32::from(u16::MAX),
            _ => 1.0,
        });
    }

    /// Reserves memory for the values of `count` vertices or faces.
    pub(super) fn reserve(&mut self, count: usize) {
        self.attribute.values.reserve_exact(count.saturating_mul(self.properties.len()));
    }

    /// Appends the values of one vertex or face; `value` returns the value of a property.
    #[inline]
    pub(super) fn append(&mut self, value: impl Fn(usize) -> f32) {
        let channels = self.properties.iter().zip(&self.divisors);
        self.attribute
            .values
            .extend(channels.map(|(&property, divisor)| value(property) / divisor));
    }

    /// The finished attribute.
    pub(super) fn finish(mut self) -> Attribute {
        self.attribute.values.shrink_to_fit();
        self.attribute
    }
}

/// The stem of the attribute that a property belongs to, and the channel: `foo` and 2 for `foo_2`
/// and `foo_z`, `foo_color` and 2 for `foo_b`, `color` and 2 for `b` and `blue`.
fn channel_of(name: &str) -> Option<(String, usize)> {
    let color = |word: &str| COLOR_CHANNELS.iter().position(|names| names.contains(&word));
    if let Some(channel) = color(name) {
        return Some(("color".to_owned(), channel));
    }
    let (stem, postfix) = name.rsplit_once('_')?;
    if stem.is_empty() {
        return None;
    }
    if let Some(channel) = ["x", "y", "z", "w"].iter().position(|&axis| axis == postfix) {
        return Some((stem.to_owned(), channel));
    }
    if postfix.len() == 1
        && let Some(channel) = color(postfix)
    {
        return Some((format!("{stem}_color"), channel));
    }
    let is_number = postfix.bytes().all(|byte| byte.is_ascii_digit());
    let channel = postfix.parse().ok().filter(|_| is_number)?;
    Some((stem.to_owned(), channel))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(properties: &[&str]) -> Vec<(String, u32)> {
        let property = |name: &&str| Property {
            name: (*name).to_owned(),
            value: ScalarType::Float32,
            list_count: None,
        };
        let element = Element {
            name: "face".into(),
            row_count: 0,
            properties: properties.iter().map(property).collect(),
        };
        Column::all(&element, AttributeDomain::Face, &[])
            .into_iter()
            .map(|column| (column.attribute.name, column.attribute.channels))
            .collect()
    }

    fn expect(properties: &[&str], expected: &[(&str, u32)]) {
        let expected: Vec<_> = expected.iter().map(|&(name, n)| (name.to_owned(), n)).collect();
        assert_eq!(names(properties), expected, "{properties:?}");
    }

    #[test]
    fn consecutive_properties_with_a_common_prefix_are_one_attribute() {
        expect(&["r", "g", "b"], &[("face_color", 3)]);
        expect(&["red", "green", "blue", "alpha"], &[("face_color", 4)]);
        expect(&["foo_0", "foo_1", "foo_2", "w_0"], &[("face_foo", 3), ("face_w", 1)]);
        expect(&["foo_x", "foo_y", "foo_z"], &[("face_foo", 3)]);
        expect(&["foo_r", "foo_g", "foo_b"], &[("face_foo_color", 3)]);
        expect(&["color_0", "color_1", "color_2", "r"], &[("face_color", 3), ("face_r", 1)]);
    }

    #[test]
    fn ungrouped_properties_keep_their_names() {
        expect(&["quality", "foo_bar"], &[("face_quality", 1), ("face_foo_bar", 1)]);
        expect(&["foo_1", "foo_0"], &[("face_foo_1", 1), ("face_foo", 1)]);
        expect(&["a_0", "b_0", "a_1"], &[("face_a", 1), ("face_b", 1), ("face_a_1", 1)]);
        expect(&["_0", "foo_+0", "foo_"], &[("face__0", 1), ("face_foo_+0", 1), ("face_foo_", 1)]);
    }
}
