//! Lengths of a drawing (SVG 1.1, sec. 7.10), and the size of its page.

use super::{Fault, fault};
use kurbo::Affine;
use roxmltree::Node;
use std::str::FromStr;
use svgtypes::{Align, AspectRatio, Length, LengthUnit, ViewBox};

/// A user unit of a drawing without a size, m: 1/96 inch.
const PIXEL: f64 = 0.0254 / 96.0;
/// Font size for lengths in `em`, user units. An `ex` is half of it.
const FONT_SIZE: f64 = 16.0;
/// Default sides of a viewport, user units.
const VIEWPORT: [f64; 2] = [100.0, 100.0];

/// The page of a drawing.
pub struct Page {
    /// Transformation from user units to metres, with y upwards.
    pub to_metres: Affine,
    /// Width and height, user units.
    pub viewport: [f64; 2],
    /// Lower corner of the view box, user units.
    pub corner: [f64; 2],
}

impl Page {
    /// The page of a root element. The origin is its lower left corner. Without a view box it is
    /// the lower left corner of the first unit.
    ///
    /// # Errors
    /// A length or the view box cannot be read.
    pub fn of(root: Node, notes: &mut Vec<String>) -> Result<Self, Fault> {
        let (width, height) = (side(root, "width", notes)?, side(root, "height", notes)?);
        let Some([x, y, w, h]) = view_box(root, notes)? else {
            let bottom = height.unwrap_or(0.0);
            let [across, up] = [width, height].map(|side| side.map(|metres| metres / PIXEL));
            return Ok(Self {
                to_metres: Affine::new([PIXEL, 0.0, 0.0, -PIXEL, 0.0, bottom]),
                viewport: [across.unwrap_or(VIEWPORT[0]), up.unwrap_or(VIEWPORT[1])],
                corner: [0.0, 0.0],
            });
        };
        let aspect = root.attribute("preserveAspectRatio");
        let aspect = aspect.and_then(|text| AspectRatio::from_str(text).ok());
        let aspect = aspect.unwrap_or_default();
        let [across, up] = match (width, height) {
            (Some(width), Some(height)) if aspect.align == Align::None => [width / w, height / h],
            (Some(width), Some(height)) if aspect.slice => [(width / w).max(height / h); 2],
            (Some(width), Some(height)) => [(width / w).min(height / h); 2],
            (Some(width), None) => [width / w; 2],
            (None, Some(height)) => [height / h; 2],
            (None, None) => [PIXEL; 2],
        };
        Ok(Self {
            to_metres: Affine::new([across, 0.0, 0.0, -up, -across * x, up * (y + h)]),
            viewport: [w, h],
            corner: [x, y],
        })
    }
}

/// `width` or `height` of the page, m; `None` if it depends on the window, such as `auto` and
/// percentages.
fn side(root: Node, name: &str, notes: &mut Vec<String>) -> Result<Option<f64>, Fault> {
    let text = root.attribute(name).map_or("", str::trim);
    if text.is_empty() || text == "auto" {
        return Ok(None);
    }
    let length = Length::from_str(text).map_err(|error| fault(root, name, error))?;
    if length.unit == LengthUnit::Percent {
        return Ok(None);
    }
    let metres = match length.unit {
        LengthUnit::None | LengthUnit::Px => length.number * PIXEL,
        LengthUnit::In => length.number * 0.0254,
        LengthUnit::Cm => length.number * 0.01,
        LengthUnit::Mm => length.number * 0.001,
        LengthUnit::Pt => length.number * (0.0254 / 72.0),
        LengthUnit::Pc => length.number * (0.0254 / 6.0),
        LengthUnit::Em => length.number * FONT_SIZE * PIXEL,
        LengthUnit::Ex => length.number * 0.5 * FONT_SIZE * PIXEL,
        LengthUnit::Percent => return Ok(None),
    };
    if metres == 0.0 {
        notes.push(format!(
            "{name}=\"{text}\" is not a size of a page; a unit is 1/96 inch unless the other side gives its length"
        ));
        return Ok(None);
    }
    if metres > 0.0 && metres.is_finite() {
        Ok(Some(metres))
    } else {
        Err(fault(root, name, "must be above 0"))
    }
}

/// The view box of a root element, if it has one that spans an area.
fn view_box(root: Node, notes: &mut Vec<String>) -> Result<Option<[f64; 4]>, Fault> {
    let Some(text) = root.attribute("viewBox") else {
        return Ok(None);
    };
    match ViewBox::from_str(text) {
        Ok(ViewBox { x, y, w, h }) if [x, y, w, h].iter().all(|number| number.is_finite()) => {
            Ok(Some([x, y, w, h]))
        }
        Ok(_) => Err(fault(root, "viewBox", "its numbers must be finite")),
        Err(svgtypes::ViewBoxError::InvalidSize) => {
            notes.push(format!("viewBox=\"{text}\" spans no area and is ignored"));
            Ok(None)
        }
        Err(error) => Err(fault(root, "viewBox", error)),
    }
}

/// Reference length of a percentage.
#[derive(Clone, Copy)]
pub enum Side {
    /// The width of the viewport.
    Across,
    /// Height of the viewport.
    Up,
    /// Diagonal of the viewport over √2.
    Both,
}

/// A length of an element in user units; `None` if the attribute is missing or `auto`.
///
/// # Errors
/// It cannot be read.
pub fn length(node: Node, name: &str, side: Side) -> Result<Option<f64>, Fault> {
    let text = node.attribute(name).map_or("", str::trim);
    if text.is_empty() || text == "auto" {
        return Ok(None);
    }
    let length = Length::from_str(text).map_err(|error| fault(node, name, error))?;
    let unit = match length.unit {
        LengthUnit::None | LengthUnit::Px => 1.0,
        LengthUnit::In => 96.0,
        LengthUnit::Cm => 96.0 / 2.54,
        LengthUnit::Mm => 96.0 / 25.4,
        LengthUnit::Pt => 96.0 / 72.0,
        LengthUnit::Pc => 16.0,
        LengthUnit::Em => FONT_SIZE,
        LengthUnit::Ex => 0.5 * FONT_SIZE,
        LengthUnit::Percent => {
            let [width, height] = viewport(node);
            let whole = match side {
                Side::Across => width,
                Side::Up => height,
                Side::Both => (0.5 * (width * width + height * height)).sqrt(),
            };
            whole / 100.0
        }
    };
    Ok(Some(length.number * unit))
}

/// Width and height of the viewport around an element, user units.
fn viewport(node: Node) -> [f64; 2] {
    let mut around = node.ancestors().skip(1);
    let frame = around.find(|above| {
        matches!(above.tag_name().name(), "svg" | "symbol")
            && (above.has_attribute("viewBox") || above.has_attribute("width"))
    });
    let Some(frame) = frame else {
        return VIEWPORT;
    };
    let boxed = frame.attribute("viewBox").map(ViewBox::from_str);
    if let Some(Ok(ViewBox { w, h, .. })) = boxed {
        return [w, h];
    }
    let side = |name, side| length(frame, name, side).ok().flatten();
    [
        side("width", Side::Across).unwrap_or(VIEWPORT[0]),
        side("height", Side::Up).unwrap_or(VIEWPORT[1]),
    ]
}
