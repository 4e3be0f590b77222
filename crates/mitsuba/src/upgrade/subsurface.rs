//! Subsurface scattering of version 0.6: its diffuse reflectance replaces it.

use etendue_document::{Child, Class, FlatNode, NodeId, Value};
use glam::DVec3;

use super::approximation::Approximations;
use super::bsdf::with_parameters;
use super::entries::{color, find, new_parameter, number, take};
use super::medium;

/// The index of refraction of version 0.6's presets, most of which are liquids in water.
const USUAL_INDEX: f64 = 1.3;

/// Replaces the subsurface scattering of a shape by the diffuse reflectance of a half-space of the
/// same medium. The shape's own coat stays: `plastic` and `roughplastic` get that reflectance
/// underneath, dielectrics become such plastics, and a diffuse surface adds it to its own. Returns
/// what was replaced.
pub(super) fn upgrade(
    nodes: &mut Vec<FlatNode>,
    index: usize,
    approximations: &mut Approximations,
) -> Option<NodeId> {
    let of_class = |nodes: &[FlatNode], class| {
        let mut children = nodes[index].children.iter();
        children.position(|child| nodes[child.node.index()].class == class)
    };
    let place = of_class(nodes, Class::Subsurface)?;
    let scattering_node = nodes[index].children[place].node;
    let scattering = scattering_node.index();
    nodes[index].children.retain(|child| child.node.index() != scattering);
    let FlatNode { plugin, span, .. } = &nodes[scattering];
    let message = format!(
        "`{plugin}` is rendered as its diffuse reflectance: light does not spread below the surface"
    );
    approximations.add(message, *span);

    let reflectance = diffuse_reflectance(&mut nodes[scattering].clone());
    let surface = of_class(nodes, Class::Bsdf).map(|place| nodes[index].children[place].node);
    let material = match surface {
        None => {
            let reflectance = new_parameter(&nodes[index], "reflectance", Value::Rgb(reflectance));
            with_parameters(&nodes[index], "diffuse", vec![reflectance])
        }
        Some(id) => match coated(nodes[id.index()].clone(), reflectance) {
            Some(material) => material,
            None => return Some(scattering_node),
        },
    };
    nodes.push(material);
    // Other shapes keep the surface as it was.
    let (node, span) = (NodeId(nodes.len() as u32 - 1), nodes[index].span);
    let children = &mut nodes[index].children;
    match children.iter_mut().find(|child| Some(child.node) == surface) {
        Some(child) => child.node = node,
        None => children.push(Child { name: None, node, span }),
    }
    Some(scattering_node)
}

/// A surface with this diffuse reflectance under its coat; `None` if it has no room for one.
fn coated(mut surface: FlatNode, reflectance: DVec3) -> Option<FlatNode> {
    let plastic = match surface.plugin.as_str() {
        "plastic" | "dielectric" | "thindielectric" => "plastic",
        "roughplastic" | "roughdielectric" => "roughplastic",
        "diffuse" => {
            let own = match find(&surface, "reflectance") {
                Some(own) => color(&own.value)?,
                None if surface.children.is_empty() => DVec3::splat(0.5),
                None => return None,
            };
            take(&mut surface, "reflectance");
            let sum = Value::Rgb((own + reflectance).min(DVec3::ONE));
            let sum = new_parameter(&surface, "reflectance", sum);
            surface.parameters.push(sum);
            surface.id = None;
            return Some(surface);
        }
        _ => return None,
    };
    for name in ["diffuse_reflectance", "nonlinear", "specular_transmittance"] {
        take(&mut surface, name);
        surface.children.retain(|child| child.name.as_deref() != Some(name));
    }
    let diffuse = new_parameter(&surface, "diffuse_reflectance", Value::Rgb(reflectance));
    surface.parameters.push(diffuse);
    surface.plugin = plastic.into();
    surface.id = None;
    Some(surface)
}

/// The diffuse reflectance of a half-space (Jensen et al. 2001, *A Practical Model for Subsurface
/// Light Transport*, section 2.4).
fn diffuse_reflectance(medium: &mut FlatNode) -> DVec3 {
    let preset = medium::preset(medium);
    let mut given = |name: &str| take(medium, name).and_then(|found| color(&found.value));
    let (extinction, albedo) = (given("sigma_t"), given("albedo"));
    let (scattering, absorption) = match (extinction, albedo) {
        (Some(extinction), Some(albedo)) => (albedo * extinction, (1.0 - albedo) * extinction),
        _ => {
            let (scattering, absorption) = preset.unwrap_or_else(medium::skin);
            (given("sigma_s").unwrap_or(scattering), given("sigma_a").unwrap_or(absorption))
        }
    };
    let anisotropy = find(medium, "g").and_then(|g| color(&g.value)).unwrap_or(DVec3::ZERO);
    let reduced = scattering * (1.0 - anisotropy);
    let index = |name| find(medium, name).and_then(|index| number(&index.value));
    let eta = index("int_ior").unwrap_or(USUAL_INDEX) / index("ext_ior").unwrap_or(1.0);
    let of_channel = |channel: usize| {
        let extinction = reduced[channel] + absorption[channel];
        if extinction > 0.0 { half_space(reduced[channel] / extinction, eta) } else { 0.0 }
    };
    DVec3::new(of_channel(0), of_channel(1), of_channel(2))
}

/// The share of the light that a half-space of this reduced albedo sends back.
fn half_space(albedo: f64, eta: f64) -> f64 {
    let albedo = albedo.clamp(0.0, 1.0);
    // Egan and Hilgeman's fit of the internal reflection.
    let internal = -1.440 / (eta * eta) + 0.710 / eta + 0.668 + 0.0636 * eta;
    let internal = if eta > 1.0 { internal.clamp(0.0, 0.999) } else { 0.0 };
    let boundary = (1.0 + internal) / (1.0 - internal);
    let root = (3.0 * (1.0 - albedo)).sqrt();
    0.5 * albedo * (1.0 + (-4.0 / 3.0 * boundary * root).exp()) * (-root).exp()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_half_space_without_absorption_sends_all_light_back() {
        for eta in [0.7, 1.0, 1.3, 1.5] {
            assert_eq!(half_space(1.0, eta), 1.0);
            assert_eq!(half_space(0.0, eta), 0.0);
            assert!(half_space(0.9, eta) < half_space(0.99, eta));
        }
        // 0.45 (1 + exp(−4/3 · √0.3)) exp(−√0.3): the boundary reflects nothing.
        assert!((half_space(0.9, 1.0) - 0.385_584).abs() < 1e-5, "{}", half_space(0.9, 1.0));
    }
}
