//! Transforms in styles that cannot be read. The resolver ignores them.

use roxmltree::Node;
use std::str::FromStr;
use svgtypes::Transform;

/// Values that are not transforms.
const WORDS: [&str; 4] = ["none", "inherit", "initial", "unset"];

/// Messages about the transforms in the style of an element, or in a style sheet, that cannot be
/// read.
pub fn unreadable_transforms(node: Node) -> Vec<String> {
    let style = match node.tag_name().name() {
        "style" => node.text(),
        _ => node.attribute("style"),
    };
    let unreadable = |value: &&str| !WORDS.contains(value) && Transform::from_str(value).is_err();
    let values = transforms(style.unwrap_or_default());
    let message = |value| {
        format!(
            "transform \"{value}\" cannot be read and is ignored; write it as an attribute of SVG, as in \
             transform=\"rotate(30) scale(2)\", without units"
        )
    };
    values.filter(unreadable).map(message).collect()
}

/// The values of the property `transform` in a style.
fn transforms(style: &str) -> impl Iterator<Item = &str> {
    let declarations = style.split([';', '{', '}']);
    declarations.filter_map(|declaration| {
        let (name, value) = declaration.split_once(':')?;
        (name.trim() == "transform").then_some(value.trim())
    })
}
