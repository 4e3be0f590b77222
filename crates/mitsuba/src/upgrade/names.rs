//! Parameter names: camelCase and renames.

use etendue_document::{FlatNode, NameInterner};

use super::tables;

/// Gives every parameter and child of a node its version 3 name.
pub(super) fn upgrade(node: &mut FlatNode, names: &mut NameInterner) {
    for parameter in &mut node.parameters {
        if let Some(name) = snake_case(&parameter.name) {
            parameter.name = names.name(&name);
        }
    }
    for child in &mut node.children {
        if let Some(name) = child.name.as_deref().and_then(snake_case) {
            child.name = Some(names.name(&name));
        }
    }
    for (old, new) in tables::renamed_parameters(node.class, &node.plugin) {
        rename(node, old, new);
    }
}

/// Renames a parameter or child, unless the new name is taken.
fn rename(node: &mut FlatNode, old: &str, new: &str) {
    let taken = node.parameters.iter().any(|parameter| parameter.name == new)
        || node.children.iter().any(|child| child.name.as_deref() == Some(new));
    if taken {
        return;
    }
    for parameter in node.parameters.iter_mut().filter(|parameter| parameter.name == old) {
        parameter.name = new.into();
    }
    for child in &mut node.children {
        if child.name.as_deref() == Some(old) {
            child.name = Some(new.into());
        }
    }
}

/// The snake_case form of a camelCase name: an underscore before every run of capitals that follows
/// a lower-case letter or a digit. `None` if there is no such run.
fn snake_case(name: &str) -> Option<String> {
    if !name.bytes().any(|byte| byte.is_ascii_uppercase()) {
        return None;
    }
    let mut snake = String::with_capacity(name.len() + 4);
    let mut inside_run = false;
    let mut changed = false;
    let mut before = None;
    for letter in name.chars() {
        let starts_run = before.is_some_and(|b: char| b.is_ascii_lowercase() || b.is_ascii_digit());
        inside_run = letter.is_ascii_uppercase() && (inside_run || starts_run);
        if inside_run {
            changed = true;
            if starts_run {
                snake.push('_');
            }
            snake.push(letter.to_ascii_lowercase());
        } else {
            snake.push(letter);
        }
        before = Some(letter);
    }
    changed.then_some(snake)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn camel_case_becomes_snake_case() {
        let cases = [
            ("toWorld", "to_world"),
            ("intIOR", "int_ior"),
            ("extEta", "ext_eta"),
            ("cropOffsetX", "crop_offset_x"),
            ("maxSmoothAngle", "max_smooth_angle"),
            ("wrapModeU", "wrap_mode_u"),
            ("rrDepth", "rr_depth"),
            ("toUV", "to_uv"),
        ];
        for (camel, snake) in cases {
            assert_eq!(snake_case(camel).as_deref(), Some(snake));
        }
        for same in ["to_world", "alpha", "color0", "K", "UV", "", "größe"] {
            assert_eq!(snake_case(same), None, "{same}");
        }
    }
}
